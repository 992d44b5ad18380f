"""Speed limits that ground stations set. They are never above the limits of the study."""

import math

from sim.common.observations import Twist
from sim.parameters import RobotParameters
from sim.parameters.reconfiguration import ParameterRejection, reconfigured
from thbridge.mavlink.role.parameters import Tunable
from thbridge.mavlink.values.vehicle_interface import DenialKind, Denied

DEFAULT_FASTEST = Twist(0.5, 1.0)
"""Speed limits of manual driving for robots whose parameters are unknown."""


class SpeedLimit:
    """Speed limit of one robot.

    Args:
        robot: its index in the team, from 0.
        study: parameters of its software in the study.
        robots: access to the current parameters.
    """

    def __init__(self, robot: int, study: RobotParameters, robots: Tunable) -> None:
        self._robot = robot
        self._study = study
        self._robots = robots
        self._limit = math.inf

    def fastest(self) -> Twist:
        """Return the maximum speeds of the present local planner, or `DEFAULT_FASTEST` if unknown, both positive."""
        now = self._robots.tuning(self._robot)
        if now is None:
            return DEFAULT_FASTEST
        planner = now.software.DWAPlannerROS if _uses_dwa(now.software) else now.software.TrajectoryPlannerROS
        return Twist(min(max(planner.max_vel_x, 0.0), self._limit), planner.max_vel_theta)

    def bounded(self, twist: Twist) -> Twist:
        """Return the twist, clamped to the limit that a station has set."""
        return Twist(min(max(twist.linear, -self._limit), self._limit), twist.angular)

    def limit(self, speed: float) -> tuple[tuple[str, float], ...] | Denied:
        """Set the limit in m/s. A negative value removes it. Return the paths and values of parameters to set."""
        now = self._robots.tuning(self._robot)
        if now is None:
            return Denied("The speed of this robot is not ours to change.", DenialKind.UNSUPPORTED)
        if math.isnan(speed):
            return Denied("That is no speed.")
        limited, values = now.software, []
        for path, own in self._bounds(_uses_dwa(now.software)):
            value = own if speed < 0.0 else min(own, speed)
            changed = reconfigured(limited, path, value)
            if isinstance(changed, ParameterRejection):
                return Denied(changed.sentence)
            limited = changed
            values.append((path, value))
        self._limit = math.inf if speed < 0.0 else speed
        return tuple(values)

    def _bounds(self, with_dwa: bool) -> tuple[tuple[str, float], ...]:
        """Return the path and the value in the study of each speed bound of the local planner."""
        if with_dwa:
            dwa = self._study.DWAPlannerROS
            return ("DWAPlannerROS.max_vel_x", dwa.max_vel_x), ("DWAPlannerROS.max_vel_trans", dwa.max_vel_trans)
        return (("TrajectoryPlannerROS.max_vel_x", self._study.TrajectoryPlannerROS.max_vel_x),)


def _uses_dwa(software: RobotParameters) -> bool:
    return software.move_base.base_local_planner == "dwa_local_planner/DWAPlannerROS"
