"""People go through a study, page after page, whatever they do and whenever a program dies."""

import hashlib
import itertools
import re
from collections.abc import Callable, Iterable, Mapping
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.support.disks.small_disk import SmallDisk, why_not
from tests.support.studies.kiosk_without_screen import (
    STUDY,
    TEXTS,
    InstantGames,
    KilledError,
    Laboratory,
    Person,
    headings,
)
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.experiment_file import read_experiment
from thbridge.experiment.design.steps import PracticeTerm
from thbridge.experiment.export.tables import tables_of
from thbridge.experiment.progress import Progress, lag_words
from thbridge.experiment.store.event_log import ExperimentLog, read_log
from thbridge.experiment.store.events import EventKind, FrontEnd, RunState
from thbridge.files.errors import BadFile
from ui.hosting.kiosk import words
from ui.hosting.kiosk.game_steps import StudyClock
from ui.hosting.kiosk.games import KioskStopped
from ui.model.kiosk import (
    AnswerKept,
    BeginNext,
    ConsentToAsk,
    FocusNews,
    FormToFill,
    FromKiosk,
    GameNews,
    GameRecorded,
    GameToJoin,
    HostStops,
    InstructionsNews,
    InstructionsSoFar,
    InstructionText,
    ItemNews,
    KioskClosed,
    StoppedTakingPart,
    TextToRead,
    ToKiosk,
    WentBack,
    WentOn,
)

PRACTICE_ENDED = TEXTS.text("kiosk.practice_ended")
ONCE_MORE = TEXTS.text("kiosk.once_more")
GAME_ENDED = TEXTS.text("kiosk.game_ended")
PAUSE = TEXTS.text("kiosk.pause")
BEFORE_YOU_GO = TEXTS.text("kiosk.before_you_go")


@pytest.fixture
def laboratory(tmp_path: Path) -> Laboratory:
    return Laboratory(tmp_path)


def outline(laboratory: Laboratory) -> list[tuple[str, int, list[str]]]:
    """What happened, without what a program that comes back does again; answers to a page in any order."""
    again = {
        EventKind.STEP_RESUMED,
        EventKind.ITEM_SHOWN,
        EventKind.ITEM_TOUCHED,
        EventKind.ITEM_CHANGED,
    }
    told = [event for event in laboratory.events if event.kind not in again]
    return [
        (kind, step, sorted(f"{(event.data or {}).get('item')}: {(event.data or {}).get('answer')}" for event in group))
        for (kind, step), group in itertools.groupby(told, key=lambda event: (event.kind, event.step))
    ]


def pages_of_items(person: Person) -> list[tuple[str, ...]]:
    """The items of each page of a form, in their order."""
    return [tuple(item.id for item in page.items) for page in person.seen if isinstance(page, FormToFill)]


def test_somebody_goes_through_a_whole_study(laboratory: Laboratory) -> None:
    person = Person(learns=True)
    laboratory.run(person)
    (run,) = laboratory.people
    assert run.state is RunState.COMPLETE
    assert run.farewell_read
    assert laboratory.games.played == [("practice", False)] * 2 + [("first", False), ("second", False)]
    assert [data["bag"] for data in laboratory.data(EventKind.GAME_PLAYED)] == ["first.bag", "second.bag"]
    version = hashlib.sha256(b"We record what you do.\n").hexdigest()
    assert laboratory.data(EventKind.CONSENT_ANSWERED) == [{"agrees": True, "version": version, "window_ns": 1}]
    assert run.answers["final.line"] == 35.0
    assert headings(person) == [
        "Welcome",
        PRACTICE_ENDED,
        "Before we begin",
        ONCE_MORE,
        PRACTICE_ENDED,
        "Before we begin",
        GAME_ENDED,
        "How you feel",
        GAME_ENDED,
        "The end",
        "What this study was about",
        "Thank you",
        "Welcome",
    ]
    last = next(page for page in person.seen if isinstance(page, TextToRead) and page.code)
    assert last.code == run.code


# An odd step, so that events are written and not written in turn.
@pytest.mark.parametrize("step", [5, pytest.param(1, marks=pytest.mark.slow)])
def test_a_program_that_dies_at_any_event_loses_and_doubles_nothing(step: int, tmp_path: Path) -> None:
    def studied(name: str) -> Laboratory:
        (tmp_path / name).mkdir()
        return Laboratory(tmp_path / name)

    def somebody() -> Person:
        return Person(learns=True)

    whole, first = studied("whole"), somebody()
    whole.run(first)
    count = len(whole.events)
    assert count > 40
    for dies in range(1, count, step):
        laboratory, person = studied(f"dies-{dies}"), somebody()
        with pytest.raises(KilledError):
            # The event is written or not, in turn.
            laboratory.run(person, dies=dies, written=dies % 2 == 0)
        laboratory.run(person, people=0)
        assert outline(laboratory) == outline(whole), dies
        (run,) = laboratory.people
        assert run.state is RunState.COMPLETE, dies
        assert set(pages_of_items(person)) == set(pages_of_items(first)), "the same items in the same order"


ONE_FORM = "title: x\nquota: 1\nsteps:\n  - {step: form, form: final.yaml, name: final}\n"


def doing(kind: type, *deeds: Callable[[int], FromKiosk]) -> Callable[[ToKiosk], Iterable[FromKiosk] | None]:
    """Do these on the first page of a kind, and nothing else there."""
    done = []

    def does(page: ToKiosk) -> Iterable[FromKiosk] | None:
        if not isinstance(page, kind) or done:
            return None
        done.append(page)
        return [deed(page.page) for deed in deeds]

    return does


