"""Reduction of curves to the points that are visible in a figure."""

import numpy as np

from sim.numerics.float_array import FloatArray

POINTS = 700
"""Maximum number of points of a curve, so that files do not grow with the session."""


def simplified(line: FloatArray) -> FloatArray:
    """Return a path with at most one point every few centimeters."""
    if len(line) < 3:
        return line
    along = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))))
    step = max(0.03, along[-1] / (4 * POINTS))
    _, first = np.unique((along / step).astype(np.int64), return_index=True)
    kept: FloatArray = line[np.append(first, len(line) - 1)]
    return kept


def peaks(series: FloatArray) -> FloatArray:
    """Return a shorter (k, 2) time series: the greatest value in each of at most `POINTS` spans of a (n, 2) series."""
    size = -(-len(series) // POINTS)
    if size <= 1:
        return series
    starts = range(0, len(series), size)
    greatest = [start + int(np.argmax(series[start : start + size, 1])) for start in starts]
    return series[greatest]


def changes(series: FloatArray) -> FloatArray:
    """Return a (n, 2) time series without samples that repeat the previous value; the first and the last are kept."""
    if len(series) < 3:
        return series
    kept = np.concatenate(([True], np.diff(series[:, 1]) != 0.0))
    kept[-1] = True
    return series[kept]
