"""Conversations about three facts."""

from collections.abc import Collection

from tests.thbridge.dialogue.games.judge import Fact
from thbridge.dialogue.argumentation.arguments import Belief
from thbridge.dialogue.argumentation.beliefs import Beliefs, Source
from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.argumentation.propositions import Literal, Rule
from thbridge.dialogue.games.agents import Agent, Picture
from thbridge.dialogue.games.control import Conversation
from thbridge.files.game_files import read_rulebook

RULEBOOK = read_rulebook()
ROBOT, HUMAN = Side.ROBOT, Side.HUMAN
A, B, C = (Literal(Fact(name)) for name in "abc")
IMPLIES = Rule((A,), B)


def side(
    which: Side,
    holds: Collection[Literal] = (),
    rules: Collection[Rule] = (),
    *,
    hers: Collection[Literal] = (),
    source: Source = Source.SENSED,
    is_person: bool = False,
) -> Agent:
    return Agent(which, Beliefs.of(holds, rules, source), is_person, Picture(frozenset(hers)))


def conversation(robot: Agent, human: Agent) -> Conversation:
    return Conversation(RULEBOOK, {ROBOT: robot, HUMAN: human})


def opened(now: Conversation, who: Side, game: str, topic: Belief, parent: int | None = None) -> Conversation:
    (opening,) = now.opening(who, game, topic, parent)
    return now.open(who, opening, parent=parent)


def said(now: Conversation, *texts: str, number: int = 1) -> Conversation:
    for text in texts:
        (move,) = (move for move in now.legal(number) if str(move) == text)
        now = now.say(number, move)
    return now


def legal(now: Conversation, number: int = 1) -> set[str]:
    return {str(move) for move in now.legal(number)}