def test_a_no_is_final_even_if_the_program_dies_with_it(laboratory: Laboratory) -> None:
    with pytest.raises(KilledError):
        laboratory.run(Person(agrees=False), dies=2)
    assert laboratory.kinds()[-1] == EventKind.CONSENT_ANSWERED
    person = Person()
    laboratory.run(person, people=0)
    (run,) = laboratory.people
    assert run.state is RunState.DECLINED
    assert not any(isinstance(page, ConsentToAsk) for page in person.seen)
    assert words.farewell(TEXTS, run)[1] in [page.text for page in person.seen if isinstance(page, TextToRead)]


def test_a_check_that_is_failed_for_good_ends_the_run_kindly_or_marks_it(tmp_path: Path) -> None:
    for name, told in (("exclude", RunState.EXCLUDED), ("go on", RunState.COMPLETE)):
        (tmp_path / name).mkdir()
        steps = f"  - {{step: check, form: understood.yaml, attempts: 2, failed: {name}}}\n  - {{step: pause}}\n"
        laboratory, person = Laboratory(tmp_path / name, "title: x\nquota: 1\nsteps:\n" + steps), Person()
        person.answers = {"who": "they"}
        laboratory.run(person)
        (run,) = laboratory.people
        assert run.state is told
        assert headings(person).count(ONCE_MORE) == 1
        last = [page for page in person.seen if isinstance(page, TextToRead)][-2]
        assert ("You have done nothing wrong" in last.text) == (told is RunState.EXCLUDED)


def test_what_was_begun_is_shown_again_after_a_crash_and_what_is_missing_is_pointed_at(tmp_path: Path) -> None:
    laboratory = Laboratory(tmp_path, ONE_FORM)
    begun = doing(
        FormToFill,
        lambda page: ItemNews(page, "why", "changed", 1, "half a sen"),
        lambda page: ItemNews(page, "age", "changed", 2, 17.0),
        lambda page: ItemNews(page, "age", "given", 3, 30.0),
        lambda page: ItemNews(page + 1, "line", "given", 4, 5.0),
        WentOn,
        lambda _page: KioskClosed(),
    )
    first = Person(does=begun)
    laboratory.run(first)
    assert [data["answer"] for data in laboratory.data(EventKind.ITEM_CHANGED)] == ["half a sen"], "17 is too young"
    missing = [page.missing for page in first.seen if isinstance(page, FormToFill)]
    assert missing == [(), ("line",)]
    second = Person()
    laboratory.run(second, people=0)
    page = next(page for page in second.seen if isinstance(page, FormToFill))
    assert page.answers == {"age": 30.0, "why": "half a sen"}
    assert laboratory.people[0].answers == {"final.age": 30.0, "final.why": "half a sen", "final.line": 35.0}


@pytest.mark.parametrize("rule", ["beginning", "never"])
def test_a_step_begins_anew_or_ends_the_run_as_its_rule_says(tmp_path: Path, rule: str) -> None:
    laboratory = Laboratory(tmp_path, ONE_FORM.replace("name: final", f"name: final, resume: {rule}"))
    given = doing(FormToFill, lambda page: ItemNews(page, "age", "given", 1, 30.0), lambda _page: KioskClosed())
    laboratory.run(Person(does=given))
    person = Person()
    laboratory.run(person, people=0)
    (run,) = laboratory.people
    forms = [page for page in person.seen if isinstance(page, FormToFill)]
    if rule == "never":
        assert (run.state, forms) == (RunState.EXCLUDED, [])
        assert "not your fault" in words.farewell(TEXTS, run)[1]
    else:
        assert (run.state, forms[0].answers) == (RunState.COMPLETE, {})
        assert run.answers["final.age"] == 99.0


def test_games_go_on_after_a_crash_and_are_never_played_twice(laboratory: Laboratory) -> None:
    def die() -> None:
        raise KilledError

    laboratory.games.during = lambda: die() if laboratory.games.played[-1][0] == "first" else None
    with pytest.raises(KilledError):
        laboratory.run(Person(learns=True))
    laboratory.games.during = lambda: None
    leaves = doing(GameRecorded, lambda _page: KioskClosed())
    laboratory.run(Person(does=leaves), people=0)
    laboratory.run(Person(), people=0)
    played = [name for name in laboratory.games.played if name[0] != "practice"]
    assert played == [("first", False), ("first", True), ("second", False)]
    assert len(laboratory.data(EventKind.GAME_PLAYED)) == 2


LEAVERS = """\
title: x
quota: 2
steps:
  - {step: consent, text: consent.txt}
  - {step: check, form: understood.yaml}
  - {step: pause}
  - {step: debrief, text: debrief.txt, name: what}
  - {step: debrief, text: consent.txt, name: legal, when_leaving: false}
  - {step: debrief, text: more.md, name: more}
"""


def leavers(tmp_path: Path) -> Laboratory:
    (tmp_path / "more.md").write_text("# More\n\nRead on at home.\n")
    return Laboratory(tmp_path, LEAVERS)


def stops_at(heading: str) -> Person:
    def does(page: ToKiosk) -> Iterable[FromKiosk] | None:
        return [StoppedTakingPart()] if getattr(page, "heading", getattr(page, "title", "")) == heading else None

    return Person({"who": "you"}, does=does)


def debriefed(laboratory: Laboratory) -> list[tuple[str, int]]:
    """Events of the debriefings of people whose runs ended early."""
    kinds = {EventKind.STEP_BEGUN, EventKind.STEP_RESUMED, EventKind.STEP_ENDED}
    events = laboratory.events
    ended = next(
        index
        for index, event in enumerate(events)
        if event.kind in {EventKind.RUN_ENDED, EventKind.RUN_EXCLUDED}
        or (event.kind == EventKind.STEP_ENDED and (event.data or {})["outcome"] == "failed")
    )
    return [(str(event.kind), event.step) for event in events[ended + 1 :] if event.kind in kinds]


