"""Common interface of all localizers, and their estimate."""

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
    """A localizer's estimate of the robot's pose.

    Attributes:
        tick: time of the estimate.
        base_in_map: pose of the robot: the last correction, propagated by odometry.
        odom_in_map: the correction itself, which tf publishes as map -> odom.
        covariance: (3, 3) covariance of x, y, theta in the map frame: m^2, m rad, rad^2.
        particles: (n, 3) poses in the map, or (0, 3) if the localizer has no particles.
        updated: True if a scan (or another correction) was used in this tick.
        lost: True if the localizer considers the pose unreliable.
        agreement: share of the last used scan that the map explains from this pose, 0 to 1. None before the first scan,
            or if the localizer does not compute it.
        p_wrong: probability that the pose is wrong (`wrong_pose`), 0 to 1, as of the last used scan. None before the
            first scan, or if the localizer does not compute it.
        fault: failure of an installed localizer in this tick. Empty if nothing failed. After a failure the robot is
            lost.
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
    """State of a localizer after its pose was set and before its next tick.

    Attributes:
        base_in_map: the pose.
        covariance: (3, 3) covariance of x, y, theta: m^2, m rad, rad^2.
    """

    base_in_map: Pose2
    covariance: FloatArray


def read_only(array: FloatArray) -> FloatArray:
    """Make an array read-only, so that it can be shared, and return it."""
    array.setflags(write=False)
    return array


@njit(cache=True)
def propagated(corrections: FloatArray, odometry: FloatArray) -> FloatArray:
    """Return (n, 3) poses in the map, from poses of odom in the map and poses in odom.

    The bits are the same as with `Pose2.compose`.
    """
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
        """Return the localizer of one robot. Its `start` is called next.

        Args:
            parameters: parameters of the robot's software.
            grid: the map.
            mount: the laser.
            seed: random seed, different for each robot.
        """
        ...


class Localizer(Protocol):
    """Localization of one robot. It never sees the truth."""

    def start(self, base_in_map: Pose2, covariance: FloatArray) -> None:
        """Restart around this pose (ROS: initialpose). `covariance` is (3, 3)."""

    def globalize(self) -> None:
        """Forget the pose: the robot may be anywhere (ROS: global_localization)."""

    def widen(self, distance: float, turn: float) -> None:
        """Increase the uncertainty after unseen motion, by these standard deviations in meters and radians."""

    def request_update(self) -> None:
        """Use the next scan even if the robot has not moved (ROS: request_nomotion_update)."""

    def configure(self, parameters: RobotParameters) -> None:
        """Continue with these parameters and the present belief (ROS: dynamic_reconfigure)."""

    @property
    def awaits_scan(self) -> bool:
        """True if ticks without a scan do not change its state. Odometry then propagates the last correction."""

    def ignores_scans(self, odometry: Odometry) -> bool:
        """Return True if scans do not change its state either, until odometry changes or a request comes."""

    def update(self, odometry: Odometry, imu: Imu, scan: Scan | None) -> Estimate:
        """Process one tick. `scan` is None if the laser did not scan in this tick."""
