"""Layer of the other robots (the GridLayer of the 2016 study): bodies at the broadcast poses, and paths."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.common.grid import OccupancyGrid
from sim.common.observations import Neighbour
from sim.numerics import elementary, elementary_arrays
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.parameters import RobotsParameters
from sim.robot.costmap.costs import LETHAL, UNKNOWN, Changes, CostFrame, Costs, Window
from sim.robot.costmap.footprint_cost import circumscribed_radius, in_cells
from sim.robot.costmap.lines import line

MIN_MOTION = 0.05
"""Minimum change of position that needs an update, meters.

For the heading, the limit in radians is twice this number.
"""


_NO_PATH: FloatArray = np.empty((0, 2))


@njit(cache=True)
def _fill(costs: Costs, corners: FloatArray, row: int, col: int, row_end: int, col_end: int) -> None:
    """Make all cells of a window lethal whose centers are in a polygon (even-odd rule).

    Args:
        corners: (n, 2) column and row, in cells of `costs`.
    """
    n = corners.shape[0]
    for r in range(max(row, math.floor(corners[:, 1].min())), min(row_end, int(corners[:, 1].max()) + 1)):
        for c in range(max(col, math.floor(corners[:, 0].min())), min(col_end, int(corners[:, 0].max()) + 1)):
            x, y = c + 0.5, r + 0.5
            inside = False
            k = n - 1
            for i in range(n):
                if (corners[i, 1] > y) != (corners[k, 1] > y):
                    crossing = (corners[k, 0] - corners[i, 0]) * (y - corners[i, 1])
                    if x < crossing / (corners[k, 1] - corners[i, 1]) + corners[i, 0]:
                        inside = not inside
                k = i
            if inside:
                costs[r, c] = LETHAL


@njit(cache=True)
def _around(points: FloatArray) -> tuple[int, int, int, int]:
    """Return the window around (n, 2) columns and rows."""
    low, high = points[:, 1].min(), points[:, 1].max()
    left, right = points[:, 0].min(), points[:, 0].max()
    return math.floor(low), math.floor(left), math.floor(high) + 1, math.floor(right) + 1


@njit(cache=True)
def _outline(
    footprint: FloatArray, frame: CostFrame, x: float, y: float, theta: float
) -> tuple[FloatArray, tuple[int, int, int, int]]:
    """Return (n, 2) columns and rows of a footprint's corners, base at (x, y, theta), and the window around them."""
    corners = in_cells(footprint, frame, x, y, theta)
    return corners, _around(corners)


def neighbours_reaching(
    neighbours: Sequence[Neighbour], left: float, low: float, right: float, high: float
) -> list[tuple[Neighbour, float]]:
    """Return the neighbors whose bodies may reach into a map rectangle, with their circumscribed radii, meters."""
    met: list[tuple[Neighbour, float]] = []
    footprint: FloatArray | None = None
    radius = 0.0
    for other in neighbours:
        if other.footprint is not footprint:
            # Usually all robots share the same array.
            footprint = other.footprint
            radius = circumscribed_radius(footprint)
            # The small margin makes sure that rounding excludes no robot.
            reach = radius + 1e-6
            from_x, to_x, from_y, to_y = left - reach, right + reach, low - reach, high + reach
        pose = other.base_in_map
        if from_x < pose.x < to_x and from_y < pose.y < to_y:
            met.append((other, radius))
    return met


@dataclass(frozen=True, slots=True, eq=False)
class _DrawnRobot:
    """A robot as drawn: pose, corners and path (columns and rows in the map), and the window around both."""

    x: float
    y: float
    theta: float
    corners: FloatArray
    path: FloatArray
    window: Window


