"""People go through a study, page after page, whatever they do and whenever a program dies."""

import hashlib
import itertools
from collections.abc import Iterable
from pathlib import Path

import pytest

from tests.ui.hosting.kiosk.laboratory import STUDY, KilledError, Laboratory, Person, headings
from thbridge.experiment.progress import EventKind, RunState
from ui.hosting.kiosk import words
from ui.model.kiosk import (
    AnswerKept,
    BeginNext,
    FocusNews,
    FormToFill,
    FromKiosk,
    GameRecorded,
    GameToJoin,
    ItemNews,
    KioskClosed,
    StoppedTakingPart,
    TextToRead,
    ToKiosk,
    WentOn,
)


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
        words.PRACTICE_ENDED,
        "Before we begin",
        words.ONCE_MORE,
        words.PRACTICE_ENDED,
        "Before we begin",
        words.GAME_ENDED,
        "How you feel",
        words.GAME_ENDED,
        "The end",
        "What this study was about",
        "Thank you",
        "Welcome",
    ]
    last = next(page for page in person.seen if isinstance(page, TextToRead) and page.code)
    assert last.code == run.code


def test_a_program_that_dies_at_any_event_loses_and_doubles_nothing(tmp_path: Path) -> None:
    def studied(name: str) -> Laboratory:
        (tmp_path / name).mkdir()
        return Laboratory(tmp_path / name)

    def somebody() -> Person:
        return Person(learns=True)

    whole, first = studied("whole"), somebody()
    whole.run(first)
    count = len(whole.events)
    assert count > 40
    for dies in range(1, count):
        laboratory, person = studied(f"dies-{dies}"), somebody()
        with pytest.raises(KilledError):
            # The event is written or not, in turn.
            laboratory.run(person, dies=dies, written=dies % 2 == 0)
        laboratory.run(person, people=0)
        assert outline(laboratory) == outline(whole), dies
        (run,) = laboratory.people
        assert run.state is RunState.COMPLETE, dies
        assert set(pages_of_items(person)) == set(pages_of_items(first)), "the same items in the same order"
