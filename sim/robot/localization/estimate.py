"""Localizer: the interface that all of them share, and the estimate that they give."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from sim.common.frozen import frozen
from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import Imu, LaserMount, Odometry, Scan
from sim.numerics import elementary
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.parameters import RobotParameters


@frozen()
class Estimate:
    """Pose of the robot as a localizer estimates it.

    Attributes:
        tick: the one it holds for.
        base_in_map: the robot's pose: the last correction, propagated by odometry.
        odom_in_map: the correction itself, what tf publishes as map -> odom.
        covariance: (3, 3) of x, y, theta in the map frame; m^2, m rad, rad^2.
        particles: (n, 3) poses in the map; (0, 3) where the localizer has none.
        updated: True if a scan (or whatever it corrects by) was weighed in this tick.
        lost: True if the localizer itself holds that the pose cannot be relied on.
        agreement: share of the last scan weighed that the map explains from this place, 0..1; None where the localizer
            weighs none, or has not yet.
        p_wrong: probability that the pose is wrong (`wrong_pose`) by the last scan weighed, 0..1; None likewise.
        fault: failure of a localizer of others in this tick, which is lost then; empty without one.
    """

    tick: int
    base_in_map: Pose2
    odom_in_map: Pose2
    covariance: FloatArray
    particles: FloatArray
    updated: bool
    lost: bool = False
    agreement: float | None = None
    p_wrong: float | None = None
    fault: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class PosePrior:
    """State of a localizer that was told where it is, and has seen no tick since.

    Attributes:
        base_in_map: the pose.
        covariance: (3, 3) how sure; m^2, m rad, rad^2.
    """

    base_in_map: Pose2
    covariance: FloatArray


def read_only(array: FloatArray) -> FloatArray:
    """Return the array itself, now safe to hand out: nobody can write to it."""
    array.setflags(write=False)
    return array


@njit(cache=True)
def propagated(corrections: FloatArray, odometry: FloatArray) -> FloatArray:
    """Return the propagated poses in the map, (n, 3), of poses of odom in the map and in odom: `Pose2.compose`, to the bit."""
    out = np.empty_like(odometry)
    for i in range(odometry.shape[0]):
        c, s = elementary.cos_sin(corrections[i, 2])
        out[i, 0] = corrections[i, 0] + c * odometry[i, 0] - s * odometry[i, 1]
        out[i, 1] = corrections[i, 1] + s * odometry[i, 0] + c * odometry[i, 1]
        out[i, 2] = wrap_angle(corrections[i, 2] + odometry[i, 2])
    return out


class LocalizerFactory(Protocol):
    """Factory of a localizer: a class or function."""

    def __call__(
        self, parameters: RobotParameters, grid: OccupancyGrid, mount: LaserMount, seed: int, /
    ) -> "Localizer":
        """Return the localizer of one robot, whose `start` is called next.

        Args:
            parameters: of the robot's software.
            grid: the map.
            mount: of the laser.
            seed: random seed, another one for each robot.
        """
        ...


class Localizer(Protocol):
    """One robot's localization; it never sees the truth."""

    def start(self, base_in_map: Pose2, covariance: FloatArray) -> None:
        """Begin anew around this pose (ROS: initialpose); `covariance` is (3, 3)."""

    def globalize(self) -> None:
        """Forget where the robot was: it may be anywhere (ROS: global_localization)."""

    def widen(self, distance: float, turn: float) -> None:
        """Doubt the pose more: the robot has moved unseen, with standard deviations of these meters and radians."""

    def request_update(self) -> None:
        """Weigh the next scan even if the robot has not moved (ROS: request_nomotion_update)."""

    def configure(self, parameters: RobotParameters) -> None:
        """Go on with these parameters, believing what it believed (ROS: dynamic_reconfigure)."""

    @property
    def awaits_scan(self) -> bool:
        """True when ticks without a scan change nothing in it: odometry carries the last correction on."""

    def update(self, odometry: Odometry, imu: Imu, scan: Scan | None) -> Estimate:
        """Take in one tick; a scan where the laser was due."""
