"""The layer of the other robots: the report's GridLayer, where they stand by their own word."""

import math
from collections.abc import Sequence

import numpy as np
from numba import njit

from sim.costmap.costs import NOTHING, Costs, Window
from sim.geometry import FloatArray
from sim.grid import OccupancyGrid
from sim.observations import Neighbour

STIR = 0.05
"""Metres (and 0.1 rad for each) below which a change of pose is not worth an update."""


@njit(cache=True)
def _fill(costs: Costs, corners: FloatArray, row: int, col: int, row_end: int, col_end: int) -> None:
    """Make the cells lethal whose centre lies in a polygon (even-odd rule), and those under its outline's corners.

    Args:
        corners: (n, 2) column and row, in cells of `costs`.
    """
    n = corners.shape[0]
    for r in range(max(row, math.floor(corners[:, 1].min())), min(row_end, int(corners[:, 1].max()) + 1)):
        for c in range(max(col, math.floor(corners[:, 0].min())), min(col_end, int(corners[:, 0].max()) + 1)):
            x, y = c + 0.5, r + 0.5
            inside = False
            k = n - 1
            for i in range(n):
                if (corners[i, 1] > y) != (corners[k, 1] > y):
                    crossing = (corners[k, 0] - corners[i, 0]) * (y - corners[i, 1])
                    if x < crossing / (corners[k, 1] - corners[i, 1]) + corners[i, 0]:
                        inside = not inside
                k = i
            if inside:
                costs[r, c] = 254


class RobotsLayer:
    """The footprints of the other robots.

    Args:
        grid: the map.
        resting_only: whether robots that mean to move are left out. A plan through the map reckons with those that
            stay; where the others are now says little of where they will be.
    """

    def __init__(self, grid: OccupancyGrid, resting_only: bool) -> None:
        self._grid = grid
        self._resting_only = resting_only
        self._seen: dict[int, tuple[float, float, float]] = {}
        self._corners: dict[int, FloatArray] = {}
        self._windows: dict[int, Window] = {}
        self._pending = NOTHING

    def see(self, neighbours: Sequence[Neighbour]) -> None:
        """Take in what the others said last."""
        heard = set()
        for neighbour in neighbours:
            if self._resting_only and len(neighbour.times):
                continue
            heard.add(neighbour.robot)
            pose = neighbour.base_in_map
            seen = self._seen.get(neighbour.robot)
            if (
                seen is not None
                and math.hypot(pose.x - seen[0], pose.y - seen[1]) < STIR
                and abs(math.remainder(pose.theta - seen[2], math.tau)) < 2 * STIR
            ):
                continue
            self._forget(neighbour.robot)
            origin = self._grid.origin
            points = pose.transform(neighbour.footprint) - np.array([origin.x, origin.y])
            self._seen[neighbour.robot] = (pose.x, pose.y, pose.theta)
            corners = points / self._grid.resolution
            (left, low), (right, high) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
            around = Window(math.floor(low), math.floor(left), math.floor(high) + 1, math.floor(right) + 1)
            self._corners[neighbour.robot] = corners
            self._windows[neighbour.robot] = around
            self._pending = self._pending.union(around)
        for robot in [robot for robot in self._seen if robot not in heard]:
            self._forget(robot)

    def _forget(self, robot: int) -> None:
        if robot in self._seen:
            self._pending = self._pending.union(self._windows[robot])
            del self._seen[robot], self._corners[robot], self._windows[robot]

    def bounds(self) -> Window:
        """Where robots came or went."""
        changed, self._pending = self._pending, NOTHING
        return changed

    def reach(self) -> int:
        """None."""
        return 0

    def write(self, costs: Costs, origin: tuple[int, int], window: Window) -> None:
        """Lethal under every footprint."""
        row, col = origin
        for robot, corners in self._corners.items():
            if self._windows[robot].clipped(window).empty:
                continue
            _fill(
                costs,
                corners - np.array([col, row]),
                window.row - row,
                window.col - col,
                window.row_end - row,
                window.col_end - col,
            )
