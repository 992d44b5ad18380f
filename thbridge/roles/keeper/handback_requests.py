"""The participant asks for robots back: passed on at once, and for the same robot every ten seconds at most."""

from sim.common.observations import TICKS_PER_SECOND

_AGAIN = 10 * TICKS_PER_SECOND
"""Ticks after which the participant may ask for the same robot again."""


class HandbackRequests:
    """The robots that were asked for just now, and since when."""

    def __init__(self) -> None:
        self._tick = 0
        self._since: dict[int, int] = {}

    @property
    def recent(self) -> frozenset[int]:
        """Robots that were asked for in the last ten seconds."""
        return frozenset(self._since)

    def advance(self, tick: int) -> bool:
        """It is this tick now; whether there is a robot that may be asked for again."""
        self._tick = tick
        over = [robot for robot, since in self._since.items() if tick - since >= _AGAIN]
        for robot in over:
            del self._since[robot]
        return bool(over)

    def add(self, robot: int) -> None:
        """Whoever commands this robot was just told that the participant asks for it."""
        self._since[robot] = self._tick

    def forget(self, robot: int) -> None:
        """The robot has another commander, whom nobody has asked yet."""
        self._since.pop(robot, None)

    def clear(self) -> None:
        """Another game begins."""
        self._since.clear()
