"""Search for rooms on an occupancy grid. A room is floor that becomes narrow at its doorways.

Method: segmentation by the distance transform with the persistence of its peaks, refined by a watershed. The clearance
(distance to the nearest wall) of a room has a peak in the middle and a saddle in each doorway. The algorithm increases
a threshold of clearance step by step. If the floor above the threshold splits into parts with peaks that are high
enough above the saddle, each part is a separate place. A watershed from these places finds the borders on the narrowest
lines. All floor that connects places is corridor: floor without a peak, long floor with many doorways, and floor with
many openings.

Sources: R. Bormann, F. Jordan, W. Li, J. Hampp and M. Haegele, "Room Segmentation: Survey, Implementation, and
Analysis", ICRA 2016 (distance transform, clutter); S. Thrun, "Learning metric-topological maps for indoor mobile robot
navigation", Artificial Intelligence 99, 1998 (narrowest lines as doors).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, find_objects, label

from sim.common.distance_fields import cells_away
from sim.common.grid import FREE, OccupancyGrid
from sim.common.traversability import Mask
from sim.numerics.float_array import FloatArray

Labels = NDArray[np.int32]
"""(rows, cols) number of the cell's room, from 1 in reading order. 0 is for corridor, wall and unknown cells."""

Span: TypeAlias = "slice[int, int, None]"
"""Range of rows or columns."""

SPECK = 0.5
"""Maximum extent of noise and of table legs, meters."""
FURNITURE = 2.5
"""Maximum extent of isolated things on the floor that are ignored, meters. But thin things count as walls."""
SLENDER = 0.3
"""A thing is a piece of wall if its ratio of width to length is below this."""
LEVEL = 0.05
"""Step of the clearance threshold, meters. The step is at least half a cell."""
PASSAGE = 0.3
"""Floor with more clearance than this is a passage, and not the corner of a room, meters."""
CORNER = 1.5
"""Maximum distance of a room's floor from drivable places, as a multiple of the radius of the robot's inner circle."""
WIDEST_DOOR = 10.0
"""Maximum width of an opening that separates rooms, meters."""
SHED = 3.0
"""Minimum area of a corridor that is detected if it splits off from a single room, square meters."""
TINY = 1.0
"""Minimum area of a corridor, square meters."""
LONG = 3.2
"""Floor is a corridor if (length / width) * (number of doorways - 1) is above this."""
OPEN = 0.35
"""Maximum share of openings in the border of a room. Floor with a larger share is no room."""

_TOUCHING = np.ones((3, 3), dtype=np.bool_)


@dataclass(frozen=True, slots=True)
class RoomFindingOptions:
    """Thresholds for rooms.

    Attributes:
        prominence: minimum ratio of the clearance in a room's middle to the clearance in its widest doorway.
        area: minimum floor area, square meters.
    """

    prominence: float = 1.25
    area: float = 3.0


RELAXED = (RoomFindingOptions(), RoomFindingOptions(1.15, 2.0), RoomFindingOptions(1.08, 1.0))
"""Thresholds that the search uses in this order, until it finds enough rooms."""


def find_rooms(grid: OccupancyGrid, inscribed: float, circumscribed: float, wanted: int | None = None) -> Labels:
    """Find the rooms of a map. The same grid gives the same rooms.

    Args:
        grid: the map. Noise, furniture and unknown space are tolerated, but unknown space is not floor.
        inscribed: radius of the robot's inner circle, meters. The robot drives where this circle fits.
        circumscribed: radius of the robot's outer circle, meters. A room must have a place where the robot can turn.
        wanted: maximum number of rooms. If there are more rooms, the smallest rooms become corridor. If None, return
            all rooms for the usual thresholds.

    Returns:
        The rooms. There may be fewer rooms than `wanted`.
    """
    floor = drivable_floor(grid, inscribed)
    if not floor.any():
        return np.zeros(grid.cells.shape, dtype=np.int32)
    turning = floor & (cells_away(grid.cells == FREE) * grid.resolution > circumscribed)
    box = _around(floor, int(np.ceil(2 * inscribed / grid.resolution)))
    free = _without_furniture(grid)[box]
    found = np.zeros(grid.cells.shape, dtype=np.int32)
    for options in RELAXED:
        found[box] = _segment(free, floor[box], turning[box], grid.resolution, inscribed, options)
        if wanted is None or found.max() >= wanted:
            break
    areas = np.bincount(found.ravel())
    largest = np.argsort(-areas[1:], kind="stable")[:wanted] + 1
    return in_reading_order(np.where(np.isin(found, largest), found, 0).astype(np.int32))


