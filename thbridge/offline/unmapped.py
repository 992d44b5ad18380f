"""Obstacles that are in the world but not in the robot's map. A separate map shows these obstacles."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sim.common.grid import OCCUPIED, OccupancyGrid
from sim.numerics.elementary import wrap_angle
from thbridge.files.errors import BadFile

_SAME_YAW = 1e-6
"""Tolerance between the yaws of two origins, radians."""
_SLIVER = 1e-3
"""Share of a cell that an obstacle may overlap without occupying the cell. Origins in files are rounded."""


def with_unmapped(grid: OccupancyGrid, unmapped: OccupancyGrid, path: Path) -> tuple[OccupancyGrid, int]:
    """Return the true map: the robot's map, with every cell occupied that an obstacle of the other map overlaps.

    Free and unknown cells of the other map have no effect. This map may have another size, resolution and origin.

    Args:
        grid: the robot's map.
        unmapped: the obstacles, in the same frame and with the same rotation as the map.
        path: file of the obstacles, for errors.

    Returns:
        The true map, and the number of ignored cells: occupied cells of the other map that are outside the true map.

    Raises:
        BadFile: the maps have different rotations, no cell is occupied, or all occupied cells are outside the map.
    """
    if abs(wrap_angle(unmapped.origin.theta - grid.origin.theta)) > _SAME_YAW:
        problem = f"it is rotated by {unmapped.origin.theta:g} rad, but the map is rotated by {grid.origin.theta:g} rad"
        raise BadFile(path, problem, "use the same yaw as the map", key="origin")
    rows, cols = np.nonzero(unmapped.cells == OCCUPIED)
    if not len(rows):
        remedy = "draw obstacles darker than occupied_thresh requires, or omit --unmapped"
        raise BadFile(path, "it has no occupied cell, so it contains no obstacle", remedy)
    corner = grid.origin.inverse().transform(np.array([[unmapped.origin.x, unmapped.origin.y]]))[0]
    top, bottom = _overlapped(rows, float(corner[1]), unmapped.resolution, grid.resolution, grid.rows)
    left, right = _overlapped(cols, float(corner[0]), unmapped.resolution, grid.resolution, grid.cols)
    here = (top < bottom) & (left < right)
    if not here.any():
        problem = f"all of its {len(rows)} occupied cells are outside the map"
        raise BadFile(path, problem, "write an origin in the map's frame", key="origin")
    # Summed-area table: each rectangle of cells changes the counts at its four corners. Then the cumulative sums are
    # the numbers of rectangles over each cell.
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
    """For each cell, return the first map cell that it overlaps along one axis, and the map cell after the last."""
    first = np.floor((corner + indices * side) / resolution + _SLIVER)
    last = np.ceil((corner + (indices + 1) * side) / resolution - _SLIVER)
    return np.clip(first, 0, count).astype(np.int64), np.clip(last, 0, count).astype(np.int64)
