"""Checks of a study with people: every step once and in its order, every recording whole, and what an export says."""

import hashlib
import runpy
import shutil
from collections import Counter
from collections.abc import Callable, Sequence
from itertools import groupby

import pandas as pd

from tests.support.programs.peer_programs import run_peer
from thbridge.experiment.design.plan import PlannedStep
from thbridge.experiment.design.steps import StepKind
from thbridge.experiment.export.folder import export_experiment
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.progress import Run
from thbridge.experiment.store.event_log import read_log
from thbridge.experiment.store.events import EventKind, NewEvent
from thbridge.recording.bag.reading.reader import info


def steps_of(run: Run, *kinds: StepKind) -> list[PlannedStep]:
    return [step for step in run.plan if step.entry.step in kinds]


def check_run(run: Run, events: Sequence[NewEvent], forms: Callable[[PlannedStep], int]) -> None:
    """A complete run has each step once and in its order, its check as often as it was tried."""
    told = Counter(event.kind for event in events)
    assert told[EventKind.RUN_BEGUN] == told[EventKind.RUN_ENDED] == told[EventKind.FAREWELL_READ] == 1
    begun = [event.step for event in events if event.kind == EventKind.STEP_BEGUN]
    assert begun == [event.step for event in events if event.kind == EventKind.STEP_ENDED]
    assert [step for step, _ in groupby(begun)] == [step.number for step in run.plan]
    assert {step for step, times in Counter(begun).items() if times > 1} <= {
        step.number for step in steps_of(run, StepKind.CHECK)
    }
    played = [event.step for event in events if event.kind == EventKind.GAME_PLAYED]
    assert played == [step.number for step in steps_of(run, StepKind.TRIAL)]
    given = Counter(event.step for event in events if event.kind == EventKind.ITEM_GIVEN)
    for step in steps_of(run, StepKind.FORM):
        assert given[step.number] == forms(step)


def check_recordings(folder: ExperimentFolder, events: Sequence[NewEvent]) -> None:
    """Every game has its own recording, which is the one that the log names."""
    games = [event for event in events if event.kind == EventKind.GAME_PLAYED]
    for event in games:
        bag = folder.root / str(event.data["bag"])
        assert hashlib.sha256(bag.read_bytes()).hexdigest() == event.data["sha256"]
        assert info(bag).messages > 100
    assert len({event.data["bag"] for event in games}) == len(games)


def analysed(folder: ExperimentFolder) -> pd.DataFrame:
    """What pandas, and R where it is installed, say of the export."""
    export = folder.export("first")
    export_experiment(folder, folder.read(), read_log(folder.log), export, {"thbridge": "1.0"}, None)
    table = runpy.run_path(str(export / "analysis.py"), run_name="__main__")["table"]
    assert table("steps").duration_s.dtype == "float64"
    assert table("participants").began.dt.tz is not None
    assert table("answers")["dialogue.condition"].cat.categories.tolist() == ["supervisor", "collaborator"]
    assert table("trials").counts.all()
    tests = pd.read_csv(export / "results" / "tests-python.csv")
    if shutil.which("Rscript") is not None:
        run_peer(["Rscript", "analysis.R"], cwd=export).check_returncode()
        r = pd.read_csv(export / "results" / "tests-r.csv")
        pd.testing.assert_frame_equal(tests, r, check_dtype=False, rtol=1e-4, atol=1e-9)
    return tests