def drivable_floor(grid: OccupancyGrid, inscribed: float) -> Mask:
    """Return the cells of the largest connected floor that a robot's center can reach.

    If there is enough floor inside, floor at the image's border is ignored, because it is the paper around a drawn
    plan.
    """
    areas, count = label(cells_away(grid.cells == FREE) * grid.resolution > inscribed)
    if count == 0:
        return np.zeros(grid.cells.shape, dtype=np.bool_)
    sizes = np.bincount(areas.ravel())
    sizes[0] = 0
    margin = int(np.ceil(inscribed / grid.resolution)) + 1
    border = np.ones(areas.shape, dtype=np.bool_)
    border[margin:-margin, margin:-margin] = False
    inner = sizes.copy()
    inner[np.unique(areas[border])] = 0
    chosen = inner.argmax() if 5 * inner.max() >= sizes.max() else sizes.argmax()
    floor: Mask = areas == chosen
    return floor


def in_reading_order(labels: Labels) -> Labels:
    """Number rooms in reading order: rows from the top, and rooms in a row from the left.

    A room belongs to a row if the room's middle is within the vertical extent of the row's first room.
    """
    boxes = {number: box for number, box in enumerate(find_objects(labels), start=1) if box is not None}
    waiting = sorted(boxes, key=lambda number: (-boxes[number][0].stop, boxes[number][1].start))
    order: list[int] = []
    while waiting:
        rows = boxes[waiting[0]][0]
        row = [
            number
            for number in waiting
            if rows.start <= (boxes[number][0].start + boxes[number][0].stop) / 2 <= rows.stop
        ]
        order.extend(sorted(row, key=lambda number: (boxes[number][1].start, number)))
        waiting = [number for number in waiting if number not in row]
    renumbered = np.zeros(int(labels.max()) + 1, dtype=np.int32)
    renumbered[order] = np.arange(1, len(order) + 1)
    numbered: Labels = renumbered[labels]
    return numbered


def _around(mask: Mask, margin: int) -> tuple[Span, Span]:
    """Return the box around a mask's cells, with a margin."""
    rows, cols = (np.nonzero(mask.any(axis=axis))[0] for axis in (1, 0))
    return (
        slice(max(0, int(rows[0]) - margin), int(rows[-1]) + margin + 1),
        slice(max(0, int(cols[0]) - margin), int(cols[-1]) + margin + 1),
    )


def _without_furniture(grid: OccupancyGrid) -> Mask:
    """Return the free cells, including the cells of isolated things that are not walls."""
    free: Mask = grid.cells == FREE
    things, _ = label(~free, structure=_TOUCHING)
    filled = free.copy()
    for number, box in enumerate(find_objects(things), start=1):
        extents = [(side.stop - side.start) * grid.resolution for side in box]
        if max(extents) > FURNITURE or _at_border(box, free.shape):
            continue
        mine = things[box] == number
        if max(extents) <= SPECK or not _is_slender(mine):
            filled[box] |= mine
    return filled


def _at_border(box: tuple[Span, ...], shape: tuple[int, ...]) -> bool:
    return any(side.start == 0 or side.stop == length for side, length in zip(box, shape, strict=True))


def _is_slender(mask: Mask) -> bool:
    """Return True if the width of a thing is small compared with its length. Both are computed from second moments."""
    cells = np.argwhere(mask).astype(np.float64)
    small, large = np.linalg.eigvalsh(np.cov(cells.T, bias=True) + np.eye(2) / 12)
    return bool(np.sqrt(small / large) < SLENDER)


