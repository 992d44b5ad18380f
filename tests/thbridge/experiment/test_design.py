"""Experiments read with all faults, planned for each person, and carried on by the log alone."""

from collections import Counter
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.studies.experiment_files import EXAMPLE, write_experiment
from thbridge.experiment.design.experiment_file import ExperimentDesign, drawn_seed, read_experiment
from thbridge.experiment.design.plan import plan_of
from thbridge.experiment.progress import BadHistory, Progress
from thbridge.experiment.store.events import Clocks, EventKind, LoggedEvent, NewEvent, RunState
from thbridge.files.errors import BadFile

NOON = Clocks("2026-01-02T12:00:00Z", 0)


def test_conditions_are_studies_with_their_levels(design: ExperimentDesign) -> None:
    assert [condition.name for condition in design.conditions] == [
        "dialogue.condition=supervisor",
        "dialogue.condition=collaborator",
    ]
    assert [cell.name for cell in design.cells] == ["noise.preset=none", "noise.preset=bad wheels"]
    studies = [study for cell in design.cells for study in cell.studies]
    assert {study.robots for study in studies} == {2}
    assert [study.dialogue.condition for study in studies] == ["supervisor", "collaborator"] * 2


def test_each_person_meets_all_conditions_in_the_order_of_their_place(design: ExperimentDesign) -> None:
    orders = Counter()
    for number in range(design.allocation.size):
        place = design.allocation.place(number)
        plan = plan_of(design, place)
        assert [step.number for step in plan] == list(range(1, len(plan) + 1))
        trials = [step for step in plan if step.trial is not None]
        assert [trial.trial for trial in trials] == [0, 1]
        assert tuple(trial.condition for trial in trials) == design.orders[place.order]
        names = [step.name for step in plan]
        assert names[4:10] == ["trial_5", "workload", "trust"] * 2
        orders[place.cell, place.order] += 1
    assert set(orders.values()) == {2}
    assert drawn_seed(design, 0) != drawn_seed(design, 1)


def test_all_faults_of_an_experiment_are_told_with_their_lines(tmp_path: Path) -> None:
    path = write_experiment(
        tmp_path,
        "title: x\nseeds: [1]\nwithin:\n  robots: [1, 2]\n"
        "steps:\n  - {step: consent}\n  - {step: form, form: wrkload}\n"
        "  - {step: trial}\n  - {step: trial, when: {nobody.q: 'yes'}}\n  - {step: check, form: workload}\n",
    )
    with pytest.raises(BadFile) as told:
        read_experiment(path)
    said = str(told.value)
    for fault in (
        "line 2, seeds: 2 trials need 2 seeds, but the list has 1",
        "line 5, steps: no trial is repeated for each condition",
        "line 6, steps[0]: the step consent has no text",
        "line 7, steps[1].form: the form wrkload does not exist. Write the path of a form, or one of preference, trust",
        "line 9, steps[3].when: no earlier step has the name nobody",
        "no item of this check has a right answer",
    ):
        assert fault in said


@pytest.mark.parametrize(
    ("line", "problem"),
    [
        ("within: {robots: [1, 2], seed: [1, 2]}", "seed cannot be a factor"),
        ("base: {robots: 3}\nwithin: {robots: [1, 2]}", "base and robots both set this key"),
        ("within: {robts: [1, 2]}", "the nearest name is robots"),
        ("between: {noise.preset: [none, worse]}", "worse"),
        ("quota: 0", "1 to 100000"),
    ],
)
def test_a_fault_of_a_factor_names_it(tmp_path: Path, line: str, problem: str) -> None:
    path = write_experiment(tmp_path, f"title: x\n{line}\nsteps:\n  - {{step: trial, each_condition: true}}\n")
    with pytest.raises(BadFile) as told:
        read_experiment(path)
    assert problem.lower() in str(told.value).lower()


class Log:
    """A log in memory, and the progress after each of its events."""

    def __init__(self, design: ExperimentDesign) -> None:
        self.progress = Progress(design)
        self.entries: list[LoggedEvent] = []

    def add(self, kind: EventKind, participant: str, step: int = 0, **data: object) -> None:
        event = NewEvent(kind, "program", NOON, participant, step, data=data)
        self.entries.append(LoggedEvent(len(self.entries) + 1, event))
        self.progress = self.progress.after(self.entries[-1:])

    def begin(self, participant: str) -> None:
        self.add(EventKind.RUN_BEGUN, participant, place=self.progress.next_place().number)

    def do(self, participant: str, outcome: str = "done", **answers: str) -> str:
        """Go through the next step; return its name."""
        step = self.progress.next_step(participant)
        assert step is not None
        self.add(EventKind.STEP_BEGUN, participant, step.number)
        for item, answer in answers.items():
            self.add(EventKind.ITEM_GIVEN, participant, step.number, item=item, answer=answer)
        self.add(EventKind.STEP_ENDED, participant, step.number, outcome=outcome)
        return step.name