def test_whoever_stops_reads_the_debriefing_and_the_log_has_that(tmp_path: Path) -> None:
    laboratory, person = leavers(tmp_path), stops_at(PAUSE)
    laboratory.run(person)
    (run,) = laboratory.people
    assert (run.state, run.reason, run.step) == (RunState.LEFT, "stopped taking part", 3)
    assert headings(person)[-5:] == [PAUSE, "Thank you", BEFORE_YOU_GO, "Thank you", "Welcome"]
    read = [page.text for page in person.seen if getattr(page, "heading", "") == BEFORE_YOU_GO]
    assert read == ["It was about robots.\n", "# More\n\nRead on at home.\n"], "not the one that says otherwise"
    assert debriefed(laboratory) == [("step-begun", 4), ("step-ended", 4), ("step-begun", 6), ("step-ended", 6)]
    assert run.debriefs == {4: True, 6: True}
    assert run.farewell_read


def test_whoever_fails_a_check_is_told_so_first_and_reads_the_debriefing(tmp_path: Path) -> None:
    laboratory, person = leavers(tmp_path), Person({"who": "they"})
    laboratory.run(person)
    assert laboratory.people[0].state is RunState.EXCLUDED
    ends = "The study ends here"
    assert headings(person)[-4:] == [ends, BEFORE_YOU_GO, ends, "Welcome"]
    first = next(page for page in person.seen if isinstance(page, TextToRead) and page.heading == ends)
    assert first.text == (
        "The study can go on only after certain answers to the questions, and your answers were different. "
        "You have done nothing wrong. Thank you for your time. On the next page you read what the study was about."
    )
    assert debriefed(laboratory) == [("step-begun", 4), ("step-ended", 4), ("step-begun", 6), ("step-ended", 6)]


@pytest.mark.parametrize("declines", [True, False])
def test_whoever_never_agreed_gets_a_page_and_no_debriefing(tmp_path: Path, declines: bool) -> None:
    laboratory = leavers(tmp_path)
    person = Person(agrees=False) if declines else Person(does=doing(ConsentToAsk, lambda _page: StoppedTakingPart()))
    laboratory.run(person)
    assert laboratory.people[0].state is (RunState.DECLINED if declines else RunState.LEFT)
    assert headings(person) == ["Welcome", "Thank you", "Welcome"]
    assert debriefed(laboratory) == []


def test_a_program_that_dies_in_a_debriefing_goes_on_with_it_and_the_run_stays_left(tmp_path: Path) -> None:
    whole = leavers(tmp_path)
    whole.run(stops_at(PAUSE))
    kinds = whole.kinds()
    ended = kinds.index(EventKind.RUN_ENDED)
    for dies in range(ended + 1, len(kinds)):
        for written in (True, False):
            folder = tmp_path / f"{dies}-{written}"
            folder.mkdir()
            laboratory = leavers(folder)
            with pytest.raises(KilledError):
                laboratory.run(stops_at(PAUSE), dies=dies, written=written)
            laboratory.run(Person(), people=0)
            (run,) = laboratory.people
            assert (run.state, run.step, run.farewell_read) == (RunState.LEFT, 3, True)
            assert run.debriefs == {4: True, 6: True}
            told = [event for event in debriefed(laboratory) if event[0] != EventKind.STEP_RESUMED]
            assert told == debriefed(whole), (dies, written)


def test_a_debriefing_that_somebody_stops_at_is_not_shown_again(tmp_path: Path) -> None:
    laboratory, person = leavers(tmp_path), stops_at("What this study was about")
    laboratory.run(person)
    assert [page.text for page in person.seen if getattr(page, "heading", "") == BEFORE_YOU_GO] == [
        "# More\n\nRead on at home.\n"
    ]
    assert laboratory.people[0].debriefs == {6: True}


def test_the_researcher_goes_on_for_somebody_who_has_walked_away(tmp_path: Path) -> None:
    laboratory = leavers(tmp_path)

    def does(page: ToKiosk) -> Iterable[FromKiosk] | None:
        if getattr(page, "heading", "") == PAUSE and len(laboratory.people) == 1:
            return [StoppedTakingPart()]
        if getattr(page, "heading", "") == BEFORE_YOU_GO and laboratory.people[-1].debriefs == {4: False}:
            assert laboratory.host is not None and laboratory.host.study.admit_next() is None
            return []
        return None

    laboratory.run(Person({"who": "you"}, does=does), people=2)
    first, second = laboratory.people
    assert (first.state, first.debriefs) == (RunState.LEFT, {4: False}), "it was not read"
    assert second.state is RunState.COMPLETE


LIMITED = "title: x\nquota: 1\nsteps:\n  - {step: form, form: limited.yaml, name: limited}\n"
LIMITED_FORM = """\
title: Quickly
items:
  - {id: calm, text: I feel calm., points: 5}
  - {id: quick, text: I was quick., points: 5, seconds: 20}
  - {id: look, text: Please choose 2 here., points: 5, correct: 2, attention: true, subscale: mood}
  - {id: sure, text: I felt sure., points: 5, subscale: mood}
"""


def limited(tmp_path: Path) -> Laboratory:
    (tmp_path / "limited.yaml").write_text(LIMITED_FORM)
    return Laboratory(tmp_path, LIMITED)


def too_slow(*before: float) -> Callable[[ToKiosk], Iterable[FromKiosk] | None]:
    """Answer in time, or not at all, until the time limit closes the item."""

    def does(page: ToKiosk) -> Iterable[FromKiosk] | None:
        if not isinstance(page, FormToFill) or page.items[0].id != "quick":
            return None
        number = page.page
        so_far = [ItemNews(number, "quick", "changed", 2, answer) for answer in before]
        late = [ItemNews(number, "quick", "given", 4, 5.0), ItemNews(number, "quick", "timed out", 5, 5.0)]
        closed = ItemNews(number, "quick", "timed out", 3, before[-1] if before else None)
        return [ItemNews(number, "quick", "shown", 1), *so_far, closed, *late, WentOn(number)]

    return does


