"""Strategies of robots that argue.

Each manner has a built-in strategy. Strategies of other people can be installed. If such a strategy fails, the built-in
strategy chooses the move.
"""

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

        Each move gets a new strategy, so that a move depends only on manner, seed and conversation.

        Args:
            manner: manner of the robot.
            seed: random seed, different for each game and robot.
        """
        ...


@dataclass(frozen=True, slots=True)
class ChosenMove:
    """Move of a robot.

    Attributes:
        move: the move, which is legal.
        fault: reason why the robot's own strategy chose the move; empty if the installed strategy chose the move.
    """

    move: DialogueMove
    fault: str = ""


def own_strategy(manner: Manner, _seed: int = 0, /) -> GameStrategy:
    """Return the built-in strategy; see `StrategyFactory`."""
    return ArguingStrategy(manner.attitude, manner.persistence)


def choose_by(
    factory: StrategyFactory, manner: Manner, seed: int, conversation: Conversation, number: int
) -> ChosenMove:
    """Return the move that an installed strategy chooses in a dialogue. If it fails, the built-in strategy chooses.

    Args:
        factory: makes the installed strategy.
        manner: manner of the robot.
        seed: random seed, as for `StrategyFactory`.
        conversation: the present conversation.
        number: number of the dialogue, in which it is the robot's turn.
    """
    try:
        # A copy, so that the program cannot change the original.
        given = replace(conversation, agents=dict(conversation.agents))
        chosen: object = factory(manner, seed).choose(given, number)
        legal = conversation.legal(number)
        if isinstance(chosen, DialogueMove) and chosen in legal:
            return ChosenMove(legal[legal.index(chosen)])
        is_move = isinstance(chosen, DialogueMove)
        fault = f"{in_a_line(str(chosen))} is not legal here" if is_move else f"a {type(chosen).__name__} is no move"
    except RAISED as error:
        # The game continues after any error of another program.
        fault = told_error(error)
    return ChosenMove(own_strategy(manner).choose(conversation, number), fault)
