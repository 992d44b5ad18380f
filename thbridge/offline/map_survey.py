"""Statistics of a map: size and floor, rooms with areas and doors, and places that robots can reach."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import find_objects, label

from sim.common.distance_fields import nearest_cells
from sim.common.grid import FREE, OCCUPIED, OccupancyGrid
from sim.common.traversability import Mask, Polygon, TraversabilityMap
from sim.robot.costmap.footprint import radii
from thbridge.files.map_files import FOOTPRINT, Map, MapRoom
from thbridge.hunt.rooms import Room

Owners = NDArray[np.int32]
"""(rows, cols) number of the room that contains the cell's center. Number 0 is the corridor."""

GAP = 0.6
"""Maximum area of the sill of a door, square meters. A larger area of floor between two outlines is a corridor."""

_TOUCHING = np.ones((3, 3), dtype=np.bool_)


@dataclass(frozen=True, slots=True)
class Doorway:
    """An opening between a room and the corridor or another room. A robot fits through the opening.

    Attributes:
        room: the room. Between two rooms, this is the room with the lower number.
        beyond: the room on the other side, or the corridor.
        x: x of the opening's middle, map frame, meters.
        y: y of the opening's middle, map frame, meters.
        width: width of the opening, meters.
    """

    room: Room
    beyond: Room
    x: float
    y: float
    width: float


@dataclass(frozen=True, slots=True)
class RoomSurvey:
    """A room, its free floor in square meters, and its doors."""

    room: MapRoom
    area: float
    doors: tuple[Doorway, ...]


@dataclass(frozen=True, slots=True)
class MapSurvey:
    """Statistics of a map.

    Attributes:
        place: the map.
        free: share of free cells.
        occupied: share of occupied cells. Cells that are neither free nor occupied are unknown.
        rooms: the rooms, in the order of their numbers.
        pairs: number of ordered pairs of different places. The first place is a room or the corridor (at start 1), the
            second place is a room.
        reachable: number of pairs with a path for a robot.
    """

    place: Map
    free: float
    occupied: float
    rooms: tuple[RoomSurvey, ...]
    pairs: int
    reachable: int

    @property
    def unknown(self) -> float:
        """Share of cells that are neither free nor occupied."""
        return max(0.0, 1.0 - self.free - self.occupied)


def survey(place: Map, footprint: Polygon = FOOTPRINT) -> MapSurvey:
    """Return the statistics of a map. The map may have faults.

    Args:
        place: the map.
        footprint: corners of a robot in its own frame, meters.
    """
    grid = place.grid
    floor = TraversabilityMap.of(grid, *radii(np.array(footprint)))
    owners = owners_of(place, floor)
    openings = tuple(doorways(floor, owners, footprint))
    free = grid.cells == FREE
    cells = np.bincount(owners[free], minlength=1 + max((entry.room.people for entry in place.rooms), default=0))
    rooms = tuple(
        RoomSurvey(
            entry,
            float(cells[entry.room.people]) * grid.resolution**2,
            tuple(door for door in openings if entry.room in (door.room, door.beyond)),
        )
        for entry in place.rooms
    )
    passable = floor.clearance > floor.inscribed
    areas = np.asarray(label(passable)[0], dtype=np.int32)
    starts, goals = place.starts[:1], [entry.goal for entry in place.rooms]
    there = [_area_at(areas, grid, pose.x, pose.y) for pose in (*starts, *goals)]
    pairs = [(i, j) for i in range(len(there)) for j in range(len(starts), len(there)) if i != j]
    return MapSurvey(
        place=place,
        free=float(free.mean()),
        occupied=float((grid.cells == OCCUPIED).mean()),
        rooms=rooms,
        pairs=len(pairs),
        reachable=sum(there[i] == there[j] > 0 for i, j in pairs),
    )


def owners_of(place: Map, floor: TraversabilityMap) -> Owners:
    """Return the room of every cell. If regions overlap, use the later region."""
    owners = np.zeros(place.grid.cells.shape, dtype=np.int32)
    for entry in place.rooms:
        box, held = floor.held_by(entry.region)
        owners[box][held] = entry.room.people
    return owners


def doorways(floor: TraversabilityMap, owners: Owners, footprint: Polygon = FOOTPRINT) -> Iterator[Doorway]:
    """Yield the openings of rooms, ordered by room, then by the room beyond, then by position.

    An opening is a connected group of free cells on one side that touch free cells on the other side. A robot fits
    through the opening if one of these cells has enough clearance for the robot's inscribed circle.
    """
    grid = floor.grid
    inscribed, _ = radii(np.array(footprint))
    free = grid.cells == FREE
    owners = _without_gaps(owners, free, grid.resolution)
    boxes = find_objects(owners)
    for number in (int(number) for number in np.unique(owners[owners > 0])):
        found = boxes[number - 1]
        low = [max(0, side.start - 1) for side in found]
        box = slice(low[0], found[0].stop + 1), slice(low[1], found[1].stop + 1)
        for other in sorted({int(other) for other in np.unique(owners[box])}):
            if 0 < other <= number:
                continue
            touching = free[box] & (owners[box] == number) & _beside(free[box] & (owners[box] == other))
            labels, count = label(touching, structure=_TOUCHING)
            for index in range(1, count + 1):
                cells = np.argwhere(labels == index) + np.array(low)
                if floor.clearance[tuple(cells.T)].max() <= inscribed:
                    continue
                middle = grid.centres_of(cells).mean(axis=0)
                extent = np.ptp(cells, axis=0) + 1
                width = float(max(extent)) if min(extent) <= 2 else float(np.hypot(*extent))
                x, y = float(middle[0]), float(middle[1])
                yield Doorway(Room(number), Room(other), x, y, width * grid.resolution)


def _without_gaps(owners: Owners, free: Mask, resolution: float) -> Owners:
    """Return the rooms of cells. Small areas between rooms, too small for a corridor, belong to the nearest room."""
    labels, _ = label(free & (owners == 0))
    small = np.bincount(labels.ravel()) * resolution**2 < GAP
    small[0] = False
    gaps = small[labels]
    if not gaps.any() or not owners.any():
        return owners
    near_row, near_col = nearest_cells(owners > 0)
    closed = owners.copy()
    closed[gaps] = owners[near_row[gaps], near_col[gaps]]
    return closed


def _beside(mask: Mask) -> Mask:
    """Return the cells directly above, below, left or right of a cell of the mask."""
    padded = np.pad(mask, 1)
    beside: Mask = padded[:-2, 1:-1] | padded[2:, 1:-1] | padded[1:-1, :-2] | padded[1:-1, 2:]
    return beside


def _area_at(areas: NDArray[np.int32], grid: OccupancyGrid, x: float, y: float) -> int:
    row, col = grid.cell_of(x, y)
    return int(areas[row, col]) if grid.contains(row, col) else 0
