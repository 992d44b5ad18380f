"""An experiment carried on through crashes: nothing lost, nothing double, nobody sees a step twice or never."""

from collections import Counter
from pathlib import Path

import pytest

from tests.support.studies.experiment_files import write_experiment
from tests.thbridge.experiment.crashing_laboratory import CrashingLaboratory
from thbridge.experiment.allocation.places import NoPlace
from thbridge.experiment.conductor import unfinished
from thbridge.experiment.design.experiment_file import ExperimentDesign, read_experiment
from thbridge.experiment.store.event_log import read_log
from thbridge.experiment.store.events import EventKind, LoggedEvent, RunState, StepOutcome


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(1, 10))])
def test_a_whole_experiment_with_crashes(design: ExperimentDesign, tmp_path: Path, seed: int) -> None:
    laboratory = CrashingLaboratory(design, tmp_path / "log", seed)
    for _ in range(60):
        admitted = laboratory.conductor.admit()
        if isinstance(admitted, NoPlace):
            break
        laboratory.run(admitted.participant)
    laboratory.log.close()
    progress = laboratory.conductor.progress
    assert progress.next_place() is NoPlace.FULL
    assert not unfinished(progress)
    events = [entry.event for entry in read_log(tmp_path / "log") if isinstance(entry, LoggedEvent)]
    for participant, run in progress.runs.items():
        own = [event for event in events if event.participant == participant]
        begun = Counter(event.step for event in own if event.kind == EventKind.STEP_BEGUN)
        ended = Counter(event.step for event in own if event.kind == EventKind.STEP_ENDED)
        if run.state is RunState.COMPLETE:
            plan = run.plan
            assert set(begun) == {step.number for step in plan}
            assert begun == ended
            repeats = {number for number, times in begun.items() if times > 1}
            assert repeats <= {3, 4}, "only a failed check and its practice come again"
            given = Counter((event.step, event.data["item"]) for event in own if event.kind == EventKind.ITEM_GIVEN)
            assert all(times == begun[step] for (step, _), times in given.items()), "asked once each time"
            wanted = {step.number for step in plan if step.entry.form and step.name != "preference"}
            assert wanted <= {step for step, _ in given}
    complete = [run for run in progress.runs.values() if run.state is RunState.COMPLETE]
    assert len(complete) == design.allocation.size
    assert set(Counter((run.place.cell, run.place.order) for run in complete).values()) == {2}
    lost = {run.place.number for run in progress.runs.values() if run.state is not RunState.COMPLETE}
    assert lost <= {run.place.number for run in complete}, "the place of whoever left or failed was given again"


def test_a_step_that_must_not_go_on_ends_the_run(tmp_path: Path) -> None:
    text = "title: x\nsteps:\n  - {step: trial, resume: never}\n"
    laboratory = CrashingLaboratory(read_experiment(write_experiment(tmp_path, text)), tmp_path / "log", 1)
    run = laboratory.conductor.admit()
    assert laboratory.conductor.begin(run.participant) is not None
    laboratory.crash()
    assert laboratory.conductor.begin(run.participant) is None
    run = laboratory.conductor.progress.runs[run.participant]
    assert (run.state, run.reason) == (RunState.EXCLUDED, "trial_1 could not go on")
    laboratory.log.close()


def test_who_completes_gets_a_code_and_who_is_excluded_opens_a_place(design: ExperimentDesign, tmp_path: Path) -> None:
    laboratory = CrashingLaboratory(design, tmp_path / "log", 4)
    conductor = laboratory.conductor
    first = conductor.admit("service-7").participant
    while (step := conductor.begin(first)) is not None:
        if step.name == "understood":
            data = {"item": "who", "answer": "you"}
            conductor.tell(EventKind.ITEM_GIVEN, first, step, data, "participant")
        assert conductor.end(first, step) is StepOutcome.DONE
    ended = [e.event for e in read_log(tmp_path / "log") if e.event.kind == EventKind.RUN_ENDED]
    assert len(ended[0].data["code"]) == 8
    place = conductor.progress.runs[first].place
    conductor.exclude(first, "knew the study")
    assert conductor.admit().place == place
    laboratory.log.close()


def test_nothing_is_left_of_somebody_who_withdraws(design: ExperimentDesign, tmp_path: Path) -> None:
    laboratory = CrashingLaboratory(design, tmp_path / "log", 5)
    conductor = laboratory.conductor
    gone, stays = conductor.admit("service-1").participant, conductor.admit("service-2").participant
    conductor.note(f"{gone} and {stays} know each other")
    conductor.begin(gone)
    place = conductor.progress.runs[gone].place
    conductor.withdraw(gone)
    assert gone not in conductor.progress.runs
    for file in tmp_path.iterdir():
        if file.is_file():
            assert gone.encode() not in file.read_bytes()
            assert b"service-1" not in file.read_bytes()
    assert stays in conductor.progress.runs
    assert conductor.admit().place == place
    laboratory.crash()
    assert stays in laboratory.conductor.progress.runs
    laboratory.log.close()


def test_listeners_hear_each_event_of_the_log_withdrawals_included(design: ExperimentDesign, tmp_path: Path) -> None:
    laboratory = CrashingLaboratory(design, tmp_path / "log", 6)
    heard: list[LoggedEvent] = []
    laboratory.conductor.listeners.append(heard.append)
    gone = laboratory.conductor.admit().participant
    laboratory.conductor.begin(gone)
    laboratory.conductor.withdraw(gone)
    assert [logged.sequence for logged in heard] == [1, 2, 3]
    assert heard[-1] == read_log(tmp_path / "log")[-1]
    laboratory.log.close()
