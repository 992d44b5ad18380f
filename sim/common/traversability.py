"""Traversability: places on a map where a robot fits, and places that it reaches from there. Rooms as polygons."""

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from sim.common.distance_fields import cells_away
from sim.common.geometry import Pose2
from sim.common.grid import FREE, OccupancyGrid
from sim.numerics.float_array import FloatArray

Point = tuple[float, float]
Polygon = tuple[Point, ...]
"""Corners in order, meters. The last corner is connected to the first."""
Mask = NDArray[np.bool_]
Span: TypeAlias = "slice[int, int, None]"
"""Range of rows or columns."""
Box = tuple[Span, Span]
"""Rows and columns of a part of a map."""


@dataclass(frozen=True, slots=True, eq=False)
class TraversabilityMap:
    """Clearance of all cells of a map, for robots of one size.

    Attributes:
        grid: the map. Its border counts as a wall, because nothing is known about the space outside.
        clearance: (rows, cols) meters from each cell's center to the center of the nearest cell that is not free. Cells
            that are not free have 0.
        inscribed: radius of the largest circle around a robot's center inside its footprint, meters.
        circumscribed: radius of the smallest circle around its center that contains the footprint.
    """

    grid: OccupancyGrid
    clearance: FloatArray
    inscribed: float
    circumscribed: float

    @classmethod
    def of(cls, grid: OccupancyGrid, inscribed: float, circumscribed: float) -> "TraversabilityMap":
        """Compute the clearance of a grid."""
        clearance = cells_away(grid.cells == FREE)
        clearance *= grid.resolution
        return cls(grid, clearance, inscribed, circumscribed)

    @property
    def everywhere(self) -> Box:
        """All rows and columns."""
        return slice(0, self.grid.rows), slice(0, self.grid.cols)

    def centres(self, box: Box) -> tuple[FloatArray, FloatArray]:
        """Return (rows, cols) x and y of the centers of the cells in a box, map frame, meters."""
        frame = self.grid.frame
        along = (np.arange(box[1].start, box[1].stop) + 0.5) * frame.resolution
        across = ((np.arange(box[0].start, box[0].stop) + 0.5) * frame.resolution)[:, np.newaxis]
        return (
            frame.x + frame.cos * along - frame.sin * across,
            frame.y + frame.sin * along + frame.cos * across,
        )

    def box_around(self, points: FloatArray, margin: float = 0.0) -> Box:
        """Return the rows and columns of a box around (n, 2) points, map frame, with a margin on all sides, meters."""
        places = self.grid.origin.inverse().transform(points)[:, ::-1]
        # One additional cell, because rounding may put a point on the edge of a cell into the next cell.
        low, high = (
            np.clip(np.floor(ends / self.grid.resolution) + more, 0, self.grid.cells.shape).astype(np.int64).tolist()
            for ends, more in ((places.min(axis=0) - margin, -1), (places.max(axis=0) + margin, 2))
        )
        return slice(low[0], high[0]), slice(low[1], high[1])

    def held_by(self, polygon: Polygon) -> tuple[Box, Mask]:
        """Return the cells with their centers in a polygon (map frame): a box, and a mask of this box."""
        box = self.box_around(np.array(polygon))
        return box, inside(polygon, *self.centres(box))

    def clearance_at(self, pose: Pose2) -> float:
        """Return the distance to the nearest cell that is not free, meters, or 0 outside the map."""
        row, col = self.grid.cell_of(pose.x, pose.y)
        return float(self.clearance[row, col]) if self.grid.contains(row, col) else 0.0

    def obstructed_by(self, other: Pose2) -> tuple[Box, Mask]:
        """Return the cells where no robot's center may be while another robot stands at `other`, for any headings.

        Returns:
            A box, and a mask of this box.
        """
        apart = self.inscribed + self.circumscribed
        box = self.box_around(np.array([[other.x, other.y]]), apart)
        x, y = self.centres(box)
        return box, np.sqrt(np.square(x - other.x) + np.square(y - other.y)) <= apart

    def reachable(self, start: Pose2) -> Mask:
        """Return the cells that a robot's center can reach from a pose.

        The mask is empty if no robot fits at the pose.
        """
        passable = self.clearance > self.inscribed
        areas = _areas(passable)
        row, col = self.grid.cell_of(start.x, start.y)
        area = areas[row, col] if self.grid.contains(row, col) else 0
        reached: Mask = (areas == area) & passable
        return reached


