"""Recovery behaviors. A navigator tries them one after another before it gives a goal up.

Source: ros-planning/navigation, move_base/src/move_base.cpp (loadDefaultRecoveryBehaviors, executeCycle),
clear_costmap_recovery, rotate_recovery.
Difference from ROS: the list starts again only after the robot has come nearer to its goal, while in ROS it starts
again as soon as a plan exists. In ROS, a robot between two closed doors would drive back and forth forever.
"""

import math
from dataclasses import dataclass
from typing import Protocol

from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND, Scan, Twist
from sim.numerics.float_array import FloatArray
from sim.parameters import MoveBaseParameters
from sim.robot.costmap.costs import CostFrame, Costs

LONGEST_RECOVERY = 30.0
"""Seconds after which a recovery behavior is stopped."""


@dataclass(frozen=True, slots=True, eq=False)
class RecoverySituation:
    """Input of a recovery behavior when a command is due. Its arrays are read-only.

    Attributes:
        seconds: simulated time since the behavior began.
        base_in_map: pose estimate of the robot.
        twist: velocity of the robot, by odometry.
        goal_in_map: pose of the goal. None if the robot has no goal, but makes room for another robot.
        scan: the last scan that the local costmap has not processed yet, or None.
        costs: (rows, cols) local costmap.
        frame: frame of the local costmap in the map.
        footprint: (n, 2) padded corners of the body, base frame, meters.
    """

    seconds: float
    base_in_map: Pose2
    twist: Twist
    goal_in_map: Pose2 | None
    scan: Scan | None
    costs: Costs
    frame: CostFrame
    footprint: FloatArray


class RunningRecovery(Protocol):
    """A running recovery behavior (nav_core::RecoveryBehavior, one command at a time)."""

    def command(self, now: RecoverySituation) -> Twist | None:
        """Return the next command, or None if the behavior has ended.

        If a command leaves no room to stop, the robot stands.
        """


class RecoveryFactory(Protocol):
    """Factory of a recovery behavior: a class or function."""

    def __call__(self, seed: int, /) -> RunningRecovery:
        """Start the behavior, and return it.

        Args:
            seed: random seed, different for each robot and each start.
        """
        ...


@dataclass(frozen=True, slots=True)
class RecoveryProgress:
    """State of a goal's recovery.

    Attributes:
        tried: number of behaviors that were tried since the last progress.
        names: names of all behaviors, in their order.
    """

    tried: int
    names: tuple[str, ...]


class RecoveryBehaviours:
    """The list of recovery behaviors, and the next behavior to try.

    Args:
        parameters: parameters of move_base.
        circumscribed: circumscribed radius of the robot, meters. The side of the square in the aggressive reset is four
            times this radius.
    """

    def __init__(self, parameters: MoveBaseParameters, circumscribed: float) -> None:
        self._next = 0
        self.configure(parameters, circumscribed)

    def configure(self, parameters: MoveBaseParameters, circumscribed: float) -> None:
        """Continue with these parameters and the remaining behaviors."""
        names = [behaviour.name for behaviour in parameters.recovery_behaviors]
        if not parameters.clearing_rotation_allowed:
            names = [name for name in names if name != "rotate_recovery"]
        self._names = names if parameters.recovery_behavior_enabled else []
        self._squares = {
            "conservative_reset": parameters.conservative_reset_dist,
            "aggressive_reset": 4.0 * circumscribed,
        }

    def restart(self) -> None:
        """Start the list again."""
        self._next = 0

    @property
    def progress(self) -> RecoveryProgress:
        """Names of the behaviors, and the number of those that were tried."""
        return RecoveryProgress(self._next, tuple(self._names))

    def next(self) -> str | None:
        """Return the next behavior to try, or None if all have been tried."""
        if self._next >= len(self._names):
            return None
        self._next += 1
        return self._names[self._next - 1]

    def reset_side(self, behaviour: str) -> float:
        """Return the side of the square around the robot that a reset does not change, meters, or 0 for a rotation."""
        return self._squares.get(behaviour, 0.0)


class OscillationDetector:
    """Detector of robots that try to move, but remain in one place.

    Args:
        timeout: seconds after which a robot counts as oscillating. If 0, it never does.
        distance: distance that counts as motion, meters.
    """

    def __init__(self, timeout: float, distance: float) -> None:
        self._mark: Pose2 | None = None
        self._since = 0
        self.configure(timeout, distance)

    def configure(self, timeout: float, distance: float) -> None:
        """Continue with these parameters and the last mark."""
        self._ticks = timeout * TICKS_PER_SECOND if timeout > 0.0 else math.inf
        self._distance = distance

    def restart(self, tick: int) -> None:
        """Restart the time."""
        self._since = tick

    def watch(self, tick: int, pose: Pose2) -> bool:
        """Record the robot's pose. Return True if it has moved since the last mark."""
        if self._mark is not None and self._mark.distance(pose) < self._distance:
            return False
        self._mark, self._since = pose, tick
        return True

    def pause(self, ticks: int) -> None:
        """Exclude `ticks` during which the robot waited for a good reason."""
        self._since += ticks

    def due(self, tick: int) -> bool:
        """Return True if the time is over."""
        return tick - self._since > self._ticks
