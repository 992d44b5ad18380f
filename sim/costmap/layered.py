"""A costmap made of layers, brought up to date in two passes over what changed.

First every layer says where it has changed (the bounds), then every layer writes its costs there, in order. So a
costmap in which nothing moves costs nothing, however large.

Source: ros-planning/navigation, costmap_2d/src/layered_costmap.cpp.
"""

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from sim.costmap.costs import FREE, NOTHING, CostFrame, Costs, Window
from sim.grid import OccupancyGrid


class Layer(Protocol):
    """One kind of knowledge about costs. Windows are in cells of the static map, also outside of it."""

    def bounds(self) -> Window:
        """Where its costs differ from the last time it was asked."""

    def reach(self) -> int:
        """How many cells beyond a change its costs may change too."""

    def write(self, costs: Costs, origin: tuple[int, int], window: Window) -> None:
        """Write its costs into a window.

        Args:
            costs: (rows, cols) of the whole costmap, with what the layers before this one wrote.
            origin: row and column of the costmap's cell (0, 0) in the static map.
            window: in cells of the static map, within the costmap.
        """


class LayeredCostmap:
    """Costs on the cells of a map, or on a square of them that moves along with the robot.

    A rolling one is written anew at every update and never asks layers for bounds, so it may share them with another.

    Args:
        grid: the map whose cells are used; its origin must not be turned.
        layers: in the order in which they write.
        size: cells on each side of a rolling window; None covers the map.
    """

    def __init__(self, grid: OccupancyGrid, layers: Sequence[Layer], size: int | None = None) -> None:
        self._corner = (grid.origin.x, grid.origin.y)
        self._resolution = grid.resolution
        self._layers = tuple(layers)
        self._rolling = size is not None
        self._reach = max((layer.reach() for layer in self._layers), default=0)
        self.origin = (0, 0)
        rows, cols = (grid.rows, grid.cols) if size is None else (size, size)
        self.costs: Costs = np.full((rows, cols), FREE, dtype=np.uint8)

    @property
    def frame(self) -> CostFrame:
        """Where the costmap lies."""
        row, col = self.origin
        x, y = self._corner
        return CostFrame(x + col * self._resolution, y + row * self._resolution, self._resolution)

    def update(self, x: float, y: float) -> Window:
        """Bring the costs up to date for a robot at this map point; a rolling window is centred there.

        Returns:
            The cells that were written, in cells of the static map.
        """
        rows, cols = self.costs.shape
        if self._rolling:
            self.origin = (
                round((y - self._corner[1]) / self._resolution) - rows // 2,
                round((x - self._corner[0]) / self._resolution) - cols // 2,
            )
        row, col = self.origin
        whole = Window(row, col, row + rows, col + cols)
        window = whole if self._rolling else self._changed().clipped(whole)
        if window.empty:
            return NOTHING
        self.costs[window.row - row : window.row_end - row, window.col - col : window.col_end - col] = FREE
        for layer in self._layers:
            layer.write(self.costs, self.origin, window)
        return window

    def _changed(self) -> Window:
        changed = NOTHING
        for layer in self._layers:
            changed = changed.union(layer.bounds())
        return changed.grown(self._reach)
