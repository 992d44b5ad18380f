"""The layer of what the laser sees: readings mark obstacles, and clear the space before them.

Source: ros-planning/navigation, costmap_2d/plugins/obstacle_layer.cpp.
Differs: readings that the map or another robot explains do not mark, else every error of localisation would thicken
the walls and every passing robot would leave a trail; readings beyond the laser's range clear (inf_is_valid).
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim.costmap.costs import FREE, LETHAL, NOTHING, Costs, Window
from sim.geometry import FloatArray, Pose2
from sim.grid import OccupancyGrid, distance_field
from sim.observations import Scan
from sim.parameters import ObstacleParameters

EXPLAINED = 0.2
"""Metres from a wall, or beyond a robot's circumscribed radius, within which a reading is no news."""


@njit(cache=True)
def _mark_and_clear(
    marks: Costs,
    wall_distance: FloatArray,
    corner_x: float,
    corner_y: float,
    resolution: float,
    x: float,
    y: float,
    theta: float,
    angle_min: float,
    angle_increment: float,
    range_min: float,
    ranges: NDArray[np.float32],
    obstacle_range: float,
    raytrace_range: float,
    explained: float,
    discs: FloatArray,
    clear: bool,
    changed: FloatArray,
) -> int:
    """Marks (and with `clear` clears) cells; returns how many it marked; `changed` becomes the bounds of both."""
    rows, cols = marks.shape
    marked = 0
    changed[0], changed[1], changed[2], changed[3] = rows, cols, -1, -1
    if clear:
        for i in range(ranges.shape[0]):
            reading = ranges[i]
            if math.isnan(reading) or reading < range_min:
                continue
            angle = theta + angle_min + i * angle_increment
            length = min(reading - resolution, raytrace_range)
            steps = int(length / (0.5 * resolution))
            dx, dy = 0.5 * resolution * math.cos(angle), 0.5 * resolution * math.sin(angle)
            for step in range(steps + 1):
                row = math.floor((y + step * dy - corner_y) / resolution)
                col = math.floor((x + step * dx - corner_x) / resolution)
                if 0 <= row < rows and 0 <= col < cols and marks[row, col] != 0:
                    marks[row, col] = 0
                    changed[0], changed[1] = min(changed[0], row), min(changed[1], col)
                    changed[2], changed[3] = max(changed[2], row), max(changed[3], col)
    for i in range(ranges.shape[0]):
        reading = ranges[i]
        if not (range_min <= reading <= obstacle_range):
            continue
        angle = theta + angle_min + i * angle_increment
        px, py = x + reading * math.cos(angle), y + reading * math.sin(angle)
        row = math.floor((py - corner_y) / resolution)
        col = math.floor((px - corner_x) / resolution)
        if row < 0 or col < 0 or row >= rows or col >= cols or marks[row, col] != 0:
            continue
        if wall_distance[row, col] <= explained:
            continue
        known = False
        for k in range(discs.shape[0]):
            known = known or math.hypot(px - discs[k, 0], py - discs[k, 1]) <= discs[k, 2] + explained
        if known:
            continue
        marks[row, col] = 254
        marked += 1
        changed[0], changed[1] = min(changed[0], row), min(changed[1], col)
        changed[2], changed[3] = max(changed[2], row), max(changed[3], col)
    return marked


class ObstacleLayer:
    """What the laser has seen that neither the map nor the other robots explain."""

    def __init__(self, parameters: ObstacleParameters, grid: OccupancyGrid) -> None:
        self._parameters = parameters
        self._grid = grid
        self._wall_distance = distance_field(grid, 2 * EXPLAINED).astype(np.float64)
        self._marks: Costs = np.full(grid.cells.shape, FREE, dtype=np.uint8)
        self._any = False
        self._pending = NOTHING
        self._changed = np.zeros(4)

    @property
    def marks(self) -> Costs:
        """(rows, cols) of the static map: LETHAL where something stands, else FREE."""
        return self._marks

    @property
    def any_marks(self) -> bool:
        """Whether anything is marked at all."""
        return self._any

    def observe(self, base_in_map: Pose2, scan: Scan, discs: FloatArray) -> None:
        """Take in a scan.

        Args:
            base_in_map: where the robot was when it scanned.
            scan: the readings.
            discs: (n, 3) x, y, radius of the other robots, whose readings do not mark.
        """
        laser = base_in_map.compose(scan.mount.laser_in_base)
        marked = _mark_and_clear(
            self._marks,
            self._wall_distance,
            self._grid.origin.x,
            self._grid.origin.y,
            self._grid.resolution,
            laser.x,
            laser.y,
            laser.theta,
            scan.mount.angle_min,
            scan.mount.angle_increment,
            scan.mount.range_min,
            scan.ranges,
            self._parameters.obstacle_range,
            self._parameters.raytrace_range,
            EXPLAINED,
            discs,
            self._any,
            self._changed,
        )
        self._any = self._any or marked > 0
        row, col, last_row, last_col = (int(value) for value in self._changed)
        if last_row >= row:
            self._pending = self._pending.union(Window(row, col, last_row + 1, last_col + 1))
            self._any = bool(self._marks.any())

    def clear(self) -> None:
        """Forget everything seen (move_base's clear_costmap_recovery)."""
        if self._any:
            rows, cols = np.nonzero(self._marks)
            seen = Window(int(rows.min()), int(cols.min()), int(rows.max()) + 1, int(cols.max()) + 1)
            self._pending = self._pending.union(seen)
            self._marks[:] = FREE
            self._any = False

    def bounds(self) -> Window:
        """What was marked or cleared since the last time."""
        changed, self._pending = self._pending, NOTHING
        return changed

    def reach(self) -> int:
        """None."""
        return 0

    def write(self, costs: Costs, origin: tuple[int, int], window: Window) -> None:
        """Lethal where something is marked."""
        if not self._any:
            return
        row, col = origin
        inside = window.clipped(Window(0, 0, *self._marks.shape))
        if inside.empty:
            return
        target = costs[inside.row - row : inside.row_end - row, inside.col - col : inside.col_end - col]
        target[self._marks[inside.row : inside.row_end, inside.col : inside.col_end] == LETHAL] = LETHAL
