"""Estimate of the time offset between odometry and scans of a recording, from turns that both measure."""

from typing import NamedTuple

import numpy as np

from sim.numerics.float_array import FloatArray

LONGEST_OFFSET = 0.5
"""Maximum offset that can be estimated, seconds."""
_STEP = 0.01
"""Step between the compared offsets, seconds. A parabola gives the best offset between two compared offsets."""
_BLOCKS = 20
"""Number of parts of the recording.

The estimate is repeated without each part. The spread of these estimates shows the accuracy.
"""
_FEWEST_TURNS = 3 * _BLOCKS
_EXPLAINED = 0.3
"""Minimum share of the scans' squared turns that odometry must explain.

If it explains less, odometry and scans do not belong together.
"""


class TimeOffset(NamedTuple):
    """Offset between the clocks of odometry and scans.

    Attributes:
        seconds: time by which odometry shows a turn earlier than the scans. It is negative for later odometry.
        deviation: standard deviation of this time, seconds.
        turns: rotation that odometry reports for each radian of rotation in the scans, radians.
    """

    seconds: float
    deviation: float
    turns: float


def time_offset(
    odometry_times: FloatArray, odometry_headings: FloatArray, scan_times: FloatArray, scan_headings: FloatArray
) -> TimeOffset | None:
    """Estimate the offset from headings by odometry and by scans.

    The turns between successive scans are compared with the turns of odometry over the same intervals, shifted by each
    offset. At the right offset, odometry explains the largest share of the scans' turns (least squares).

    Args:
        odometry_times: (m,) seconds, increasing.
        odometry_headings: (m,) radians.
        scan_times: (n,) seconds, increasing.
        scan_headings: (n,) radians; NaN for a scan without a heading.

    Returns:
        The offset. Or None if the robot turns too little, the best offset is at the end of the range, or odometry
            explains too little of the turns.

    Source: Quenouille, Notes on bias in estimation (1956), for the deviation (the jackknife). It is valid for errors
        that are dependent within a part.
    """
    offsets = np.arange(-LONGEST_OFFSET, LONGEST_OFFSET + _STEP / 2, _STEP)
    first, last = odometry_times[0] + LONGEST_OFFSET, odometry_times[-1] - LONGEST_OFFSET
    headings = np.unwrap(odometry_headings)
    seen = (np.diff(scan_headings) + np.pi) % (2.0 * np.pi) - np.pi
    usable = np.isfinite(seen) & (scan_times[:-1] >= first) & (scan_times[1:] <= last)
    if np.count_nonzero(usable) < _FEWEST_TURNS:
        return None
    seen, begin, end = seen[usable], scan_times[:-1][usable], scan_times[1:][usable]
    sums = np.empty((3, _BLOCKS, len(offsets)))
    block = np.arange(len(seen)) * _BLOCKS // len(seen)
    for number, offset in enumerate(offsets.tolist()):
        told = np.interp(end - offset, odometry_times, headings)
        told -= np.interp(begin - offset, odometry_times, headings)
        for row, products in enumerate((told * told, told * seen, seen * seen)):
            sums[row, :, number] = np.bincount(block, products, _BLOCKS)
    whole = sums.sum(axis=1)
    best = _best(whole, offsets)
    without = [_best(whole - sums[:, each], offsets) for each in range(_BLOCKS)]
    if best is None or any(each is None for each in without):
        return None
    squares, common, _ = whole[:, int(np.argmin(np.abs(offsets - best)))]
    deviation = np.std([each for each in without if each is not None]) * np.sqrt(_BLOCKS - 1.0)
    return TimeOffset(best, float(deviation), float(squares / common))


def _best(sums: FloatArray, offsets: FloatArray) -> float | None:
    """Return the offset for the best explanation of the scans' turns, from (3, n) sums of squares and products."""
    squares, common, seen = sums
    explained = np.where(common > 0.0, common * common / np.maximum(squares, 1e-12), 0.0)
    top = int(np.argmax(explained))
    if not 0 < top < len(offsets) - 1 or explained[top] < _EXPLAINED * seen[top]:
        return None
    before, here, after = explained[top - 1 : top + 2].tolist()
    curvature = before - 2.0 * here + after
    shift = 0.5 * (before - after) / curvature if curvature < 0.0 else 0.0
    return float(offsets[top]) + shift * _STEP