@dataclass(frozen=True, slots=True)
class _Core:
    """Middle of a place.

    Attributes:
        cells: flat indices of the cells.
        door: clearance in the place's widest doorway, meters.
    """

    cells: NDArray[np.int64]
    door: float


def _segment(
    free: Mask, floor: Mask, turning: Mask, resolution: float, inscribed: float, options: RoomFindingOptions
) -> Labels:
    """Return the number of each cell's room. The order of the numbers is arbitrary."""
    clearance = cells_away(free) * resolution
    areas, _ = label(clearance > inscribed)
    wide = np.isin(areas, np.unique(areas[floor]))
    cores = list(_cores(np.where(wide, clearance, 0.0), resolution, inscribed, options))
    near = np.asarray(distance_transform_edt(~wide)) * resolution <= CORNER * inscribed
    clearance[~near] = 0.0
    places = _with_alcoves(_places_around(cores, clearance, resolution), len(cores), resolution)
    rooms = _rooms_among(places, len(cores), clearance, resolution, options)
    kept = [number for number in rooms if (turning & (places == number)).any()]
    renumbered = np.zeros(int(places.max()) + 1, dtype=np.int32)
    renumbered[kept] = np.arange(1, len(kept) + 1)
    found: Labels = renumbered[places]
    return found


def _cores(clearance: FloatArray, resolution: float, inscribed: float, options: RoomFindingOptions) -> Iterator[_Core]:
    """Yield the middles of places: floor with more clearance than the doorways of the place."""
    level, step = inscribed, max(LEVEL, resolution / 2)
    above, areas, peaks = _above(clearance, level, resolution)
    parts = {number: _Core(np.flatnonzero(above == number), level) for number in range(1, len(peaks))}
    while parts:
        level += step
        if level > WIDEST_DOOR / 2:
            yield from parts.values()
            return
        higher, areas_higher, peaks = _above(clearance, level, resolution)
        first = np.unique(higher, return_index=True)[1]
        parents = above.ravel()[first]
        following: dict[int, _Core] = {}
        for parent, core in parts.items():
            children = [
                child
                for child in range(1, len(peaks))
                if parents[child] == parent
                and peaks[child] >= max(options.prominence * level, level + 2 * resolution)
                and areas_higher[child] >= options.area
            ]
            if not children:
                yield core
            elif len(children) == 1 and areas[parent] - areas_higher[children[0]] < SHED:
                following[children[0]] = core
            else:
                for child in children:
                    following[child] = _Core(np.flatnonzero(higher == child), level)
        above, areas, parts = higher, areas_higher, following


def _above(clearance: FloatArray, level: float, resolution: float) -> tuple[Labels, FloatArray, FloatArray]:
    """Return the labels of connected floor above a clearance.

    Also return two values for each label: the area of the floor, extended by `level`, and the maximum clearance.
    """
    above, count = label(clearance > level)
    labels: Labels = np.asarray(above, dtype=np.int32)
    if count == 0:
        return labels, np.zeros(1), np.zeros(1)
    opened = _within(labels, level, resolution)
    opened[clearance == 0.0] = 0
    areas = np.bincount(opened.ravel(), minlength=count + 1).astype(np.float64) * resolution**2
    return labels, areas, _peaks(clearance, labels, count + 1)


def _peaks(clearance: FloatArray, labels: Labels, count: int) -> FloatArray:
    """Return (count,) maximum clearance of each label."""
    peaks = np.zeros(count)
    np.maximum.at(peaks, labels.ravel(), clearance.ravel())
    return peaks


def _within(labels: Labels, distance: float, resolution: float) -> Labels:
    """Return extended labels: each cell within the distance of labeled cells gets the nearest label."""
    away, nearest = distance_transform_edt(labels == 0, return_indices=True)
    grown: Labels = np.where(np.asarray(away) * resolution <= distance, labels[tuple(np.asarray(nearest))], 0)
    return grown


