"""Bodies as polygons: their overlaps with each other and with occupied cells, and the distances between them."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.common.grid import OCCUPIED, GridFrame, OccupancyGrid
from sim.common.grid_transforms import king_moves
from sim.numerics import elementary, elementary_arrays
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit

_HALF_DIAGONAL = math.sqrt(0.5)


class Polygons(NamedTuple):
    """Several polygons in flat arrays, for compiled kernels.

    Attributes:
        corners: (v, 2) corners of all polygons, meters.
        ends: (p + 1,) int64. The corners of polygon i are corners[ends[i] : ends[i + 1]].
        circles: (p, 3) x, y and radius of a circle around each polygon.
    """

    corners: FloatArray
    ends: NDArray[np.int64]
    circles: FloatArray


def pack_polygons(polygons: Sequence[FloatArray]) -> Polygons:
    """Pack polygons, (v, 2) corners each, into flat read-only arrays."""
    corners = np.concatenate([np.empty((0, 2)), *polygons])
    ends = np.cumsum([0, *(len(polygon) for polygon in polygons)], dtype=np.int64)
    circles = np.empty((len(polygons), 3))
    for circle, polygon in zip(circles, polygons, strict=True):
        circle[:2] = polygon.mean(axis=0)
        circle[2] = elementary_arrays.hypot(*(polygon - circle[:2]).T).max()
    for array in (corners, ends, circles):
        array.flags.writeable = False
    return Polygons(corners, ends, circles)


def unpack_polygons(polygons: Polygons) -> list[FloatArray]:
    """Return the corners of each polygon, (v, 2)."""
    return np.split(polygons.corners, polygons.ends[1:-1]) if len(polygons.circles) else []


NO_POLYGONS = pack_polygons([])

Clearance = NDArray[np.uint8]
"""(rows, cols): number of king's moves (as in chess) from each cell to the nearest occupied cell, 0 to 255."""

_CLEARANCE_LIMIT = 255


def clearance_of(grid: OccupancyGrid) -> Clearance:
    """Return, for every cell, the number of king's moves to the nearest occupied cell, at most 255."""
    return king_moves(grid.cells == OCCUPIED, _CLEARANCE_LIMIT)


@njit(cache=True)
def clearance_at(clearance: Clearance, row: int, col: int) -> int:
    """Return the clearance of a cell.

    For a cell outside the grid, return the king's moves to the grid's nearest cell.
    """
    rows: int = clearance.shape[0]
    cols: int = clearance.shape[1]
    if 0 <= row < rows and 0 <= col < cols:
        return int(clearance[row, col])
    return max(-row, row - rows + 1, -col, col - cols + 1)


@njit(cache=True)
def _inside(x: float, y: float, polygon: FloatArray) -> bool:
    """Return True if a point is in a polygon (even-odd rule)."""
    inside = False
    last = polygon.shape[0] - 1
    for k in range(polygon.shape[0]):
        if (polygon[k, 1] > y) != (polygon[last, 1] > y):
            share = (y - polygon[k, 1]) / (polygon[last, 1] - polygon[k, 1])
            if x < polygon[k, 0] + share * (polygon[last, 0] - polygon[k, 0]):
                inside = not inside
        last = k
    return inside


@njit(cache=True)
def point_to_edge(x: float, y: float, ax: float, ay: float, bx: float, by: float) -> float:
    """Return the squared distance from a point to the line segment a-b."""
    ex = bx - ax
    ey = by - ay
    length = ex * ex + ey * ey
    share = 0.0
    if length > 0.0:
        share = min(1.0, max(0.0, ((x - ax) * ex + (y - ay) * ey) / length))
    dx = x - ax - share * ex
    dy = y - ay - share * ey
    return dx * dx + dy * dy


@njit(cache=True)
def _near_point(x: float, y: float, polygon: FloatArray, margin: float) -> bool:
    """Return True if a point is in a polygon or within `margin` of it."""
    last = polygon.shape[0] - 1
    for k in range(polygon.shape[0]):
        edge = point_to_edge(x, y, polygon[last, 0], polygon[last, 1], polygon[k, 0], polygon[k, 1])
        if edge <= margin * margin:
            return True
        last = k
    return _inside(x, y, polygon)


@njit(cache=True)
def side(ax: float, ay: float, bx: float, by: float, x: float, y: float) -> float:
    """Return a positive number if the point is to the left of a-b, a negative number if it is to the right."""
    return (bx - ax) * (y - ay) - (by - ay) * (x - ax)


