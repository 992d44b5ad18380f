"""Rehearsals: a whole experiment without people, that finds the effect which was put in, and none where none was."""

import hashlib
import itertools
import random
from pathlib import Path

import pandas as pd
import pytest

from tests.thbridge.experiment.test_design import write
from thbridge.experiment.allocation.places import NoPlace
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.export.tables import tables_of
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.progress import EventKind, Progress, RunState
from thbridge.experiment.rehearsal import Rehearsal, Rehearsed
from thbridge.experiment.store.event_log import ExperimentLog, read_log
from thbridge.experiment.store.events import Clocks
from thbridge.recording.bag.reading.reader import info

COLLABORATOR = "dialogue.condition=collaborator"


def rehearse(root: Path, people: Rehearsed, seed: int, text: str | None = None) -> ExperimentFolder:
    folder = ExperimentFolder(root)
    write(root, *([] if text is None else [text]))
    folder.log.parent.mkdir()
    chance, ticks = random.Random(seed), itertools.count()
    design = folder.read()
    with ExperimentLog(folder.log, chance.randbytes) as log:
        conductor = Conductor(
            design, log, lambda: Clocks("2026-01-02T12:00:00Z", next(ticks) * 10**9), chance.randrange
        )
        assert Rehearsal(design, people, seed, folder.bag, root).run(conductor) is NoPlace.FULL
    return folder


def scores(folder: ExperimentFolder, subscale: str) -> pd.DataFrame:
    table = next(table for table in tables_of(folder.read(), read_log(folder.log)) if table.name == "scores")
    frame = pd.DataFrame(table.rows)
    return frame[(frame.subscale == subscale) & frame.counts].dropna(subset="score")


def difference(folder: ExperimentFolder, subscale: str) -> tuple[float, float]:
    """Mean difference within people between the conditions, and its standard error."""
    wide = scores(folder, subscale).pivot_table(index="participant", columns="dialogue.condition", values="score")
    off = (wide.collaborator - wide.supervisor).dropna()
    return off.mean(), off.sem()


def test_an_effect_that_was_put_in_is_found_and_none_where_none_was(tmp_path: Path) -> None:
    people = Rehearsed(effects={("workload", COLLABORATOR): 0.2}, plays=False)
    folder = rehearse(tmp_path, people, 3)
    mean, error = difference(folder, "workload")
    assert mean > 3.0 * error
    assert mean == pytest.approx(20.0, abs=4.0 * error)
    mean, error = difference(folder, "trust")
    assert abs(mean) < 3.0 * error


def test_a_rehearsal_with_games_links_each_trial_to_its_recording(tmp_path: Path) -> None:
    text = (
        "title: x\nbase: {map: arena8, game.energy: 10, participant.strategy: nearest}\n"
        "within: {robots: [1, 2]}\nquota: 2\nsteps:\n  - {step: trial, each_condition: true, max_seconds: 20}\n"
    )
    folder = rehearse(tmp_path, Rehearsed(drop_out=0.0), 1, text)
    played = [e.event for e in read_log(folder.log) if e.event.kind == EventKind.GAME_PLAYED]
    assert len(played) == 4
    for event in played:
        bag = tmp_path / event.data["bag"]
        assert info(bag).messages > 100
        assert hashlib.sha256(bag.read_bytes()).hexdigest() == event.data["sha256"]
        assert event.data["sim_seconds"] > 0


def test_the_same_seed_rehearses_the_same(tmp_path: Path) -> None:
    def logged(name: str, seed: int) -> list[object]:
        (tmp_path / name).mkdir()
        text = "title: x\nquota: 2\nsteps:\n  - {step: form, form: workload}\n  - {step: trial}\n"
        return read_log(rehearse(tmp_path / name, Rehearsed(plays=False), seed, text).log)

    assert logged("a", 1) == logged("b", 1) != logged("c", 2)


def test_people_who_drop_out_are_replaced(tmp_path: Path) -> None:
    text = "title: x\nquota: 8\nsteps:\n  - {step: check, form: understood.yaml}\n  - {step: trial}\n"
    folder = rehearse(tmp_path, Rehearsed(drop_out=0.2, plays=False), 2, text)
    runs = Progress(folder.read()).after(read_log(folder.log)).runs.values()
    assert sum(run.state is RunState.COMPLETE for run in runs) == 8
    assert any(run.state is RunState.LEFT for run in runs)
