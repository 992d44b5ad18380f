"""Layer of the walls in the given map.

Source: ros-planning/navigation, costmap_2d/plugins/static_layer.cpp.
"""

from functools import lru_cache

import numpy as np

from sim.common.grid import OccupancyGrid
from sim.parameters import StaticParameters
from sim.robot.costmap.costs import FREE, LETHAL, UNKNOWN, Costs, Window


def interpretation(parameters: StaticParameters) -> Costs:
    """Return the (256,) costs of all values of an occupancy grid, as unsigned bytes as in ROS: -1 is 255."""
    values = np.arange(256)
    lethal = parameters.lethal_cost_threshold
    scaled = values / max(lethal, 1) * LETHAL
    costs = np.where(values >= lethal, LETHAL, FREE if parameters.trinary_costmap else scaled).astype(np.uint8)
    costs[parameters.unknown_cost_value % 256] = UNKNOWN if parameters.track_unknown_space else FREE
    return costs


@lru_cache(maxsize=8)
def _costs_of(parameters: StaticParameters, grid: OccupancyGrid) -> Costs:
    """Return (rows, cols) costs of the map. They are read-only, because all robots on a map share them."""
    costs: Costs = interpretation(parameters)[grid.cells.view(np.uint8)]
    costs.setflags(write=False)
    return costs


class StaticLayer:
    """Layer of a map's walls. It writes nothing outside the map.

    Args:
        parameters: parameters of costmap_2d.
        grid: the map.
    """

    reach = 0

    def __init__(self, parameters: StaticParameters, grid: OccupancyGrid) -> None:
        self._costs = _costs_of(parameters, grid)
        self._use_maximum = parameters.use_maximum

    def bounds(self) -> tuple[Window, ...]:
        """Return no windows, because a map never changes."""
        return ()

    def extents(self) -> tuple[Window, ...]:
        """Return no windows, because a map never changes."""
        return ()

    def write(self, costs: Costs, origin: tuple[int, int], window: Window) -> None:
        """Write the map's costs within the map. With use_maximum, they only raise the costs of previous layers."""
        known = window.clipped(Window(0, 0, *self._costs.shape))
        if known.empty:
            return
        source = known.of(self._costs)
        target = known.of(costs, origin)
        if self._use_maximum:
            raised = (source != UNKNOWN) & ((target == UNKNOWN) | (source > target))
            target[raised] = source[raised]
        else:
            target[:] = source
