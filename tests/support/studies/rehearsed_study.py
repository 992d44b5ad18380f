"""A study with people that was rehearsed without games, for tests of what is shown of one."""

import itertools
import random
from dataclasses import dataclass
from pathlib import Path

from tests.thbridge.experiment.test_design import write
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.rehearsal.clock import RehearsalClock
from thbridge.experiment.rehearsal.people import SimulatedPeople
from thbridge.experiment.rehearsal.rehearsal import Rehearsal
from thbridge.experiment.store.event_log import ExperimentLog, read_log
from thbridge.experiment.store.events import Clocks, LogEntry


def clocks(seconds: int) -> Clocks:
    return Clocks(f"2026-01-02T{9 + seconds // 3600:02}:{seconds // 60 % 60:02}:{seconds % 60:02}Z", seconds * 10**9)


@dataclass(frozen=True)
class Study:
    folder: ExperimentFolder
    design: ExperimentDesign
    entries: tuple[LogEntry, ...]


def rehearse(root: Path) -> Study:
    """A full study of eight places, a second between two events."""
    write(root)
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
    return Study(folder, design, tuple(read_log(folder.log)))
