"""Curves in few numbers: only samples that linear interpolation needs, as differences of whole numbers."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.numerics.float_array import FloatArray

TIME_STEP = 0.01
"""Unit of times in the page, seconds."""


@dataclass(frozen=True, slots=True)
class PlayedCurve:
    """Curve over time, for the page; the first number of each list is a value, and the others are differences.

    Attributes:
        times: times, in units of `TIME_STEP`.
        values: for each quantity, its values in whole units.
    """

    times: tuple[int, ...]
    values: tuple[tuple[int, ...], ...]


def line(rows: FloatArray, units: Sequence[float], tolerances: Sequence[float]) -> PlayedCurve:
    """Return a curve whose values between samples are interpolated linearly.

    At the time of each row, the curve differs from the row by at most the tolerance and one unit, and by the change of
    the value within half a `TIME_STEP`.

    Args:
        rows: (n, 1 + k) time and k values, in the order of time.
        units: size of the unit of each value in the curve.
        tolerances: tolerance of each value.
    """
    return _packed(rows[needed_samples(rows, tolerances)], units)


def steps(rows: FloatArray, units: Sequence[float]) -> PlayedCurve:
    """Return a curve whose values last until the next sample; samples without a change are omitted."""
    rounded = np.round(rows[:, 1:] / units)
    changed = np.concatenate((np.ones(min(len(rows), 1), bool), (np.diff(rounded, axis=0) != 0.0).any(axis=1)))
    return _packed(rows[changed], units)


def needed_samples(rows: FloatArray, tolerances: Sequence[float]) -> NDArray[np.int64]:
    """Return the indices of samples from which linear interpolation gives all rows, within the tolerances.

    This is the algorithm of Douglas and Peucker (1973), with the differences at equal times instead of distances.
    """
    kept = np.zeros(len(rows), dtype=np.bool_)
    kept[[0, -1] if len(rows) else []] = True
    times, values = rows[:, 0], rows[:, 1:] / tolerances
    waiting = [(0, len(rows) - 1)]
    while waiting:
        first, last = waiting.pop()
        if last - first < 2:
            continue
        inner = slice(first + 1, last)
        seconds = times[last] - times[first]
        shares = (times[inner] - times[first]) / seconds if seconds > 0.0 else np.zeros(last - first - 1)
        straight = values[first] + shares[:, np.newaxis] * (values[last] - values[first])
        differences = np.abs(values[inner] - straight).max(axis=1)
        farthest = int(np.argmax(differences))
        if differences[farthest] > 1.0:
            middle = first + 1 + farthest
            kept[middle] = True
            waiting += [(first, middle), (middle, last)]
    return np.flatnonzero(kept)


def _packed(rows: FloatArray, units: Sequence[float]) -> PlayedCurve:
    whole = np.round(rows / (TIME_STEP, *units)).astype(np.int64)
    times, *values = np.diff(whole, axis=0, prepend=0).T.tolist() if len(whole) else [[] for _ in range(1 + len(units))]
    return PlayedCurve(tuple(times), tuple(map(tuple, values)))
