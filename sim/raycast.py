"""Beams through an occupancy grid and against other robots' bodies: exact ranges, no sampling.

Only occupied cells (100) stop a beam. Unknown cells and everything outside the grid let it pass: nobody knows of
anything there, and inventing walls would make a simulated laser mark obstacles that no map shows. A beam that starts
in an occupied cell has range 0.
"""

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_cdt

from sim.geometry import FloatArray
from sim.grid import OCCUPIED, GridFrame, OccupancyGrid

Clearance = NDArray[np.uint8]
"""(rows, cols): how many king's moves from each cell to the nearest occupied one, 0 if itself, at most 255."""

_CLEARANCE_LIMIT = 255


def clearance_of(grid: OccupancyGrid) -> Clearance:
    """The free square around every cell: all cells nearer (in king's moves) than this are not occupied."""
    open_cells = grid.cells != OCCUPIED
    if open_cells.all():
        return np.full(grid.cells.shape, _CLEARANCE_LIMIT, dtype=np.uint8)
    moves = np.asarray(distance_transform_cdt(open_cells, metric="chessboard"))
    return np.minimum(moves, _CLEARANCE_LIMIT).astype(np.uint8)


@njit(cache=True)
def clearance_at(clearance: Clearance, row: int, col: int) -> int:
    """The clearance of a cell that may lie outside the grid: there, the king's moves to the grid's nearest cell."""
    rows: int = clearance.shape[0]
    cols: int = clearance.shape[1]
    if 0 <= row < rows and 0 <= col < cols:
        return int(clearance[row, col])
    return max(-row, row - rows + 1, -col, col - cols + 1)


@njit(cache=True)
def _line_after(
    start: int, step: int, origin: float, speed: float, pace: float, distance: float, inclusive: bool
) -> int:
    """The row (or column) that a beam is in after `distance`, having been in `start` before.

    A line between two rows counts as crossed by comparing the very expression that `cast` steps by, so that rounding
    can never send a beam that skips through other cells than one that goes step by step.
    """
    line = math.floor(origin + speed * distance)
    ahead = 1 if step > 0 else 0
    behind = 1 - ahead
    while True:
        crossed = (line + ahead - origin) * pace
        if crossed < distance or (inclusive and crossed == distance):
            line += step
        else:
            break
    while line != start:
        crossed = (line + behind - origin) * pace
        if crossed < distance or (inclusive and crossed == distance):
            break
        line -= step
    return line


@njit(cache=True)
def cast(clearance: Clearance, frame: GridFrame, x: float, y: float, cos: float, sin: float, max_range: float) -> float:
    """Metres along one beam to the first occupied cell; inf if there is none within `max_range`.

    Args:
        clearance: of the grid; all ones on free cells would give the same range, slower.
        frame: the grid's.
        x: where the beam starts, map frame.
        y: the same.
        cos: where it points: cosine of its angle in the map frame.
        sin: sine of that angle.
        max_range: metres, finite.

    Source: Amanatides and Woo, A fast voxel traversal algorithm for ray tracing (1987).
    Differs: crosses a whole free square at a time; each crossing is computed from the start, not accumulated.
    """
    dx = x - frame.x
    dy = y - frame.y
    # In cells, and cells per metre of beam, along the grid's own axes.
    col_start = (frame.cos * dx + frame.sin * dy) / frame.resolution
    row_start = (frame.cos * dy - frame.sin * dx) / frame.resolution
    col_speed = (frame.cos * cos + frame.sin * sin) / frame.resolution
    row_speed = (frame.cos * sin - frame.sin * cos) / frame.resolution
    # A beam along a grid line must still have a finite pace across it, or 0 * inf would be met on the line itself.
    if col_speed == 0.0:
        col_speed = 1e-300
    if row_speed == 0.0:
        row_speed = 1e-300
    col_pace = 1.0 / col_speed
    row_pace = 1.0 / row_speed
    col_step = 1 if col_speed > 0.0 else -1
    row_step = 1 if row_speed > 0.0 else -1
    col_ahead = 1 if col_speed > 0.0 else 0
    row_ahead = 1 if row_speed > 0.0 else 0
    col = math.floor(col_start)
    row = math.floor(row_start)
    distance = 0.0
    free = clearance_at(clearance, row, col)
    while free > 0:
        # The last row and column of the free square that the beam heads for, and where it would leave by each.
        last_col = col + col_step * (free - 1)
        last_row = row + row_step * (free - 1)
        col_exit = (last_col + col_ahead - col_start) * col_pace
        row_exit = (last_row + row_ahead - row_start) * row_pace
        distance = min(col_exit, row_exit)
        if not distance <= max_range:
            return math.inf
        if col_exit < row_exit:
            row = _line_after(row, row_step, row_start, row_speed, row_pace, distance, True)
            col = last_col + col_step
        else:
            col = _line_after(col, col_step, col_start, col_speed, col_pace, distance, False)
            row = last_row + row_step
        free = clearance_at(clearance, row, col)
    return distance


