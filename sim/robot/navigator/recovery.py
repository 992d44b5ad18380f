"""Recovery behaviours: what a navigator tries, one after the other, before it gives a goal up.

Source: ros-planning/navigation, move_base/src/move_base.cpp (loadDefaultRecoveryBehaviors, executeCycle),
clear_costmap_recovery, rotate_recovery.
Differs: the list begins again only when the robot has come nearer to its goal, not as soon as there is a plan, else
two closed doors would keep it going to and fro for ever.
"""

import math

from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND
from sim.parameters import MoveBaseParameters


class RecoveryBehaviours:
    """Which recovery behaviour is next.

    Args:
        parameters: of move_base.
        circumscribed: radius of the robot, metres; four times that is the side of the aggressive reset's square.
    """

    def __init__(self, parameters: MoveBaseParameters, circumscribed: float) -> None:
        self._next = 0
        self.configure(parameters, circumscribed)

    def configure(self, parameters: MoveBaseParameters, circumscribed: float) -> None:
        """Go on with these parameters, with the behaviours that are left."""
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

    def next(self) -> str | None:
        """The behaviour to try now; None when all have been tried."""
        if self._next >= len(self._names):
            return None
        self._next += 1
        return self._names[self._next - 1]

    def reset_side(self, behaviour: str) -> float:
        """Side of the square around the robot outside of which a reset forgets what was seen; 0 for a rotation."""
        return self._squares.get(behaviour, 0.0)


class OscillationDetector:
    """Whether a robot that tries to move comes nowhere.

    Args:
        timeout: seconds after which it counts as oscillating; 0: never.
        distance: metres that count as having moved.
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
        """Take note of where the robot is; whether it has moved on since the last mark."""
        if self._mark is not None and self._mark.distance(pose) < self._distance:
            return False
        self._mark, self._since = pose, tick
        return True

    def pause(self, ticks: int) -> None:
        """So much of the time was spent waiting with good reason."""
        self._since += ticks

    def due(self, tick: int) -> bool:
        """Whether the time is over."""
        return tick - self._since > self._ticks
