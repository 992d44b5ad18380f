"""Strategies of robots that argue: their own by manner, and programs of others, whose faults do no harm."""

from dataclasses import dataclass, replace
from typing import Protocol

from thbridge.dialogue.conditions import Manner
from thbridge.dialogue.games.contents import DialogueMove
from thbridge.dialogue.games.control import Conversation
from thbridge.dialogue.games.strategies import ArguingStrategy, GameStrategy
from thbridge.dialogue.other_programs import RAISED, in_a_line, told_error


class StrategyFactory(Protocol):
    """Factory of strategies: a class or function."""

    def __call__(self, manner: Manner, seed: int, /) -> GameStrategy:
        """Return a strategy.

        It is made anew for each move, so that a move depends on nothing but manner, seed and conversation.

        Args:
            manner: of the robot.
            seed: of all chance, keyed by game and robot.
        """
        ...


@dataclass(frozen=True, slots=True)
class ChosenMove:
    """Move that a robot makes.

    Attributes:
        move: the move, which is legal.
        fault: why the robot's own strategy chose it in place of another program; empty where that program did.
    """

    move: DialogueMove
    fault: str = ""


def own_strategy(manner: Manner, _seed: int = 0, /) -> GameStrategy:
    """Return the strategy that robots come with; see `StrategyFactory`."""
    return ArguingStrategy(manner.attitude, manner.persistence)


def choose_by(
    factory: StrategyFactory, manner: Manner, seed: int, conversation: Conversation, number: int
) -> ChosenMove:
    """Return the move that a program chooses in a dialogue, or where it fails, that of the robot's own strategy.

    Args:
        factory: makes the program's strategy.
        manner: of the robot.
        seed: as for `StrategyFactory`.
        conversation: as things are.
        number: of the dialogue, in which it is the robot's turn.
    """
    try:
        # A copy, so that what it does to what it is given stays with it.
        given = replace(conversation, agents=dict(conversation.agents))
        chosen: object = factory(manner, seed).choose(given, number)
        legal = conversation.legal(number)
        if isinstance(chosen, DialogueMove) and chosen in legal:
            return ChosenMove(legal[legal.index(chosen)])
        is_move = isinstance(chosen, DialogueMove)
        fault = f"{in_a_line(str(chosen))} is not legal here" if is_move else f"a {type(chosen).__name__} is no move"
    except RAISED as error:
        # Whatever a program of others does, the game goes on.
        fault = told_error(error)
    return ChosenMove(own_strategy(manner).choose(conversation, number), fault)
