"""Arenas made of found rooms: their outlines, goals and start poses."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, binary_fill_holes, label

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.traversability import (
    CrowdedFloor,
    Mask,
    Point,
    Polygon,
    TraversabilityMap,
    area,
    crosses_itself,
    inside,
)
from sim.numerics.float_array import FloatArray
from sim.robot.costmap.footprint import radii
from thbridge.files.map_files import FOOTPRINT, MapRoom
from thbridge.hunt.rooms import Room
from thbridge.offline.room_finding import Labels, drivable_floor

TOLERANCES = (0.2, 0.1, 0.05)
"""Meters that the outline of the cells may be away from that with fewer corners; the first that fits is taken."""
GAP = 2
"""Cells between rooms without a wall, where their outlines would be complicated without."""
SPARE = 0.1
"""Meters that goals and starts are farther from walls than they must be, where there is room."""
APART = 1.0
"""Meters from one start pose to the next."""
SKIPPED = 0.2
"""Meters from a place where no robot may stand to the next that is tried."""
NEARER = 20.0
"""Meters that a start pose may be farther from the middle for each meter that it is farther from a wall."""
MOST_TRIED = 400
"""Places tried for start poses before it is said that no more robots fit."""


_TOUCHING = np.ones((3, 3), dtype=np.bool_)


@dataclass(frozen=True, slots=True)
class Arena:
    """Rooms and start poses for a map.

    Attributes:
        rooms: the rooms in the order of their numbers.
        starts: start poses of robot 1, 2, ...; perhaps fewer than were wanted.
    """

    rooms: tuple[MapRoom, ...]
    starts: tuple[Pose2, ...]


def arena_of(
    grid: OccupancyGrid, labels: Labels, robots: int, names: Sequence[str] = (), footprint: Polygon = FOOTPRINT
) -> Arena:
    """Make an arena of found rooms.

    Args:
        grid: the map.
        labels: its rooms, as `find_rooms` gives them.
        robots: number of start poses wanted.
        names: names of the first rooms; the others are called "Room 3".
        footprint: corners of a robot in its own frame, meters.
    """
    inscribed, circumscribed = radii(np.array(footprint))
    floor = TraversabilityMap.of(grid, inscribed, circumscribed)
    reach = drivable_floor(grid, inscribed)
    # In gaps where they cannot turn with some room to spare, robots get stuck.
    easy = drivable_floor(grid, circumscribed + SPARE)
    rooms: list[MapRoom] = []
    for outline in room_outlines(labels, floor):
        own = reach & (floor.clearance > circumscribed) & cells_inside(outline, floor)
        goal = best_goal(floor, outline, own & easy if (own & easy).any() else own)
        if goal is not None:
            number = len(rooms) + 1
            name = names[number - 1] if number <= len(names) else f"Room {number}"
            rooms.append(MapRoom(Room(number), name, outline, goal))
    return Arena(tuple(rooms), start_poses(floor, reach, rooms, robots))


def cells_inside(outline: Polygon, floor: TraversabilityMap) -> Mask:
    """Cells whose centers an outline in the map frame holds."""
    held = np.zeros(floor.clearance.shape, dtype=np.bool_)
    box, mask = floor.held_by(outline)
    held[box] = mask
    return held


def best_goal(floor: TraversabilityMap, outline: Polygon, where: Mask) -> Pose2 | None:
    """The pose with the greatest clearance among these cells, the most central of equals; yaw 0.

    A cell whose center lies on the outline may be inside it, and its pose, which is rounded, outside: it is left out.

    Returns:
        None where there is no cell.
    """
    cells = np.argwhere(where)
    if not len(cells):
        return None
    clearance = floor.clearance[tuple(cells.T)]
    equal = np.minimum(clearance, clearance.max() - floor.grid.resolution / 2)
    central = np.hypot(*(cells - cells.mean(axis=0)).T)
    poses = (_pose_at(floor.grid, cells[index]) for index in np.lexsort((central, -equal)))
    return next((pose for pose in poses if inside(outline, np.array([pose.x]), np.array([pose.y]))[0]), None)


def _pose_at(grid: OccupancyGrid, cell: NDArray[np.int64]) -> Pose2:
    x, y = grid.centre_of(int(cell[0]), int(cell[1]))
    return Pose2(round(x, 3), round(y, 3), 0.0)


# Start poses ----------------------------------------------------------------------------------------------------------


def start_poses(floor: TraversabilityMap, reach: Mask, rooms: Sequence[MapRoom], robots: int) -> tuple[Pose2, ...]:
    """Start poses in the corridor, near the middle of the rooms; with all taken every robot still gets everywhere.

    Args:
        floor: the map for the robot's footprint.
        reach: cells that a robot's center reaches.
        rooms: their floor is used only when there is no corridor at all.
        robots: number of poses wanted.

    Returns:
        At most that many.
    """
    corridor = reach.copy()
    for room in rooms:
        corridor &= ~cells_inside(room.region, floor)
    roomy = floor.clearance > floor.circumscribed + floor.grid.resolution
    free = (corridor if (corridor & roomy).any() else reach) & roomy
    cells = np.argwhere(free)
    if not len(cells):
        return ()
    places = floor.grid.centres_of(cells)
    middle = np.mean([[room.goal.x, room.goal.y] for room in rooms] or places, axis=0)
    spare = np.minimum(floor.clearance[free] - floor.circumscribed, SPARE)
    nearest = np.argsort(np.hypot(*(places - middle).T) - NEARER * spare, kind="stable")
    chosen: list[Pose2] = []
    possible = np.ones(len(places), dtype=np.bool_)
    for _ in range(MOST_TRIED):
        waiting = nearest[possible[nearest]]
        if len(chosen) == robots or not len(waiting):
            break
        pose = _pose_at(floor.grid, cells[waiting[0]])
        taken = not _is_shut_in(floor, [*chosen, pose], rooms)
        if taken:
            chosen.append(pose)
        possible &= np.hypot(*(places - [pose.x, pose.y]).T) >= (APART if taken else SKIPPED)
    return tuple(chosen) or (_pose_at(floor.grid, cells[nearest[0]]),)


def _is_shut_in(floor: TraversabilityMap, starts: Sequence[Pose2], rooms: Sequence[MapRoom]) -> bool:
    """Return True when robots that stand at all starts part a room from another, or one of them from a room."""
    goals = [floor.grid.cell_of(room.goal.x, room.goal.y) for room in rooms]
    crowd = CrowdedFloor(floor, starts)
    return not crowd.are_connected(goals) or not all(all(crowd.reached(robot, goals)) for robot in range(len(starts)))


# Outlines -------------------------------------------------------------------------------------------------------------


def room_outlines(labels: Labels, floor: TraversabilityMap) -> list[Polygon]:
    """Outlines of all rooms in the map frame, with few corners and without overlaps, in the order of their numbers."""
    taken = np.zeros(labels.shape, dtype=np.bool_)
    outlines: list[Polygon] = []
    for number in range(1, int(labels.max()) + 1):
        outline = simple_outline(_filled(labels, number), taken, floor)
        if outline is not None:
            taken |= cells_inside(outline, floor)
            outlines.append(outline)
    return outlines


def simple_outline(mask: Mask, taken: Mask, floor: TraversabilityMap) -> Polygon | None:
    """An outline of the largest piece of a mask that holds no taken cell, with few corners; None without a piece."""
    grid = floor.grid
    apart = ~np.asarray(binary_dilation(taken, structure=_TOUCHING, iterations=GAP)) if taken.any() else ~taken
    piece = _largest(mask & ~taken)
    if not piece.any():
        return None
    # Beside a room without a wall between, a gap keeps the two outlines simple.
    for source in (piece, _largest(mask & apart)):
        exact = outline_of(source) if source.any() else []
        for tolerance in TOLERANCES if exact else ():
            outline = _placed(simplified(exact, tolerance / grid.resolution), grid)
            if _fits(outline, taken, floor):
                return outline
    return _placed(outline_of(piece), grid)


def _fits(outline: Polygon, taken: Mask, floor: TraversabilityMap) -> bool:
    simple = len(outline) >= 3 and area(outline) > 0.0 and not crosses_itself(outline)
    return simple and not (cells_inside(outline, floor) & taken).any()


def _placed(corners: Sequence[Point], grid: OccupancyGrid) -> Polygon:
    """Corners in cells as corners in the map frame, in whole millimeters."""
    placed = grid.origin.transform(np.array(corners) * grid.resolution)
    return tuple((round(float(x), 3), round(float(y), 3)) for x, y in placed)


def _filled(labels: Labels, number: int) -> Mask:
    """A room, and holes in it that belong to nobody."""
    room = _largest(labels == number)
    filled: Mask = np.asarray(binary_fill_holes(room)) & ((labels == 0) | room)
    return filled


def _largest(mask: Mask) -> Mask:
    """The largest connected piece."""
    pieces, count = label(mask)
    largest: Mask = (pieces == np.bincount(pieces[pieces > 0]).argmax()) if count else mask
    return largest


def outline_of(mask: Mask) -> list[Point]:
    """Corners (column, row) of the outer edge of connected cells, anticlockwise, from the lowest left one.

    Where two cells touch at a corner only the edge stays with its own cell, so it does not cross itself.
    """
    padded = np.pad(mask, 1)
    inner = padded[1:-1, 1:-1]
    following: dict[tuple[int, int], list[tuple[int, int]]] = {}
    # Each side of a cell that is no other cell's: where it begins and ends, seen from the cell's lower left corner.
    for beside, begin, end in (
        (padded[:-2, 1:-1], (0, 0), (1, 0)),
        (padded[1:-1, 2:], (1, 0), (1, 1)),
        (padded[2:, 1:-1], (1, 1), (0, 1)),
        (padded[1:-1, :-2], (0, 1), (0, 0)),
    ):
        for row, col in np.argwhere(inner & ~beside).tolist():
            here, there = (col + begin[0], row + begin[1]), (col + end[0], row + end[1])
            following.setdefault(here, []).append(there)
    first = min(following, key=lambda corner: (corner[1], corner[0]))
    corners, here, ahead = [first], first, (1, 0)
    while True:
        left = (here[0] - ahead[1], here[1] + ahead[0])
        there = left if left in following[here] else following[here][0]
        following[here].remove(there)
        turned = (there[0] - here[0], there[1] - here[1])
        if turned != ahead:
            corners.append(here)
        if there == first:
            break
        here, ahead = there, turned
    return [(float(x), float(y)) for x, y in corners]


def simplified(corners: Sequence[Point], tolerance: float) -> list[Point]:
    """A closed outline with fewer corners, none of those left out farther than the tolerance from it.

    Source: D. Douglas and T. Peucker, "Algorithms for the reduction of the number of points required to represent a
    digitized line", The Canadian Cartographer 10, 1973; the outline is cut at its first corner and the one farthest
    from that.
    """
    points = np.array(corners)
    far = int(np.hypot(*(points - points[0]).T).argmax())
    halves = points[: far + 1], np.concatenate([points[far:], points[:1]])
    kept = [_reduced(half, tolerance)[:-1] for half in halves]
    return [(float(x), float(y)) for x, y in np.concatenate(kept)]


def _reduced(line: FloatArray, tolerance: float) -> FloatArray:
    """An open line with fewer corners, its ends kept."""
    along = line[-1] - line[0]
    length = float(np.hypot(*along))
    offset = line - line[0]
    away = np.abs(along[0] * offset[:, 1] - along[1] * offset[:, 0]) / length if length else np.hypot(*offset.T)
    if len(line) < 3 or away.max() <= tolerance:
        return line[[0, -1]]
    index = int(away.argmax())
    return np.concatenate([_reduced(line[: index + 1], tolerance)[:-1], _reduced(line[index:], tolerance)])
