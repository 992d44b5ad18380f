"""Tables of an experiment: what pandas reads is what people answered."""

import itertools
import math
from pathlib import Path

import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.thbridge.experiment.crashing_laboratory import CrashingLaboratory
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.export.families.described import ExperimentTable
from thbridge.experiment.export.tables import tables_of
from thbridge.experiment.questionnaires.scoring import NOT_APPLICABLE
from thbridge.experiment.store.event_log import ExperimentLog, read_log
from thbridge.experiment.store.events import Clocks, EventKind, LoggedEvent, RunState
from thbridge.files.tables.table_files import TableFiles, TableFormat


@pytest.fixture(scope="module")
def tables(design: ExperimentDesign, tmp_path_factory: pytest.TempPathFactory) -> dict[str, ExperimentTable]:
    """Of one person who fails the check once, and one who leaves in the first trial."""
    path = tmp_path_factory.mktemp("store") / "log"
    ticks = itertools.count()
    with ExperimentLog(path) as log:
        lab = Conductor(
            design, log, lambda: Clocks("2026-01-02T12:00:00Z", next(ticks) * 1_000_000_000), lambda n: next(ticks) % n
        )
        first, second = lab.admit("x").participant, lab.admit("y").participant
        wrong = iter(["they"])
        while (step := lab.begin(first)) is not None:
            for item in lab.form(step).items if step.entry.form else ():
                answer = item.options[0] if item.options else item.greatest
                if item.correct:
                    answer = next(wrong, item.correct)
                if item.not_applicable and item.id == "know":
                    answer = NOT_APPLICABLE
                for kind in (EventKind.ITEM_SHOWN, EventKind.ITEM_TOUCHED, EventKind.ITEM_CHANGED):
                    lab.tell(kind, first, step, {"item": item.id}, "participant")
                lab.tell(EventKind.ITEM_GIVEN, first, step, {"item": item.id, "answer": answer}, "participant")
            lab.end(first, step)
        while (step := lab.begin(second)) is not None and step.name != "trial_5":
            if step.entry.form:
                lab.tell(EventKind.ITEM_GIVEN, second, step, {"item": "who", "answer": "you"}, "participant")
            lab.end(second, step)
        lab.leave(second, "went home")
    return {table.name: table for table in tables_of(design, read_log(path))}


@pytest.fixture(params=[TableFormat.PARQUET, TableFormat.CSV])
def frames(request, tables: dict[str, ExperimentTable], tmp_path: Path) -> dict[str, pd.DataFrame]:
    files = TableFiles(tmp_path, [request.param])
    for table in tables.values():
        files.write(table.name, table.columns, table.values())
    files.finish(lambda *_: None)
    read = pd.read_parquet if request.param is TableFormat.PARQUET else pd.read_csv
    return {name: read(tmp_path / f"{name}.{request.param}") for name in tables}


def test_people_and_their_runs(frames: dict[str, pd.DataFrame]) -> None:
    people = frames["participants"]
    assert people.state.tolist() == ["complete", "left"]
    assert people.counts.tolist() == [True, False]
    assert set(people["noise.preset"]) == {"none", "bad wheels"}
    assert people.reason.iloc[1] == "went home"


def test_steps_have_outcomes_and_durations(frames: dict[str, pd.DataFrame]) -> None:
    steps = frames["steps"]
    first = steps[steps.participant == steps.participant.iloc[0]]
    assert first[first.name == "understood"].outcome.tolist() == ["failed", "done"]
    assert first[first.name == "practice"].attempt.tolist() == [1, 2]
    trials = first[first.kind == "trial"]
    assert trials.trial.tolist() == [1, 2]
    assert set(trials["dialogue.condition"]) == {"supervisor", "collaborator"}
    assert (first.duration_s > 0).all()


def test_answers_are_numbers_keyed_and_timed(frames: dict[str, pd.DataFrame]) -> None:
    answers = frames["answers"]
    performance = answers[answers.item == "performance"]
    assert performance.value.tolist() == [100.0, 100.0]
    assert performance.keyed.tolist() == [0.0, 0.0]
    assert (performance.seen_s == 3.0).all()
    assert (performance.hesitation_s == 1.0).all()
    assert (performance.changes == 1).all()
    know = answers[answers.item == "know"]
    assert know.answer.tolist() == [NOT_APPLICABLE] * 2
    assert know.keyed.isna().all()
    check = answers[answers.item == "who"]
    assert check.right.tolist() == [False, True, True]
    assert not check.counts.any()


