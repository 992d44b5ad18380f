"""The participant's requests to other commanders to give robots back."""

from sim.common.observations import TICKS_PER_SECOND
from thbridge.hunt.events import CommanderChanged, HandbackRequested, JournalEntry

_ASK_AGAIN = 10 * TICKS_PER_SECOND
"""Number of ticks after which the participant may ask for the same robot again."""


class RecentHandbacks:
    """Robots that the participant has asked for recently. The participant cannot ask for them again yet."""

    def __init__(self) -> None:
        # Tick of the request, by robot.
        self._asked: dict[int, int] = {}

    @property
    def robots(self) -> frozenset[int]:
        """Robots that the participant has requested from their commanders, and cannot request again yet."""
        return frozenset(self._asked)

    def note(self, event: JournalEntry, tick: int) -> None:
        """Process an event of the game."""
        match event:
            case HandbackRequested(robot=robot):
                self._asked[robot] = tick
            case CommanderChanged(robot=robot):
                self._asked.pop(robot, None)

    def advance(self, tick: int) -> bool:
        """Remove old requests. Return True if a request was removed."""
        if not self._asked:
            return False
        before = len(self._asked)
        self._asked = {robot: asked for robot, asked in self._asked.items() if tick - asked < _ASK_AGAIN}
        return len(self._asked) < before
