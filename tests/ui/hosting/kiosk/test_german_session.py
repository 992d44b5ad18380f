"""A study in German: nobody reads English on any page of the kiosk, whatever comes of their run."""

from collections.abc import Iterable
from pathlib import Path

import msgspec
import pytest

from tests.support.studies.kiosk_without_screen import KilledError, Laboratory, Person, headings
from tests.support.windows.english import english_in, strings_in
from thbridge.experiment.design.steps import PracticeTerm
from thbridge.experiment.folder import write_example
from thbridge.experiment.store.events import EventKind, RunState
from thbridge.files.language_texts import shipped_texts
from ui.model.kiosk import Answer, FormItem, FormToFill, FromKiosk, StoppedTakingPart, TextToRead, ToKiosk

GERMAN = shipped_texts("de")
CODES = frozenset({"type", "id", "scale", "options", "answers", "missing", "token", "host", "item", "answer"})
"""What no participant reads."""


class Learner(Person):
    """A person who answers rightly once they are asked again."""

    def answer(self, item: FormItem) -> Answer:
        again = headings(self)[-1:] and GERMAN.text("kiosk.once_more") in headings(self)
        read = next((page.text for page in reversed(self.seen) if "Im nächsten Spiel" in getattr(page, "text", "")), "")
        decides = "den ich wähle" if "entscheiden Sie." in read else "uns einig"
        right = (option for option in item.options if decides in option or option == "Energie.")
        return (next(right, None) if again else None) or super().answer(item)


@pytest.fixture
def laboratory(tmp_path: Path) -> Laboratory:
    write_example(tmp_path, "de")
    # Its first line tells the researcher to replace it.
    consent = tmp_path / "texts" / "consent.txt"
    consent.write_text(consent.read_text().partition("\n\n")[2])
    made = Laboratory(tmp_path, None)
    made.games.missing = {PracticeTerm.MOVES: 2.0, PracticeTerm.DIALOGUES: 1.0}
    return made


def read_by(person: Person) -> list[str]:
    """All that somebody read, but codes."""
    pages = [msgspec.to_builtins(page) for page in person.seen]
    return [words for page in pages for words in strings_in(page, CODES)]


def test_somebody_who_fails_a_check_first_reads_no_english_to_the_end(laboratory: Laboratory) -> None:
    person = Learner()
    with pytest.raises(KilledError):
        laboratory.run(person, dies=12)
    laboratory.run(person, people=0)
    (run,) = laboratory.people
    assert run.state is RunState.COMPLETE
    for key in ("welcome", "restarted", "once_more", "practice_ended", "game_ended", "debrief", "thank_you"):
        assert GERMAN.text(f"kiosk.{key}") in headings(person)
    assert english_in(read_by(person)) == []
    given = {data["item"]: data["answer"] for data in laboratory.data(EventKind.ITEM_GIVEN)}
    assert given["preferred"] == "the first", "the log has codes, whatever the language"


@pytest.mark.parametrize("ends", ["stops", "fails", "declines"])
def test_whoever_ends_early_reads_no_english(laboratory: Laboratory, ends: str) -> None:
    def stops(page: ToKiosk) -> Iterable[FromKiosk] | None:
        is_check = isinstance(page, FormToFill) and ends == "stops"
        return [StoppedTakingPart()] if is_check else None

    person = Person(does=stops, agrees=ends != "declines")
    laboratory.run(person)
    assert laboratory.people[0].state is not RunState.COMPLETE
    assert sum(isinstance(page, TextToRead) for page in person.seen) > 2
    assert english_in(read_by(person)) == []
