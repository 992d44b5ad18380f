"""What to say of what may be said: the seam where ways of persuading are exchanged."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from thbridge.dialogue.moves import Dialogue, Move, Speaker


@dataclass(frozen=True, slots=True)
class StrategyInput:
    """What a side may build on when it chooses: the public record. What it believes beyond that is its own affair.

    Attributes:
        side: which side is choosing.
        dialogue: everything said so far, and about what.
    """

    side: Speaker
    dialogue: Dialogue


class Strategy(Protocol):
    """Chooses one side's moves. Must be a function of its arguments and of what it was built with."""

    def choose(self, view: StrategyInput, legal: Sequence[Move]) -> Move:
        """One of the legal moves, of which there is at least one."""
        ...


@dataclass(frozen=True, slots=True)
class TemplateStrategy:
    """The robot of 2016: it follows its script, which leaves it one move at a time."""

    def choose(self, view: StrategyInput, legal: Sequence[Move]) -> Move:
        """The first legal move: the next question."""
        return legal[0]
