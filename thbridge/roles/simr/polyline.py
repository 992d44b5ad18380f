"""Polyline simplification."""

import numpy as np
from numpy.typing import NDArray

from sim.numerics import elementary_arrays
from sim.numerics.float_array import FloatArray


def needed_points(points: FloatArray, tolerance: float) -> NDArray[np.bool_]:
    """Return the points of a polyline that are needed for drawing it within a tolerance.

    Args:
        points: (m, 2) points, at least one.
        tolerance: largest distance of a removed point from the drawn line, in the unit of the points.

    Returns:
        (m,) True for each needed point. Both ends are needed.

    Source: Ramer, An iterative procedure for the polygonal approximation of plane curves (1972); Douglas and Peucker
    (1973).
    """
    kept: NDArray[np.bool_] = np.zeros(len(points), dtype=np.bool_)
    kept[[0, -1]] = True
    stretches = [(0, len(points) - 1)]
    while stretches:
        first, last = stretches.pop()
        if last - first < 2:
            continue
        off = _off(points[first + 1 : last], points[first], points[last])
        farthest = int(np.argmax(off))
        if off[farthest] > tolerance:
            middle = first + 1 + farthest
            kept[middle] = True
            stretches += [(first, middle), (middle, last)]
    return kept


def _off(points: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    """Return the (m,) distances of (m, 2) points from the segment between two points."""
    along = end - start
    length = float((along * along).sum())
    if length == 0.0:
        return np.asarray(elementary_arrays.hypot(*(points - start).T), dtype=np.float64)
    share = np.clip(((points - start) * along).sum(axis=1) / length, 0.0, 1.0)
    return np.asarray(elementary_arrays.hypot(*(points - start - share[:, np.newaxis] * along).T), dtype=np.float64)
