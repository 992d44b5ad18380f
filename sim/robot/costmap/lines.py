"""Cells along lines and inside polygons, by the rules of costmap_2d.

Source: ros-planning/navigation, costmap_2d/include/costmap_2d/costmap_2d.h (raytraceLine) and src/costmap_2d.cpp
(convexFillCells).
"""

import math

import numpy as np
from numpy.typing import NDArray

from sim.numerics import elementary
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.robot.costmap.costs import FREE, Costs


@njit(cache=True)
def line(row: int, col: int, row_end: int, col_end: int, longest: int) -> NDArray[np.int64]:
    """Return (n, 2) rows and columns from one cell toward another, both included (Bresenham).

    Args:
        row: row of the first cell; `col` is its column.
        row_end: row of the last cell; `col_end` is its column.
        longest: maximum length of the line, cells. A longer line is cut.
    """
    dr, dc = abs(row_end - row), abs(col_end - col)
    step_r = 1 if row_end > row else -1
    step_c = 1 if col_end > col else -1
    distance = elementary.hypot(dr, dc)
    scale = 1.0 if distance == 0.0 else min(1.0, longest / distance)
    along, across = max(dr, dc), min(dr, dc)
    steps = int(scale * along)
    cells = np.empty((steps + 1, 2), np.int64)
    # The error counts steps across in units of 1 / along. It starts at one half, which rounds to the nearest cell.
    error = along // 2
    for i in range(steps):
        cells[i, 0], cells[i, 1] = row, col
        error += across
        sideways = error >= along
        if sideways:
            error -= along
        if dc >= dr or sideways:
            col += step_c
        if dc < dr or sideways:
            row += step_r
    cells[steps, 0], cells[steps, 1] = row, col
    return cells


@njit(cache=True)
def clear_line(
    costs: Costs, row: int, col: int, row_end: int, col_end: int, longest: int, changed: NDArray[np.int64]
) -> None:  # fmt: skip
    """Write FREE to the cells of `line`, without making an array of them. All cells must be on the costmap.

    Args:
        costs: (rows, cols), contiguous.
        row: see `line`, also for the other arguments.
        changed: (4,) window, which grows by the cells that change.
    """
    width = costs.shape[1]
    # One index instead of two makes this loop faster. It takes most of the time for clearing by scans.
    flat = costs.reshape(costs.size)
    dr, dc = abs(row_end - row), abs(col_end - col)
    step_r = width if row_end > row else -width
    step_c = 1 if col_end > col else -1
    distance = elementary.hypot(dr, dc)
    scale = 1.0 if distance == 0.0 else min(1.0, longest / distance)
    along, across = max(dr, dc), min(dr, dc)
    onward, sideways = (step_c, step_r) if dc >= dr else (step_r, step_c)
    error = along // 2
    cell = row * width + col
    for _ in range(int(scale * along) + 1):
        if flat[cell] != FREE:
            flat[cell] = FREE
            include(changed, cell // width, cell % width)
        cell += onward
        error += across
        if error >= along:
            error -= along
            cell += sideways


@njit(cache=True)
def include(changed: NDArray[np.int64], row: int, col: int) -> None:
    """Grow a (4,) window (row, col, row_end, col_end) by a cell."""
    changed[0], changed[1] = min(changed[0], row), min(changed[1], col)
    changed[2], changed[3] = max(changed[2], row + 1), max(changed[3], col + 1)


@njit(cache=True)
def fill_convex(costs: Costs, corners: FloatArray, cost: int) -> bool:
    """Give this cost to all cells of a convex polygon, including its outline. Cells outside the costmap are ignored.

    Args:
        costs: (rows, cols).
        corners: (n, 2) column and row, in cells, n at least 3.
        cost: FREE to UNKNOWN.

    Returns:
        True if one of these cells had another cost.
    """
    rows, cols = costs.shape
    changes = False
    first = math.floor(corners[:, 0].min())
    # Lowest and highest row of the outline in each column. In a convex polygon, all rows between them are inside.
    lows = np.full(math.floor(corners[:, 0].max()) - first + 1, np.iinfo(np.int64).max)
    highs = np.full(lows.shape[0], np.iinfo(np.int64).min)
    n = corners.shape[0]
    for i in range(n):
        k = (i + 1) % n
        side = line(
            math.floor(corners[i, 1]),
            math.floor(corners[i, 0]),
            math.floor(corners[k, 1]),
            math.floor(corners[k, 0]),
            np.iinfo(np.int64).max,
        )
        for j in range(side.shape[0]):
            c = side[j, 1] - first
            lows[c], highs[c] = min(lows[c], side[j, 0]), max(highs[c], side[j, 0])
    for c in range(max(first, 0), min(first + lows.shape[0], cols)):
        for r in range(max(lows[c - first], 0), min(highs[c - first] + 1, rows)):
            if costs[r, c] != cost:
                costs[r, c] = cost
                changes = True
    return changes
