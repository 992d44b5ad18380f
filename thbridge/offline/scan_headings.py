"""Headings of a robot from its scans without odometry, for the comparison of the clocks of scans and odometry."""

import math

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import LaserMount, Scan
from sim.robot.localization.likelihood_field import Beams
from sim.robot.localization.scan_matching import GOOD, ScanMatcher
from thbridge.offline.odometry import OdometryTrack
from thbridge.offline.time_offset import TimeOffset, time_offset

_BEAMS = 60
_PERIOD_NS = 50_000_000
"""Minimum time between two matched scans, nanoseconds."""
_SEARCHED = 0.6
"""Maximum displacement of a point due to the error of a match's initial pose, meters."""


class ScanHeadings:
    """Collector of headings. It matches scans to the map near the poses of a filter.

    Args:
        grid: the map.
        mount: the laser.
    """

    def __init__(self, grid: OccupancyGrid, mount: LaserMount) -> None:
        self._matcher = ScanMatcher.of(grid, mount.laser_in_base)
        self._beams = Beams.of(mount, _BEAMS, -1.0)
        self._stamps: list[int] = []
        self._headings: list[float] = []

    def add(self, stamp_ns: int, scan: Scan, base_in_map: Pose2) -> None:
        """Match a scan near a pose. Skip a scan that is too soon after the last scan or has an earlier stamp."""
        if self._stamps and stamp_ns - self._stamps[-1] < _PERIOD_NS:
            return
        match = self._matcher.match(base_in_map, self._beams.end_points(scan), _SEARCHED)
        good = match is not None and match.share >= GOOD
        self._stamps.append(stamp_ns)
        self._headings.append(match.base_in_map.theta if match is not None and good else math.nan)

    def time_offset(self, odometry: OdometryTrack) -> TimeOffset | None:
        """Return the offset between the clocks of odometry and scans, or None if it cannot be estimated."""
        run = odometry.longest_run
        if run is None or not self._stamps:
            return None
        begin_ns = int(run.stamps[0])
        return time_offset(
            (run.stamps - begin_ns) / 1e9,
            run.poses[:, 2],
            (np.array(self._stamps) - begin_ns) / 1e9,
            np.array(self._headings),
        )
