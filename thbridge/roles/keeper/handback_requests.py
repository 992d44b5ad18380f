"""The participant's requests to get robots back: at most one for the same robot in ten seconds."""

from sim.common.observations import TICKS_PER_SECOND

_AGAIN = 10 * TICKS_PER_SECOND
"""Ticks after which the participant may ask for the same robot again."""


class HandbackRequests:
    """Robots that were asked for recently, each with the tick of the request."""

    def __init__(self) -> None:
        self._tick = 0
        self._since: dict[int, int] = {}

    @property
    def recent(self) -> frozenset[int]:
        """Robots that were asked for in the last ten seconds."""
        return frozenset(self._since)

    def advance(self, tick: int) -> bool:
        """Set the current tick; return True when a robot may be asked for again."""
        self._tick = tick
        over = [robot for robot, since in self._since.items() if tick - since >= _AGAIN]
        for robot in over:
            del self._since[robot]
        return bool(over)

    def add(self, robot: int) -> None:
        """Note that the participant has asked for this robot now."""
        self._since[robot] = self._tick

    def forget(self, robot: int) -> None:
        """Forget the request for a robot that has another commander now."""
        self._since.pop(robot, None)

    def clear(self) -> None:
        """Forget all requests, because another game begins."""
        self._since.clear()
