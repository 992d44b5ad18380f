"""Beams through an occupancy grid and against other robots' bodies: exact ranges, no sampling.

A beam is followed from one grid line to the next (Amanatides and Woo, A fast voxel traversal algorithm for ray
tracing, 1987), but in long strides. For each cell and each of the four diagonal directions, a table has the side of the
largest square that starts there and contains no occupied cell. A beam inside this square meets nothing before it
leaves the square. So one step goes to the square's border, which is dozens of cells away in open space. The distance of
each crossing is computed from the beam's start, never as a sum of steps. So strides of any length give the same range
to the last bit.

Only occupied cells (100) stop a beam. It passes unknown cells and the space outside the grid. It is not known what is
there. If walls were assumed, the simulated laser would mark obstacles that no map shows. A beam that starts in an
occupied cell has range 0.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.common.grid import OCCUPIED, Cells, GridFrame, OccupancyGrid
from sim.numerics import elementary, elementary_arrays
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit

FreeSquares = NDArray[np.uint8]
"""(4, rows, cols): side of the largest square that has this cell as a corner and contains no occupied cell. The unit is
cells, the maximum is 255, and the value is 0 if the cell itself is occupied. All cells outside the grid are free. The
first index is the direction of the square. 0: lower columns and rows. 1: higher columns, lower rows. 2: lower columns,
higher rows. 3: higher columns and rows."""

_LARGEST_SQUARE = 255


@njit(cache=True)
def _free_squares(cells: Cells) -> FreeSquares:
    """Compute the table of free squares by dynamic programming, starting at the far end of each quadrant."""
    rows, cols = cells.shape
    squares = np.empty((4, rows, cols), dtype=np.uint8)
    for quadrant in range(4):
        col_step = 1 if quadrant & 1 else -1
        row_step = 1 if quadrant & 2 else -1
        for i in range(rows):
            row = rows - 1 - i if row_step > 0 else i
            next_row = row + row_step
            for j in range(cols):
                col = cols - 1 - j if col_step > 0 else j
                next_col = col + col_step
                if cells[row, col] == OCCUPIED:
                    squares[quadrant, row, col] = 0
                    continue
                # A square of side n consists of this cell and three overlapping squares of side n - 1 (at the side,
                # above, diagonal). All cells outside the map are free, so they do not limit the side.
                smallest = _LARGEST_SQUARE - 1
                if i > 0:
                    smallest = min(smallest, squares[quadrant, next_row, col])
                if j > 0:
                    smallest = min(smallest, squares[quadrant, row, next_col])
                if i > 0 and j > 0:
                    smallest = min(smallest, squares[quadrant, next_row, next_col])
                squares[quadrant, row, col] = smallest + 1
    return squares


@lru_cache(maxsize=8)
def free_squares_of(grid: OccupancyGrid) -> FreeSquares:
    """Return the strides that a beam may make from every cell, for each quadrant of its direction.

    The table is read-only, because a map never changes and all users share the table.
    """
    squares = _free_squares(grid.cells)
    squares.setflags(write=False)
    return squares


@njit(cache=True)
def _line_after(
    start: int, step: int, origin: float, speed: float, pace: float, distance: float, inclusive: bool, hair: float
) -> int:
    """Return the row (or column) that a beam from row (or column) `start` reaches after `distance`.

    If the beam is closer than `hair` to a grid line, rounding could put it on either side. In this case, the function
    compares crossings as `_cast` computes them. So a beam with strides passes the same cells as a beam that goes cell
    by cell.
    """
    reached = origin + speed * distance
    line = math.floor(reached)
    if hair < reached - line < 1.0 - hair:
        return line
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
def _cast(
    squares: FreeSquares, col_start: float, row_start: float, col_speed: float, row_speed: float, limit: float
) -> float:
    """Return the distance along one beam to the first occupied cell, meters, or inf if it is not below `limit`.

    Args:
        squares: table of the grid. A table with 1 in all free cells would give the same range, but more slowly.
        col_start: start of the beam, along the columns, in cells.
        row_start: start along the rows.
        col_speed: cells per meter of beam along the columns.
        row_speed: cells per meter along the rows.
        limit: meters, finite.

    See the module's docstring. At a corner the row is crossed first, here and in `_line_after` (`inclusive`).
    """
    rows = squares.shape[1]
    cols = squares.shape[2]
    # A beam along a grid line needs a finite pace (meters per cell) across it. Otherwise a beam exactly on the line
    # would compute 0 * inf.
    if col_speed == 0.0:
        col_speed = 1e-300
    if row_speed == 0.0:
        row_speed = 1e-300
    col_pace = 1.0 / col_speed
    row_pace = 1.0 / row_speed
    col_step = 1 if col_speed > 0.0 else -1
    row_step = 1 if row_speed > 0.0 else -1
    # Edge through which the beam enters a cell: 0 for the cell's lower edge, 1 for its upper edge.
    col_behind = 0 if col_speed > 0.0 else 1
    row_behind = 0 if row_speed > 0.0 else 1
    # Rounding moves a beam by about 1e-16 of the numbers from which it is computed.
    hair = 1e-13 * (abs(col_start) + abs(row_start) + rows + cols)
    # The grid is convex, so a beam that leaves it does not return. Therefore no stride below has to end outside the
    # grid.
    leaves_cols = ((cols if col_step > 0 else 0) - col_start) * col_pace
    leaves_rows = ((rows if row_step > 0 else 0) - row_start) * row_pace
    limit = min(limit, leaves_cols, leaves_rows)
    col = math.floor(col_start)
    row = math.floor(row_start)
    distance = 0.0
    if not (0 <= col_start < cols and 0 <= row_start < rows):
        enters_cols = ((0 if col_step > 0 else cols) - col_start) * col_pace
        enters_rows = ((0 if row_step > 0 else rows) - row_start) * row_pace
        distance = max(enters_cols, enters_rows)
        if not 0.0 <= distance < limit:
            return math.inf
        if enters_cols >= enters_rows:
            row = _line_after(row, row_step, row_start, row_speed, row_pace, distance, True, hair)
            col = 0 if col_step > 0 else cols - 1
        else:
            col = _line_after(col, col_step, col_start, col_speed, col_pace, distance, False, hair)
            row = 0 if row_step > 0 else rows - 1
    quadrant = squares[(1 - col_behind) + 2 * (1 - row_behind)]
    free = int(quadrant[np.uintp(row), np.uintp(col)])
    # Invariant: the beam enters cell (row, col) at `distance`, and all cells before it are free. `free` is the side of
    # the free square that starts at this cell. It is 0 in an occupied cell, which ends the beam.
    while free > 0:
        # Far column and row of the square, and the distances at which the beam reaches them. The beam leaves the square
        # at the smaller distance.
        next_col = col + col_step * free
        next_row = row + row_step * free
        col_exit = (next_col + col_behind - col_start) * col_pace
        row_exit = (next_row + row_behind - row_start) * row_pace
        if col_exit < row_exit:
            distance = col_exit
            if not distance < limit:
                return math.inf
            row = _line_after(row, row_step, row_start, row_speed, row_pace, distance, True, hair)
            col = next_col
        else:
            distance = row_exit
            if not distance < limit:
                return math.inf
            col = _line_after(col, col_step, col_start, col_speed, col_pace, distance, False, hair)
            row = next_row
        free = int(quadrant[np.uintp(row), np.uintp(col)])
    return distance


@njit(cache=True)
def cast_beams(
    squares: FreeSquares, frame: GridFrame, poses: FloatArray, directions: FloatArray, max_range: float, out: FloatArray
) -> None:
    """Fill `out`, (n, m), with the ranges of m beams from each of n sensors.

    Args:
        squares: table of the grid.
        frame: frame of the grid.
        poses: (n, 3) poses of the sensors in the map frame.
        directions: (m, 2) cosine and sine of the beams' angles in the sensor's frame.
        max_range: meters, finite. A beam that meets nothing within it has range inf.
        out: (n, m) meters.
    """
    # A cell at exactly max_range is still visible.
    limit = np.nextafter(max_range, np.inf)
    for i in range(poses.shape[0]):
        dx = poses[i, 0] - frame.x
        dy = poses[i, 1] - frame.y
        col_start = (frame.cos * dx + frame.sin * dy) / frame.resolution
        row_start = (frame.cos * dy - frame.sin * dx) / frame.resolution
        c, s = elementary.cos_sin(poses[i, 2])
        # The sensor's axes, in cells per meter along the grid's axes. With them, no beam needs a sine or cosine of its
        # own.
        ahead_cols = (frame.cos * c + frame.sin * s) / frame.resolution
        ahead_rows = (frame.cos * s - frame.sin * c) / frame.resolution
        for j in range(directions.shape[0]):
            cos = directions[j, 0]
            sin = directions[j, 1]
            out[i, j] = _cast(
                squares,
                col_start,
                row_start,
                ahead_cols * cos - ahead_rows * sin,
                ahead_rows * cos + ahead_cols * sin,
                limit,
            )


@njit(cache=True)
def _circle(polygon: FloatArray) -> tuple[float, float, float]:
    """Return the center (x, y) and radius of a circle around all corners."""
    x, y = polygon[:, 0].mean(), polygon[:, 1].mean()
    radius = 0.0
    for k in range(polygon.shape[0]):
        radius = max(radius, elementary.hypot(polygon[k, 0] - x, polygon[k, 1] - y))
    return x, y, radius


@njit(cache=True)
def shorten_by_polygon(polygon: FloatArray, directions: FloatArray, max_range: float, ranges: FloatArray) -> None:
    """Shorten the ranges of those beams that meet a polygon.

    Args:
        polygon: (v, 2) corners in the sensor's frame, clockwise or counterclockwise, convex or not.
        directions: (m, 2) cosine and sine of the beams' angles in the sensor's frame.
        max_range: maximum distance of visible edges, meters.
        ranges: (m,) meters, changed in place. A sensor inside the polygon sees its outline from inside.
    """
    corners = polygon.shape[0]
    centre_x, centre_y, radius = _circle(polygon)
    if elementary.hypot(centre_x, centre_y) > max_range + radius:
        return
    for j in range(directions.shape[0]):
        c = directions[j, 0]
        s = directions[j, 1]
        # Most beams miss the circle around the polygon, or point away from it.
        if abs(c * centre_y - s * centre_x) > radius or c * centre_x + s * centre_y < -radius:
            continue
        last_along = c * polygon[corners - 1, 0] + s * polygon[corners - 1, 1]
        last_across = c * polygon[corners - 1, 1] - s * polygon[corners - 1, 0]
        for k in range(corners):
            along = c * polygon[k, 0] + s * polygon[k, 1]
            across = c * polygon[k, 1] - s * polygon[k, 0]
            # A corner on the beam belongs to only one side, so that no beam slips between two edges.
            if (across > 0.0) != (last_across > 0.0):
                hit = along + (last_along - along) * across / (across - last_across)
                if 0.0 <= hit <= max_range and hit < ranges[j]:
                    ranges[j] = hit
            last_along = along
            last_across = across


class BeamFan(NamedTuple):
    """Evenly spread beams, in the form for compiled kernels.

    Attributes:
        angle_min: angle of the first beam, radians in the sensor's frame.
        angle_increment: angle from one beam to the next, greater than 0.
        directions: (m, 2) cosine and sine of the beams' angles.
    """

    angle_min: float
    angle_increment: float
    directions: FloatArray


@njit(cache=True)
def shorten_fan_by_polygon(polygon: FloatArray, fan: BeamFan, max_range: float, ranges: FloatArray) -> None:
    """Do the same as `shorten_by_polygon`, but examine only the beams that may meet the polygon."""
    beams = fan.directions.shape[0]
    centre_x, centre_y, radius = _circle(polygon)
    away = elementary.hypot(centre_x, centre_y)
    # If the sensor is near, even beams that point away from the polygon's center may meet the polygon.
    if away < 2.0 * radius:
        shorten_by_polygon(polygon, fan.directions, max_range, ranges)
        return
    half = elementary.atan2(radius, math.sqrt((away - radius) * (away + radius)))
    begin = (elementary.atan2(centre_y, centre_x) - half - fan.angle_min) / fan.angle_increment
    end = begin + 2.0 * half / fan.angle_increment
    turn = math.tau / fan.angle_increment
    for turns in (-1, 0, 1):
        # One additional beam on either side, so that rounding does not omit a beam.
        first = max(0, math.floor(begin + turns * turn) - 1)
        last = min(beams, math.ceil(end + turns * turn) + 2)
        if first < last:
            shorten_by_polygon(polygon, fan.directions[first:last], max_range, ranges[first:last])


def directions_of(angles: FloatArray) -> FloatArray:
    """Return (m,) angles as (m, 2) cosines and sines, the form of beams for kernels."""
    return np.column_stack((elementary_arrays.cos(angles), elementary_arrays.sin(angles)))


@dataclass(frozen=True, slots=True, eq=False)
class Raycaster:
    """Table of strides of a grid, with the grid's frame. It casts beams through the grid.

    Attributes:
        squares: (4, rows, cols) table for the kernels of this module.
        frame: frame of the grid in the map.
    """

    squares: FreeSquares
    frame: GridFrame

    @classmethod
    def of(cls, grid: OccupancyGrid) -> "Raycaster":
        """Prepare a grid. Equal grids share the same table."""
        return cls(free_squares_of(grid), grid.frame)

    def ranges(self, poses: FloatArray, angles: FloatArray, max_range: float) -> FloatArray:
        """Return the distance to the first occupied cell along every beam, meters, or inf beyond `max_range`.

        Args:
            poses: (n, 3) poses of the sensors in the map frame.
            angles: (m,) radians in the sensor's frame.
            max_range: meters.

        Returns:
            (n, m).

        Raises:
            ValueError: `max_range` is not finite.
        """
        if not math.isfinite(max_range):
            raise ValueError(f"max_range must be finite, not {max_range}")
        out = np.empty((poses.shape[0], angles.shape[0]))
        cast_beams(self.squares, self.frame, poses, directions_of(angles), max_range, out)
        return out
