"""Recovery behaviors: what a navigator tries, one after the other, before it gives a goal up.

Source: ros-planning/navigation, move_base/src/move_base.cpp (loadDefaultRecoveryBehaviors, executeCycle),
clear_costmap_recovery, rotate_recovery.
Differs: the list begins again only when the robot has come nearer to its goal, not as soon as there is a plan, or a
robot between two closed doors would drive to and fro for ever.
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
"""Seconds after which a recovery behavior is ended."""


@dataclass(frozen=True, slots=True, eq=False)
class RecoverySituation:
    """All that a recovery behavior knows when a command is due. Arrays cannot be written to.

    Attributes:
        seconds: simulated time since the behavior began.
        base_in_map: believed pose of the robot.
        twist: its velocity, by odometry.
        goal_in_map: pose of the goal; None where the robot makes room without one.
        scan: the last one that the local costmap has not taken in yet; None without one.
        costs: (rows, cols) the local costmap.
        frame: its place in the map.
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
    """A recovery behavior that has begun (nav_core::RecoveryBehavior, a command at a time)."""

    def command(self, now: RecoverySituation) -> Twist | None:
        """Return the next command, or None at the end. Where a command leaves no room to stop, the robot stands."""


class RecoveryFactory(Protocol):
    """Factory of a recovery behavior: a class or function."""

    def __call__(self, seed: int, /) -> RunningRecovery:
        """Return the behavior, which begins now.

        Args:
            seed: random seed, another one for each robot and each time.
        """
        ...


@dataclass(frozen=True, slots=True)
class RecoveryProgress:
    """State of a goal's recovery.

    Attributes:
        tried: number of behaviors that have been tried since something went well.
        names: all behaviors, in order.
    """

    tried: int
    names: tuple[str, ...]


class RecoveryBehaviours:
    """The list of recovery behaviors, and the next one to try.

    Args:
        parameters: move_base's.
        circumscribed: radius of the robot, meters; four times that is the side of the aggressive reset's square.
    """

    def __init__(self, parameters: MoveBaseParameters, circumscribed: float) -> None:
        self._next = 0
        self.configure(parameters, circumscribed)

    def configure(self, parameters: MoveBaseParameters, circumscribed: float) -> None:
        """Go on with these parameters, with the behaviors that are left."""
        names = [behaviour.name for behaviour in parameters.recovery_behaviors]
        if not parameters.clearing_rotation_allowed:
            names = [name for name in names if name != "rotate_recovery"]
        self._names = names if parameters.recovery_behavior_enabled else []
        self._squares = {
            "conservative_reset": parameters.conservative_reset_dist,
            "aggressive_reset": 4.0 * circumscribed,
        }

    def restart(self) -> None:
        """Begin the list again."""
        self._next = 0

    @property
    def progress(self) -> RecoveryProgress:
        """The behaviors, and how many of them have been tried."""
        return RecoveryProgress(self._next, tuple(self._names))

    def next(self) -> str | None:
        """Return the behavior to try now; None when all have been tried."""
        if self._next >= len(self._names):
            return None
        self._next += 1
        return self._names[self._next - 1]

    def reset_side(self, behaviour: str) -> float:
        """Return the side, meters, of the square around the robot outside of which a reset forgets marks; 0 for a rotation."""
        return self._squares.get(behaviour, 0.0)


class OscillationDetector:
    """Notices that a robot which tries to move stays where it is.

    Args:
        timeout: seconds after which it counts as oscillating; 0: never.
        distance: meters that count as having moved.
    """

    def __init__(self, timeout: float, distance: float) -> None:
        self._mark: Pose2 | None = None
        self._since = 0
        self.configure(timeout, distance)

    def configure(self, timeout: float, distance: float) -> None:
        """Go on with these parameters, from the last mark."""
        self._ticks = timeout * TICKS_PER_SECOND if timeout > 0.0 else math.inf
        self._distance = distance

    def restart(self, tick: int) -> None:
        """Count from now on."""
        self._since = tick

    def watch(self, tick: int, pose: Pose2) -> bool:
        """Take note of where the robot is; return True when it has moved on since the last mark."""
        if self._mark is not None and self._mark.distance(pose) < self._distance:
            return False
        self._mark, self._since = pose, tick
        return True

    def pause(self, ticks: int) -> None:
        """Leave out so many ticks, which the robot waited with good reason."""
        self._since += ticks

    def due(self, tick: int) -> bool:
        """Return True if the time is over."""
        return tick - self._since > self._ticks
