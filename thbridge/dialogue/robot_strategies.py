"""Strategies of robots that argue: their own by manner, and programs of others, whose faults do no harm."""

import re
import traceback
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from thbridge.dialogue.conditions import Manner
from thbridge.dialogue.games.contents import DialogueMove
from thbridge.dialogue.games.control import Conversation
from thbridge.dialogue.games.strategies import ArguingStrategy, GameStrategy

LONGEST_FAULT = 300
"""Greatest length of a fault, in characters."""
_PACKAGE = Path(__file__).parents[1]
_ADDRESS = re.compile(r" at 0x[0-9a-fA-F]+")


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
        chosen: object = factory(manner, seed).choose(conversation, number)
        legal = conversation.legal(number)
        if isinstance(chosen, DialogueMove) and chosen in legal:
            return ChosenMove(legal[legal.index(chosen)])
        is_move = isinstance(chosen, DialogueMove)
        fault = f"{_in_a_line(str(chosen))} is not legal here" if is_move else f"a {type(chosen).__name__} is no move"
    except (Exception, SystemExit) as error:
        # Whatever a program of others does, the game goes on.
        fault = told_error(error)
    return ChosenMove(own_strategy(manner).choose(conversation, number), fault)


def told_error(error: BaseException) -> str:
    """Return an error of a program of others, with its place there; it reads the same on each machine."""
    text = _in_a_line(traceback.format_exception_only(error)[-1])
    frames = traceback.extract_tb(error.__traceback__)
    # The last one in the program itself, which may have called us again.
    theirs = [frame for frame in frames if not Path(frame.filename).is_relative_to(_PACKAGE)]
    return f"{text} ({Path(theirs[-1].filename).name}, line {theirs[-1].lineno})" if theirs else text


def _in_a_line(text: str) -> str:
    """A text of a program of others as it can be recorded, without addresses, which differ each time."""
    line = " ".join(_ADDRESS.sub("", text).split()).encode("utf-8", "replace").decode()
    return line if len(line) <= LONGEST_FAULT else f"{line[:LONGEST_FAULT]}..."
