"""Dialogue strategies: the choice among legal moves. Other strategies of persuasion are plugged in here."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from thbridge.dialogue.moves import Dialogue, Move


class Strategy(Protocol):
    """Chooses the robot's moves. Must be a function of its arguments and of its constructor's."""

    def choose(self, dialogue: Dialogue, legal: Sequence[Move]) -> Move:
        """Return one of the legal moves, of which there is at least one, by a dialogue's topic and moves so far."""
        ...


@dataclass(frozen=True, slots=True)
class TemplateStrategy:
    """The robot of 2016: it follows its script, which leaves it one move at a time."""

    def choose(self, dialogue: Dialogue, legal: Sequence[Move]) -> Move:
        """Return the first legal move: the next question."""
        return legal[0]
