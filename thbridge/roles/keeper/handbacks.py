"""The participant's requests to get robots back from their commanders."""

from sim.common.observations import TICKS_PER_SECOND
from thbridge.hunt.events import CommanderChanged, HandbackRequested, JournalEntry

_ASK_AGAIN = 10 * TICKS_PER_SECOND
"""Ticks after which the participant may ask for the same robot again."""


class RecentHandbacks:
    """Robots for which the participant has asked recently, and cannot ask again yet."""

    def __init__(self) -> None:
        # By robot, the tick of the request.
        self._asked: dict[int, int] = {}

    @property
    def robots(self) -> frozenset[int]:
        """Robots for which the participant cannot ask again yet."""
        return frozenset(self._asked)

    def note(self, event: JournalEntry, tick: int) -> None:
        """Note an event of the game."""
        match event:
            case HandbackRequested(robot=robot):
                self._asked[robot] = tick
            case CommanderChanged(robot=robot):
                self._asked.pop(robot, None)

    def advance(self, tick: int) -> bool:
        """Forget requests that are old by this tick; return True if there were any."""
        before = len(self._asked)
        self._asked = {robot: asked for robot, asked in self._asked.items() if tick - asked < _ASK_AGAIN}
        return len(self._asked) < before
