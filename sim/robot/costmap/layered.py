"""A costmap made of layers, brought up to date in two passes over what changed.

First every layer tells the windows that it has changed (the bounds), then every layer writes its costs there, in order.
So a costmap in which nothing moves takes no time, however large it is.

Source: ros-planning/navigation, costmap_2d/src/layered_costmap.cpp.
Differs: changes that lie apart stay apart, where ROS draws one rectangle around all of them; ten robots all over a map
are ten small windows.
"""

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sim.common.grid import OccupancyGrid
from sim.numerics.kernels import njit
from sim.robot.costmap.costs import FREE, UNKNOWN, CostFrame, Costs, Window


class CostmapLayer(Protocol):
    """One source of costs. Windows are in cells of the static map, also outside of it.

    Attributes:
        reach: cells beyond another layer's change within which its own costs may change too.
    """

    reach: int

    def bounds(self) -> tuple[Window, ...]:
        """Return the windows in which its costs differ from the last time it was asked."""

    def extents(self) -> tuple[Window, ...]:
        """Return windows outside of which its costs are what they were when it was new."""

    def write(self, costs: Costs, origin: tuple[int, int], window: Window) -> None:
        """Write its costs into a window; writing twice leaves the same as writing once.

        Args:
            costs: (rows, cols) of the whole costmap, with what the layers before this one wrote.
            origin: row and column of the costmap's cell (0, 0) in the static map.
            window: in cells of the static map, within the costmap.
        """


@njit(cache=True)
def _cells(window: NDArray[np.int64], reach: int) -> int:
    """Number of cells in a window with a rim of `reach` cells around it."""
    return int((window[2] - window[0] + 2 * reach) * (window[3] - window[1] + 2 * reach))


@njit(cache=True)
def _apart(changes: NDArray[np.int64], reach: int, bounds: NDArray[np.int64]) -> NDArray[np.int64]:
    """Grow changed windows by the reach, and join those that are cheaper to write as one.

    Args:
        changes: (n, 4) row, col, row_end, col_end of each.
        reach: cells by which a change reaches beyond itself.
        bounds: (4,) the window outside of which nothing counts.

    Returns:
        (m, 4), none empty.
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
            # Around every window the costs are read as far as they reach.
            if _cells(union, reach) <= _cells(window, reach) + _cells(apart[k], reach):
                count -= 1
                for later in range(k, count):
                    for side in range(4):
                        apart[later, side] = apart[later + 1, side]
                window, k = union, 0
            else:
                k += 1
        for side in range(4):
            apart[count, side] = window[side]
        count += 1
    return apart[:count]


class LayeredCostmap:
    """Costs on the cells of a map, or on a rectangle of them that moves along with the robot.

    Args:
        grid: the map whose cells are used; its origin must not be turned.
        layers: in the order in which they write.
        shape: rows and columns of a rolling window; None covers the map.
        track_unknown_space: True if cells that no layer writes are unknown; else they are free.
        ready: (rows, cols) costs that the layers wrote when they were new, of a costmap that covers the map: only what
            changes from then on is written. Left as they are. None: the first update writes all.
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
        """(rows, cols) as of the last update; room is made for them when they are first asked for."""
        if self._costs is None:
            ready = self._ready
            self._costs = np.full(self._shape, self._default, np.uint8) if ready is None else ready.copy()
        return self._costs

    @property
    def frame(self) -> CostFrame:
        """Place of the costmap in the map."""
        row, col = self.origin
        x, y = self._corner
        return CostFrame(x + col * self._resolution, y + row * self._resolution, self._resolution)

    @property
    def window(self) -> Window:
        """The cells of the static map that it lies on."""
        row, col = self.origin
        return Window(row, col, row + self._shape[0], col + self._shape[1])

    def roll(self, x: float, y: float) -> None:
        """Move a rolling window by whole cells until its middle is at this map point; `update` writes the costs."""
        if self._rolling:
            rows, cols = self._shape
            self.origin = (
                round((y - self._corner[1]) / self._resolution) - rows // 2,
                round((x - self._corner[0]) / self._resolution) - cols // 2,
            )

    def update(self) -> tuple[Window, ...]:
        """Bring the costs up to date: of a rolling costmap all of them, else what changed.

        Returns:
            The cells that were written, in cells of the static map; windows may overlap.
        """
        changes = [window for layer in self._layers for window in layer.bounds()]
        windows = (self.window,) if self._rolling or self._all_due else self._around(changes)
        self._all_due = False
        self.write(windows)
        return windows

    def compose(self) -> None:
        """Write the costs of all layers into a costmap of which nothing but what was ready is written."""
        changes = [window for layer in self._layers for window in layer.extents()]
        self.write((self.window,) if self._rolling or self._all_due else self._around(changes))
        self._all_due = False

    def _around(self, changes: Sequence[Window]) -> tuple[Window, ...]:
        """Return the windows to write when these have changed."""
        apart = _apart(np.array(changes, np.int64).reshape(-1, 4), self._reach, np.array(self.window))
        return tuple(Window(*window) for window in apart.tolist())

    def write(self, windows: Sequence[Window]) -> None:
        """Write the costs of these windows anew, each within the costmap; the layers' bounds are not asked for."""
        for window in windows:
            window.of(self.costs, self.origin)[:] = self._default
        # Layer by layer: what a layer reads around one window must be written in the others already.
        for layer in self._layers:
            for window in windows:
                layer.write(self.costs, self.origin, window)
