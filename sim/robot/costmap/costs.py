"""Values of a costmap's cells, and rectangles of cells.

Source: ros-planning/navigation, costmap_2d/include/costmap_2d/cost_values.h.
"""

import functools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Costs = NDArray[np.uint8]
"""(rows, cols) costs, with row 0 and column 0 at the costmap's origin."""

FREE = 0
INSCRIBED = 253
"""Cost of cells that the robot's center must avoid, because the robot would touch an obstacle for any heading."""
LETHAL = 254
"""Cost of cells with an obstacle."""
UNKNOWN = 255
"""Value of unknown cells."""

MAX_CHANGES = 100
"""Maximum number of windows that are kept separately."""


class CostFrame(NamedTuple):
    """Frame of a costmap: map coordinates of the outer corner of cell (0, 0), and the side of a cell, meters."""

    x: float
    y: float
    resolution: float


class Window(NamedTuple):
    """A rectangle of cells, without the end row and the end column.

    It is empty if an end is not above its beginning.
    """

    row: int
    col: int
    row_end: int
    col_end: int

    @property
    def empty(self) -> bool:
        """True if the window contains no cell."""
        return self.row_end <= self.row or self.col_end <= self.col

    def of(self, costs: Costs, origin: tuple[int, int] = (0, 0)) -> Costs:
        """Return a view of the part of an array that is in this window; `origin` is the first cell of the array."""
        row, col = origin
        return costs[self.row - row : self.row_end - row, self.col - col : self.col_end - col]

    def meets(self, other: "Window") -> bool:
        """Return True if two windows that are not empty have cells in common."""
        return (
            self.row < other.row_end
            and other.row < self.row_end
            and self.col < other.col_end
            and other.col < self.col_end
        )

    def union(self, other: "Window") -> "Window":
        """Return the smallest rectangle around both windows."""
        if self.empty:
            return other
        if other.empty:
            return self
        return Window(
            min(self.row, other.row),
            min(self.col, other.col),
            max(self.row_end, other.row_end),
            max(self.col_end, other.col_end),
        )

    def clipped(self, other: "Window") -> "Window":
        """Return the common part of both windows."""
        return Window(
            max(self.row, other.row),
            max(self.col, other.col),
            min(self.row_end, other.row_end),
            min(self.col_end, other.col_end),
        )


class Changes:
    """Windows that a layer has changed since the last call of `take`."""

    def __init__(self) -> None:
        self._windows: list[Window] = []

    def add(self, window: Window) -> None:
        """Add a window."""
        self._windows.append(window)
        if len(self._windows) > MAX_CHANGES:
            # The windows were not taken for a long time. So one window around all of them is enough.
            self._windows = [functools.reduce(Window.union, self._windows)]

    def take(self) -> tuple[Window, ...]:
        """Return all windows, and remove them."""
        taken, self._windows = tuple(self._windows), []
        return taken
