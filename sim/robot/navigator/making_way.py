"""Making way: a robot that waits for one with the right of way, or drives aside or round it."""

from sim.common.observations import TICKS_PER_SECOND

PAUSE = 1.0
"""Seconds without a reason to make way that do not yet end it: a robot in a queue comes on by little steps."""


class MakingWay:
    """The robot that another one makes way for, without the short pauses between."""

    def __init__(self) -> None:
        self._robot: int | None = None
        self._reason: int | None = None
        self._tick = 0

    @property
    def pauses(self) -> bool:
        """True when there was no reason to make way in the last tick, and it may soon be over."""
        return self._robot is not None and self._reason is None

    def go_on(self, tick: int) -> None:
        """Make way in one more tick for the same reason as in the last, if there was one."""
        if self._reason is not None:
            self._tick = tick

    def now(self, tick: int, robot: int | None, *, has_goal: bool) -> int | None:
        """Return the robot that way is made for.

        Args:
            tick: the present one.
            robot: that in this very tick; None: none.
            has_goal: True for a robot with a goal, which may have to make way again at once.
        """
        self._reason = robot
        if robot is not None:
            self._robot, self._tick = robot, tick
        elif not has_goal or tick - self._tick > PAUSE * TICKS_PER_SECOND:
            self._robot = None
        return self._robot
