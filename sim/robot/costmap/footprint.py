"""The robot's footprint: its padding, its radii, and the costs under its outline.

Source: ros-planning/navigation, costmap_2d/src/footprint.cpp and base_local_planner/src/costmap_model.cpp.
"""

import math

import numpy as np

from sim.common.geometry import FloatArray
from sim.common.kernels import njit
from sim.robot.costmap.costs import LETHAL, CostFrame, Costs

COLLIDES = -1.0
"""Cost of a footprint whose outline crosses an obstacle or unknown space, or leaves the costmap."""


def of_radius(radius: float) -> FloatArray:
    """(16, 2) corners of the polygon that costmap_2d takes for a round robot."""
    angles = np.arange(16) * 2 * math.pi / 16
    corners: FloatArray = radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return corners


def pad(footprint: FloatArray, padding: float) -> FloatArray:
    """Move every corner outward by `padding` metres along each axis; a coordinate that is 0 stays.

    Args:
        footprint: (n, 2) corners in the base frame, metres.

    Returns:
        (n, 2).
    """
    padded: FloatArray = footprint + padding * np.sign(footprint)
    return padded


def radii(footprint: FloatArray) -> tuple[float, float]:
    """Inscribed and circumscribed radius about the base frame's origin, metres.

    Args:
        footprint: (n, 2) corners in order; the last is joined to the first.
    """
    following = np.roll(footprint, -1, axis=0)
    edges = following - footprint
    lengths = np.maximum((edges**2).sum(axis=1), 1e-12)
    along = np.clip(-(footprint * edges).sum(axis=1) / lengths, 0.0, 1.0)
    nearest = footprint + along[:, np.newaxis] * edges
    return float(np.hypot(*nearest.T).min()), float(circumscribed_radius(footprint))


@njit(cache=True)
def in_cells(footprint: FloatArray, frame: CostFrame, x: float, y: float, theta: float) -> FloatArray:
    """(n, 2) column and row, in cells, of a footprint's (n, 2) corners when its base is at (x, y, theta) in the map."""
    c, s = math.cos(theta), math.sin(theta)
    corners = np.empty_like(footprint)
    for i in range(footprint.shape[0]):
        corners[i, 0] = (x + c * footprint[i, 0] - s * footprint[i, 1] - frame.x) / frame.resolution
        corners[i, 1] = (y + s * footprint[i, 0] + c * footprint[i, 1] - frame.y) / frame.resolution
    return corners


@njit(cache=True)
def circumscribed_radius(footprint: FloatArray) -> float:
    """Metres from the base frame's origin to the farthest of (n, 2) corners."""
    farthest = 0.0
    for i in range(footprint.shape[0]):
        farthest = max(farthest, math.hypot(footprint[i, 0], footprint[i, 1]))
    return farthest


def outline(footprint: FloatArray, spacing: float) -> FloatArray:
    """(m, 2) points along the outline, corners included, no farther apart than `spacing` metres."""
    points: list[FloatArray] = []
    for start, end in zip(footprint, np.roll(footprint, -1, axis=0), strict=True):
        steps = max(1, math.ceil(float(np.hypot(*(end - start))) / spacing))
        points.extend(start + (end - start) * (step / steps) for step in range(steps))
    return np.array(points)


@njit(cache=True)
def _line_cost(costs: Costs, row: int, col: int, row_end: int, col_end: int) -> float:
    """Greatest cost along a line of cells (Bresenham), or COLLIDES."""
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
    """Greatest cost under the outline of a footprint, or COLLIDES.

    Args:
        costs: (rows, cols).
        frame: their place in the map.
        footprint: (n, 2) corners in the base frame.
        x: place of the base in the map, metres; so y, and theta in radians.

    Returns:
        FREE to INSCRIBED, or COLLIDES.
    """
    c, s = math.cos(theta), math.sin(theta)
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