def _places_around(cores: Sequence[_Core], clearance: FloatArray, resolution: float) -> Labels:
    """Return the place of each cell: place i + 1 around core i, and further places for the floor between cores."""
    markers = np.zeros(clearance.shape, dtype=np.int32)
    opened = np.zeros(clearance.shape, dtype=np.bool_)
    for door in sorted({core.door for core in cores}):
        own = np.zeros(clearance.shape, dtype=np.int32)
        for number, core in enumerate(cores, start=1):
            if core.door == door:
                own.ravel()[core.cells] = number
        opened |= _within(own, door, resolution) > 0
        markers[own > 0] = own[own > 0]
    between, _ = label((clearance > PASSAGE) & ~opened, structure=_TOUCHING)
    markers[between > 0] = between[between > 0] + len(cores)
    return _flood(markers, clearance, resolution)


def _flood(markers: Labels, clearance: FloatArray, resolution: float) -> Labels:
    """Extend the markers over all floor, from high to low clearance. So they meet at the lowest clearance."""
    places = np.pad(markers, 1)
    height = np.pad(clearance, 1)
    highest = float(height[places == 0].max(initial=0.0))
    level = float(clearance.max())
    while level > 0.0:
        level = max(0.0, level - resolution / 2)
        if highest <= level:
            continue
        waiting = (height > level) & (places == 0)
        while waiting.any():
            rows, cols = np.nonzero(waiting)
            beside = np.stack(
                [places[rows - 1, cols], places[rows + 1, cols], places[rows, cols - 1], places[rows, cols + 1]]
            )
            reached = beside.max(axis=0)
            if not reached.any():
                break
            places[rows, cols] = reached
            waiting[rows, cols] = reached == 0
    flooded: Labels = places[1:-1, 1:-1]
    return flooded


def _rooms_among(
    places: Labels, cores: int, clearance: FloatArray, resolution: float, options: RoomFindingOptions
) -> list[int]:
    """Return the places around cores that are rooms. The other places are corridors."""
    borders, areas = _borders(places), np.bincount(places.ravel()) * resolution**2
    peaks = _peaks(clearance, places, len(areas))
    rooms = []
    for number in range(1, cores + 1):
        open_to = np.delete(borders[number], [0, number])
        doors = int(np.count_nonzero(open_to))
        is_open = open_to.sum() > OPEN * (open_to.sum() + borders[number, 0])
        is_long = (doors - 1) * areas[number] > LONG * (2 * peaks[number]) ** 2
        if areas[number] >= options.area and not is_open and not is_long:
            rooms.append(number)
    if len(rooms) > 1 and len(rooms) == len(areas) - 1:
        rooms.remove(max(rooms, key=lambda number: (np.count_nonzero(borders[number, 1:]), areas[number])))
    return rooms


def _with_alcoves(places: Labels, cores: int, resolution: float) -> Labels:
    """Assign each piece of floor between cores to a neighboring place if it is tiny or has only one neighbor."""
    while True:
        borders, areas = _borders(places), np.bincount(places.ravel()) * resolution**2
        renumbered = np.arange(len(areas), dtype=np.int32)
        for number in range(cores + 1, len(areas)):
            beside = borders[number].copy()
            beside[[0, number]] = 0
            if beside.any() and (np.count_nonzero(beside) == 1 or areas[number] < TINY):
                renumbered[number] = renumbered[beside.argmax()]
        kept, compact = np.unique(renumbered, return_inverse=True)
        places = compact.astype(np.int32)[places]
        if len(kept) == len(areas):
            return places


def _borders(places: Labels) -> NDArray[np.int64]:
    """Return (n + 1, n + 1) numbers of cell sides that two places share. Place 0 has all cells without floor."""
    size = int(places.max()) + 1
    padded = np.pad(places, 1).astype(np.int64)
    sides = np.zeros((size, size), dtype=np.int64)
    for one, other in ((padded[:-1], padded[1:]), (padded[:, :-1], padded[:, 1:])):
        sides += np.bincount((one * size + other).ravel(), minlength=size * size).reshape(size, size)
    return sides + sides.T
