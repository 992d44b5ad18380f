"""Traversability: places on a map where a robot's body fits, and how far it gets from there; rooms as polygons."""

import math
from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, label

from sim.common.geometry import Pose2
from sim.common.grid import FREE, OccupancyGrid
from sim.numerics.float_array import FloatArray

Point = tuple[float, float]
Polygon = tuple[Point, ...]
"""Corners in turn, metres; the last is joined to the first."""
Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class TraversabilityMap:
    """Clearance everywhere on a map, for robots of one size.

    Attributes:
        grid: the map. Its border counts as a wall: nothing is known of what lies beyond.
        clearance: (rows, cols) metres from each cell's centre to that of the nearest cell that is not free; 0 there.
        x: (rows, cols) metres, of each cell's centre in the map frame.
        y: the same.
        inscribed: radius of the largest circle about a robot's centre inside its footprint, metres.
        circumscribed: radius of the smallest one around it.
    """

    grid: OccupancyGrid
    clearance: FloatArray
    x: FloatArray
    y: FloatArray
    inscribed: float
    circumscribed: float

    @classmethod
    def of(cls, grid: OccupancyGrid, inscribed: float, circumscribed: float) -> "TraversabilityMap":
        """Compute the clearance of a grid."""
        free = np.pad(grid.cells == FREE, 1, constant_values=False)
        cells_away = np.asarray(distance_transform_edt(free), dtype=np.float64)[1:-1, 1:-1]
        centres = grid.centres_of(np.indices(grid.cells.shape).reshape(2, -1).T)
        x, y = centres.T.reshape(2, grid.rows, grid.cols)
        return cls(grid, cells_away * grid.resolution, x, y, inscribed, circumscribed)

    def clearance_at(self, pose: Pose2) -> float:
        """Metres to the nearest cell that is not free; 0 outside the map."""
        row, col = self.grid.cell_of(pose.x, pose.y)
        return float(self.clearance[row, col]) if self.grid.contains(row, col) else 0.0

    def obstructed_by(self, other: Pose2) -> Mask:
        """Cells in which no robot's centre can be while another stands there, however the two are turned."""
        away: FloatArray = np.sqrt(np.square(self.x - other.x) + np.square(self.y - other.y))
        return away <= self.inscribed + self.circumscribed

    def reachable(self, start: Pose2, obstructed: Mask) -> Mask:
        """Cells to which a robot's centre gets from a pose.

        Args:
            start: map frame; from a place where no robot fits nothing is reachable.
            obstructed: (rows, cols) cells that are taken.
        """
        passable = (self.clearance > self.inscribed) & ~obstructed
        # From a cell a robot gets to the four beside it, not past the corner between two walls.
        areas, _ = cast(tuple[NDArray[np.int32], int], label(passable))
        row, col = self.grid.cell_of(start.x, start.y)
        area = areas[row, col] if self.grid.contains(row, col) else 0
        reached: Mask = (areas == area) & passable
        return reached


def inside(polygon: Polygon, x: FloatArray, y: FloatArray) -> Mask:
    """Return a mask of the points (x, y), arrays of one shape, that lie in a polygon (even-odd rule)."""
    odd = np.zeros(x.shape, dtype=np.bool_)
    for (x0, y0), (x1, y1) in sides(polygon):
        if y0 != y1:
            odd ^= ((y0 > y) != (y1 > y)) & (x < x0 + (y - y0) * (x1 - x0) / (y1 - y0))
    return odd


def sides(polygon: Polygon) -> list[tuple[Point, Point]]:
    """Return the polygon's sides: each corner with the next."""
    return list(zip(polygon, polygon[1:] + polygon[:1], strict=True))


def area(polygon: Polygon) -> float:
    """Square metres, whichever way round the corners are."""
    return abs(math.fsum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in sides(polygon))) / 2


def crosses_itself(polygon: Polygon) -> bool:
    """Return True when two sides cross between their ends."""
    edges = sides(polygon)
    return any(_cross(edges[first], edges[second]) for second in range(len(edges)) for first in range(second))


def _cross(one: tuple[Point, Point], other: tuple[Point, Point]) -> bool:
    (a, b), (c, d) = one, other
    return _turn(a, b, c) * _turn(a, b, d) < 0 and _turn(c, d, a) * _turn(c, d, b) < 0


def _turn(a: Point, b: Point, c: Point) -> float:
    """Positive when the path from a by b to c turns left."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
