"""Other authors of sentences: what they offer is said only if it carries the values of the move, and no others."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.dialogue.random_propositions import MOVES, WORDINGS
from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.argumentation.propositions import Conjunction, Literal
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.dialogue.games.contents import DialogueMove
from thbridge.dialogue.propositions import (
    ColourFound,
    CouldBe,
    EnergyCost,
    InTheWay,
    LessThan,
    NextRoom,
    PictureTaken,
    Selected,
    UnderWay,
    Wanted,
)
from thbridge.dialogue.wording.authors import (
    LONGEST_OFFERED,
    RefusalReason,
    WordingRequest,
    ask_author,
    judge_sentence,
    longest_sentence,
    request_of,
)
from thbridge.dialogue.wording.wording import Wording
from thbridge.hunt.rooms import Room

ENGLISH, GERMAN = WORDINGS["en"], WORDINGS["de"]
KNOWN = ("teddy", "toy block", "red")
ROOM_3 = Literal(NextRoom(0, Room(3)))
WAY = Literal(EnergyCost(Room(4), Room(3), 12.5))
LESS = Literal(LessThan((100.0, 250.0), 1000.0))


def request(literal: Literal, wording: Wording = ENGLISH, locution: str = "assert") -> WordingRequest:
    return request_of(wording, DialogueMove(locution, literal), known=KNOWN)


@pytest.mark.parametrize(
    ("literal", "sentence"),
    [
        (ROOM_3, "Room 3 would be my choice."),
        (~ROOM_3, "Honestly, I'd rather not go to room 3!"),
        (~ROOM_3, "I wouldn't go to room 3."),
        (WAY, "Going from room 4 to room 3 would cost me 12.5 energy!"),
        (LESS, "Since 100 + 250 is less than 1000, fine."),
        (Literal(UnderWay(1, Room(2))), "Look: robot 2 is driving to room 2 (Kitchen), happily."),
        (Literal(CouldBe(Room(3), ("ball", "teddy"))), "What lies in room 3 might be ball or teddy."),
    ],
)
def test_a_sentence_with_the_same_values_is_taken(literal: Literal, sentence: str) -> None:
    asked = request(literal)
    outcome = ask_author(lambda _: sentence, asked)
    assert (outcome.text, outcome.refusal) == (sentence, None), outcome.refusal


LIES = {
    "another number": (WAY, "The way from room 4 to room 3 costs 10 energy."),
    "a number more": (WAY, "The way from room 4 to room 3 costs 12.5 energy, not 20."),
    "a number less": (WAY, "The way from room 4 to room 3 costs energy."),
    "a number in words": (ROOM_3, "I would go to room 3 in two minutes."),
    "a fraction": (ROOM_3, "I would go to room 3, ½ of the way."),
    "a number of another script": (ROOM_3, "I would go to room ٣."),
    "a sign": (WAY, "The way from room 4 to room 3 costs -12.5 energy."),
    "a number with a letter": (WAY, "The way from room 4 to room 3 costs 12.5k energy."),
    "a per cent sign": (WAY, "The way from room 4 to room 3 costs 12.5% energy."),
    "a currency": (WAY, "The way from room 4 to room 3 costs $12.5 energy."),
    "per cent in words": (WAY, "The way from room 4 to room 3 costs 12.5 percent of the energy."),
    "another decimal sign": (WAY, "The way from room 4 to room 3 costs 12,5 energy."),
    "a group of digits": (LESS, "100 + 250 is less than 1,000."),
    "a great number in words": (ROOM_3, "I would go to room 3, as fourteen people did."),
    "a number within a name": (Literal(NextRoom(0, Room(2))), "I would go to room 2 (Kitchen 2)."),
    "a hedge": (WAY, "The way from room 4 to room 3 costs about 12.5 energy."),
    "a denial in a word": (ROOM_3, "It is a lie that I would go to room 3."),
    "another unit": (WAY, "The way from room 4 to room 3 costs 12.5 seconds."),
    "a room more": (ROOM_3, "I would go to room 3, then to room 4."),
    "a name more": (ROOM_3, "I would go to room 3, past the Kitchen."),
    "another thing": (ROOM_3, "I would go to robot 3."),
    "a treasure": (ROOM_3, "I would go to room 3 for the Toy Block."),
    "a colour": (ROOM_3, "I would go to room 3, where something red lies."),
    "a name less": (Literal(NextRoom(0, Room(2))), "I would go to room 2."),
    "a name less of several": (Literal(CouldBe(Room(3), ("ball", "teddy"))), "In room 3 there could be teddy."),
    "no negation": (~ROOM_3, "I would go to room 3."),
    "a negation": (ROOM_3, "I would not go to room 3."),
    "a contraction": (ROOM_3, "I wouldn't go to room 3."),
    "a typographic contraction": (ROOM_3, "I wouldn’t go to room 3."),
    "a negation too many": (~ROOM_3, "I would not go to room 3, never."),
    "a negation elsewhere": (~ROOM_3, "I would go to room 3, would I not."),
    "nothing becomes something": (~Literal(InTheWay(Room(3))), "Something is in the way to room 3."),
    "no becomes a": (~Literal(PictureTaken(Room(3))), "There is a picture of the treasure in room 3."),
    "numbers that change places": (LESS, "1000 is less than 100 + 250."),
    "more for less": (LESS, "100 + 250 is more than 1000."),
    "minus for plus": (LESS, "100 - 250 is less than 1000."),
    "rooms that change places": (WAY, "The way to room 4 from room 3 costs 12.5 energy."),
    "a condition": (ROOM_3, "I would go to room 3, if you insist."),
    "a question": (ROOM_3, "I would go to room 3?"),
}


@pytest.mark.parametrize("lie", LIES)
def test_a_sentence_that_says_something_else_is_refused(lie: str) -> None:
    literal, sentence = LIES[lie]
    asked = request(literal)
    outcome = ask_author(lambda _: sentence, asked)
    assert outcome.refusal is not None and outcome.refusal.reason is RefusalReason.OTHER_VALUES
    assert outcome.text == asked.sentence
    assert outcome.offered == sentence


@pytest.mark.parametrize(
    ("offered", "reason"),
    [
        (7, RefusalReason.NO_TEXT),
        (type("Mute", (), {"__repr__": None})(), RefusalReason.NO_TEXT),
        (b"room 3", RefusalReason.NO_TEXT),
        ("  ", RefusalReason.NO_TEXT),
        ("I would go\nto room 3.", RefusalReason.NOT_PRINTABLE),
        ("I would go to room 3.\x1b[2J", RefusalReason.NOT_PRINTABLE),
        ("I would go to \u202eroom 3.", RefusalReason.NOT_PRINTABLE),
        ("I would go to room 3" + " please" * 100, RefusalReason.TOO_LONG),
    ],
)
def test_what_is_no_sentence_is_refused(offered: object, reason: RefusalReason) -> None:
    refusal = judge_sentence(offered, request(ROOM_3))
    assert refusal is not None and refusal.reason is reason


def test_a_sentence_may_be_as_long_as_its_bound() -> None:
    asked = request(ROOM_3)
    longest = longest_sentence(asked.sentence)
    assert judge_sentence("I go to room 3".ljust(longest, "."), asked) is None
    assert judge_sentence("I go to room 3".ljust(longest + 1, "."), asked) is not None


def test_an_author_that_fails_or_has_nothing_leaves_the_files_sentence() -> None:
    def fails(asked: WordingRequest) -> str:
        raise KeyError(asked.language)

    asked = request(ROOM_3)
    failed = ask_author(fails, asked)
    assert failed.refusal is not None and failed.refusal.reason is RefusalReason.AUTHOR_FAILED
    assert "KeyError" in failed.refusal.why
    nothing = ask_author(lambda _: None, asked)
    assert (nothing.offered, nothing.refusal) == (None, None)
    assert failed.text == nothing.text == asked.sentence


class MuteError(Exception):
    def __str__(self) -> str:
        raise ValueError(self.args)


@pytest.mark.parametrize(
    ("error", "told"),
    [
        (SystemExit("bye"), "SystemExit: bye"),
        (GeneratorExit(), "GeneratorExit"),
        (MuteError(), "str() failed"),
        (ValueError(f"{object()}"), "<object object>"),
    ],
)
def test_whatever_an_author_raises_is_told_the_same_each_time(error: BaseException, told: str) -> None:
    def fails(_: WordingRequest) -> str:
        raise error

    failed = ask_author(fails, request(ROOM_3))
    assert failed.refusal is not None and failed.refusal.reason is RefusalReason.AUTHOR_FAILED
    assert told in failed.refusal.why
    assert "test_authors.py, line" in failed.refusal.why


def test_an_author_cannot_change_what_it_is_judged_by() -> None:
    def forges(asked: WordingRequest) -> str:
        object.__setattr__(asked, "sentence", "I would go to room 4.")
        return asked.sentence

    asked = request(ROOM_3)
    assert ask_author(forges, asked).text == "I would go to room 3 next."


def test_of_a_sentence_without_an_end_the_beginning_is_kept() -> None:
    outcome = ask_author(lambda asked: asked.sentence * 10_000, request(ROOM_3))
    assert outcome.offered is not None and len(outcome.offered) == LONGEST_OFFERED


def test_an_author_is_told_all_that_the_files_say() -> None:
    move = DialogueMove("assert", Literal(NextRoom(1, Room(2)), holds=False))
    asked = request_of(GERMAN, move, Side.HUMAN, condition=DialogueCondition.ADVISER, known=KNOWN)
    assert (asked.language, asked.speaker, asked.condition) == ("de", Side.HUMAN, DialogueCondition.ADVISER)
    (literal,) = asked.literals
    assert (literal.predicate, literal.holds) == ("next", False)
    assert literal.values == {"robot": "Roboter 2", "room": "Raum 2 (Kitchen)"}
    assert literal.phrase == "Roboter 2 fährt als Nächstes nicht zu Raum 2 (Kitchen)"


def test_what_is_denied_stays_in_its_clause() -> None:
    blue = Literal(ColourFound("image2", "blue"))
    search = Literal(Selected(Room(1)))
    for asked_of, said in [((~blue, search), (blue, ~search)), ((blue, ~search), (~blue, search))]:
        for wording in (ENGLISH, GERMAN):
            asked = request(Literal(Conjunction(asked_of)), wording)
            assert judge_sentence(request(Literal(Conjunction(said)), wording).sentence, asked) is not None
    asked = request(Literal(Wanted(~ROOM_3)), GERMAN)
    assert judge_sentence(request(~Literal(Wanted(ROOM_3)), GERMAN).sentence, asked) is not None


@pytest.mark.parametrize(
    ("literal", "sentence", "is_taken"),
    [
        (~Literal(ColourFound("image2", "blue")), "Auf Bild 2 ist Blau nun einmal nicht zu sehen.", True),
        (~Literal(ColourFound("image2", "blue")), "Auf Bild 2 ist Blau zu sehen, was nicht schlecht ist.", False),
        (~ROOM_3, "Zu Raum 3 würde ich lieber nicht fahren.", False),
        (~ROOM_3, "Ich würde lieber nicht zu Raum 3 fahren.", True),
        (~ROOM_3, "Ich würde gern zu Raum 3 fahren.", False),
        (WAY, "Die Fahrt von Raum 4 zu Raum 3 kostet 12,5 Energie.", True),
        (WAY, "Die Fahrt von Raum 4 zu Raum 3 kostet 12.5 Energie.", False),
        (LESS, "100 + 250 sind mehr als 1000.", False),
    ],
)
def test_german_sentences_are_judged_likewise(literal: Literal, sentence: str, is_taken: bool) -> None:
    assert (judge_sentence(sentence, request(literal, GERMAN)) is None) is is_taken


@given(st.sampled_from([ENGLISH, GERMAN]), MOVES, st.sampled_from(Side))
def test_the_files_own_sentence_is_taken_and_a_number_more_never(
    wording: Wording, move: DialogueMove, side: Side
) -> None:
    asked = request_of(wording, move, side, known=KNOWN)
    assert judge_sentence(asked.sentence, asked) is None
    assert judge_sentence(f"{asked.sentence} 99", asked) is not None


@given(
    st.sampled_from([ENGLISH, GERMAN]),
    MOVES.filter(lambda move: isinstance(move.content, Literal)),
    st.sampled_from(Side),
)
def test_the_opposite_is_never_taken(wording: Wording, move: DialogueMove, side: Side) -> None:
    assert isinstance(move.content, Literal)
    opposite = DialogueMove(move.locution, ~move.content)
    asked = request_of(wording, move, side)
    assert judge_sentence(wording.sentence(opposite, side), asked) is not None
