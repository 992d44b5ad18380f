"""Localizer that knows the true pose: ROS's fake_localization."""

from collections.abc import Callable

import numpy as np

from sim.common.geometry import Pose2
from sim.common.observations import Imu, Odometry, Scan
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray
from sim.parameters import FakeLocalizationParameters, RobotParameters
from sim.robot.localization.estimate import Estimate, read_only


class FakeLocalization:
    """Localizer that reports the robot's true pose, for studies that are not about localization.

    This is the only part of a robot's software that may see the truth. The code that builds the team passes the truth
    to it.
    """

    def __init__(self, parameters: FakeLocalizationParameters, base_in_world: Callable[[], Pose2]) -> None:
        """Store `base_in_world`. This function must return the true pose in the tick that is being estimated.

        Source: fake_localization.cpp. Its deltas move the map frame: a rotation by -delta_yaw, then a translation by
            (-delta_x, -delta_y).
        """
        self._base_in_world = base_in_world
        self._world_in_map = Pose2(-parameters.delta_x, -parameters.delta_y, wrap_angle(-parameters.delta_yaw))
        self._covariance = read_only(np.zeros((3, 3)))
        self._particles = np.empty((0, 3))

    def start(self, base_in_map: Pose2, covariance: FloatArray) -> None:
        """Do nothing, because the true pose needs no start.

        Difference from ROS: fake_localization moves its map frame so that the received pose becomes the true pose.
        """

    def globalize(self) -> None:
        """Do nothing, because there is no belief to forget."""

    def widen(self, distance: float, turn: float) -> None:
        """Do nothing, because there is no belief to widen."""

    def request_update(self) -> None:
        """Do nothing, because no scans are used."""

    def configure(self, parameters: RobotParameters) -> None:
        """Do nothing: as in ROS, its parameters cannot change while it runs."""

    @property
    def awaits_scan(self) -> bool:
        """False, because the truth changes in every tick."""
        return False

    def ignores_scans(self, odometry: Odometry) -> bool:
        """Return False; see `awaits_scan`."""
        return False

    def update(self, odometry: Odometry, imu: Imu, scan: Scan | None) -> Estimate:
        """Return the present true pose, and the correction `odom_in_map` with which odometry gives this pose."""
        base_in_map = self._world_in_map.compose(self._base_in_world())
        odom_in_map = base_in_map.compose(odometry.base_in_odom.inverse())
        return Estimate(
            odometry.tick, base_in_map, odom_in_map, self._covariance, self._particles, updated=True, p_wrong=0.0
        )
