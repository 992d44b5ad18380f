"""Wordings of arguing robots: every move has a sentence that carries its values, in every language that is shipped."""

import re
from dataclasses import fields, replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.dialogue.random_propositions import MOVES, PLAIN, PROPOSITIONS, ROOMS, WORDINGS, values_in
from thbridge.dialogue import propositions
from thbridge.dialogue.argumentation.arguments import Argument
from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.argumentation.propositions import Literal, Proposition
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.dialogue.games.contents import DialogueMove
from thbridge.dialogue.propositions import (
    EnergyLevel,
    FewerRooms,
    HuntProposition,
    NextRoom,
    RoomSequence,
    TeamPlan,
    Wanted,
)
from thbridge.dialogue.wording.authors import judge_sentence, request_of
from thbridge.dialogue.wording.lines import LINES, LineKey
from thbridge.dialogue.wording.predicates import PREDICATES, ValueKind
from thbridge.hunt.rooms import CORRIDOR, Room

SIDES = st.sampled_from(Side)
NAME = st.sampled_from(sorted(WORDINGS))
CHANCES = st.floats(0, 1, exclude_max=True)
ROOM_3 = Literal(NextRoom(0, Room(3)))
ENGLISH = WORDINGS["en"]


def stands_in(value: str, sentence: str) -> bool:
    """Return True when a value stands in a sentence as a whole word; numbers are not parts of other numbers."""
    return re.search(rf"(?<![\w.,]){re.escape(value)}(?!\w|[.,]\d)", sentence, re.IGNORECASE) is not None


@given(NAME, MOVES, SIDES, CHANCES)
def test_every_move_has_a_sentence_that_carries_all_values(
    name: str, move: DialogueMove, side: Side, chance: float
) -> None:
    wording = WORDINGS[name]
    grammar = wording.language.grammar
    sentence = wording.sentence(move, side, chance=chance)
    assert sentence[-1] in ".?" and sentence[0] == sentence[0].upper() and "£" not in sentence and "  " not in sentence
    for value in values_in(move.content, 0, grammar.decimal):
        assert stands_in(grammar.names.get(value, value), sentence), (value, sentence)


@given(NAME, PLAIN, SIDES, CHANCES, st.booleans(), st.booleans())
def test_people_who_do_not_see_energy_read_no_amount_of_it(
    name: str, proposition: Proposition, side: Side, chance: float, holds: bool, simply: bool
) -> None:
    wording = replace(WORDINGS[name], names_energy=False)
    kinds = PREDICATES[str(proposition).partition("(")[0]].values
    amounts: dict[str, float | tuple[float, ...]] = {
        each: (0.125,) if kind is ValueKind.SUM else 0.125
        for each, kind in kinds.items()
        if kind in {ValueKind.SUM, ValueKind.ENERGY}
    }
    said, other = (
        wording.phrase(Literal(each, holds), side, chance=chance, simply=simply)
        for each in (proposition, replace(proposition, **amounts))
    )
    assert said == other and "…" not in said


@given(NAME, SIDES)
def test_a_treasure_is_named_as_people_read_it_and_not_as_in_its_file(name: str, side: Side) -> None:
    said = WORDINGS[name].phrase(Literal(propositions.NamesTreasureAs(Room(3), "oil_can")), side)
    assert stands_in("oil can", said), said


@given(NAME, PROPOSITIONS, SIDES, CHANCES, st.booleans())
def test_what_does_not_hold_is_said_otherwise(
    name: str, proposition: Proposition, side: Side, chance: float, simply: bool
) -> None:
    wording = WORDINGS[name]
    yes, no = (
        wording.phrase(Literal(proposition, holds), side, chance=chance, simply=simply) for holds in (True, False)
    )
    assert yes != no
    for locution in ("assert", "challenge", "accept", "reject"):
        said, denied = (
            wording.sentence(DialogueMove(locution, Literal(proposition, holds)), side, chance=chance)
            for holds in (True, False)
        )
        assert said != denied


@pytest.mark.parametrize("name", sorted(WORDINGS))
def test_every_line_has_words(name: str) -> None:
    values = {
        ValueKind.ROOM: Room(3),
        ValueKind.NUMBER: 30,
        ValueKind.NAME: "Why room 3?",
        ValueKind.CLAUSE: ROOM_3,
        ValueKind.CLAUSES: (ROOM_3, ~ROOM_3),
        ValueKind.ALTERNATIVES: (ROOM_3, ~ROOM_3),
    }
    for key, line in LINES.items():
        text = WORDINGS[name].line(key, **{word: values[kind] for word, kind in line.values.items()})
        assert text and "£" not in text
    assert set(LINES) == set(LineKey)


def test_every_class_of_propositions_has_a_predicate_with_all_its_values() -> None:
    named = [each for each in vars(propositions).values() if isinstance(each, type)]
    # Only people object and decide, and each reason has a sentence of its own.
    without_words = {HuntProposition, propositions.Objected, propositions.Decided}
    classes = {each for each in named if issubclass(each, HuntProposition)} - without_words
    assert {predicate.proposition for predicate in PREDICATES.values()} == classes
    for predicate in PREDICATES.values():
        assert list(predicate.values) == [field.name for field in fields(predicate.proposition)]