@njit(cache=True)
def cast_beams(
    clearance: Clearance, frame: GridFrame, poses: FloatArray, directions: FloatArray, max_range: float, out: FloatArray
) -> None:
    """Fill `out`, (n, m), with the ranges of m beams from each of n sensors.

    Args:
        clearance: of the grid.
        frame: the grid's.
        poses: (n, 3) of the sensors in the map frame.
        directions: (m, 2) cosine and sine of the beams' angles in the sensor's frame.
        max_range: metres, finite; what is farther away has range inf.
        out: (n, m) metres.
    """
    for i in range(poses.shape[0]):
        c = math.cos(poses[i, 2])
        s = math.sin(poses[i, 2])
        for j in range(directions.shape[0]):
            cos = c * directions[j, 0] - s * directions[j, 1]
            sin = s * directions[j, 0] + c * directions[j, 1]
            out[i, j] = cast(clearance, frame, poses[i, 0], poses[i, 1], cos, sin, max_range)


@njit(cache=True)
def shorten_by_polygon(polygon: FloatArray, directions: FloatArray, max_range: float, ranges: FloatArray) -> None:
    """Shorten those of a sensor's ranges that a polygon cuts off.

    Args:
        polygon: (v, 2) corners in the sensor's frame, either way round, convex or not.
        directions: (m, 2) cosine and sine of the beams' angles in the sensor's frame.
        max_range: what is farther away is not seen.
        ranges: (m,) metres, changed in place. A sensor inside the polygon sees its outline from within.
    """
    corners = polygon.shape[0]
    centre_x = polygon[:, 0].mean()
    centre_y = polygon[:, 1].mean()
    radius = 0.0
    for k in range(corners):
        radius = max(radius, math.hypot(polygon[k, 0] - centre_x, polygon[k, 1] - centre_y))
    if math.hypot(centre_x, centre_y) > max_range + radius:
        return
    for j in range(directions.shape[0]):
        c = directions[j, 0]
        s = directions[j, 1]
        if abs(c * centre_y - s * centre_x) > radius or c * centre_x + s * centre_y < -radius:
            continue
        last_along = c * polygon[corners - 1, 0] + s * polygon[corners - 1, 1]
        last_across = c * polygon[corners - 1, 1] - s * polygon[corners - 1, 0]
        for k in range(corners):
            along = c * polygon[k, 0] + s * polygon[k, 1]
            across = c * polygon[k, 1] - s * polygon[k, 0]
            # A corner on the beam belongs to one side, so that no beam slips between two edges.
            if (across > 0.0) != (last_across > 0.0):
                hit = along + (last_along - along) * across / (across - last_across)
                if 0.0 <= hit <= max_range and hit < ranges[j]:
                    ranges[j] = hit
            last_along = along
            last_across = across


def directions_of(angles: FloatArray) -> FloatArray:
    """(m, 2) cosine and sine of (m,) angles, the form in which kernels take beams."""
    return np.column_stack((np.cos(angles), np.sin(angles)))


@dataclass(frozen=True, slots=True, eq=False)
class Raycaster:
    """A grid made ready for beams.

    Attributes:
        clearance: (rows, cols) for the kernels of this module.
        frame: where the grid lies, for the same.
    """

    clearance: Clearance
    frame: GridFrame

    @classmethod
    def of(cls, grid: OccupancyGrid) -> "Raycaster":
        """Make a grid ready, once."""
        return cls(clearance_of(grid), grid.frame)

    def ranges(self, poses: FloatArray, angles: FloatArray, max_range: float) -> FloatArray:
        """Metres to the first occupied cell along every beam; inf where there is none within `max_range`.

        Args:
            poses: (n, 3) of the sensors in the map frame.
            angles: (m,) radians in the sensor's frame.
            max_range: metres.

        Returns:
            (n, m).

        Raises:
            ValueError: `max_range` is not finite.
        """
        if not math.isfinite(max_range):
            raise ValueError(f"max_range must be finite, not {max_range}")
        out = np.empty((poses.shape[0], angles.shape[0]))
        cast_beams(self.clearance, self.frame, poses, directions_of(angles), max_range, out)
        return out
