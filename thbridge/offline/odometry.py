"""Odometry of a recording, interpolated for any time."""

from bisect import bisect_right
from collections.abc import Iterable
from copy import copy
from dataclasses import replace

import numpy as np

from sim.common.geometry import Pose2
from sim.numerics.elementary import wrap_angle
from thbridge.ros.odometry_faults import MissedMotion, OdometryRun, OdometrySample, sound_odometry

LONGEST_GAP_NS = 1_000_000_000
"""Maximum time between two odometry messages for interpolation between them."""
REACH_NS = 100_000_000
"""Maximum time of extrapolation before the first and after the last message, similar to amcl's transform_tolerance."""


def _pose_at(run: OdometryRun, stamp_ns: int) -> Pose2 | None:
    """Return the pose at a time, interpolated linearly, or None if no sample is near this time."""
    stamps, poses = run.stamps, run.poses
    if not stamps[0] - REACH_NS <= stamp_ns <= stamps[-1] + REACH_NS:
        return None
    if len(stamps) == 1:
        return Pose2(*poses[0].tolist())
    after = min(max(int(np.searchsorted(stamps, stamp_ns)), 1), len(stamps) - 1)
    start, end = int(stamps[after - 1]), int(stamps[after])
    if end - start > LONGEST_GAP_NS:
        nearest = after if end - stamp_ns < stamp_ns - start else after - 1
        near = abs(int(stamps[nearest]) - stamp_ns) <= REACH_NS
        return Pose2(*poses[nearest].tolist()) if near else None
    share = (stamp_ns - start) / (end - start)
    (x0, y0, theta0), (x1, y1, theta1) = poses[after - 1].tolist(), poses[after].tolist()
    turned = wrap_angle(theta1 - theta0)
    return Pose2(x0 + share * (x1 - x0), y0 + share * (y1 - y0), wrap_angle(theta0 + share * turned))


class OdometryTrack:
    """All odometry of a recording. Faults are removed; see `odometry_faults`.

    Messages may be in any order. A new run starts at each change of the clock. For a scan, the run that was recorded at
    the same time is used.

    Attributes:
        faults: removed faults and joined runs.
        begin_ns: time of recording of the first sample.
        unstamped: number of samples with a stamp of 0. For these samples, the time of recording is used.
    """

    def __init__(self, samples: Iterable[OdometrySample], max_speed: float | None = None) -> None:
        """Check samples in the order of recording; see `sound_odometry`."""
        samples = list(samples)
        self.unstamped = sum(sample.stamp_ns == 0 for sample in samples)  # of integers
        sound = sound_odometry(
            (sample if sample.stamp_ns else sample._replace(stamp_ns=sample.received_ns) for sample in samples),
            max_speed,
        )
        self.begin_ns = samples[0].received_ns if samples else 0
        self.faults = sound.faults
        self._runs, self._missed = sound.runs, sound.missed

    def later(self, seconds: float) -> "OdometryTrack":
        """Return the track with stamps that are `seconds` later, for odometry with stamps too early for the scans."""
        shift = round(seconds * 1e9)
        moved = copy(self)
        moved._runs = tuple(replace(run, stamps=run.stamps + shift) for run in self._runs)
        return moved

    @property
    def longest_run(self) -> OdometryRun | None:
        """The run with the largest number of poses, or None without poses."""
        return max(self._runs, key=lambda run: len(run.stamps), default=None)

    def __len__(self) -> int:
        """Number of poses."""
        return sum(len(run.stamps) for run in self._runs)

    def missed(self, since_ns: int, until_ns: int) -> tuple[MissedMotion, ...]:
        """Return motions that are missing in the odometry and were recorded after `since_ns` and up to `until_ns`."""
        return tuple(each for each in self._missed if since_ns < each.received_ns <= until_ns)

    def at(self, stamp_ns: int, received_ns: int) -> Pose2 | None:
        """Return the pose of the base in odom, or None if no odometry is near this time.

        Args:
            stamp_ns: time of the pose.
            received_ns: time of recording of the scan. It selects the run if stamps of several runs overlap.
        """
        current = bisect_right([run.received_ns for run in self._runs], received_ns) - 1
        for index in (current, current - 1, current + 1):
            if 0 <= index < len(self._runs) and (pose := _pose_at(self._runs[index], stamp_ns)) is not None:
                return pose
        return None
