"""Obstacles that stand in the world and not in the robot's map, drawn as a map of their own."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sim.common.grid import OCCUPIED, OccupancyGrid
from sim.numerics.elementary import wrap_angle
from thbridge.files.errors import BadFile

_SAME_YAW = 1e-6
"""Radians by which the yaws of two origins may differ."""
_SLIVER = 1e-3
"""Share of a cell that an obstacle may overlap without filling it: origins in files are rounded."""


def with_unmapped(grid: OccupancyGrid, unmapped: OccupancyGrid, path: Path) -> tuple[OccupancyGrid, int]:
    """The true map: the robot's, with every cell occupied that an occupied cell of the other one overlaps.

    Free and unknown cells of the other map change nothing; its size, resolution and place may be its own.

    Args:
        grid: the robot's map.
        unmapped: the obstacles, in the same frame, turned as the map is.
        path: the file that the obstacles are from, for faults.

    Returns:
        The true map, and the number of occupied cells that lie outside it and so stand nowhere.

    Raises:
        BadFile: it is turned otherwise than the map, has no occupied cell, or none on the map.
    """
    if abs(wrap_angle(unmapped.origin.theta - grid.origin.theta)) > _SAME_YAW:
        problem = f"it is turned by {unmapped.origin.theta:g} rad, the map by {grid.origin.theta:g}"
        raise BadFile(path, problem, "draw it with the same yaw", key="origin")
    rows, cols = np.nonzero(unmapped.cells == OCCUPIED)
    if not len(rows):
        remedy = "draw obstacles darker than occupied_thresh says, or leave --unmapped out"
        raise BadFile(path, "it has no occupied cell, so there is no obstacle", remedy)
    corner = grid.origin.inverse().transform(np.array([[unmapped.origin.x, unmapped.origin.y]]))[0]
    top, bottom = _overlapped(rows, float(corner[1]), unmapped.resolution, grid.resolution, grid.rows)
    left, right = _overlapped(cols, float(corner[0]), unmapped.resolution, grid.resolution, grid.cols)
    here = (top < bottom) & (left < right)
    if not here.any():
        problem = f"all its {len(rows)} occupied cells lie outside the map"
        raise BadFile(path, problem, "give it an origin in the map's frame", key="origin")
    # A rectangle of cells is four corners of a table whose sums from the origin on count how many cover a cell.
    corners = np.zeros((grid.rows + 1, grid.cols + 1), np.int64)
    for row, col, count in ((top, left, 1), (top, right, -1), (bottom, left, -1), (bottom, right, 1)):
        np.add.at(corners, (row[here], col[here]), count)
    covered = corners.cumsum(axis=0).cumsum(axis=1)[:-1, :-1] > 0
    cells = np.where(covered, np.int8(OCCUPIED), grid.cells)
    return OccupancyGrid(cells, grid.resolution, grid.origin), int((~here).sum())


IntArray = NDArray[np.int64]


def _overlapped(
    indices: IntArray, corner: float, side: float, resolution: float, count: int
) -> tuple[IntArray, IntArray]:
    """First cell of the map, and the one after the last, that cells along one axis overlap; within the map."""
    first = np.floor((corner + indices * side) / resolution + _SLIVER)
    last = np.ceil((corner + (indices + 1) * side) / resolution - _SLIVER)
    return np.clip(first, 0, count).astype(np.int64), np.clip(last, 0, count).astype(np.int64)