@njit(cache=True)
def within_margin(a: FloatArray, b: FloatArray, margin: float) -> bool:
    """Return True if two polygons, (v, 2) and (w, 2), overlap or come within `margin` of each other."""
    limit = margin * margin
    i = a.shape[0] - 1
    for k in range(a.shape[0]):
        ax, ay, bx, by = a[i, 0], a[i, 1], a[k, 0], a[k, 1]
        j = b.shape[0] - 1
        for m in range(b.shape[0]):
            cx, cy, dx, dy = b[j, 0], b[j, 1], b[m, 0], b[m, 1]
            # Two segments cross if the ends of each are on different sides of the other.
            apart_cd = (side(ax, ay, bx, by, cx, cy) > 0.0) != (side(ax, ay, bx, by, dx, dy) > 0.0)
            apart_ab = (side(cx, cy, dx, dy, ax, ay) > 0.0) != (side(cx, cy, dx, dy, bx, by) > 0.0)
            if apart_cd and apart_ab:
                return True
            # Edges that do not cross are closest at an end of one of them, and every corner is an end of an edge.
            if point_to_edge(bx, by, cx, cy, dx, dy) <= limit or point_to_edge(dx, dy, ax, ay, bx, by) <= limit:
                return True
            j = m
        i = k
    # Without crossing edges, the polygons are apart or one contains the other. In the second case, every corner of the
    # inner polygon is inside the outer one, so one corner is enough to check.
    return _inside(a[0, 0], a[0, 1], b) or _inside(b[0, 0], b[0, 1], a)


@njit(cache=True)
def placed_at(footprint: FloatArray, x: float, y: float, theta: float) -> FloatArray:
    """Return the (v, 2) corners of a body at a pose, map frame."""
    c, s = elementary.cos_sin(theta)
    corners = np.empty_like(footprint)
    for k in range(footprint.shape[0]):
        corners[k, 0] = x + c * footprint[k, 0] - s * footprint[k, 1]
        corners[k, 1] = y + s * footprint[k, 0] + c * footprint[k, 1]
    return corners


@njit(cache=True)
def near_wall(corners: FloatArray, clearance: Clearance, frame: GridFrame, margin: float) -> bool:
    """Return True if a body overlaps an occupied cell or comes within `margin` meters of an occupied cell."""
    body = np.empty_like(corners)  # in cells: columns, rows
    left, right, bottom, top = np.inf, -np.inf, np.inf, -np.inf
    for k in range(corners.shape[0]):
        dx = corners[k, 0] - frame.x
        dy = corners[k, 1] - frame.y
        body[k, 0] = (frame.cos * dx + frame.sin * dy) / frame.resolution
        body[k, 1] = (frame.cos * dy - frame.sin * dx) / frame.resolution
        left, right = min(left, body[k, 0]), max(right, body[k, 0])
        bottom, top = min(bottom, body[k, 1]), max(top, body[k, 1])
    margin /= frame.resolution
    first_col = max(0, math.floor(left - margin))
    last_col = min(clearance.shape[1] - 1, math.floor(right + margin))
    first_row = max(0, math.floor(bottom - margin))
    last_row = min(clearance.shape[0] - 1, math.floor(top + margin))
    cell = np.empty((4, 2))
    for row in range(first_row, last_row + 1):
        for col in range(first_col, last_col + 1):
            # The circle around a cell is a cheap test that skips most cells.
            if clearance[row, col] > 0 or not _near_point(col + 0.5, row + 0.5, body, margin + _HALF_DIAGONAL):
                continue
            cell[0, 0], cell[0, 1] = col, row
            cell[1, 0], cell[1, 1] = col + 1, row
            cell[2, 0], cell[2, 1] = col + 1, row + 1
            cell[3, 0], cell[3, 1] = col, row + 1
            if within_margin(body, cell, margin):
                return True
    return False


@njit(cache=True)
def is_clear_of_walls(x: float, y: float, distance: float, clearance: Clearance, frame: GridFrame) -> bool:
    """Return True if certainly no occupied cell is within `distance` of a point.

    The test is cheap, and may return False although no occupied cell is near.
    """
    dx = x - frame.x
    dy = y - frame.y
    col = math.floor((frame.cos * dx + frame.sin * dy) / frame.resolution)
    row = math.floor((frame.cos * dy - frame.sin * dx) / frame.resolution)
    return (clearance_at(clearance, row, col) - 1) * frame.resolution > distance
