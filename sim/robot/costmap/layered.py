"""Costmap made of layers, updated in two passes over the changed parts.

First every layer reports the windows that it has changed (the bounds). Then every layer in turn writes its costs into
these windows. So an update of a costmap without changes takes no time, even if the costmap is large.

Source: ros-planning/navigation, costmap_2d/src/layered_costmap.cpp.
Difference from ROS: separate changes are written separately, while ROS writes one rectangle around all of them. For ten
robots in different places of a map, ten small windows are written.
"""

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sim.common.grid import OccupancyGrid
from sim.numerics.kernels import njit
from sim.robot.costmap.costs import FREE, UNKNOWN, CostFrame, Costs, Window


class CostmapLayer(Protocol):
    """A source of costs. Windows are in cells of the static map, and may extend beyond the map.

    Attributes:
        reach: distance in cells. Within this distance of a change in another layer, the costs of this layer may change.
    """

    reach: int

    def bounds(self) -> tuple[Window, ...]:
        """Return the windows in which this layer's costs have changed since the last call."""

    def extents(self) -> tuple[Window, ...]:
        """Return windows that contain all costs of this layer that differ from the costs of a new layer."""

    def write(self, costs: Costs, origin: tuple[int, int], window: Window) -> None:
        """Write this layer's costs into a window. Writing twice has the same result as writing once.

        Args:
            costs: (rows, cols) of the whole costmap, with the costs of previous layers.
            origin: row and column of the costmap's cell (0, 0) in the static map.
            window: window in cells of the static map, within the costmap.
        """


@njit(cache=True)
def _cells(window: NDArray[np.int64], reach: int) -> int:
    """Return the number of cells in a window with a rim of `reach` cells around it."""
    return int((window[2] - window[0] + 2 * reach) * (window[3] - window[1] + 2 * reach))


@njit(cache=True)
def _apart(changes: NDArray[np.int64], reach: int, bounds: NDArray[np.int64]) -> NDArray[np.int64]:
    """Grow changed windows by the reach, and merge windows if one large window is cheaper to write.

    Args:
        changes: (n, 4) row, col, row_end and col_end of each window.
        reach: distance in cells within which a change has an effect.
        bounds: (4,) window to which all windows are clipped.

    Returns:
        (m, 4) windows, none of them empty.
    """
    apart = np.empty_like(changes)
    count = 0
    for i in range(changes.shape[0]):
        if changes[i, 2] <= changes[i, 0] or changes[i, 3] <= changes[i, 1]:
            continue
        window = np.empty(4, np.int64)
        for side in range(2):
            window[side] = max(changes[i, side] - reach, bounds[side])
            window[side + 2] = min(changes[i, side + 2] + reach, bounds[side + 2])
        if window[2] <= window[0] or window[3] <= window[1]:
            continue
        k = 0
        while k < count:
            union = np.empty(4, np.int64)
            for side in range(2):
                union[side] = min(window[side], apart[k, side])
                union[side + 2] = max(window[side + 2], apart[k, side + 2])
            # Writing a window also reads the costs around it, within the reach. So the rim counts as work.
            if _cells(union, reach) <= _cells(window, reach) + _cells(apart[k], reach):
                count -= 1
                for later in range(k, count):
                    for side in range(4):
                        apart[later, side] = apart[later + 1, side]
                # It may now be cheaper to merge the larger window with earlier ones, so start again.
                window, k = union, 0
            else:
                k += 1
        for side in range(4):
            apart[count, side] = window[side]
        count += 1
    return apart[:count]


class LayeredCostmap:
    """Costs on the cells of a map, or on a rectangle of its cells that moves with the robot.

    Args:
        grid: the map. Its origin must not be rotated.
        layers: layers in the order in which they write.
        shape: rows and columns of a rolling window. If None, the costmap covers the map.
        track_unknown_space: True if cells that no layer writes are unknown, False if they are free.
        ready: (rows, cols) costs of new layers, for a costmap that covers the map. This array is not changed. With it,
            updates write only later changes. If None, the first update writes all costs.
    """

    def __init__(
        self,
        grid: OccupancyGrid,
        layers: Sequence[CostmapLayer],
        shape: tuple[int, int] | None = None,
        track_unknown_space: bool = False,
        ready: Costs | None = None,
    ) -> None:
        self._corner = (grid.origin.x, grid.origin.y)
        self._resolution = grid.resolution
        self._layers = tuple(layers)
        self._rolling = shape is not None
        self._reach = max((layer.reach for layer in self._layers), default=0)
        self._default = UNKNOWN if track_unknown_space else FREE
        self.origin = (0, 0)
        self._shape = shape or grid.cells.shape
        self._ready = ready
        self._all_due = ready is None
        self._costs: Costs | None = None

    @property
    def costs(self) -> Costs:
        """(rows, cols) costs of the last update. The array is allocated at the first use."""
        if self._costs is None:
            ready = self._ready
            self._costs = np.full(self._shape, self._default, np.uint8) if ready is None else ready.copy()
        return self._costs

    @property
    def frame(self) -> CostFrame:
        """Frame of the costmap in the map."""
        row, col = self.origin
        x, y = self._corner
        return CostFrame(x + col * self._resolution, y + row * self._resolution, self._resolution)

    @property
    def window(self) -> Window:
        """Cells of the static map that the costmap covers."""
        row, col = self.origin
        return Window(row, col, row + self._shape[0], col + self._shape[1])

    def roll(self, x: float, y: float) -> None:
        """Move a rolling window by whole cells until its middle is at this map point. `update` writes the costs."""
        if self._rolling:
            rows, cols = self._shape
            self.origin = (
                round((y - self._corner[1]) / self._resolution) - rows // 2,
                round((x - self._corner[0]) / self._resolution) - cols // 2,
            )

    def update(self) -> tuple[Window, ...]:
        """Update the costs: all costs of a rolling costmap, otherwise only the changed parts.

        Returns:
            The windows that were written, in cells of the static map. They may overlap.
        """
        changes = [window for layer in self._layers for window in layer.bounds()]
        windows = (self.window,) if self._rolling or self._all_due else self._around(changes)
        self._all_due = False
        self.write(windows)
        return windows

    def compose(self) -> None:
        """Write the costs of all layers into a costmap that contains only the `ready` costs so far."""
        changes = [window for layer in self._layers for window in layer.extents()]
        self.write((self.window,) if self._rolling or self._all_due else self._around(changes))
        self._all_due = False

    def _around(self, changes: Sequence[Window]) -> tuple[Window, ...]:
        """Return the windows that must be written again after changes in these windows."""
        apart = _apart(np.array(changes, np.int64).reshape(-1, 4), self._reach, np.array(self.window))
        return tuple(Window(*window) for window in apart.tolist())

    def write(self, windows: Sequence[Window]) -> None:
        """Write the costs of these windows again. They must be within the costmap. Bounds of layers are not used."""
        for window in windows:
            window.of(self.costs, self.origin)[:] = self._default
        # Layers are in the outer loop: a layer reads costs around a window, so previous layers must have written all
        # windows before.
        for layer in self._layers:
            for window in windows:
                layer.write(self.costs, self.origin, window)
