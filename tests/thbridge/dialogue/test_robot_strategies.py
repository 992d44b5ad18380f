"""Programs of others choose robots' moves; where one fails, the robot's own strategy does, and that is told."""

import re
from collections.abc import Callable
from dataclasses import dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.dialogue.argued_topics import FACTS, RULEBOOK, FormalPhrasing, play_to_the_end, topics
from thbridge.dialogue.arguing import ArguingEngine
from thbridge.dialogue.argumentation.propositions import Literal
from thbridge.dialogue.conditions import Manner
from thbridge.dialogue.games.contents import DialogueMove
from thbridge.dialogue.games.control import Conversation
from thbridge.dialogue.games.strategies import GameStrategy
from thbridge.dialogue.moves import Author, DialogueTopic, Scenario, Speaker
from thbridge.dialogue.propositions import NextRoom
from thbridge.dialogue.robot_strategies import StrategyFactory, own_strategy
from thbridge.hunt.rooms import Room

TOPIC = DialogueTopic(Scenario.SPECIFIC_ROOM, 0, Room(1), 50.0, 500.0, facts=FACTS)


@dataclass(frozen=True)
class Chooser:
    """A strategy that is one function."""

    choose: Callable[[Conversation, int], DialogueMove]


def talk(factory: StrategyFactory | None, robot: int | None = None) -> ArguingEngine:
    return ArguingEngine(RULEBOOK, {None: Manner()}, FormalPhrasing(), 3, {robot: factory})


def first_answer(factory: StrategyFactory | None, robot: int | None = None) -> tuple[str, str]:
    """What the robot says first, and the fault."""
    step = talk(factory, robot).open(1, TOPIC)
    said = next(each for each in step.utterances if each.speaker is Speaker.ROBOT)
    assert said.author is Author.ROBOT
    return said.text, said.fault


def asks_why(_manner: Manner, _seed: int, /) -> GameStrategy:
    def choose(conversation: Conversation, number: int) -> DialogueMove:
        legal = conversation.legal(number)
        return next((move for move in legal if move.locution == "challenge"), legal[0])

    return Chooser(choose)


def raising(_manner: Manner, _seed: int, /) -> GameStrategy:
    def choose(conversation: Conversation, number: int) -> DialogueMove:
        raise KeyError("room")

    return Chooser(choose)


def leaving(_manner: Manner, _seed: int, /) -> GameStrategy:
    raise SystemExit(1)


def cheating(_manner: Manner, _seed: int, /) -> GameStrategy:
    move = DialogueMove("accept", Literal(NextRoom(0, Room(7))))
    return Chooser(lambda _conversation, _number: move)


def unspeakable(_manner: Manner, _seed: int, /) -> GameStrategy:
    raise ValueError(f"\udc80\n{object()} {'x' * 10**6}")


def silent(_manner: Manner, _seed: int, /) -> GameStrategy:
    return Chooser(lambda _conversation, _number: None)  # type: ignore[arg-type,return-value]  # the mistake


def confused(_manner: Manner, _seed: int, /) -> GameStrategy:
    def choose(conversation: Conversation, _number: int) -> DialogueMove:
        return conversation.legal(99)[0]

    return Chooser(choose)


def forging(_manner: Manner, _seed: int, /) -> GameStrategy:
    def choose(conversation: Conversation, number: int) -> DialogueMove:
        move = conversation.legal(number)[0]
        object.__setattr__(conversation, "plays", ())
        conversation.agents.clear()  # type: ignore[attr-defined]  # the mistake
        return move

    return Chooser(choose)


def test_what_a_strategy_does_to_the_conversation_stays_with_it() -> None:
    text, fault = first_answer(forging)
    assert text and not fault


def test_another_strategy_chooses_among_legal_moves() -> None:
    own, other = first_answer(None), first_answer(asks_why)
    assert own == ("assert(not next(Robot1, Room1))", "")
    assert other == ("challenge(next(Robot1, Room1))", "")


def test_one_robot_may_have_another_strategy() -> None:
    assert first_answer(asks_why, robot=0) != first_answer(None)
    assert first_answer(asks_why, robot=1) == first_answer(None)


@pytest.mark.parametrize(
    ("factory", "told"),
    [
        (raising, r"KeyError: 'room' \(test_robot_strategies.py, line \d+\)"),
        (leaving, r"SystemExit: 1 \(test_robot_strategies.py, line \d+\)"),
        (confused, r".*IllegalMoveError: there is no dialogue 99 \(test_robot_strategies.py, line \d+\)"),
        (cheating, r"accept\(next\(Robot1, Room7\)\) is not legal here"),
        (unspeakable, r"ValueError: \? <object object> x{1,300}\.\.\. \(test_robot_strategies.py, line \d+\)"),
        (silent, r"a NoneType is no move"),
    ],
)
def test_where_a_strategy_fails_the_own_one_speaks_and_the_fault_is_told(factory: StrategyFactory, told: str) -> None:
    text, fault = first_answer(factory)
    assert text == first_answer(None)[0]
    assert re.fullmatch(told, fault)


def last_legal(_manner: Manner, seed: int, /) -> GameStrategy:
    return Chooser(lambda conversation, number: conversation.legal(number)[-1])


@given(topics(), st.data(), st.sampled_from([asks_why, raising, cheating, last_legal, own_strategy]))
def test_every_dialogue_ends_whatever_a_strategy_chooses(
    topic: DialogueTopic, draw: st.DataObject, factory: StrategyFactory
) -> None:
    engine = talk(factory)
    step = play_to_the_end(engine, engine.open(1, topic), draw)
    failing = factory in {raising, cheating}
    moves = [turn for turn in step.dialogue.turns if turn.speaker is Speaker.ROBOT]
    assert all(not turn.fault for turn in moves) or failing
    assert {said.fault for said in engine.utterances(step.dialogue)} == {turn.fault for turn in step.dialogue.turns}
