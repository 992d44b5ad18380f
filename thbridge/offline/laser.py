"""Conversion of laser drivers' scan messages to scans of the simulation."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.common.observations import LaserMount, Scan
from thbridge.ros.frames import PlanarMount
from thbridge.ros.messages.unpack import LaserScan

FAR = 30.0
"""Range of a laser if its driver gives no valid range, meters."""


@dataclass(frozen=True, slots=True, eq=False)
class Laser:
    """Converter of the scans of one laser.

    Attributes:
        mount: pose of the laser on the base, and the beams of the first scan. All scans are converted to these beams.
        first: the first scan.
        upside_down: True if the angles of the beams increase clockwise, seen from above.
    """

    mount: LaserMount
    first: LaserScan
    upside_down: bool

    @classmethod
    def of(cls, first: LaserScan, mounting: PlanarMount) -> "Laser":
        """Return the converter for a laser, given its first usable scan (see `usable`) and its mounting."""
        sign = -1.0 if mounting.upside_down else 1.0
        range_min = first.range_min if first.range_min > 0.0 else 0.0
        range_max = first.range_max
        if not (math.isfinite(range_max) and range_max > range_min):
            finite = first.ranges[np.isfinite(first.ranges)]
            range_max = max(FAR, float(finite.max(initial=0.0)))
        mount = LaserMount(
            mounting.laser_in_base,
            sign * first.angle_min,
            sign * increment_of(first),
            len(first.ranges),
            range_min,
            range_max,
        )
        return cls(mount, first, mounting.upside_down)

    def scan(self, tick: int, read: LaserScan) -> Scan:
        """Convert a scan message of this laser.

        Readings outside the laser's range become +inf (no obstacle), as in amcl. If the beams of a scan differ from the
        beams of the first scan, each beam gets the reading of the nearest beam. If no beam is near, the reading is
        missing (NaN).
        """
        ranges = read.ranges if self.same_beams(read) else self._nearest(read)
        nothing = (ranges >= self.mount.range_max) | (ranges <= self.mount.range_min)
        return Scan(tick, self.mount, np.where(nothing, np.float32(np.inf), ranges))

    def same_beams(self, read: LaserScan) -> bool:
        """Return True if a scan's beams differ from the first scan's by at most a tenth of the angle between beams."""
        first = self.first
        if len(read.ranges) != len(first.ranges):
            return False
        step = increment_of(first)
        last = len(first.ranges) - 1
        starts = abs(read.angle_min - first.angle_min)
        ends = abs(read.angle_min + last * increment_of(read) - first.angle_min - last * step)
        return max(starts, ends) <= 0.1 * abs(step)

    def _nearest(self, read: LaserScan) -> NDArray[np.float32]:
        first = self.first
        angles = first.angle_min + increment_of(first) * np.arange(len(first.ranges))
        indices = np.rint((angles - read.angle_min) / increment_of(read)).astype(np.int64)
        there = (indices >= 0) & (indices < len(read.ranges))
        ranges = np.full(len(angles), np.nan, dtype=np.float32)
        ranges[there] = read.ranges[indices[there]]
        return ranges


def increment_of(scan: LaserScan) -> float:
    """Return the angle between two beams, or 0 if the message does not contain it."""
    if scan.angle_increment != 0.0 and math.isfinite(scan.angle_increment):
        return scan.angle_increment
    spread = (scan.angle_max - scan.angle_min) / max(1, len(scan.ranges) - 1)
    return spread if math.isfinite(spread) else 0.0


def usable(scan: LaserScan) -> bool:
    """Return True if a message has the angles of at least two beams."""
    return len(scan.ranges) >= 2 and math.isfinite(scan.angle_min) and increment_of(scan) != 0.0
