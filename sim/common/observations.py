"""Sensor messages and motor commands: all data between the world and a robot's software.

Times are ticks: the number of physics steps since the session began. Each step takes `TICK` seconds.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.common.frozen import frozen
from sim.common.geometry import Pose2
from sim.numerics.float_array import FloatArray

TICKS_PER_SECOND = 50
TICK = 1.0 / TICKS_PER_SECOND
"""Duration of a physics step, seconds. Each step sends one odometry message."""


def next_turn(tick: int, robot: int, period: int) -> int:
    """Return the next tick after `tick` in which it is a robot's turn.

    Each robot has one turn in `period` ticks.
    """
    return tick + period - (tick - robot) % period


@frozen()
class Twist:
    """A velocity of the base, in its own frame: meters per second forward, radians per second counterclockwise."""

    linear: float
    angular: float


STANDSTILL = Twist(0.0, 0.0)


@frozen()
class Odometry:
    """Wheel odometry: the pose since the start in the drifting frame `odom`, and the measured velocity."""

    tick: int
    base_in_odom: Pose2
    twist: Twist


@frozen()
class Imu:
    """Gyroscope reading: the angular velocity, radians per second."""

    tick: int
    angular_velocity: float


@dataclass(frozen=True, slots=True)
class LaserMount:
    """A planar laser: its pose on the base, and its beams.

    Beam i points at `angle_min + i * angle_increment` in the laser's frame. Ranges are in meters.
    """

    laser_in_base: Pose2
    angle_min: float
    angle_increment: float
    beams: int
    range_min: float
    range_max: float

    def angles(self) -> FloatArray:
        """Return the (beams,) angles in the laser's frame, radians."""
        return self.angle_min + self.angle_increment * np.arange(self.beams, dtype=np.float64)


@frozen()
class Scan:
    """One scan of the laser.

    Attributes:
        ranges: (beams,) float32 meters. +inf if nothing was hit within range_max (REP 117), NaN if the beam was lost.
    """

    tick: int
    mount: LaserMount
    ranges: NDArray[np.float32]


@frozen()
class Battery:
    """The remaining energy, in the game's units. A robot starts with `capacity`."""

    tick: int
    charge: float
    capacity: float


class Claim(NamedTuple):
    """Priority of a robot that asks others to clear its path. The robot with the smaller claim goes first.

    Attributes:
        since: tick at which the robot accepted its goal. The robot that has waited longest goes first, so no robot
            waits forever.
        robot: index of the robot in the team.
    """

    since: int
    robot: int


@frozen()
class Neighbour:
    """State that a robot broadcasts to its team. The others receive it one tick later.

    Attributes:
        robot: index of the robot in the team.
        base_in_map: pose where the robot believes it is.
        twist: its velocity.
        footprint: (n, 2) corners in its base frame, meters.
        path: (m, 2) map points of its planned path, starting at its own position. Empty if it stands still.
        times: (m,) planned times at these points. They define the order in which robots pass a place
            (`sim.robot.global_planning.itinerary`). Empty if other robots block the path; the robot then asks them to
            clear it.
        claim: priority of the robot while it asks others to clear its path, otherwise None.
    """

    robot: int
    base_in_map: Pose2
    twist: Twist
    footprint: FloatArray
    path: FloatArray
    times: FloatArray
    claim: Claim | None = None


@frozen()
class Observations:
    """All data that a robot perceives in a tick. None for a sensor that is not due."""

    tick: int
    odometry: Odometry
    imu: Imu
    scan: Scan | None
    battery: Battery
