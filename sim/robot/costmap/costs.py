"""The values of a costmap's cells.

Source: ros-planning/navigation, costmap_2d/include/costmap_2d/cost_values.h.
"""

import functools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Costs = NDArray[np.uint8]
"""(rows, cols), row 0 and column 0 at the costmap's origin."""

FREE = 0
INSCRIBED = 253
"""A robot whose center is here touches an obstacle, however it is turned."""
LETHAL = 254
"""An obstacle is here."""
UNKNOWN = 255
"""The cell is unknown."""

MAX_CHANGES = 100
"""Windows that are kept apart, at most."""


class CostFrame(NamedTuple):
    """Place of a costmap: map coordinates of the outer corner of cell (0, 0), and the side of a cell, meters."""

    x: float
    y: float
    resolution: float


class Window(NamedTuple):
    """A rectangle of cells, the upper ends not included; empty when an end is not above its beginning."""

    row: int
    col: int
    row_end: int
    col_end: int

    @property
    def empty(self) -> bool:
        """True when it holds no cell."""
        return self.row_end <= self.row or self.col_end <= self.col

    def of(self, costs: Costs, origin: tuple[int, int] = (0, 0)) -> Costs:
        """Return the part of an array that lies in this window, as a view; `origin` is the cell at which the array begins."""
        row, col = origin
        return costs[self.row - row : self.row_end - row, self.col - col : self.col_end - col]

    def meets(self, other: "Window") -> bool:
        """Return True if the two have cells in common; neither is empty."""
        return (
            self.row < other.row_end
            and other.row < self.row_end
            and self.col < other.col_end
            and other.col < self.col_end
        )

    def union(self, other: "Window") -> "Window":
        """Return the smallest rectangle around both."""
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
        """Return the part that lies in both."""
        return Window(
            max(self.row, other.row),
            max(self.col, other.col),
            min(self.row_end, other.row_end),
            min(self.col_end, other.col_end),
        )


class Changes:
    """The windows that a layer has changed since it was last asked."""

    def __init__(self) -> None:
        self._windows: list[Window] = []

    def add(self, window: Window) -> None:
        """Add a window."""
        self._windows.append(window)
        if len(self._windows) > MAX_CHANGES:
            # Nobody has asked for long: one window around all of them is enough to know.
            self._windows = [functools.reduce(Window.union, self._windows)]

    def take(self) -> tuple[Window, ...]:
        """Return all of them, and forget them."""
        taken, self._windows = tuple(self._windows), []
        return taken