def test_scores_are_by_the_key(frames: dict[str, pd.DataFrame]) -> None:
    scores = frames["scores"]
    workload = scores[scores.subscale == "workload"]
    assert workload.score.tolist() == [pytest.approx(500 / 6)] * 2
    # Five are reversed, and one was not applicable: the form asks for nine of twelve.
    assert scores[scores.subscale == "trust"].score.tolist() == [pytest.approx((5 * 1 + 6 * 7) / 11)] * 2
    assert scores[scores.subscale == "trust"].answered.tolist() == [11, 11]


@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 10**6), withdrawn=st.booleans())
def test_tables_of_any_course_of_an_experiment_agree(
    design: ExperimentDesign, tmp_path_factory: pytest.TempPathFactory, seed: int, withdrawn: bool
) -> None:
    """People fail checks, leave, are excluded or withdraw, and programs die."""
    laboratory = CrashingLaboratory(design, tmp_path_factory.mktemp("course") / "log", seed)
    people = [laboratory.conductor.admit().participant for _ in range(3)]
    for person in people[:2]:
        laboratory.run(person)
    laboratory.conductor.begin(people[2])
    if seed % 3 == 0:
        laboratory.conductor.exclude(people[1], "knew the study")
    if withdrawn:
        laboratory.conductor.withdraw(people[0])
    laboratory.log.close()
    entries = read_log(laboratory.log.path)
    events = [entry.event for entry in entries if isinstance(entry, LoggedEvent)]
    runs = laboratory.conductor.progress.runs
    tables = {table.name: table for table in tables_of(design, entries)}
    for table in tables.values():
        for column in table.columns:
            values = [row[column.name] for row in table.rows if row[column.name] is not None]
            assert column.least is None or all(value >= column.least for value in values)
            assert column.greatest is None or all(value <= column.greatest for value in values)
    whole = {name: pd.DataFrame(table.rows) for name, table in tables.items() if table.rows}
    assert whole["participants"].participant.tolist() == [*runs]
    assert people[0] not in runs or not withdrawn
    assert len(whole["events"]) == len(events)
    steps = whole["steps"].set_index(["participant", "step", "attempt"]).sort_index()
    assert steps.index.is_unique
    assert len(steps) == sum(event.kind == EventKind.STEP_BEGUN for event in events)
    complete = {person for person, run in runs.items() if run.state is RunState.COMPLETE}
    is_data = steps.index.get_level_values("participant").isin(complete) & ~steps.kind.isin(["practice", "check"])
    assert (steps.counts == is_data).all()
    games = steps[steps.kind.isin(["trial", "practice"]) & (steps.outcome != "passed over")]
    assert len(whole.get("trials", ())) == len(games)
    if "answers" in whole:
        own = ["participant", "step", "attempt"]
        answers = whole["answers"].set_index([*own, "item"]).sort_index()
        assert answers.index.is_unique
        given = {(event.participant, event.step, event.data["item"]) for event in events if "item" in event.data}
        assert {(person, step, item) for person, step, _, item in answers.index} == given
        for score in whole.get("scores", pd.DataFrame()).itertuples():
            keyed = answers.loc[(score.participant, score.step, score.attempt)].keyed.astype(float)
            assert score.answered == keyed.notna().sum()
            assert pd.isna(score.score) or score.score == pytest.approx(keyed.mean())


def test_every_event_is_there_and_every_column_is_explained(tables, frames) -> None:
    assert frames["events"].sequence.tolist() == list(range(1, len(frames["events"]) + 1))
    assert all(column.meaning for table in tables.values() for column in table.columns)
    for name, table in tables.items():
        assert len({column.name for column in table.columns}) == len(table.columns)
        assert list(frames[name].columns) == [column.name for column in table.columns]
        assert all(set(row) == {column.name for column in table.columns} for row in table.rows)
    assert math.isnan(frames["events"].simulated_s.iloc[0])
