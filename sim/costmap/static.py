"""The layer of the walls: the map as it was given.

Source: ros-planning/navigation, costmap_2d/plugins/static_layer.cpp (trinary, track_unknown_space).
"""

import numpy as np

from sim.costmap.costs import FREE, LETHAL, NOTHING, UNKNOWN, Costs, Window
from sim.grid import OCCUPIED, OccupancyGrid
from sim.grid import UNKNOWN as UNKNOWN_CELL


def static_costs(grid: OccupancyGrid) -> Costs:
    """(rows, cols): occupied cells are lethal, unknown ones unknown, all else free."""
    costs: Costs = np.full(grid.cells.shape, FREE, dtype=np.uint8)
    costs[grid.cells == OCCUPIED] = LETHAL
    costs[grid.cells == UNKNOWN_CELL] = UNKNOWN
    return costs


class StaticLayer:
    """The walls of a map; outside of it all is unknown.

    Args:
        grid: the map.
        inflated: (rows, cols) its costs where they are inflated once and for all, so that only what moves need be
            inflated at every update. A rolling costmap then also knows of walls just beyond its rim.
    """

    def __init__(self, grid: OccupancyGrid, inflated: Costs | None = None) -> None:
        self._costs = static_costs(grid) if inflated is None else inflated
        self._pending = Window(0, 0, grid.rows, grid.cols)

    def bounds(self) -> Window:
        """The whole map once, then nothing."""
        changed, self._pending = self._pending, NOTHING
        return changed

    def reach(self) -> int:
        """None."""
        return 0

    def write(self, costs: Costs, origin: tuple[int, int], window: Window) -> None:
        """The map's costs where there is map, else unknown."""
        row, col = origin
        rows, cols = self._costs.shape
        known = window.clipped(Window(0, 0, rows, cols))
        if known != window:
            costs[window.row - row : window.row_end - row, window.col - col : window.col_end - col] = UNKNOWN
        if not known.empty:
            costs[known.row - row : known.row_end - row, known.col - col : known.col_end - col] = self._costs[
                known.row : known.row_end, known.col : known.col_end
            ]