class CrowdedFloor:
    """A map on which several robots stand at the same time.

    Args:
        floor: the map.
        poses: poses of the robots, map frame.
    """

    def __init__(self, floor: TraversabilityMap, poses: Sequence[Pose2]) -> None:
        self._floor, self._poses = floor, poses
        self._obstructed = [floor.obstructed_by(pose) for pose in poses]
        # Number of robots that obstruct each cell.
        self._robots = np.zeros(floor.grid.cells.shape, dtype=np.int16)
        for box, mask in self._obstructed:
            self._robots[box] += mask
        self._areas = _areas((floor.clearance > floor.inscribed) & (self._robots == 0))

    def are_connected(self, cells: Sequence[tuple[int, int]]) -> bool:
        """Return True if an additional robot could drive between any two of these cells."""
        areas = {int(self._areas[cell]) for cell in cells}
        return areas <= {0} if not cells else len(areas) == 1 and 0 not in areas

    def reached(self, robot: int, cells: Sequence[tuple[int, int]]) -> list[bool]:
        """Return for each cell whether a robot can reach it from its present position, past all other robots."""
        floor, (box, own) = self._floor, self._obstructed[robot]
        # A robot does not obstruct itself. So cells that no other robot obstructs may connect areas for it.
        freed = _areas(own & (self._robots[box] == 1) & (floor.clearance[box] > floor.inscribed))
        mine, areas = np.zeros(int(freed.max(initial=0)) + 1, dtype=np.bool_), set[int]()
        place = floor.grid.cell_of(self._poses[robot].x, self._poses[robot].y)
        if floor.grid.contains(*place):
            mine[_at(freed, box, place)] = True
            areas.add(int(self._areas[place]))
        mine[0] = False
        areas.discard(0)
        beside, known = _beside(freed, self._areas[box]), -1
        while known < len(areas) + int(mine.sum()):
            known = len(areas) + int(mine.sum())
            areas.update(beside[mine[beside[:, 0]], 1].tolist())
            mine[beside[np.isin(beside[:, 1], [*areas]), 0]] = True
        return [int(self._areas[cell]) in areas or bool(mine[_at(freed, box, cell)]) for cell in cells]


def _areas(passable: Mask) -> NDArray[np.int32]:
    """Label connected cells with the number of their area, from 1, and cells that are not passable with 0."""
    # A robot drives only to a cell's four neighbors, because diagonally it could pass between two walls that meet at a
    # corner. The choice is that of `nearest_cells`.
    if "sim.common.grid_transforms" in sys.modules:
        from sim.common.grid_transforms import connected_areas  # noqa: PLC0415

        return connected_areas(passable)
    from scipy.ndimage import label  # noqa: PLC0415

    return cast(tuple[NDArray[np.int32], int], label(passable))[0]


def _at(labels: NDArray[np.int32], box: Box, cell: tuple[int, int]) -> int:
    """Return the label of a map cell in a box, or 0 outside the box."""
    row, col = cell[0] - box[0].start, cell[1] - box[1].start
    return int(labels[row, col]) if 0 <= row < labels.shape[0] and 0 <= col < labels.shape[1] else 0


def _beside(labels: NDArray[np.int32], others: NDArray[np.int32]) -> NDArray[np.int32]:
    """Return (n, 2) pairs: a label, and a label in `others` of a neighboring cell."""
    sides = (
        (labels[:-1], others[1:]),
        (labels[1:], others[:-1]),
        (labels[:, :-1], others[:, 1:]),
        (labels[:, 1:], others[:, :-1]),
    )
    pairs = np.concatenate([np.stack([one.ravel(), other.ravel()], axis=1) for one, other in sides])
    return np.unique(pairs[(pairs > 0).all(axis=1)], axis=0)


def inside(polygon: Polygon, x: FloatArray, y: FloatArray) -> Mask:
    """Return a mask of the points (x, y) that are in a polygon (even-odd rule). x and y have the same shape."""
    odd = np.zeros(x.shape, dtype=np.bool_)
    for (x0, y0), (x1, y1) in sides(polygon):
        if y0 != y1:
            odd ^= ((y0 > y) != (y1 > y)) & (x < x0 + (y - y0) * (x1 - x0) / (y1 - y0))
    return odd


def sides(polygon: Polygon) -> list[tuple[Point, Point]]:
    """Return the polygon's sides, each as a corner and the next corner."""
    return list(zip(polygon, polygon[1:] + polygon[:1], strict=True))


def area(polygon: Polygon) -> float:
    """Return the area in square meters. The corners may be clockwise or counterclockwise."""
    return abs(math.fsum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in sides(polygon))) / 2


def crosses_itself(polygon: Polygon) -> bool:
    """Return True if two sides of the polygon cross between their ends."""
    edges = sides(polygon)
    return any(_cross(edges[first], edges[second]) for second in range(len(edges)) for first in range(second))


def _cross(one: tuple[Point, Point], other: tuple[Point, Point]) -> bool:
    (a, b), (c, d) = one, other
    return _turn(a, b, c) * _turn(a, b, d) < 0 and _turn(c, d, a) * _turn(c, d, b) < 0


def _turn(a: Point, b: Point, c: Point) -> float:
    """Return a positive number if the path from a via b to c turns left."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
