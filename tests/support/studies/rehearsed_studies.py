"""Studies with people, in which simulated people take part."""

import itertools
import random
from dataclasses import dataclass
from pathlib import Path

from tests.support.studies.experiment_files import write_experiment
from thbridge.experiment.allocation.places import NoPlace
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.export.folder import export_experiment
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.rehearsal.clock import RehearsalClock
from thbridge.experiment.rehearsal.people import PutInEffect, SimulatedPeople
from thbridge.experiment.rehearsal.rehearsal import Rehearsal
from thbridge.experiment.rehearsal.rehearsal import rehearse as play_through
from thbridge.experiment.store.event_log import ExperimentLog, read_log
from thbridge.experiment.store.events import Clocks, LogEntry


def rehearse(root: Path, people: SimulatedPeople, seed: int, text: str | None = None) -> ExperimentFolder:
    folder = ExperimentFolder(root)
    write_experiment(root, *([] if text is None else [text]))
    assert play_through(folder, folder.read(), people, seed) is NoPlace.FULL
    return folder


MIXED_DESIGN = """\
title: Three ways
seed: 5
within: {dialogue.condition: [supervisor, collaborator, adviser]}
between: {robots: [1, 2, 3]}
quota: 6
steps:
  - {step: check, form: understood.yaml, attempts: 2}
  - {step: trial, each_condition: true}
  - {step: form, form: workload, each_condition: true}
  - {step: form, form: trust, each_condition: true}
"""


def rehearsed_export(root: Path) -> Path:
    """Rehearse a mixed design without games, in which collaborators cause more workload; return its export."""
    effect = PutInEffect("workload", 0.2, {"dialogue.condition": "collaborator"})
    people = SimulatedPeople(effects=(effect,), plays=False)
    folder = rehearse(root, people, 3, MIXED_DESIGN)
    export = root / "exports" / "first"
    export_experiment(folder, folder.read(), read_log(folder.log), export, {"thbridge": "1.0"}, None)
    return export


def clocks(seconds: int) -> Clocks:
    return Clocks(f"2026-01-02T{9 + seconds // 3600:02}:{seconds // 60 % 60:02}:{seconds % 60:02}Z", seconds * 10**9)


@dataclass(frozen=True)
class RehearsedStudy:
    folder: ExperimentFolder
    design: ExperimentDesign
    entries: tuple[LogEntry, ...]


def rehearsed_study(root: Path) -> RehearsedStudy:
    """Return a complete study of eight people, with one second between two events."""
    write_experiment(root)
    folder = ExperimentFolder(root)
    design = folder.read()
    folder.log.parent.mkdir()
    ticks = itertools.count()
    with ExperimentLog(folder.log) as log:
        conductor = Conductor(design, log, lambda: clocks(next(ticks)), random.Random(3).randrange)
        conductor.note("the heating was off")
        Rehearsal(design, SimulatedPeople(plays=False), 1, RehearsalClock(), folder.bag, root).run(conductor)
        someone = next(iter(conductor.progress.runs))
        conductor.note("knows the study", someone)
        conductor.exclude(someone, "knows the study")
    return RehearsedStudy(folder, design, tuple(read_log(folder.log)))
