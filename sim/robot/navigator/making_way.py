"""Making way: a robot that waits for one with the right of way, or drives aside or round it."""

from sim.common.observations import TICKS_PER_SECOND

PAUSE = 1.0
"""Seconds without a reason to make way that do not yet end it: a robot in a queue comes on by little steps."""


class MakingWay:
    """The robot that another one makes way for, without the short pauses between."""

    def __init__(self) -> None:
        self._robot: int | None = None
        self._tick = 0

    def now(self, tick: int, robot: int | None, *, has_goal: bool) -> int | None:
        """Return the robot that way is made for.

        Args:
            tick: the present one.
            robot: that in this very tick; None: none.
            has_goal: True for a robot with a goal, which may have to make way again at once.
        """
        if robot is not None:
            self._robot, self._tick = robot, tick
        elif not has_goal or tick - self._tick > PAUSE * TICKS_PER_SECOND:
            self._robot = None
        return self._robot
