"""Making way: a robot waits for another robot with the right of way, drives aside for it, or drives around it."""

from sim.common.observations import TICKS_PER_SECOND

PAUSE = 1.0
"""Seconds without a reason to make way. Then a robot stops making way.

Shorter pauses are ignored, because robots in a queue advance in small steps.
"""


class MakingWay:
    """Memory of the robot for which another robot makes way. Short pauses are ignored."""

    def __init__(self) -> None:
        self._robot: int | None = None
        self._reason: int | None = None
        self._tick = 0

    @property
    def pauses(self) -> bool:
        """True if there was no reason to make way in the last tick, so that making way may end soon."""
        return self._robot is not None and self._reason is None

    def go_on(self, tick: int) -> None:
        """Make way for one more tick, for the same reason as in the last tick, if there was a reason."""
        if self._reason is not None:
            self._tick = tick

    def now(self, tick: int, robot: int | None, *, has_goal: bool) -> int | None:
        """Return the robot for which this robot makes way.

        Args:
            tick: the present tick.
            robot: the robot for which this robot makes way in this tick, or None.
            has_goal: True if this robot has a goal. It may have to make way again immediately.
        """
        self._reason = robot
        if robot is not None:
            self._robot, self._tick = robot, tick
        elif not has_goal or tick - self._tick > PAUSE * TICKS_PER_SECOND:
            self._robot = None
        return self._robot
