"""Progress toward a goal: clocks for the time without a plan and for the time without coming nearer."""

import math

from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND
from sim.robot.global_planning.itinerary import ITINERARY_SPEED

PROGRESS_TIMEOUT = 120.0
"""Seconds within which the remaining path must become shorter than ever before. The time for the goal's longest path is
added. If the path does not become shorter, the goal is given up. So every goal ends."""
PROGRESS_DISTANCE = 0.5
"""A robot makes progress if its remaining path becomes shorter by this number of meters."""
STAY_TIMEOUT = 20.0
"""A recovery behavior is due after this number of seconds of driving within STAY_DISTANCE of one place, even if
`oscillation_timeout` is 0. It allows for the slowest robots of other labs, which drive 0.1 m/s."""
STAY_DISTANCE = 0.5
"""Distance within which a robot counts as staying in one place, meters."""
GIVE_WAY_TIME = 5.0
"""Seconds for which a robot that gave way lets the other robot plan first."""


class GoalProgress:
    """The clocks of one goal, in ticks.

    Args:
        tick: tick at which the goal was accepted.

    Attributes:
        began: tick at which the goal was accepted.
        planned: last tick in which the robot tried to plan.
        last_valid: last tick with a valid command, or with a good reason to wait.
    """

    def __init__(self, tick: int) -> None:
        self.began = tick
        self.planned = tick
        self._longest = 0.0
        self._gave_way: tuple[int, int] | None = None
        self._place: Pose2 | None = None
        self.restart_stay()
        self.restart_patience(tick)
        self.restart_distance(tick)
        self.last_valid = tick

    def restart_patience(self, tick: int) -> None:
        """Record that a plan exists, or that a recovery behavior may make a plan possible."""
        self._planning_since, self._retries = tick, 0

    def note_others_arriving(self, tick: int) -> None:
        """Record that robots will still arrive on the path. They can be asked to clear it only after their arrival."""
        self._planning_since = tick

    def count_retry(self) -> int:
        """Count a refused plan, and return the number of consecutive refused plans."""
        self._retries += 1
        return self._retries

    def patience_over(self, tick: int, seconds: float) -> bool:
        """Return True if there has been no plan for more than `seconds`."""
        return tick - self._planning_since > seconds * TICKS_PER_SECOND

    def restart_distance(self, tick: int) -> None:
        """Restart the measurement of the shortest remaining path."""
        self._shortest, self._shortest_tick = math.inf, tick

    def note_path(self, length: float) -> None:
        """Record a path of `length` meters."""
        self._longest = max(self._longest, length)

    def watch(self, tick: int, remaining: float) -> bool:
        """Record the remaining meters of the path. Return True if the robot is nearer to the goal than ever before."""
        if remaining >= self._shortest - PROGRESS_DISTANCE:
            return False
        self._shortest, self._shortest_tick = remaining, tick
        return True

    def timed_out(self, tick: int) -> bool:
        """Return True if the robot has not come nearer to the goal for too long."""
        return tick - self._shortest_tick > (PROGRESS_TIMEOUT + self._longest / ITINERARY_SPEED) * TICKS_PER_SECOND

    def restart_stay(self) -> None:
        """Restart the clock of `stays`."""
        self._stayed = 0

    def note_driving(self, ticks: int, pose: Pose2) -> None:
        """Count a command with which the robot drives for `ticks` from a pose. Waiting does not count."""
        self._stayed += ticks
        if self._place is None or self._place.distance(pose) >= STAY_DISTANCE:
            self._place = pose
            self.restart_stay()

    @property
    def stays(self) -> bool:
        """True if the robot has driven for a long time, but remained in one place."""
        return self._stayed > STAY_TIMEOUT * TICKS_PER_SECOND

    def note_way_given(self, tick: int, robot: int) -> None:
        """Record that this robot begins to give way to another robot."""
        self._gave_way = tick, robot

    def yields_to(self, tick: int) -> int | None:
        """Return the robot that should plan first, because this robot has just given way to it."""
        if self._gave_way is None or tick - self._gave_way[0] >= GIVE_WAY_TIME * TICKS_PER_SECOND:
            return None
        return self._gave_way[1]
