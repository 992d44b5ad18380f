"""Odometry of a recording, interpolated at any time."""

import math
from bisect import bisect_right
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import Pose2
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray

CLOCK_SET_BACK_NS = 1_000_000_000
"""Stamps that go back farther than this are not reordered messages: the clock was set back."""
LONGEST_GAP_NS = 1_000_000_000
"""Longest time between two odometry messages over which poses are interpolated."""
REACH_NS = 100_000_000
"""Longest extrapolation before the first and after the last message; amcl's transform_tolerance."""


class OdometrySample(NamedTuple):
    """One odometry message: stamp of recording, its own stamp, pose of the base in odom."""

    received_ns: int
    stamp_ns: int
    base_in_odom: Pose2


@dataclass(frozen=True, slots=True, eq=False)
class OdometrySegment:
    """Odometry between two jumps of the clock.

    Attributes:
        received_ns: stamp of recording of its first message.
        stamps: (n,) int64 nanoseconds, strictly increasing; n at least 1.
        poses: (n, 3) poses of the base in odom.
    """

    received_ns: int
    stamps: NDArray[np.int64]
    poses: FloatArray

    @classmethod
    def of(cls, steps: list[OdometrySample]) -> "OdometrySegment":
        """The segment of some samples, sorted by stamp; of equal stamps the last is kept, as in tf."""
        newest = {step.stamp_ns: step.base_in_odom for step in steps}
        stamps = np.array(sorted(newest), dtype=np.int64)
        return cls(steps[0].received_ns, stamps, np.array([newest[int(stamp)].array() for stamp in stamps]))

    def at(self, stamp_ns: int) -> Pose2 | None:
        """The pose at a time, interpolated linearly; None where the nearest samples are too far away."""
        if not self.stamps[0] - REACH_NS <= stamp_ns <= self.stamps[-1] + REACH_NS:
            return None
        if len(self.stamps) == 1:
            return Pose2(*self.poses[0].tolist())
        after = min(max(int(np.searchsorted(self.stamps, stamp_ns)), 1), len(self.stamps) - 1)
        start, end = int(self.stamps[after - 1]), int(self.stamps[after])
        if end - start > LONGEST_GAP_NS:
            nearest = after if end - stamp_ns < stamp_ns - start else after - 1
            near = abs(int(self.stamps[nearest]) - stamp_ns) <= REACH_NS
            return Pose2(*self.poses[nearest].tolist()) if near else None
        share = (stamp_ns - start) / (end - start)
        (x0, y0, theta0), (x1, y1, theta1) = self.poses[after - 1].tolist(), self.poses[after].tolist()
        turned = wrap_angle(theta1 - theta0)
        return Pose2(x0 + share * (x1 - x0), y0 + share * (y1 - y0), wrap_angle(theta0 + share * turned))


class OdometryTrack:
    """All odometry of a recording; its clock may have been set back.

    Messages may come in any order; where stamps go back by more than `CLOCK_SET_BACK_NS` a new segment begins. A scan
    is looked up in the segment that was recorded at the same time.
    """

    def __init__(self, steps: list[OdometrySample]) -> None:
        """Make segments of samples in the order of recording; those that are not finite are left out."""
        runs: list[list[OdometrySample]] = []
        latest = 0
        for step in steps:
            if not all(map(math.isfinite, step.base_in_odom.array().tolist())):
                continue
            if not runs or step.stamp_ns < latest - CLOCK_SET_BACK_NS:
                runs.append([])
                latest = step.stamp_ns
            latest = max(latest, step.stamp_ns)
            runs[-1].append(step)
        self._runs = [OdometrySegment.of(run) for run in runs]

    def __len__(self) -> int:
        """Number of poses."""
        return sum(len(run.stamps) for run in self._runs)

    @property
    def clock_set_back(self) -> int:
        """Number of times that the clock was set back."""
        return max(0, len(self._runs) - 1)

    def at(self, stamp_ns: int, received_ns: int) -> Pose2 | None:
        """The pose of the base in odom; None when no odometry is near.

        Args:
            stamp_ns: the time of the pose.
            received_ns: stamp of recording of the scan, which selects the segment where stamps of segments overlap.
        """
        current = bisect_right([run.received_ns for run in self._runs], received_ns) - 1
        for index in (current, current - 1, current + 1):
            if 0 <= index < len(self._runs) and (pose := self._runs[index].at(stamp_ns)) is not None:
                return pose
        return None