@pytest.mark.parametrize("before", [(), (3.0, 4.0)])
def test_a_time_limit_closes_an_item_with_the_answer_so_far_and_is_no_missing_answer(
    tmp_path: Path, before: tuple[float, ...]
) -> None:
    laboratory, person = limited(tmp_path), Person({"look": 2.0}, does=too_slow(*before))
    laboratory.run(person)
    answer = before[-1] if before else None
    assert pages_of_items(person) == [("calm",), ("quick",), ("look", "sure")], "a limit begins on a page of its own"
    assert laboratory.data(EventKind.ITEM_TIMED_OUT) == [{"item": "quick", "window_ns": 3, "answer": answer}]
    (run,) = laboratory.people
    assert (run.state, run.answers["limited.quick"]) == (RunState.COMPLETE, answer)
    rows = {
        row["item"]: row
        for table in tables_of(laboratory.design, read_log(tmp_path / "store" / "log"))
        if table.name == "answers"
        for row in table.rows
    }
    assert {item: row["timed_out"] for item, row in rows.items()} == {
        "calm": False, "quick": True, "look": False, "sure": False,
    }  # fmt: skip
    assert rows["quick"]["value"] == answer


def test_nobody_comes_back_to_an_item_with_a_time_limit(tmp_path: Path) -> None:
    backs = 0

    def does(page: ToKiosk) -> Iterable[FromKiosk] | None:
        nonlocal backs
        if isinstance(page, FormToFill) and page.items[0].id == "look" and backs == 0:
            backs += 1
            return [WentBack(page.page)]
        return None

    laboratory, person = limited(tmp_path), Person({"look": 2.0}, does=does)
    laboratory.run(person)
    assert pages_of_items(person) == [("calm",), ("quick",), ("look", "sure"), ("calm",), ("look", "sure")]
    assert [page.back for page in pages_seen(person)] == [False, True, True, False, True]
    assert laboratory.people[0].state is RunState.COMPLETE


def test_a_program_that_dies_after_a_time_limit_does_not_open_the_item_again(tmp_path: Path) -> None:
    whole = limited(tmp_path)
    whole.run(Person({"look": 2.0}, does=too_slow(3.0)))
    at = whole.kinds().index(EventKind.ITEM_TIMED_OUT)
    for dies, shown in ((at, True), (at + 1, False)):
        folder = tmp_path / str(dies)
        folder.mkdir()
        laboratory = limited(folder)
        with pytest.raises(KilledError):
            laboratory.run(Person({"look": 2.0}, does=too_slow(3.0)), dies=dies, written=False)
        person = Person({"look": 2.0}, does=too_slow(3.0))
        laboratory.run(person, people=0)
        assert (("quick",) in pages_of_items(person)) is shown
        assert laboratory.data(EventKind.ITEM_TIMED_OUT) == whole.data(EventKind.ITEM_TIMED_OUT)


def test_attention_checks_stand_among_items_and_count_for_no_score(tmp_path: Path) -> None:
    people = []
    for name, answer in (("passes", 2.0), ("fails", 4.0)):
        (tmp_path / name).mkdir()
        laboratory = limited(tmp_path / name)
        laboratory.run(Person({"look": answer, "sure": 5.0}))
        tables = {
            table.name: table.rows
            for table in tables_of(laboratory.design, read_log(tmp_path / name / "store" / "log"))
        }
        (person,), (score,) = tables["participants"], tables["scores"]
        (look,) = [row for row in tables["answers"] if row["item"] == "look"]
        assert (score["subscale"], score["score"], score["items"]) == ("mood", 5.0, 1)
        assert (look["attention"], look["keyed"]) == (True, None)
        people.append((person["state"], person["attention_checks"], person["attention_passed"], look["right"]))
    assert people == [("complete", 1, 1, True), ("complete", 1, 0, False)]


INSTRUCTED = """\
title: x
quota: 1
steps:
  - {step: consent, text: consent.txt}
  - {step: instructions, text: how.md, name: how}
  - {step: trial, name: first}
  - {step: instructions, text: debrief.txt, name: other}
  - {step: form, form: final.yaml, name: final}
"""


def test_instructions_read_so_far_are_there_to_be_read_again_and_that_is_in_the_log(tmp_path: Path) -> None:
    (tmp_path / "how.md").write_text("*Send* robots.\n")
    how, other = InstructionText("*Send* robots.\n", True), InstructionText("It was about robots.\n")

    def does(page: ToKiosk) -> Iterable[FromKiosk] | None:
        if isinstance(page, FormToFill) and not page.answers:
            return [InstructionsNews(True, 5), InstructionsNews(False, 6), *Person().react(page)]
        return [InstructionsNews(True, 3), InstructionsNews(False, 4)] if isinstance(page, GameToJoin) else None

    laboratory, person = Laboratory(tmp_path, INSTRUCTED), Person(does=does)
    laboratory.run(person)
    sent = [page.texts for page in person.seen if isinstance(page, InstructionsSoFar)]
    assert sent == [(how,), (how, other), ()]
    game = next(index for index, page in enumerate(person.seen) if isinstance(page, GameToJoin))
    assert person.seen[:game].count(InstructionsSoFar((how,))) == 1, "before the game"
    news = [
        (event.kind, event.step, (event.data or {})["window_ns"])
        for event in laboratory.events
        if event.kind in {EventKind.INSTRUCTIONS_OPENED, EventKind.INSTRUCTIONS_CLOSED}
    ]
    opened, closed = EventKind.INSTRUCTIONS_OPENED, EventKind.INSTRUCTIONS_CLOSED
    assert news == [(opened, 3, 3), (closed, 3, 4), (opened, 5, 5), (closed, 5, 6)]
    tables = tables_of(laboratory.design, read_log(tmp_path / "store" / "log"))
    (steps,) = [table.rows for table in tables if table.name == "steps"]
    assert [row["read_again"] for row in steps] == [0, 0, 1, 0, 1]


