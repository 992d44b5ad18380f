"""Trail of a robot, and the rest of the robot's planned path."""

import math
from collections import deque

import numpy as np

from sim.numerics.float_array import FloatArray

TRAIL_STEP = 0.12
"""Distance between two points of a trail, meters."""

TRAIL_POINTS = 44
"""Maximum number of points of a trail; they cover 5 m."""

PATH_SEARCH = 1.5
"""Length of the part of a path that is searched for the robot's present place, ahead of its last place, meters."""


class Trail:
    """Places at which one robot was displayed, thinned and limited in number."""

    def __init__(self) -> None:
        self._points: deque[tuple[float, float]] = deque(maxlen=TRAIL_POINTS)
        self._array: FloatArray | None = None

    def add(self, x: float, y: float) -> None:
        """Add the place where the robot is displayed now, if it is far enough from the last point."""
        if self._points:
            last_x, last_y = self._points[-1]
            if math.hypot(x - last_x, y - last_y) < TRAIL_STEP:
                return
        self._points.append((x, y))
        self._array = None

    def cut(self) -> None:
        """Delete all points."""
        self._points.clear()
        self._array = None

    def array(self) -> FloatArray:
        """Return (k, 2) points, oldest first. The same array is returned until a point is added."""
        if self._array is None:
            self._array = np.array(self._points, dtype=np.float64).reshape(-1, 2)
        return self._array


class PathAhead:
    """Rest of one robot's planned path, without the part that the robot has already driven."""

    def __init__(self, planned: tuple[tuple[float, float], ...]) -> None:
        self.planned = planned
        self._points = np.array(planned, dtype=np.float64).reshape(-1, 2)
        steps = np.diff(self._points, axis=0)
        self._steps = steps
        self._lengths = np.hypot(steps[:, 0], steps[:, 1])
        self._along = np.concatenate(([0.0], np.cumsum(self._lengths)))
        self._driven: float | None = None

    def remaining_from(self, x: float, y: float) -> FloatArray:
        """Return the (m, 2) points of the rest of the path, beginning at this place."""
        if len(self._points) < 2:
            return np.empty((0, 2))
        driven = self._driven = self._nearest(x, y)
        rest = self._points[np.searchsorted(self._along, driven, side="right") :]
        if not len(rest):
            rest = self._points[-1:]
        return np.concatenate((np.array([[x, y]]), rest))

    def _nearest(self, x: float, y: float) -> float:
        """Find the point of the path that is nearest to a place, and return its distance along the path, meters.

        The first search covers the whole path. Later searches cover only a part ahead of the last result. Otherwise the
        result could jump if a path passes the same place twice.
        """
        if self._driven is None:
            reach = slice(0, len(self._steps))
        else:
            first = int(np.searchsorted(self._along, self._driven, side="right")) - 1
            last = int(np.searchsorted(self._along, self._driven + PATH_SEARCH, side="left"))
            reach = slice(min(first, len(self._steps) - 1), max(last, first + 1))
        starts, steps, lengths = self._points[:-1][reach], self._steps[reach], self._lengths[reach]
        offset = np.array([x, y]) - starts
        share = np.clip(np.sum(offset * steps, axis=1) / np.maximum(lengths**2, 1e-12), 0.0, 1.0)
        gaps = offset - share[:, None] * steps
        best = int(np.argmin(np.sum(gaps**2, axis=1)))
        return max(float(self._along[:-1][reach][best] + share[best] * lengths[best]), self._driven or 0.0)