@given(PLAIN)
def test_predicates_are_named_as_propositions_are_written(proposition: Proposition) -> None:
    predicate = PREDICATES[str(proposition).partition("(")[0]]
    assert isinstance(proposition, predicate.proposition)


def test_robots_say_i_people_say_you_and_others_have_numbers() -> None:
    other = Literal(NextRoom(1, Room(2)))
    assert ENGLISH.phrase(ROOM_3) == "I go to room 3 next"
    assert ENGLISH.phrase(ROOM_3, Side.HUMAN) == "you go to room 3 next"
    assert ENGLISH.phrase(other) == ENGLISH.phrase(other, Side.HUMAN) == "robot 2 goes to room 2 (Kitchen) next"
    assert ENGLISH.phrase(Literal(Wanted(~ROOM_3)), Side.HUMAN) == "I want this: you do not go to room 3 next"


def test_the_most_specific_wording_is_said() -> None:
    assert ENGLISH.sentence(DialogueMove("challenge", ROOM_3)) == "Why should I go to room 3 next?"
    assert ENGLISH.sentence(DialogueMove("challenge", ~ROOM_3), Side.HUMAN) == "Why not room 3?"
    level = Literal(EnergyLevel(1000.0))
    assert ENGLISH.sentence(DialogueMove("challenge", level)) == "Why do you say that I have 1000 energy left?"
    advised = ENGLISH.sentence(DialogueMove("assert", ROOM_3), condition=DialogueCondition.ADVISER)
    assert advised == "My advice: send me to room 3 next."


@given(NAME, st.lists(ROOMS, min_size=2, max_size=5, unique=True), SIDES, CHANCES, st.booleans())
def test_the_order_of_a_tour_is_recovered_from_its_sentences_and_no_other_one_is_taken(
    name: str, rooms: list[Room], side: Side, chance: float, holds: bool
) -> None:
    wording = WORDINGS[name]
    for locution in ("assert", "challenge", "accept", "reject"):
        move = DialogueMove(locution, Literal(RoomSequence(tuple(rooms)), holds))
        sentence = wording.sentence(move, side, chance=chance)
        said = re.findall(r"(?:room|Raum) (\d+)", sentence)
        assert [int(room) for room in said] == [room.people for room in rooms]
        assert (re.search(r"\b(not|nicht)\b", sentence) is not None) == (holds == (locution == "reject")) or (
            side is Side.HUMAN and locution == "reject"
        )
        request = request_of(wording, move, side, chance=chance)
        turned = DialogueMove(locution, Literal(RoomSequence((*rooms[1:], rooms[0])), holds))
        assert judge_sentence(wording.sentence(turned, side, chance=chance), request) is not None


def test_an_order_of_rooms_is_said_as_people_say_it() -> None:
    tour = Literal(RoomSequence((Room(2), Room(5), Room(1))))
    said = "to room 2 (Kitchen) first, then to room 5 (Lab 7), then to room 1"
    assert ENGLISH.sentence(DialogueMove("assert", tour)) == f"I would go {said}."
    assert ENGLISH.sentence(DialogueMove("reject", ~tour)) == f"I still want to go {said}."
    assert WORDINGS["de"].sentence(DialogueMove("assert", Literal(RoomSequence((Room(1), Room(3)))))) == (
        "Ich würde erst zu Raum 1, dann zu Raum 3 fahren."
    )


def test_one_room_is_counted_as_one() -> None:
    phrase = ENGLISH.phrase(Literal(TeamPlan(0, CORRIDOR, 1, 12.5)))
    assert phrase == "if I go to the corridor next, we reach 1 room for 12.5 energy in all"


def test_reasons_come_before_what_compares_them_and_those_for_the_room_itself_first() -> None:
    support = frozenset(
        map(Literal, (FewerRooms(4, 5), TeamPlan(0, Room(3), 5, 300.0), TeamPlan(0, Room(1), 4, 250.0)))
    )
    said = ENGLISH.sentence(DialogueMove("assert", Argument(support, ROOM_3)))
    assert said == (
        "I would go to room 3 next. My reasons: if I go to room 3 next, we reach 5 rooms for 300 energy in all; "
        "if I go to room 1 next, we reach 4 rooms for 250 energy in all, and reaching 5 rooms is better than "
        "reaching 4 rooms."
    )


def test_chance_chooses_one_of_several_wordings() -> None:
    move = DialogueMove("assert", ROOM_3)
    assert {ENGLISH.sentence(move, chance=chance) for chance in (0.0, 0.49)} == {"I would go to room 3 next."}
    assert ENGLISH.sentence(move, chance=0.99) == "I think I should go to room 3 next."


def test_simpler_words_are_of_the_same_speaker() -> None:
    level = Literal(EnergyLevel(1000.0))
    assert ENGLISH.phrase(level, simply=True) == "I have 1000 energy"
    assert ENGLISH.phrase(level, Side.HUMAN, simply=True) == "you have 1000 energy left"