def test_instructions_for_other_conditions_are_not_read_again(tmp_path: Path) -> None:
    for name in ("few", "many"):
        (tmp_path / f"{name}.txt").write_text(f"Now there are {name} robots.\n")
    laboratory = Laboratory(
        tmp_path,
        "title: x\nquota: 1\norder: fixed\nwithin: {robots: [1, 3]}\nsteps:\n"
        "  - {step: instructions, name: all, text: debrief.txt}\n"
        "  - {step: instructions, name: few, text: few.txt, each_condition: true, only_at: {robots: 1}}\n"
        "  - {step: instructions, name: many, text: many.txt, each_condition: true, only_at: {robots: 3}}\n"
        "  - {step: trial, name: first, each_condition: true}\n"
        "  - {step: form, form: final.yaml, name: final}\n",
    )
    person = Person()
    laboratory.run(person)
    both, few, many = "It was about robots.", "Now there are few robots.", "Now there are many robots."
    now, offered = (), []
    for page in person.seen:
        now = tuple(text.text.strip() for text in page.texts) if isinstance(page, InstructionsSoFar) else now
        if isinstance(page, GameToJoin | FormToFill):
            offered.append(now)
    assert offered == [(both, few), (both, many), (both, few, many)]


def test_steps_of_another_group_are_not_counted(tmp_path: Path) -> None:
    for name in ("few", "many"):
        (tmp_path / f"{name}.txt").write_text(f"Now there are {name} robots.\n")
    laboratory = Laboratory(
        tmp_path,
        "title: x\nquota: 1\nbetween: {robots: [1, 3]}\nsteps:\n"
        "  - {step: instructions, name: few, text: few.txt, only_at: {robots: 1}}\n"
        "  - {step: instructions, name: many, text: many.txt, only_at: {robots: 3}}\n"
        "  - {step: form, form: final.yaml, name: final}\n"
        "  - {step: debrief, text: debrief.txt}\n",
    )
    person = Person()
    laboratory.run(person, people=2)
    pages = [page.progress for page in person.seen if isinstance(page, TextToRead | FormToFill) and page.progress.steps]
    assert [(way.step, way.steps) for way in pages] == [(1, 3), (2, 3), (3, 3)] * 2


def test_a_program_that_comes_back_sends_the_instructions_again(tmp_path: Path) -> None:
    (tmp_path / "how.md").write_text("*Send* robots.\n")
    laboratory = Laboratory(tmp_path, INSTRUCTED)
    laboratory.run(Person(does=doing(FormToFill, lambda _page: KioskClosed())))
    person = Person()
    laboratory.run(person, people=0)
    sent = [page.texts for page in person.seen if isinstance(page, InstructionsSoFar)]
    assert [len(texts) for texts in sent] == [2, 0]


PRACTICE_ONLY = "title: x\nquota: 1\nsteps:\n  - {step: practice, name: practice}\n  - {step: pause}\n"


def test_practice_is_not_left_before_all_is_done_that_it_asks_for(tmp_path: Path) -> None:
    laboratory = Laboratory(tmp_path, PRACTICE_ONLY)
    laboratory.games.missing = {PracticeTerm.MOVES: 1.0, PracticeTerm.IDENTIFIED: 2.0}
    # A key that skips it is pressed in each game, and does nothing.
    person = Person(does=lambda page: [WentOn(page.page)] if isinstance(page, GameToJoin) else None)
    laboratory.run(person)
    games = [page for page in person.seen if isinstance(page, GameToJoin)]
    assert [game.to_do for game in games] == [("send a robot to a room", "name 2 more treasures")] * 3
    news = [page for page in person.seen if isinstance(page, GameNews)]
    assert (news[0].page, news[0].to_do, news[0].seconds_left) == (games[0].page, games[0].to_do, 60)
    assert headings(person) == ["Welcome", *[PRACTICE_ENDED, ONCE_MORE] * 2, PRACTICE_ENDED,
                                PAUSE, "Thank you", "The study is complete"]  # fmt: skip
    again = next(page for page in person.seen if isinstance(page, TextToRead) and page.heading == ONCE_MORE)
    assert "send a robot to a room and name 2 more treasures" in again.text
    assert laboratory.data(EventKind.PRACTICE_PLAYED) == [{"missing": ["moves", "identified"]}] * 3


def test_practice_is_left_at_once_when_all_is_done(tmp_path: Path) -> None:
    laboratory = Laboratory(tmp_path, PRACTICE_ONLY)
    person = Person(does=lambda page: [WentOn(page.page)] if isinstance(page, GameToJoin) else None)
    laboratory.run(person)
    assert headings(person) == ["Welcome", PAUSE, "Thank you", "The study is complete"]
    assert laboratory.data(EventKind.PRACTICE_PLAYED) == [{"missing": []}]


FEELINGS = "title: x\nquota: 1\nsteps:\n  - {step: form, form: feelings.yaml, name: feelings}\n  - {step: pause}\n"


def pages_seen(person: Person) -> list[FormToFill]:
    return [page for page in person.seen if isinstance(page, FormToFill)]


def goes_back(page: ToKiosk) -> Iterable[FromKiosk] | None:
    """From the second page, after beginning it; on the first one they change an answer."""
    if not isinstance(page, FormToFill):
        return None
    if page.part == 2 and not page.answers:
        return [ItemNews(page.page, page.items[0].id, "changed", 5, 2.0), WentBack(page.page)]
    if page.part == 1 and page.answers:
        item = page.items[0].id
        return [
            ItemNews(page.page, item, "changed", 6, 7.0),
            ItemNews(page.page, item, "given", 7, 7.0),
            WentOn(page.page),
        ]
    return None


