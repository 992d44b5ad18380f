"""Kalman filter for recordings."""

from dataclasses import replace

from sim.common.observations import Imu, Odometry, Scan
from sim.robot.localization.ekf import KalmanLocalizer
from sim.robot.localization.estimate import Estimate


class RecordedKalman(KalmanLocalizer):
    """Kalman filter that reports every scan it looks at, also those that it does not believe, as the particle filter
    does: else a robot that is lost would have no updates."""

    def update(self, odometry: Odometry, imu: Imu, scan: Scan | None) -> Estimate:
        """Take in one tick; see `Localizer`."""
        before = self.looked
        return replace(super().update(odometry, imu, scan), updated=self.looked is not before)
