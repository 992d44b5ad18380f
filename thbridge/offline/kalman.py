"""Kalman filter for recordings."""

from dataclasses import replace

from sim.common.observations import Imu, Odometry, Scan
from sim.robot.localization.ekf import KalmanLocalizer
from sim.robot.localization.estimate import Estimate


class RecordedKalman(KalmanLocalizer):
    """Kalman filter with an update for each examined scan, even if the filter rejects the scan.

    The particle filter does the same. Without these updates, there would be no updates of a lost robot.
    """

    def update(self, odometry: Odometry, imu: Imu, scan: Scan | None) -> Estimate:
        """Process one tick; see `Localizer`."""
        before = self.looked
        return replace(super().update(odometry, imu, scan), updated=self.looked is not before)