def test_people_go_back_within_a_form_and_what_they_change_is_in_the_log(tmp_path: Path) -> None:
    laboratory, person = Laboratory(tmp_path, FEELINGS), Person(does=goes_back)
    laboratory.run(person)
    (run,), pages = laboratory.people, pages_seen(person)
    assert [(page.part, page.back) for page in pages] == [(1, False), (2, True), (1, False), (2, True)]
    assert pages[2].answers == {item.id: 3.0 for item in pages[0].items}
    (later,) = pages[3].items
    assert pages[3].answers == {later.id: 2.0}, "what was begun there before"
    assert laboratory.data(EventKind.WENT_BACK) == [{"page": 1}]
    first = pages[0].items[0].id
    given = [(data["item"], data["answer"]) for data in laboratory.data(EventKind.ITEM_GIVEN)]
    assert [answer for item, answer in given if item == first] == [3.0, 7.0]
    assert [item for item, _ in given].count(pages[0].items[1].id) == 1, "what is not changed keeps its time"
    assert run.answers[f"feelings.{first}"] == 7.0
    assert run.state is RunState.COMPLETE


def test_the_way_back_never_leaves_the_form(tmp_path: Path) -> None:
    text = FEELINGS.replace("  - {step: pause}\n", "  - {step: form, form: final.yaml, name: final}\n")
    back = doing(FormToFill, WentBack, lambda _page: KioskClosed())
    laboratory, person = Laboratory(tmp_path, text), Person(does=back)
    laboratory.run(person)
    assert [page.part for page in pages_seen(person)] == [1]
    assert laboratory.data(EventKind.WENT_BACK) == []


def test_an_answer_changed_on_the_way_back_is_not_lost_in_a_crash(tmp_path: Path) -> None:
    laboratory = Laboratory(tmp_path, FEELINGS)

    def does(page: ToKiosk) -> Iterable[FromKiosk] | None:
        deeds = list(goes_back(page) or ())
        # The window is closed when the answer is changed, and not given yet.
        return [deeds[0], KioskClosed()] if len(deeds) == 3 else deeds or None

    laboratory.run(Person(does=does))
    person = Person()
    laboratory.run(person, people=0)
    page = pages_seen(person)[0]
    assert (page.part, page.answers[page.items[0].id]) == (1, 7.0)
    assert laboratory.people[0].answers[f"feelings.{page.items[0].id}"] == 7.0


def test_a_window_whose_program_ends_in_the_middle_of_a_run_stays_and_says_why(laboratory: Laboratory) -> None:
    def stop() -> None:
        raise KioskStopped

    def fail() -> None:
        raise BadFile(Path("log"), "cannot be written", "Make room")

    laboratory.games.during = stop
    first = Person()
    laboratory.run(first)
    assert first.seen[-1] == HostStops(TEXTS.text("kiosk.pauses"), TEXTS.text("kiosk.stopped_text"))
    assert laboratory.window is not None and laboratory.window.left_open
    laboratory.games.during = fail
    second = Person()
    with pytest.raises(BadFile):
        laboratory.run(second)
    assert second.seen[-1] == HostStops(TEXTS.text("kiosk.pauses"), TEXTS.text("kiosk.failed_text"))
    laboratory.games.during = lambda: None
    laboratory.run(Person(learns=True), people=0)
    assert not laboratory.window.left_open, "nobody is in the middle of the study"


@pytest.mark.parametrize("when", ["Before we begin", "How you feel", "The end"])
def test_on_a_full_disk_people_are_told_and_no_answer_is_lost(when: str, tmp_path: Path) -> None:
    if (reason := why_not()) is not None:
        pytest.skip(reason)
    (tmp_path / "whole").mkdir()
    whole = Laboratory(tmp_path / "whole")
    whole.run(Person(learns=True))
    with SmallDisk(tmp_path / "disk", 16 << 20) as disk, ExitStack() as filled:
        laboratory = Laboratory(disk.folder)

        def fill(page: ToKiosk) -> None:
            if isinstance(page, FormToFill) and page.title == when:
                filled.enter_context(disk.full())

        person = Person(learns=True, does=fill)
        with pytest.raises(BadFile, match=r"log: the log cannot be written \(No space left on device\)"):
            laboratory.run(person)
        assert person.seen[-1] == HostStops(TEXTS.text("kiosk.pauses"), TEXTS.text("kiosk.failed_text"))
        told = laboratory.events
        filled.close()
        person.does = lambda page: None
        laboratory.run(person, people=0)
        assert laboratory.events[: len(told)] == told
        assert outline(laboratory) == outline(whole)
        assert [run.state for run in laboratory.people] == [RunState.COMPLETE]


def test_a_person_who_stops_is_let_go(tmp_path: Path) -> None:
    laboratory = Laboratory(tmp_path, ONE_FORM)
    person = Person(does=doing(FormToFill, lambda _page: StoppedTakingPart()))
    laboratory.run(person)
    (run,) = laboratory.people
    assert (run.state, run.reason) == (RunState.LEFT, "stopped taking part")
    assert "Thank you" in headings(person)


def test_pastes_and_looks_elsewhere_are_events_with_the_windows_time(tmp_path: Path) -> None:
    laboratory = Laboratory(tmp_path, ONE_FORM)
    deeds = doing(
        FormToFill,
        lambda page: ItemNews(page, "why", "pasted", 7, None, 120),
        lambda _page: FocusNews(False, 8),
        lambda _page: FocusNews(True, 9),
        lambda _page: KioskClosed(),
    )
    laboratory.run(Person(does=deeds))
    assert laboratory.data(EventKind.TEXT_PASTED) == [{"item": "why", "window_ns": 7, "characters": 120}]
    assert laboratory.data(EventKind.FOCUS_LOST) == [{"window_ns": 8}]
    assert laboratory.data(EventKind.FOCUS_REGAINED) == [{"window_ns": 9}]


def test_the_code_of_a_recruiting_service_is_an_event_and_no_id(tmp_path: Path) -> None:
    text = ONE_FORM.replace("quota: 1", "quota: 1\nrecruiting: {ask: 'Your code?'}")
    laboratory, person = Laboratory(tmp_path, text), Person(answers={"code": " SVC-1 "})
    laboratory.run(person)
    assert laboratory.data(EventKind.RECRUITING_CODE) == [{"code": "SVC-1"}]
    assert "SVC-1" not in laboratory.people[0].participant
    assert "external_id" not in laboratory.data(EventKind.RUN_BEGUN)[0]


