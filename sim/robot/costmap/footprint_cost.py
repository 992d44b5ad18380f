"""The robot's footprint on a costmap: corners, radius, and costs under the outline.

Source: ros-planning/navigation, costmap_2d/src/footprint.cpp and base_local_planner/src/costmap_model.cpp.
"""

import math

import numpy as np

from sim.numerics import elementary
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.robot.costmap.costs import LETHAL, CostFrame, Costs

COLLIDES = -1.0
"""Cost of a footprint whose outline crosses an obstacle or unknown space, or leaves the costmap."""


@njit(cache=True)
def in_cells(footprint: FloatArray, frame: CostFrame, x: float, y: float, theta: float) -> FloatArray:
    """Return (n, 2) columns and rows of a footprint's (n, 2) corners, with its base at (x, y, theta) in the map."""
    c, s = elementary.cos_sin(theta)
    corners = np.empty_like(footprint)
    for i in range(footprint.shape[0]):
        corners[i, 0] = (x + c * footprint[i, 0] - s * footprint[i, 1] - frame.x) / frame.resolution
        corners[i, 1] = (y + s * footprint[i, 0] + c * footprint[i, 1] - frame.y) / frame.resolution
    return corners


@njit(cache=True)
def circumscribed_radius(footprint: FloatArray) -> float:
    """Return the distance from the base frame's origin to the farthest of (n, 2) corners, meters."""
    farthest = 0.0
    for i in range(footprint.shape[0]):
        farthest = max(farthest, elementary.hypot(footprint[i, 0], footprint[i, 1]))
    return farthest


@njit(cache=True)
def _line_cost(costs: Costs, row: int, col: int, row_end: int, col_end: int) -> float:
    """Return the maximum cost along a line of cells (Bresenham), or COLLIDES."""
    rows, cols = costs.shape
    dr, dc = abs(row_end - row), abs(col_end - col)
    step_r = 1 if row_end >= row else -1
    step_c = 1 if col_end >= col else -1
    error = dc - dr
    worst = 0.0
    while True:
        if row < 0 or col < 0 or row >= rows or col >= cols:
            return COLLIDES
        cost = costs[row, col]
        if cost >= LETHAL:
            return COLLIDES
        worst = max(worst, float(cost))
        if row == row_end and col == col_end:
            return worst
        doubled = 2 * error
        if doubled > -dr:
            error -= dr
            col += step_c
        if doubled < dc:
            error += dc
            row += step_r


@njit(cache=True)
def footprint_cost(costs: Costs, frame: CostFrame, footprint: FloatArray, x: float, y: float, theta: float) -> float:
    """Return the maximum cost under the outline of a footprint, or COLLIDES.

    Args:
        costs: (rows, cols).
        frame: frame of the costs in the map.
        footprint: (n, 2) corners in the base frame.
        x: pose of the base in the map, with `y` and `theta`; meters, radians.

    Returns:
        A cost from FREE to INSCRIBED, or COLLIDES.
    """
    # The corners are computed one by one, without the array of `in_cells`, because this runs for each pose of each
    # trajectory.
    c, s = elementary.cos_sin(theta)
    n = footprint.shape[0]
    last_x, last_y = footprint[n - 1, 0], footprint[n - 1, 1]
    row = math.floor((y + s * last_x + c * last_y - frame.y) / frame.resolution)
    col = math.floor((x + c * last_x - s * last_y - frame.x) / frame.resolution)
    worst = 0.0
    for i in range(n):
        fx, fy = footprint[i, 0], footprint[i, 1]
        next_row = math.floor((y + s * fx + c * fy - frame.y) / frame.resolution)
        next_col = math.floor((x + c * fx - s * fy - frame.x) / frame.resolution)
        cost = _line_cost(costs, row, col, next_row, next_col)
        if cost == COLLIDES:
            return COLLIDES
        worst = max(worst, cost)
        row, col = next_row, next_col
    return worst
