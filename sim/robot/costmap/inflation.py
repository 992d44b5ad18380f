"""The inflation layer: costs that fall with the distance from the nearest obstacle.

The squared distance of a cell to the nearest lethal cell can be computed in two steps. First, each column is swept once
up and once down. This gives, for each cell, the squared steps to the nearest lethal cell in its own column. Second, in
each row, the squared steps to another column are added to that column's value. The minimum of the sums, over all
columns within reach, is the squared distance.

Source: ros-planning/navigation, costmap_2d/plugins/inflation_layer.cpp and include/costmap_2d/inflation_layer.h;
Felzenszwalb, Huttenlocher, Distance Transforms of Sampled Functions (2012), for columns first and then rows.
Difference from ROS: distances are exact, from cell center to cell center. ROS propagates the nearest obstacle from cell
to cell, and sometimes misses a nearer obstacle.
"""

import math

import numpy as np
from numpy.typing import NDArray

from sim.numerics import elementary
from sim.numerics.kernels import njit
from sim.parameters import InflationParameters
from sim.robot.costmap.costs import FREE, INSCRIBED, LETHAL, UNKNOWN, Costs, Window

FAR = np.float32(1e9)
"""Squared distance, in cells, if no obstacle exists."""


@njit(cache=True)
def cost_at(distance: float, inscribed_radius: float, cost_scaling_factor: float) -> int:
    """Return the cost at a distance: LETHAL at 0, INSCRIBED within the inscribed radius, decreasing beyond it.

    Args:
        distance: distance from the nearest obstacle, meters, at least 0.
        inscribed_radius: inscribed radius of the robot's padded footprint, meters.
        cost_scaling_factor: decay rate of the cost, 1/m.
    """
    if distance == 0.0:
        return LETHAL
    if distance <= inscribed_radius:
        return INSCRIBED
    return int((INSCRIBED - 1) * elementary.exp(-cost_scaling_factor * (distance - inscribed_radius)))


@njit(cache=True)
def _columns_away(costs: Costs, row: int, row_end: int, left: int, right: int, reach: int) -> NDArray[np.float32]:
    """Return (row_end - row, right - left) squared distances of cells to the nearest lethal cell in their columns."""
    away = np.empty((row_end - row, right - left), np.float32)
    last = np.full(right - left, np.float32(1e4))
    # Number of rows since the last lethal cell. It is 1e4 if there is none, because its square is beyond any reach.
    for r in range(max(0, row - reach), row_end):
        line = costs[r, left:right]
        for c in range(right - left):
            last[c] = np.float32(0) if line[c] == LETHAL else last[c] + np.float32(1)
        if r >= row:
            for c in range(right - left):
                away[r - row, c] = last[c]
    last[:] = np.float32(1e4)
    for r in range(min(costs.shape[0], row_end + reach) - 1, row - 1, -1):
        line = costs[r, left:right]
        for c in range(right - left):
            last[c] = np.float32(0) if line[c] == LETHAL else last[c] + np.float32(1)
        if r < row_end:
            nearest = away[r - row]
            for c in range(right - left):
                least = last[c] if last[c] < nearest[c] else nearest[c]
                nearest[c] = least * least
    return away


@njit(cache=True)
def _inflate(
    costs: Costs, table: Costs, inflate_unknown: bool, row: int, col: int, row_end: int, col_end: int
) -> None:  # fmt: skip
    """Raise the cost of every cell of a window according to its distance to the nearest lethal cell.

    Args:
        costs: (rows, cols).
        table: (k * k + 1,) cost for each squared distance in cells, where k is the reach.
        inflate_unknown: True if unknown cells accept any cost, not only the cost within the inscribed radius.
        row: first row of the window, with `col`, `row_end` and `col_end`. The window is within `costs`.
    """
    reach = int(math.sqrt(table.shape[0] - 1))
    farthest = np.float32(table.shape[0])
    left, right = max(0, col - reach), min(costs.shape[1], col_end + reach)
    away = _columns_away(costs, row, row_end, left, right, reach)
    width = col_end - col
    line = np.full(width + 2 * reach, FAR)
    best = np.empty(width, np.float32)
    for r in range(row, row_end):
        for c in range(left, right):
            line[c - (col - reach)] = away[r - row, c - left]
        if line.min() >= farthest:
            # No lethal cell is within reach of any column. In open space, this is so for most rows.
            continue
        for c in range(width):
            best[c] = line[reach + c]
        for step in range(1, reach + 1):
            # Steps are in the outer loop and cells in the inner loops. The inner loops run along the row without
            # branches, so the compiler can vectorize them.
            squared = np.float32(step * step)
            before, behind = line[reach - step : reach - step + width], line[reach + step : reach + step + width]
            for c in range(width):
                nearer = before[c] if before[c] < behind[c] else behind[c]
                nearer += squared
                best[c] = nearer if nearer < best[c] else best[c]
        target = costs[r, col:col_end]
        for c in range(width):
            if best[c] < farthest:
                cost = table[int(best[c])]
                old = target[c]
                if old == UNKNOWN:
                    if cost >= INSCRIBED or (inflate_unknown and cost > FREE):
                        target[c] = cost
                elif cost > old:
                    target[c] = cost


class InflationLayer:
    """Costs around every lethal cell. It is always the last layer.

    Args:
        parameters: parameters of costmap_2d.
        resolution: side of a cell, meters.
        inscribed_radius: inscribed radius of the padded footprint, meters.

    Attributes:
        reach: inflation radius, in cells.
    """

    def __init__(self, parameters: InflationParameters, resolution: float, inscribed_radius: float) -> None:
        # The reach is rounded up to whole cells, so the last cell may be a little farther away than the radius.
        self.reach = math.ceil(parameters.inflation_radius / resolution)
        self._inflate_unknown = parameters.inflate_unknown
        distances = np.sqrt(np.arange(self.reach * self.reach + 1)) * resolution
        self._table: Costs = np.array(
            [cost_at(distance, inscribed_radius, parameters.cost_scaling_factor) for distance in distances],
            dtype=np.uint8,
        )

    def bounds(self) -> tuple[Window, ...]:
        """Return no windows, because this layer changes only where previous layers change."""
        return ()

    def extents(self) -> tuple[Window, ...]:
        """Return no windows, because this layer changes only where previous layers change."""
        return ()

    def write(self, costs: Costs, origin: tuple[int, int], window: Window) -> None:
        """Raise the costs around lethal cells in and near the window. Unknown cells usually stay unknown."""
        if self.reach == 0:
            return
        row, col = origin
        _inflate(
            costs,
            self._table,
            self._inflate_unknown,
            window.row - row,
            window.col - col,
            window.row_end - row,
            window.col_end - col,
        )