def test_a_code_that_was_not_kept_is_asked_for_again_and_says_so(tmp_path: Path) -> None:
    text = ONE_FORM.replace("quota: 1", "quota: 1\nrecruiting: {ask: 'Your code?'}")
    laboratory = Laboratory(tmp_path, text)
    half = doing(FormToFill, lambda page: ItemNews(page, "code", "changed", 1, "SV"), lambda _page: KioskClosed())
    first = Person(does=half)
    laboratory.run(first)
    assert pages_seen(first)[0].instructions == ""
    assert AnswerKept(pages_seen(first)[0].page, "code", "SV") in first.seen, "a window that crashes gets it again"
    second = Person(answers={"code": "SVC-1"})
    laboratory.run(second, people=0)
    assert pages_seen(second)[0].instructions == TEXTS.text("kiosk.code_not_kept")
    assert laboratory.data(EventKind.RECRUITING_CODE) == [{"code": "SVC-1"}]


def test_whoever_comes_when_there_is_no_place_is_told_so(tmp_path: Path) -> None:
    laboratory, person = Laboratory(tmp_path, ONE_FORM), Person()
    laboratory.run(person, people=5)
    assert len(laboratory.people) == 1
    assert headings(person)[-1] == "The study is complete"


def test_the_researcher_begins_ends_and_excludes_runs(tmp_path: Path) -> None:
    text = ONE_FORM.replace("quota: 1", "quota: 3\nbegins: researcher")
    laboratory = Laboratory(tmp_path, text)
    told: list[str | None] = []
    again: list[str | None] = []

    def does(page: ToKiosk) -> Iterable[FromKiosk] | None:
        assert laboratory.host is not None
        host = laboratory.host.study
        runs = list(host.progress.runs)
        if isinstance(page, TextToRead) and page.heading == TEXTS.text("kiosk.welcome"):
            assert page.button == ""
            if len(runs) == 3:
                return [KioskClosed()]
            if len(runs) == 2:
                return [BeginNext()]
            told.append(host.admit_next())
            return [FocusNews(True, 1)]
        if isinstance(page, FormToFill) and len(runs) < 3:
            told.append(host.admit_next())
            end = host.end_run if len(runs) == 1 else host.exclude
            told.append(end(runs[-1], "fire drill"))
            again.append(end(runs[-1], "fire drill"))
            return [FocusNews(True, 1)]
        return None

    laboratory.run(Person(does=does))
    states = [(run.state, run.reason) for run in laboratory.people]
    assert states == [(RunState.LEFT, "fire drill"), (RunState.EXCLUDED, "fire drill"), (RunState.COMPLETE, "")]
    first, second = (run.participant for run in laboratory.people[:2])
    assert told == [None, f"{first} is still in the study.", None, None, f"{second} is still in the study.", None]
    by = [event.actor for event in laboratory.events if event.kind == EventKind.RUN_ENDED]
    assert by == ["experimenter", "program"]
    assert again == [f"{first} is not in the study now.", f"{second} is already excluded."]
    assert len([event for event in laboratory.events if event.kind == EventKind.RUN_EXCLUDED]) == 1


def test_events_in_a_game_have_its_simulated_time(laboratory: Laboratory) -> None:
    deeds = doing(GameToJoin, lambda _page: FocusNews(False, 1))
    laboratory.run(Person(learns=True, does=lambda page: deeds(page) if not getattr(page, "practice", True) else None))
    (lost,) = [event for event in laboratory.events if event.kind == EventKind.FOCUS_LOST]
    assert (lost.clocks.simulated, lost.step) == (12.5, 4)
    assert all(event.clocks.simulated is None for event in laboratory.events if event is not lost and event.step != 4)


BOUND = "title: x\nquota: 1\nmost_lag: 5\nsteps:\n  - {step: trial, name: first}\n  - {step: trial, name: second}\n"


class SlowGames(InstantGames):
    """Games on a machine that is too slow for the second of each person."""

    lags: Mapping[str, float] = {"first": 5.0, "second": 12.25}

    async def play(self, run, step, watcher, *, goes_on: bool):
        game = await super().play(run, step, watcher, goes_on=goes_on)
        return {**game, "most_lag_seconds": self.lags[step.name]}


def test_a_run_on_a_machine_that_was_too_slow_ends_as_any_other_and_does_not_count(tmp_path: Path) -> None:
    laboratory, person = Laboratory(tmp_path, BOUND), Person()
    laboratory.games = SlowGames()
    laboratory.run(person)
    (run,) = laboratory.people
    assert run.state is RunState.EXCLUDED
    assert run.reason == "second was 12.2 s behind real time; most_lag is 5 s"
    # The person has done all that was asked for: they are thanked, and get their code.
    last = next(page for page in person.seen if isinstance(page, TextToRead) and page.code)
    assert (last.heading, last.code) == ("Thank you", run.code)
    assert len(run.code) == 8
    # The place is open again, and a run at the bound counts.
    laboratory.games.lags = {"first": 5.0, "second": 0.1}
    laboratory.run(Person())
    again = laboratory.people[1]
    assert (again.state, again.place) == (RunState.COMPLETE, run.place)
    # Who came then keeps the place, whatever the file says later.
    (tmp_path / "experiment.yaml").write_text(BOUND.replace("most_lag: 5", "most_lag: null"))
    later = Progress(read_experiment(tmp_path / "experiment.yaml")).after(read_log(tmp_path / "store" / "log"))
    assert [str(run.state) for run in later.runs.values()] == ["excluded", "complete"]