def test_a_failed_check_is_repeated_from_where_the_design_says_and_then_excludes(design: ExperimentDesign) -> None:
    log = Log(design)
    log.begin("A")
    assert [log.do("A") for _ in range(3)] == ["instructions_1", "consent_2", "practice"]
    assert log.do("A", "failed") == "understood"
    assert [log.do("A"), log.do("A", "failed")] == ["practice", "understood"]
    run = log.progress.runs["A"]
    assert (run.state, run.reason) == (RunState.EXCLUDED, "failed understood")
    assert log.progress.next_step("A") is None
    place = run.place
    log.begin("B")
    assert log.progress.runs["B"].place == place


def test_steps_are_wanted_by_the_answers_given(design: ExperimentDesign) -> None:
    log = Log(design)
    log.begin("A")
    for _ in range(3):
        log.do("A")
    log.do("A", who="you", played="no")
    preference = log.progress.runs["A"].plan[10]
    assert preference.name == "preference"
    assert not log.progress.wants("A", preference)


def test_a_step_of_some_levels_comes_in_these_conditions_alone(tmp_path: Path) -> None:
    only = "only_at: {dialogue.condition: collaborator}"
    told = f"  - {{step: instructions, name: told, text: welcome.md, each_condition: true, {only}}}\n"
    trial = "  - {step: trial, each_condition: true}\n"
    log = Log(read_experiment(write_experiment(tmp_path, EXAMPLE.replace(trial, told + trial))))
    log.begin("A")
    steps = [step for step in log.progress.runs["A"].plan if step.name == "told"]
    wanted = {log.progress.design.conditions[step.condition].name: log.progress.wants("A", step) for step in steps}
    assert wanted == {"dialogue.condition=supervisor": False, "dialogue.condition=collaborator": True}
    assert log.progress.step_count("A") == (1, len(log.progress.runs["A"].plan) - 1)


def test_a_run_cannot_jump_nor_go_through_a_step_twice(design: ExperimentDesign) -> None:
    log = Log(design)
    log.begin("A")
    log.do("A")
    with pytest.raises(BadHistory):
        log.add(EventKind.STEP_BEGUN, "A", 1)
    with pytest.raises(BadHistory):
        log.add(EventKind.STEP_BEGUN, "A", 3)


@given(data=st.data())
def test_progress_read_from_the_log_at_any_moment_is_that_of_the_program_that_died(design, data) -> None:
    log = Log(design)
    people = iter(f"P{number}" for number in range(100))
    for _ in range(data.draw(st.integers(1, 60))):
        active = [person for person, run in log.progress.runs.items() if run.state is RunState.UNDER_WAY]
        place = log.progress.next_place()
        if hasattr(place, "number") and (not active or data.draw(st.integers(0, 4)) == 0):
            log.begin(next(people))
            continue
        if not active:
            break
        person = data.draw(st.sampled_from(active))
        step = log.progress.next_step(person)
        if step is None:
            log.add(EventKind.RUN_ENDED, person, outcome="complete")
        elif data.draw(st.integers(0, 9)) == 0:
            log.add(EventKind.RUN_ENDED, person, outcome="left", reason="went home")
        else:
            failing = step.entry.step == "check" and data.draw(st.booleans())
            log.do(person, "failed" if failing else "done")
        cut = data.draw(st.integers(0, len(log.entries)))
        again = Progress(design).after(log.entries[:cut]).after(log.entries[cut:])
        assert again == log.progress
    held = [run.place.number for run in log.progress.runs.values() if run.holds_place]
    assert len(held) == len(set(held))
    begun = [entry.event for entry in log.entries if entry.event.kind == EventKind.STEP_BEGUN]
    for person in log.progress.runs:
        numbers = [event.step for event in begun if event.participant == person]
        # Nobody passes a step by: forward one by one, back only where a check was failed.
        assert all(later <= earlier + 1 for earlier, later in pairwise(numbers))
