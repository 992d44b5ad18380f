"""The desk's view of a study: at each moment of its log, true to it."""

import random
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec import structs

from tests.support.studies.experiment_files import write_experiment
from tests.support.studies.rehearsed_studies import RehearsedStudy, clocks, rehearsed_study
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.progress import Progress
from thbridge.experiment.store.event_log import ExperimentLog
from thbridge.experiment.store.events import EventKind, LoggedEvent, NewEvent, RunState
from ui.model.desk.messages import DESK, DeskState
from ui.model.desk.rows import cell_rows, count_words, event_rows, freeze_words, note_rows, run_rows, run_words
from ui.model.desk.state import ToldToDesk, desk_state


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> RehearsedStudy:
    return rehearsed_study(tmp_path_factory.mktemp("desk"))


def seen(study: RehearsedStudy, length: int, shown: str = "") -> tuple[DeskState, Progress]:
    entries = study.entries[:length]
    progress = Progress(study.design).after(entries)
    return desk_state(study.design, progress, entries, ToldToDesk(clocks(length).wall, (), shown=shown)), progress


@given(st.data())
def test_at_each_moment_all_adds_up(study: RehearsedStudy, data: st.DataObject) -> None:
    length = data.draw(st.integers(0, len(study.entries)))
    state, progress = seen(study, length)
    assert [run.participant for run in state.runs] == list(progress.runs)
    assert state.planned == sum(cell.planned for cell in state.cells) == study.design.allocation.size
    assert state.counted == sum(cell.counted for cell in state.cells)
    assert state.counted == sum(run.state == RunState.COMPLETE for run in state.runs)
    assert sum(cell.under_way for cell in state.cells) == sum(run.state == RunState.UNDER_WAY for run in state.runs)
    assert bool(state.no_next) == (progress.under_way | progress.valid == set(range(state.planned)))
    notes = [entry for entry in study.entries[:length] if entry.event.kind == EventKind.NOTE]
    assert [note.text for note in state.notes] == [entry.event.data["text"] for entry in notes]
    for shown, run in zip(state.runs, progress.runs.values(), strict=True):
        assert 0.0 <= shown.minutes <= length / 60.0
        assert shown.since <= clocks(length).wall
        asked = study.design.forms.get(run.plan[run.step - 1].index) if run.step <= len(run.plan) else None
        required = {item.id for item in asked.items if item.required} if asked and run.under_way else set()
        over = run.state is not RunState.UNDER_WAY
        assert set(shown.missing) == (set() if over else required - set(run.given))
    assert DESK.decode_from_host(DESK.encode(state)) == state
    assert len(list(run_rows(state))) == len(state.runs)
    assert len(list(cell_rows(state))) == len(state.cells)
    assert all(map(run_words, state.runs))


def test_events_of_one_person_are_told_without_their_answers(study: RehearsedStudy) -> None:
    entries = study.entries
    person = next(entry.event.participant for entry in entries if entry.event.kind == EventKind.ITEM_GIVEN)
    state, _ = seen(study, len(entries), person)
    own = [entry for entry in entries if entry.event.participant == person]
    assert [event.sequence for event in state.events] == [entry.sequence for entry in own]
    told = [words for _, words, _ in event_rows(state.events)]
    assert any(words.startswith("the run ends: ") for words in told)
    assert "step 4, understood: who is answered" in told
    assert all(words.endswith("is answered") for words in told if "answered" in words)
    assert seen(study, len(entries), "P-NOBODY")[0].shown == ""