def test_without_a_bound_each_lag_counts(tmp_path: Path) -> None:
    laboratory = Laboratory(tmp_path, BOUND.replace("most_lag: 5\n", ""))
    laboratory.games = SlowGames()
    laboratory.run(Person())
    (run,) = laboratory.people
    assert run.state is RunState.COMPLETE
    (told,) = lag_words(Progress(laboratory.design, {run.participant: run}))
    assert told == "Games were at most 12.2 s behind real time; games measured: 2; most_lag is not set."


def test_the_researcher_sees_that_a_game_lags(laboratory: Laboratory) -> None:
    seen: list[tuple[str, ...]] = []

    class Lagging(InstantGames):
        async def _at(self, watcher) -> None:
            for lag in (0.4, 3.7, 3.9):
                watcher.passed(1.0, lag, 60.0)
                seen.append(laboratory.host.study.troubles)
            await super()._at(watcher)

    laboratory.games = Lagging()
    laboratory.run(Person(learns=True))
    told = words.LAGS.format(3)
    assert seen[:3] == [(), (told,), (told,)]
    assert laboratory.host.study.troubles == ()


def test_a_reason_names_nobody_who_may_withdraw_later(laboratory: Laboratory) -> None:
    laboratory.run(Person(learns=True), people=2)
    first, second = (run.participant for run in laboratory.people)
    assert laboratory.host is not None
    assert f"Do not name {first}" in (laboratory.host.study.exclude(second, f"talked with {first}") or "")
    assert RunState.EXCLUDED not in {run.state for run in laboratory.people}


BY_CONDITION = """\
title: Before we begin
like: {scale: choice, shuffle: true}
items:
  - id: who
    text: Who decides?
    options: [you, the robots, both, nobody]
    correct_by_condition: {dialogue.condition=supervisor: you, dialogue.condition=collaborator: both}
  - {id: played, text: Have you played before?, options: ['yes', 'no', 'I do not know']}
"""


@pytest.mark.parametrize("dies", [None, 5, 6, 8])
def test_a_check_is_judged_by_its_condition_and_the_order_of_its_answers_is_recorded(
    tmp_path: Path, dies: int | None
) -> None:
    (tmp_path / "consent.txt").write_text("We record what you do.\n")
    (tmp_path / "by_condition.yaml").write_text(BY_CONDITION)
    laboratory = Laboratory(
        tmp_path,
        "title: x\nseed: 5\nquota: 1\norder: fixed\nwithin: {dialogue.condition: [supervisor, collaborator]}\n"
        "steps:\n  - {step: consent, text: consent.txt}\n"
        "  - {step: check, form: by_condition.yaml, attempts: 2, each_condition: true}\n"
        "  - {step: trial, each_condition: true}\n",
    )
    person = Person({"who": "you", "played": "no"})
    if dies is not None:
        with pytest.raises(KilledError):
            laboratory.run(person, dies=dies)
    laboratory.run(person, people=1 if dies is None else 0)
    outcomes = [event.data["outcome"] for event in laboratory.events if event.kind == "step-ended"]
    assert outcomes == ["done", "done", "done", "failed", "failed"]
    pages = [{item.id: item.options for item in page.items} for page in person.seen if isinstance(page, FormToFill)]
    assert all(page == pages[0] for page in pages)
    assert pages[0]["who"] != ("you", "the robots", "both", "nobody")
    shown = {data["item"]: tuple(data["options"]) for data in laboratory.data("item-shown")}
    assert shown == pages[0]
    entries = read_log(tmp_path / "store" / "log")
    table = next(table for table in tables_of(laboratory.design, entries) if table.name == "answers")
    rows = [row for row in table.rows if row["item"] == "who"]
    assert [row["right"] for row in rows] == [True, False, False]
    assert {row["options_shown"] for row in rows} == {"; ".join(pages[0]["who"])}


def test_a_debriefing_tells_the_results_that_games_left_out(tmp_path: Path) -> None:
    laboratory = Laboratory(tmp_path, STUDY.replace("{step: debrief,", "{step: debrief, results: true,"))
    laboratory.run(person := Person())
    page = next(page for page in person.seen if getattr(page, "heading", "") == TEXTS.text("kiosk.debrief"))
    best = r"With the same energy and enough time, \d+ points were possible\."
    assert re.fullmatch(
        rf"It was about robots\.\n\nYour score in game 1: 10\. {best}\n\nYour score in game 2: 10\. {best}",
        page.text,
    )
    assert words.results(TEXTS, [(3, None)]) == "Your score: 3."


def test_the_kiosk_leaves_runs_of_people_in_browsers_alone(laboratory: Laboratory, tmp_path: Path) -> None:
    with ExperimentLog(tmp_path / "store" / "log") as log:
        Conductor(laboratory.design, log, StudyClock(), lambda most: most // 2).admit(front_end=FrontEnd.BROWSER)
    person = Person()
    laboratory.run(person)
    at_browser, at_kiosk = laboratory.people
    assert (at_browser.state, at_browser.step) == (RunState.UNDER_WAY, 1)
    assert at_kiosk.state is RunState.COMPLETE
    assert TEXTS.text("kiosk.restarted") not in headings(person)


def test_a_place_that_a_person_in_a_browser_frees_or_takes_changes_the_first_page(laboratory: Laboratory) -> None:
    seen: list[str] = []

    def does(page: ToKiosk) -> Iterable[FromKiosk] | None:
        if not (isinstance(page, TextToRead) and page.anew):
            return None
        seen.append(page.heading)
        conductor = laboratory.conductor
        match len(seen):
            case 1:  # The quota is 2.
                for _ in range(2):
                    conductor.admit(front_end=FrontEnd.BROWSER)
                return []
            case 2:
                conductor.leave(next(iter(conductor.progress.runs)), "stopped taking part")
                return []
        return [KioskClosed()]

    laboratory.run(Person(does=does), 3)
    welcome = TEXTS.text("kiosk.welcome")
    assert seen == [welcome, TEXTS.text("kiosk.taken"), welcome]
