"""The layer of prudence: costs that fall with the distance from the nearest obstacle.

Source: ros-planning/navigation, costmap_2d/plugins/inflation_layer.cpp.
Differs: distances are exact, from cell centre to cell centre, where ROS hands the nearest obstacle from cell to cell
and now and then misses a nearer one.
"""

import math

import numpy as np
from numba import njit

from sim.costmap.costs import NOTHING, Costs, Window, cost_at
from sim.parameters import InflationParameters


@njit(cache=True)
def _inflate(
    costs: Costs, kernel: Costs, row: int, col: int, row_end: int, col_end: int, walls: Costs, row_in_map: int,
    col_in_map: int,
) -> None:  # fmt: skip
    """Raise every cell of a window to the cost that each lethal cell near it asks for, walls of the map excepted.

    Args:
        costs: (rows, cols).
        kernel: (2 k + 1, 2 k + 1) what a lethal cell in the middle asks for.
        row: where the window begins; so col, row_end and col_end.
        walls: (rows of the map, columns of the map) LETHAL where costs are inflated already.
        row_in_map: of the cell (0, 0) of `costs`; so col_in_map.
    """
    rows, cols = costs.shape
    radius = kernel.shape[0] // 2
    for i in range(max(0, row - radius), min(rows, row_end + radius)):
        for j in range(max(0, col - radius), min(cols, col_end + radius)):
            if costs[i, j] != 254:
                continue
            at_row, at_col = i + row_in_map, j + col_in_map
            if 0 <= at_row < walls.shape[0] and 0 <= at_col < walls.shape[1] and walls[at_row, at_col] == 254:
                continue
            # Cells amid obstacles add nothing: one at the rim is nearer to every free cell.
            if (
                0 < i < rows - 1
                and 0 < j < cols - 1
                and costs[i - 1, j] == 254
                and costs[i + 1, j] == 254
                and costs[i, j - 1] == 254
                and costs[i, j + 1] == 254
            ):
                continue
            top, bottom = max(row, i - radius), min(row_end, i + radius + 1)
            left, right = max(col, j - radius), min(col_end, j + radius + 1)
            for r in range(top, bottom):
                line = kernel[r - i + radius]
                target = costs[r]
                for c in range(left, right):
                    cost = line[c - j + radius]
                    old = target[c]
                    if old == 255:
                        if cost >= 253:
                            target[c] = cost
                    elif cost > old:
                        target[c] = cost


class InflationLayer:
    """Costs around every lethal cell; always the last layer.

    Args:
        parameters: costmap_2d's.
        resolution: side of a cell, metres.
        inscribed_radius: of the padded footprint, metres.
        walls: (rows, cols) costs of the map that are inflated already, where the layers before this one write these.
    """

    def __init__(
        self, parameters: InflationParameters, resolution: float, inscribed_radius: float, walls: Costs | None = None
    ) -> None:
        self._radius = math.floor(parameters.inflation_radius / resolution + 1e-9)
        side = 2 * self._radius + 1
        self._kernel: Costs = np.zeros((side, side), dtype=np.uint8)
        for i in range(side):
            for j in range(side):
                distance = math.hypot(i - self._radius, j - self._radius) * resolution
                if distance <= parameters.inflation_radius + 1e-9:
                    self._kernel[i, j] = cost_at(distance, inscribed_radius, parameters.cost_scaling_factor)
        # The lethal cells themselves stay the other layers' business.
        self._kernel[self._radius, self._radius] = 0
        self._walls: Costs = np.empty((0, 0), dtype=np.uint8) if walls is None else walls

    def inflated(self, costs: Costs) -> Costs:
        """(rows, cols) costs of a whole map, inflated."""
        inflated = costs.copy()
        self.write(inflated, (0, 0), Window(0, 0, *costs.shape))
        return inflated

    def bounds(self) -> Window:
        """Nothing of its own."""
        return NOTHING

    def reach(self) -> int:
        """The inflation radius, in cells."""
        return self._radius

    def write(self, costs: Costs, origin: tuple[int, int], window: Window) -> None:
        """Inflate the lethal cells in and around the window; unknown cells change only within the inscribed radius."""
        row, col = origin
        _inflate(
            costs,
            self._kernel,
            window.row - row,
            window.col - col,
            window.row_end - row,
            window.col_end - col,
            self._walls,
            row,
            col,
        )
