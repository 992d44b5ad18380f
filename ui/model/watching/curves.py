"""Values over time that use a limited amount of memory."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from sim.numerics.float_array import FloatArray

MAX_SAMPLES = 20_000
"""Maximum number of samples in a curve, enough for half an hour with ten samples per second.

Longer curves keep fewer samples in their older half.
"""

MAX_LINE_POINTS = 1000
"""Maximum number of points in a line on the map."""


class Curve:
    """Curve of samples in order of time; samples out of order are dropped.

    When the curve is full, each pair of neighbors in the older half becomes one sample.

    Args:
        columns: number of values in a sample, without the time.
        peaks: True to keep the sample of a pair with the greater first value; False to keep the later sample.
        most: maximum number of samples; at least 4.

    Attributes:
        time: time of the last sample; minus infinity before the first.
    """

    def __init__(self, columns: int = 1, peaks: bool = False, most: int = MAX_SAMPLES) -> None:
        self._rows = np.empty((most, 1 + columns))
        self._peaks = peaks
        self._count = 0
        self._drawn: tuple[tuple[int, int, tuple[int, ...]], FloatArray] | None = None
        self.time = -math.inf

    def __len__(self) -> int:
        """Return the number of samples."""
        return self._count

    def append(self, time: float, *values: float) -> None:
        """Add a sample, unless it is earlier than the last one."""
        if time < self.time:
            return
        if self._count == len(self._rows):
            self._thin()
        self._rows[self._count] = (time, *values)
        self._count += 1
        self.time = time

    def rows(self, until: float = np.inf) -> FloatArray:
        """Return (n, 1 + columns) times and values of all samples up to and including a time."""
        times = self._rows[: self._count, 0]
        return self._rows[: int(np.searchsorted(times, until, side="right"))].copy()

    def path(self, until: float, since: float = -math.inf, cuts: Sequence[float] = ()) -> FloatArray:
        """Return (k, 2) the first two values of all samples between two times, as a line.

        If there are many samples, the line has only every second, fourth, eighth, ... sample. As long as the line does
        not change, the same array object is returned.

        Args:
            until: latest time of the last sample.
            since: time before the first sample.
            cuts: times at which the line is interrupted, in order; a row of NaN marks each interruption.
        """
        times = self._rows[: self._count, 0]
        count = self._count if until >= self.time else int(np.searchsorted(times, until, side="right"))
        first = 0 if since < 0.0 else int(np.searchsorted(times, since, side="right"))
        cut = tuple(np.searchsorted(times[:count], [time for time in cuts if time <= until]).tolist())
        if self._drawn is None or self._drawn[0] != (first, count, cut):
            step = 1 << max(0, math.ceil(math.log2(max(count - first, 1) / MAX_LINE_POINTS)))
            ends = (first, *sorted({end for end in cut if first < end < count}), count)
            pieces = [self._rows[start:end:step, 1:3] for start, end in pairwise(ends)]
            self._drawn = (first, count, cut), joined(pieces)
        return self._drawn[1]

    def _thin(self) -> None:
        half = len(self._rows) // 4 * 2
        pairs = self._rows[:half].reshape(-1, 2, self._rows.shape[1])
        later = pairs[:, 1, 1] >= pairs[:, 0, 1] if self._peaks else np.ones(len(pairs), dtype=np.bool_)
        kept = np.where(later[:, np.newaxis], pairs[:, 1], pairs[:, 0])
        rest = self._rows[half : self._count].copy()
        self._rows[: len(kept)] = kept
        self._rows[len(kept) : len(kept) + len(rest)] = rest
        self._count = len(kept) + len(rest)
        self._drawn = None


def joined(pieces: Sequence[FloatArray]) -> FloatArray:
    """Join pieces of a line into a (k, 2) array, with a row of NaN between pieces."""
    gap = np.full((1, 2), np.nan)
    return np.concatenate([part for piece in pieces for part in (gap, piece)][1:])


def broken(rows: FloatArray, gaps: Sequence[float]) -> FloatArray:
    """Return (m, 1 + columns) samples of a curve, with a row of NaN at each gap between samples."""
    after = np.searchsorted(rows[:, 0], gaps)
    inside = (after > 0) & (after < len(rows))
    empty = np.full((int(inside.sum()), rows.shape[1]), np.nan)
    empty[:, 0] = np.asarray(gaps, dtype=np.float64)[inside]
    return np.insert(rows, after[inside], empty, axis=0)


def as_steps(rows: FloatArray, end: float) -> FloatArray:
    """Return (2 n, 1 + columns) samples as a line of steps.

    Each value lasts until the next sample; the last value lasts until the end.

    Args:
        rows: (n, 1 + columns) samples of a curve that gets a sample only when its value changes.
        end: time of the end. If it is before the last sample, it has no effect.
    """
    steps = np.repeat(rows, 2, axis=0)
    steps[1:-1:2, 0] = rows[1:, 0]
    steps[-1:, 0] = np.maximum(rows[-1:, 0], end)
    return steps