class RobotsLayer:
    """The footprints of the other robots, and the first part of their paths.

    Args:
        parameters: parameters of the layer.
        grid: the map.
    """

    reach = 0

    def __init__(self, parameters: RobotsParameters, grid: OccupancyGrid) -> None:
        self._parameters = parameters
        self._frame = CostFrame(grid.origin.x, grid.origin.y, grid.resolution)
        self._seen: dict[int, _DrawnRobot] = {}
        # (4, robots) windows of the drawn robots, or None after a change.
        self._windows: NDArray[np.int64] | None = None
        self._changes = Changes()

    def update_neighbours(self, neighbours: Sequence[Neighbour]) -> None:
        """Process the last broadcasts. Robots that are not among them are removed."""
        received = set()
        for neighbour in neighbours:
            if not self._parameters.under_way and len(neighbour.times):
                continue
            received.add(neighbour.robot)
            seen = self._seen.get(neighbour.robot)
            if seen is not None and self._moved_too_little(seen, neighbour):
                continue
            self._forget(neighbour.robot)
            self._seen[neighbour.robot] = seen = self._drawn(neighbour)
            self._windows = None
            self._changes.add(seen.window)
        for robot in [robot for robot in self._seen if robot not in received]:
            self._forget(robot)

    def reaching(self, window: Window, neighbours: Sequence[Neighbour]) -> Sequence[Neighbour]:
        """Return the robots that may write into a window of the map's cells."""
        if self._parameters.path_length > 0.0:
            # A path may lead far away from the robot's body.
            return neighbours
        frame = self._frame
        left, right = frame.x + window.col * frame.resolution, frame.x + window.col_end * frame.resolution
        low, high = frame.y + window.row * frame.resolution, frame.y + window.row_end * frame.resolution
        return [other for other, _ in neighbours_reaching(neighbours, left, low, right, high)]

    def _moved_too_little(self, seen: _DrawnRobot, neighbour: Neighbour) -> bool:
        pose = neighbour.base_in_map
        moved = elementary.hypot(pose.x - seen.x, pose.y - seen.y)
        turned = abs(math.remainder(pose.theta - seen.theta, math.tau))
        same_path = self._parameters.path_length == 0.0 or np.array_equal(seen.path, self._path_ahead(neighbour))
        return moved < MIN_MOTION and turned < 2 * MIN_MOTION and same_path

    def _path_ahead(self, neighbour: Neighbour) -> FloatArray:
        """Return (m, 2) columns and rows of the first part of a path, up to its maximum length."""
        if self._parameters.path_length == 0.0 or len(neighbour.path) < 2:
            return _NO_PATH
        path = neighbour.path[:, :2]
        lengths = np.append(0.0, np.cumsum(elementary_arrays.hypot(*np.diff(path, axis=0).T)))
        end = min(self._parameters.path_length, lengths[-1])
        last = [float(elementary_arrays.interp(end, lengths, path[:, axis])) for axis in (0, 1)]
        points = np.vstack([path[lengths < end], last])
        cells: FloatArray = (points - (self._frame.x, self._frame.y)) / self._frame.resolution
        return cells

    def _drawn(self, neighbour: Neighbour) -> _DrawnRobot:
        pose = neighbour.base_in_map
        corners, around = _outline(neighbour.footprint, self._frame, pose.x, pose.y, pose.theta)
        window = Window(*around)
        path = self._path_ahead(neighbour)
        if len(path):
            window = window.union(Window(*_around(path)))
        return _DrawnRobot(pose.x, pose.y, pose.theta, corners, path, window)

    def _forget(self, robot: int) -> None:
        if robot in self._seen:
            self._changes.add(self._seen.pop(robot).window)
            self._windows = None

    def bounds(self) -> tuple[Window, ...]:
        """Return the windows that robots entered or left."""
        return self._changes.take()

    def extents(self) -> tuple[Window, ...]:
        """Return the windows that contain robots."""
        return tuple(seen.window for seen in self._seen.values())

    def write(self, costs: Costs, origin: tuple[int, int], window: Window) -> None:
        """Write LETHAL under every footprint, and at least `path_cost` along paths."""
        row, col = origin
        shift = np.array([col, row])
        near = self._meeting(window)
        for seen in near:
            self._write_path(costs, origin, window, seen.path)
        for seen in near:
            _fill(
                costs,
                seen.corners - shift,
                window.row - row,
                window.col - col,
                window.row_end - row,
                window.col_end - col,
            )

    def _meeting(self, window: Window) -> list[_DrawnRobot]:
        """Return the robots that are drawn in a window, in the order of their first broadcasts."""
        seen = list(self._seen.values())
        if self._windows is None:
            # Large teams write many windows, and each window contains few robots. So select the robots by one array
            # operation.
            self._windows = np.array([one.window for one in seen], np.int64).reshape(-1, 4).T
        row, col, row_end, col_end = self._windows
        meets = (row < window.row_end) & (col < window.col_end) & (row_end > window.row) & (col_end > window.col)
        return [seen[i] for i in meets.nonzero()[0].tolist()]

    def _write_path(self, costs: Costs, origin: tuple[int, int], window: Window, path: FloatArray) -> None:
        if len(path) == 0:
            return
        cells = np.floor(path[:, ::-1]).astype(np.int64)
        for (row, col), (row_end, col_end) in zip(cells[:-1].tolist(), cells[1:].tolist(), strict=True):
            along = line(row, col, row_end, col_end, abs(row_end - row) + abs(col_end - col))
            inside = (along >= window[:2]) & (along < window[2:])
            along = along[inside.all(axis=1)] - origin
            old = costs[along[:, 0], along[:, 1]]
            costs[along[:, 0], along[:, 1]] = np.where(old == UNKNOWN, old, np.maximum(old, self._parameters.path_cost))
