"""Construction of arenas from found rooms: outlines and goals of rooms, and start poses."""

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
"""Tolerances between the cells' outline and an outline with fewer corners, meters. The first suitable value is used."""
GAP = 2
"""Gap between rooms without a wall between them, cells. A gap is used only if it simplifies their outlines."""
SPARE = 0.1
"""Additional distance of goals and starts from walls, if there is enough space, meters."""
APART = 1.0
"""Distance between neighboring start poses, meters."""
SKIPPED = 0.2
"""Minimum distance between a rejected start position and the next candidate, meters."""
NEARER = 20.0
"""A start may be this much farther from the middle for each meter that it is farther from walls, meters."""
MOST_TRIED = 400
"""Maximum number of candidates for start poses. If they are not enough, the search returns fewer poses."""


_TOUCHING = np.ones((3, 3), dtype=np.bool_)


@dataclass(frozen=True, slots=True)
class Arena:
    """Rooms and start poses for a map.

    Attributes:
        rooms: the rooms, in the order of their numbers.
        starts: start poses of robot 1, 2, .... If there is not enough space, fewer than requested.
    """

    rooms: tuple[MapRoom, ...]
    starts: tuple[Pose2, ...]


def arena_of(
    grid: OccupancyGrid, labels: Labels, robots: int, names: Sequence[str] = (), footprint: Polygon = FOOTPRINT
) -> Arena:
    """Return the arena for found rooms.

    Args:
        grid: the map.
        labels: rooms of the map, from `find_rooms`.
        robots: number of start poses.
        names: names of the first rooms. Further rooms have names like "Room 3".
        footprint: corners of a robot in its own frame, meters.
    """
    inscribed, circumscribed = radii(np.array(footprint))
    floor = TraversabilityMap.of(grid, inscribed, circumscribed)
    reach = drivable_floor(grid, inscribed)
    # Robots get stuck in gaps where they can hardly turn.
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
    """Return the cells with centers inside an outline (map frame)."""
    held = np.zeros(floor.clearance.shape, dtype=np.bool_)
    box, mask = floor.held_by(outline)
    held[box] = mask
    return held


def best_goal(floor: TraversabilityMap, outline: Polygon, where: Mask) -> Pose2 | None:
    """Return the pose with the greatest clearance among the cells `where`, with yaw 0. None if there is no cell.

    If several cells have the same clearance, return the most central cell. Ignore a cell with its center on the
    outline, because the rounded pose might be outside.
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
    """Return start poses in the corridor, near the middle of the rooms. Robots there do not block each other's paths.

    Args:
        floor: the map for the robot's footprint.
        reach: cells that a robot's center can reach.
        rooms: rooms of the map. Their floor is used only if there is no corridor.
        robots: maximum number of poses.
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
    """Return True if robots at these starts would block the path between two rooms, or from a robot to a room."""
    goals = [floor.grid.cell_of(room.goal.x, room.goal.y) for room in rooms]
    crowd = CrowdedFloor(floor, starts)
    return not crowd.are_connected(goals) or not all(all(crowd.reached(robot, goals)) for robot in range(len(starts)))


# Outlines -------------------------------------------------------------------------------------------------------------


def room_outlines(labels: Labels, floor: TraversabilityMap) -> list[Polygon]:
    """Return the outlines of all rooms (map frame), in the order of the rooms' numbers.

    The outlines have few corners and do not overlap.
    """
    taken = np.zeros(labels.shape, dtype=np.bool_)
    outlines: list[Polygon] = []
    for number in range(1, int(labels.max()) + 1):
        outline = simple_outline(_filled(labels, number), taken, floor)
        if outline is not None:
            taken |= cells_inside(outline, floor)
            outlines.append(outline)
    return outlines


def simple_outline(mask: Mask, taken: Mask, floor: TraversabilityMap) -> Polygon | None:
    """Return an outline with few corners around the largest piece of a mask that is not taken; None if all is taken."""
    grid = floor.grid
    apart = ~np.asarray(binary_dilation(taken, structure=_TOUCHING, iterations=GAP)) if taken.any() else ~taken
    piece = _largest(mask & ~taken)
    if not piece.any():
        return None
    # If there is no wall between two rooms, a gap between them keeps both outlines simple.
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
    """Convert corners in cells to corners in the map frame, rounded to millimeters."""
    placed = grid.origin.transform(np.array(corners) * grid.resolution)
    return tuple((round(float(x), 3), round(float(y), 3)) for x, y in placed)


def _filled(labels: Labels, number: int) -> Mask:
    """Return the cells of a room, and the cells of holes in the room that belong to no room."""
    room = _largest(labels == number)
    filled: Mask = np.asarray(binary_fill_holes(room)) & ((labels == 0) | room)
    return filled


def _largest(mask: Mask) -> Mask:
    """Return the largest connected piece of a mask."""
    pieces, count = label(mask)
    largest: Mask = (pieces == np.bincount(pieces[pieces > 0]).argmax()) if count else mask
    return largest


def outline_of(mask: Mask) -> list[Point]:
    """Return the corners (column, row) of the outer edge of connected cells, counterclockwise.

    The list starts with the lowest left corner.

    If two cells touch only at a corner, the edge continues along the same cell. So the edge does not cross itself.
    """
    padded = np.pad(mask, 1)
    inner = padded[1:-1, 1:-1]
    following: dict[tuple[int, int], list[tuple[int, int]]] = {}
    # Sides between a cell of the mask and a cell outside it: start and end, relative to the inner cell's lower left
    # corner.
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
    """Return a closed outline with fewer corners. Removed corners are at most `tolerance` from the new outline.

    Source: D. Douglas and T. Peucker, "Algorithms for the reduction of the number of points required to represent a
    digitized line", The Canadian Cartographer 10, 1973. The outline is cut at its first corner and at the corner that
    is farthest from the first corner.
    """
    points = np.array(corners)
    far = int(np.hypot(*(points - points[0]).T).argmax())
    halves = points[: far + 1], np.concatenate([points[far:], points[:1]])
    kept = [_reduced(half, tolerance)[:-1] for half in halves]
    return [(float(x), float(y)) for x, y in np.concatenate(kept)]


def _reduced(line: FloatArray, tolerance: float) -> FloatArray:
    """Return an open line with fewer corners. Its ends do not change."""
    along = line[-1] - line[0]
    length = float(np.hypot(*along))
    offset = line - line[0]
    away = np.abs(along[0] * offset[:, 1] - along[1] * offset[:, 0]) / length if length else np.hypot(*offset.T)
    if len(line) < 3 or away.max() <= tolerance:
        return line[[0, -1]]
    index = int(away.argmax())
    return np.concatenate([_reduced(line[: index + 1], tolerance)[:-1], _reduced(line[index:], tolerance)])
