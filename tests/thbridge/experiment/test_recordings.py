"""Recordings that crashes and early ends leave are told, and no others."""

import random
from pathlib import Path

import pytest

from tests.support.studies.experiment_files import write_experiment
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.recordings import moved_aside, notes_on_leftovers
from thbridge.experiment.store.event_log import ExperimentLog, read_log
from thbridge.experiment.store.events import Clocks, EventKind
from thbridge.recording.recordings import active_of


def test_files_moved_aside_are_those_of_one_recording(tmp_path: Path) -> None:
    for name in ("step-4.bag", "step-4-1.bag.active", "step-4-2_0.bag", "step-4-attempt-2.bag", "step-4-1.inputs"):
        (tmp_path / name).touch()
    assert [path.name for path in moved_aside(tmp_path / "step-4.bag")] == ["step-4-1.bag.active", "step-4-2_0.bag"]


@pytest.mark.parametrize("ending", [".bag", ".mcap"])
def test_leftovers_are_told_and_whole_recordings_are_not(tmp_path: Path, ending: str) -> None:
    write_experiment(tmp_path, "title: x\nquota: 3\nsteps:\n  - {step: trial}\n")
    folder = ExperimentFolder(tmp_path)
    folder.log.parent.mkdir()
    with ExperimentLog(folder.log) as log:
        draw = random.Random(1).randrange
        conductor = Conductor(folder.read(), log, lambda: Clocks("2026-01-02T09:00:00Z", 0), draw)
        first, second = (conductor.admit().participant for _ in range(2))
        step = conductor.begin(first)
        for kind, name in (
            (EventKind.RECORDING_CUT_OFF, f"step-1-1{ending}.active"),
            (EventKind.GAME_BROKEN_OFF, f"step-1-2{ending}"),
            (EventKind.GAME_PLAYED, f"recordings/{first}/step-1{ending}"),
        ):
            conductor.tell(kind, first, step, {"bag": name}, "program")
        conductor.begin(second)
        progress = conductor.progress
        for name in (f"step-1-1{ending}.active", f"step-1-2{ending}.active", f"step-1{ending}", f"step-1_0{ending}"):
            file = folder.bag(first, 1, ending).with_name(name)
            file.parent.mkdir(parents=True, exist_ok=True)
            file.touch()
        begun = active_of(folder.bag(second, 1, ending))
        begun.parent.mkdir()
        begun.touch()

        def told() -> list[str]:
            return [
                each.removeprefix("recordings/") for each in notes_on_leftovers(folder, progress, read_log(folder.log))
            ]

        cut, broken = told()
        assert cut.startswith(f"{first}/step-1-1{ending}.active ends where")
        assert broken.startswith(f"{first}/step-1-2{ending}.active is from an interrupted game"), "as it was written"
        conductor.leave(second, "went home")
        progress = conductor.progress
        (ended,) = (each for each in told() if each.startswith(second))
        assert f"step-1{ending}.active is from an unfinished game" in ended
