"""Dialogue strategies: the choice among legal moves. Other strategies of persuasion belong here."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from thbridge.dialogue.moves import Dialogue, Move


class Strategy(Protocol):
    """Choice of the robot's moves; it must depend only on its arguments and its constructor's arguments."""

    def choose(self, dialogue: Dialogue, legal: Sequence[Move]) -> Move:
        """Choose one of the legal moves by the dialogue's topic and moves so far. There is at least one legal move."""
        ...


@dataclass(frozen=True, slots=True)
class TemplateStrategy:
    """The robot of 2016, which follows its script; the script allows one move at a time."""

    def choose(self, dialogue: Dialogue, legal: Sequence[Move]) -> Move:
        """Return the first legal move: the next question."""
        return legal[0]
