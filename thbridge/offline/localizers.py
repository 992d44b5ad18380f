"""Localizers for recordings: the particle filter, or a Kalman filter without a gyroscope."""

from dataclasses import replace

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import STANDSTILL, Imu, LaserMount, Odometry, Scan
from sim.parameters import AmclParameters, EkfParameters, RobotParameters
from sim.robot.installed_parts import InstalledParts
from sim.robot.localization.amcl import Amcl
from sim.robot.localization.estimate import Localizer

ROBOT = "robot1"
"""Key of the filter's random stream. One key is enough, because a topic has the scans of only one robot."""


def recorded_localizer(
    software: RobotParameters,
    grid: OccupancyGrid,
    mount: LaserMount,
    start: Pose2 | None,
    seed: int,
    parts: InstalledParts | None = None,
) -> Localizer:
    """Return the localizer that `software.localization` names: `amcl`, `ekf`, `ukf`, or an installed localizer.

    Args:
        software: the parameters.
        grid: the map.
        mount: the laser.
        start: start pose of the robot. If None, the robot may be at any place on the map.
        seed: random seed of the particle filter.
        parts: installed parts that the software may name. If None, the software must not name installed parts.
    """
    localizer: Localizer
    first: AmclParameters | EkfParameters
    if software.localization == "amcl":
        localizer, first = Amcl(software.amcl, grid, mount, seed, ROBOT), software.amcl
    elif parts is not None and software.localization in parts.localizers:
        localizer, first = parts.localizers[software.localization](software, grid, mount, seed), software.amcl
    else:
        from thbridge.offline.kalman import RecordedKalman  # noqa: PLC0415 - loads filterpy

        first = replace(software.ekf, imu_used=False)
        localizer = RecordedKalman(replace(software, ekf=first), grid, mount)
    if start is None:
        localizer.globalize()
    else:
        localizer.start(start, np.diag((first.initial_cov_xx, first.initial_cov_yy, first.initial_cov_aa)))
    return localizer


def warm_up(localizer: Localizer, software: RobotParameters, scan: Scan) -> None:
    """Compile all code for updates by running a filter whose results are not used.

    Args:
        localizer: a filter with the same type and initialization as the measured filter.
        software: parameters of the filter.
        scan: any scan of the same laser.
    """
    stride = 1.01 * max(software.amcl.update_min_d, software.ekf.update_min_d) + 0.01
    for tick in range(2 * software.amcl.resample_interval + 1):
        localizer.update(Odometry(tick, Pose2(tick * stride, 0.0, 0.0), STANDSTILL), Imu(tick, 0.0), scan)