def test_steps_are_numbered_alike_everywhere_without_those_that_are_passed_over(tmp_path: Path) -> None:
    write_experiment(
        tmp_path,
        "title: x\nbetween: {dialogue.condition: [supervisor, collaborator]}\nquota: 1\nsteps:\n"
        "  - {step: consent, text: consent.txt}\n"
        "  - {step: instructions, name: other, text: welcome.md, only_at: {dialogue.condition: collaborator}}\n"
        "  - {step: instructions, name: own, text: welcome.md, only_at: {dialogue.condition: supervisor}}\n"
        "  - {step: trial}\n",
    )
    design = ExperimentFolder(tmp_path).read()
    (tmp_path / "store").mkdir(exist_ok=True)
    with ExperimentLog(tmp_path / "store" / "log") as log:
        conductor = Conductor(design, log, lambda: clocks(0), random.Random(3).randrange)
        people = [conductor.admit().participant for _ in design.cells]
        for person in people:
            for _ in range(2):
                step = conductor.begin(person)
                assert step is not None
                conductor.end(person, step)
            conductor.begin(person)
        progress, entries = conductor.progress, log.read()
    for person in people:
        is_supervisor = "supervisor" in design.cells[progress.runs[person].place.cell].name
        own, other = ("own", "other") if is_supervisor else ("other", "own")
        state = desk_state(design, progress, entries, ToldToDesk(clocks(60).wall, shown=person))
        told = [words for _, words, _ in event_rows(state.events)]
        assert {f"step 2, {own}, begins", f"{other}, ends: passed over"} <= set(told)
        run = next(run for run in state.runs if run.participant == person)
        assert "step 3 of 3, trial" in run_words(run)
        assert "1 minute so far." in run_words(run)
        assert "rder" not in run_words(run)


def test_a_run_that_is_excluded_later_took_no_longer_for_it(study: RehearsedStudy) -> None:
    before, now = seen(study, len(study.entries) - 2)[0], seen(study, len(study.entries))[0]
    assert before.runs[0].state != now.runs[0].state == "excluded"
    assert before.runs[0].minutes == now.runs[0].minutes
    assert before.no_next == "The study already has enough runs that count."
    assert (now.no_next == "") == (before.runs[0].state == "complete")


def test_sentences(study: RehearsedStudy) -> None:
    state, _ = seen(study, len(study.entries))
    counted = f"{state.counted} of 8 runs count"
    assert count_words(state).startswith(f"This is a rehearsal with simulated people. {counted}")
    assert count_words(structs.replace(state, rehearsal=False)).startswith(counted)
    assert freeze_words(state) == "The study is frozen and unchanged."
    assert [row[1] for row in note_rows(state.notes)] == ["the study", state.runs[0].participant]


def test_lag_behind_real_time_is_shown_of_each_run_and_of_the_study(study: RehearsedStudy) -> None:
    assert seen(study, len(study.entries))[0].pace == "", "a rehearsal has no real time"
    person = next(entry.event.participant for entry in study.entries if entry.event.kind == EventKind.RUN_BEGUN)
    length = next(
        number
        for number, entry in enumerate(study.entries, start=1)
        if (entry.event.participant, entry.event.kind) == (person, EventKind.STEP_BEGUN)
    )
    data = {"bag": "x.bag", "sha256": "", "score": 3, "most_lag_seconds": 2.25}
    event = NewEvent(EventKind.GAME_PLAYED, "program", clocks(length), person, 1, data=data)
    entries = (*study.entries[:length], LoggedEvent(length + 1, event))
    progress = Progress(study.design).after(entries)
    state = desk_state(study.design, progress, entries, ToldToDesk(clocks(length).wall, shown=person))
    assert state.pace == "Games were at most 2.2 s behind real time; games measured: 1; most_lag is not set."
    assert run_words(state.runs[0]).endswith("Games were at most 2.2 s behind real time.")
    assert state.events[-1].words.endswith("the game is recorded; at most 2.2 s behind real time")


def test_kinds_of_events_that_nobody_knows_yet_are_told(study: RehearsedStudy) -> None:
    person = next(entry.event.participant for entry in study.entries if entry.event.kind == EventKind.RUN_BEGUN)
    later = LoggedEvent(len(study.entries) + 1, NewEvent("chair-moved", "robot", clocks(1), person))
    entries = (*study.entries, later)
    progress = Progress(study.design).after(entries)
    state = desk_state(study.design, progress, entries, ToldToDesk(clocks(9).wall, shown=person))
    assert state.events[-1].words == "chair moved"
