"""Sensor messages and motor commands: all that passes between the world and a robot's own software.

Everything is stamped with a tick: the count of physics steps since the session began, `TICK` seconds each.
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
"""Seconds of one physics step; odometry is sensed at every one."""


def next_turn(tick: int, robot: int, period: int) -> int:
    """Return the first tick after this one that is a robot's turn; robots take turns, each once in `period` ticks."""
    return tick + period - (tick - robot) % period


@frozen()
class Twist:
    """A velocity of the base, in its own frame: meters per second forward, radians per second anti-clockwise."""

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
    """Gyroscope reading: the rate of turn, radians per second."""

    tick: int
    angular_velocity: float


@dataclass(frozen=True, slots=True)
class LaserMount:
    """A planar laser: where it sits on the base and which beams it sends.

    Beam i looks along `angle_min + i * angle_increment` in the laser's frame. Ranges in meters.
    """

    laser_in_base: Pose2
    angle_min: float
    angle_increment: float
    beams: int
    range_min: float
    range_max: float

    def angles(self) -> FloatArray:
        """Return (beams,) radians in the laser's frame."""
        return self.angle_min + self.angle_increment * np.arange(self.beams, dtype=np.float64)


@frozen()
class Scan:
    """One sweep of the laser.

    Attributes:
        ranges: (beams,) float32 meters; +inf where nothing was hit within range_max (REP 117), NaN where the beam
            was lost.
    """

    tick: int
    mount: LaserMount
    ranges: NDArray[np.float32]


@frozen()
class Battery:
    """The energy left, in the game's units; a robot starts with `capacity`."""

    tick: int
    charge: float
    capacity: float


class Claim(NamedTuple):
    """Priority of a robot that asks others to clear its path; the lesser one goes first.

    Attributes:
        since: tick at which that robot took up its goal: the one that has waited longest goes first, so none starves.
        robot: its index.
    """

    since: int
    robot: int


@frozen()
class Neighbour:
    """State that a robot broadcasts to its team; the others receive it one tick later.

    Attributes:
        robot: its index in the team.
        base_in_map: believed pose of the robot.
        twist: its velocity.
        footprint: (n, 2) corners in its base frame, meters.
        path: (m, 2) map points it is heading along, its own place first; empty when it stands.
        times: (m,) when it means to be there: the order in which robots pass a place
            (`sim.robot.global_planning.itinerary`). Empty with a path that is only wanted: other robots obstruct it
            and are asked to clear it.
        claim: with a path that is only wanted: the priority of the robot that wants it.
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
    """Everything one robot perceives in one tick; None where a sensor is not due."""

    tick: int
    odometry: Odometry
    imu: Imu
    scan: Scan | None
    battery: Battery
