"""How far each cell of the local costmap is from the path, or from a point of it, along free cells.

Source: ros-planning/navigation, base_local_planner/src/map_grid.cpp.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim.costmap.costs import CostFrame, Costs
from sim.geometry import FloatArray

Steps = NDArray[np.int32]
"""(rows, cols): steps to a side neighbour; negative where there is no way."""


@njit(cache=True)
def spread(
    costs: Costs, frame: CostFrame, seeds: FloatArray, x: float, y: float, own_radius: float, steps: Steps,
    queue: Steps,
) -> None:  # fmt: skip
    """Count the steps from the nearest seed.

    Args:
        costs: (rows, cols); cells of cost 253 and more are not entered, except those under the robot itself.
        frame: where they lie.
        seeds: (m, 2) map points; those outside are left out.
        x: of the robot; so y.
        own_radius: metres around the robot that are its own.
        steps: (rows, cols), overwritten with the result.
        queue: (rows * cols,) room to work in.
    """
    rows, cols = costs.shape
    steps[:] = -1
    end = 0
    for i in range(seeds.shape[0]):
        row = math.floor((seeds[i, 1] - frame.y) / frame.resolution)
        col = math.floor((seeds[i, 0] - frame.x) / frame.resolution)
        if 0 <= row < rows and 0 <= col < cols and steps[row, col] < 0:
            steps[row, col] = 0
            queue[end] = row * cols + col
            end += 1
    own_row, own_col = (y - frame.y) / frame.resolution, (x - frame.x) / frame.resolution
    own = (own_radius / frame.resolution) ** 2
    begin = 0
    while begin < end:
        cell = queue[begin]
        begin += 1
        row, col = cell // cols, cell % cols
        following = steps[row, col] + 1
        for dr, dc in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            r, c = row + dr, col + dc
            if r < 0 or c < 0 or r >= rows or c >= cols or steps[r, c] >= 0:
                continue
            if costs[r, c] >= 253 and (r + 0.5 - own_row) ** 2 + (c + 0.5 - own_col) ** 2 > own:
                continue
            steps[r, c] = following
            queue[end] = r * cols + c
            end += 1
