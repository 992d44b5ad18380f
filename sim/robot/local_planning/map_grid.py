"""Distance maps of the local costmap: number of steps along free cells from each cell to the path or to one point.

Grids are flat, with a border of closed cells around the costmap's cells. So steps to a neighbor need no check of
limits.

Source: ros-planning/navigation, base_local_planner/src/map_grid.cpp.
Difference from ROS: the wave stops when all requested cells are reached. Their counts are the same.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.numerics import elementary
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.robot.costmap.costs import INSCRIBED, CostFrame, Costs

Steps = NDArray[np.int32]
"""Number of steps between cells that share a side. Negative if a cell is unreachable or was not requested."""

OPEN = -1
CLOSED = -2


class MapGrids(NamedTuple):
    """Work arrays for a costmap of size (rows, cols).

    Attributes:
        terrain: ((rows + 2) * (cols + 2),) OPEN or CLOSED.
        path: same size, steps from the path.
        goal: same size, steps from the end of the path.
        nose: same size, steps from the point where a robot's nose should end.
        queue: same size, cells to visit.
        wanted: same size, True for cells with a requested count. All are False between calls.
    """

    terrain: Steps
    path: Steps
    goal: Steps
    nose: Steps
    queue: Steps
    wanted: NDArray[np.bool_]


def map_grids(rows: int, cols: int) -> MapGrids:
    """Make the arrays for a costmap of this size."""
    size = (rows + 2) * (cols + 2)
    terrain, path, goal, nose, queue = (np.empty(size, dtype=np.int32) for _ in range(5))
    return MapGrids(terrain, path, goal, nose, queue, np.zeros(size, dtype=np.bool_))


@njit(cache=True)
def index_of(costs: Costs, frame: CostFrame, x: float, y: float) -> int:
    """Return the flat index of the cell at a map point, or -1 outside the costmap."""
    rows, cols = costs.shape
    row = math.floor((y - frame.y) / frame.resolution)
    col = math.floor((x - frame.x) / frame.resolution)
    if row < 0 or col < 0 or row >= rows or col >= cols:
        return -1
    index: int = (row + 1) * (cols + 2) + col + 1
    return index


@njit(cache=True)
def survey(costs: Costs, frame: CostFrame, x: float, y: float, own_radius: float, terrain: Steps) -> None:
    """Close the cells with costs of INSCRIBED and more, except cells under the robot itself.

    Args:
        costs: (rows, cols).
        frame: frame of the costs in the map.
        x: position of the robot in the map, with `y`.
        own_radius: radius around the robot in which cells are always open, meters.
        terrain: output, see `MapGrids`.
    """
    rows, cols = costs.shape
    terrain[:] = CLOSED
    for r in range(rows):
        base = (r + 1) * (cols + 2) + 1
        for c in range(cols):
            if costs[r, c] < INSCRIBED:
                terrain[base + c] = OPEN
    # Cells under the robot are always open. Otherwise a robot close to an obstacle would stand in closed cells, and no
    # path could begin there.
    own_row, own_col = (y - frame.y) / frame.resolution, (x - frame.x) / frame.resolution
    own = own_radius / frame.resolution
    for r in range(max(0, math.floor(own_row - own)), min(rows, math.ceil(own_row + own))):
        for c in range(max(0, math.floor(own_col - own)), min(cols, math.ceil(own_col + own))):
            if (r + 0.5 - own_row) ** 2 + (c + 0.5 - own_col) ** 2 <= own * own:
                terrain[(r + 1) * (cols + 2) + c + 1] = OPEN


@njit(cache=True)
def cells_along(costs: Costs, frame: CostFrame, path: FloatArray) -> Steps:
    """Return the flat indices of the cells along a line through (m, 2) map points.

    Cells outside the costmap are omitted. Successive cells are neighbors. A cell may occur several times.
    """
    room = 1
    for i in range(1, path.shape[0]):
        room += (
            math.ceil(elementary.hypot(path[i, 0] - path[i - 1, 0], path[i, 1] - path[i - 1, 1]) / frame.resolution) + 1
        )
    out = np.empty(room, dtype=np.int32)
    n = 0
    for i in range(path.shape[0]):
        before = max(0, i - 1)
        dx, dy = path[i, 0] - path[before, 0], path[i, 1] - path[before, 1]
        # Points may be more than a cell apart, so add the cells between them.
        pieces = max(1, math.ceil(elementary.hypot(dx, dy) / frame.resolution))
        for piece in range(1, pieces + 1):
            share = piece / pieces
            index = index_of(costs, frame, path[before, 0] + share * dx, path[before, 1] + share * dy)
            if index >= 0:
                out[n] = index
                n += 1
    return out[:n]


@njit(cache=True)
def spread(grid: MapGrids, cols: int, seeds: Steps, queried: Steps, steps: Steps) -> None:
    """Count the steps from the nearest seed, by breadth-first search.

    Args:
        grid: work arrays, after a call of `survey`.
        cols: columns of the costmap.
        seeds: flat indices.
        queried: flat indices of the cells with requested counts. Negative indices are ignored. If empty, all cells
            are counted.
        steps: array of the grid for the output.
    """
    for cell in range(steps.size):
        steps[cell] = grid.terrain[cell]
    wanted, queue = grid.wanted, grid.queue
    left = 0
    for i in range(queried.shape[0]):
        cell = queried[i]
        if cell >= 0 and not wanted[cell] and steps[cell] == OPEN:
            wanted[cell] = True
            left += 1
    if queried.shape[0] == 0:
        left = steps.shape[0]
    end = 0
    for i in range(seeds.shape[0]):
        cell = seeds[i]
        if steps[cell] < 0:
            steps[cell] = 0
            queue[end] = cell
            end += 1
            if wanted[cell]:
                left -= 1
    begin = 0
    while begin < end and left > 0:
        # The search is breadth-first, so each count is final when it is set. It stops once no requested cell is left.
        cell = queue[begin]
        begin += 1
        following = steps[cell] + 1
        for side in (cell - 1, cell + 1, cell - cols - 2, cell + cols + 2):
            if steps[side] == OPEN:
                steps[side] = following
                queue[end] = side
                end += 1
                if wanted[side]:
                    left -= 1
    for i in range(queried.shape[0]):
        if queried[i] >= 0:
            wanted[queried[i]] = False
