"""Draw the maps that come with the project: `maps/arena8`, `maps/warehouse12`, `maps/office` and `maps/practice`.

Run this script from the project's folder: `.venv/bin/python scripts/draw/maps.py`. The same drawing gives the same
bytes, so `git diff` shows the effect of a changed wall. `--resolution` sets the size of cells, and `--into` the output
folder.

If a map has no measured travel costs, they are estimated, in seconds, as

    length / SPEED + turned / TURN_RATE

over the shortest path between two goals that keeps a robot's clearance. `length` is in meters. `turned` is the sum of
the angles, radians, by which a robot turns at its start, at every corner and at its goal. The robot leaves and reaches
every goal at the goal's heading. The constants are rounded from the least-squares fit of this formula to the matrix
measured in 2016 on arena8 (1.01 m/s and 0.78 rad/s). With the rounded constants, the error is 2.4 s root mean square,
and at most 5.2 s.
"""

import argparse
import itertools
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from sim.common.geometry import Pose2
from sim.common.grid import FREE, OCCUPIED, OccupancyGrid
from sim.numerics.elementary import wrap_angle
from thbridge.files.grid_files import write_grid
from thbridge.files.map_files import FOOTPRINT, read_map
from thbridge.files.yaml.tree import quoted

Point = tuple[float, float]
Segment = tuple[float, float, float, float]

WALL = 0.12
"""Thickness of a wall, meters."""
CLEARANCE = 0.4
"""Smallest distance of a robot's center from walls on a path, meters: the farthest corner of the footprint, and a
margin."""
SPEED = 1.0
"""Speed in meters per second."""
TURN_RATE = 0.8
"""Turn rate in radians per second."""


@dataclass(frozen=True)
class RoomPlan:
    """Room with its corners and the robots' goal, in the map frame, meters. Two corners are those of a box."""

    name: str
    region: tuple[Point, ...]
    goal: tuple[float, float, float]


@dataclass(frozen=True)
class MapPlan:
    """Map to draw.

    Attributes:
        name: name of the map's folder.
        origin: lower left corner, meters.
        size: width and height, meters.
        walls: center lines of the inner walls, (x0, y0, x1, y1); the outer box is added.
        cabinets: boxes of furniture, two opposite corners each, (x0, y0, x1, y1).
        rooms: rooms, starting with room 1.
        poses: start poses of the first robots.
        rows: lines along which more robots start, one meter apart.
        estimate_costs: True to write a `mapTimes` of estimated travel costs.
    """

    name: str
    origin: Point
    size: Point
    walls: tuple[Segment, ...]
    rooms: tuple[RoomPlan, ...]
    poses: tuple[tuple[float, float, float], ...]
    rows: tuple[tuple[Point, Point], ...]
    estimate_costs: bool
    cabinets: tuple[Segment, ...] = ()


def vertical(x: float, y0: float, y1: float) -> Segment:
    """Return a wall along y."""
    return (x, y0, x, y1)


def horizontal(y: float, x0: float, x1: float) -> Segment:
    """Return a wall along x."""
    return (x0, y, x1, y)


ARENA8 = MapPlan(
    name="arena8",
    origin=(-5.0, -5.0),
    size=(16.0, 12.0),
    walls=(
        vertical(5, 3, 7),
        horizontal(3, -5, -1),
        vertical(-1, 3, 5),
        vertical(1, 3, 5),
        horizontal(3, 1, 5),
        vertical(7, 3, 5),
        horizontal(3, 7, 11),
        vertical(-1, -3, 1),
        horizontal(-1, -5, -1),
        horizontal(-1, 1, 5),
        vertical(1, -3, -1),
        vertical(5, -5, -1),
        vertical(7, -3, 1),
        horizontal(-1, 7, 11),
    ),
    rooms=(
        RoomPlan("North west", ((-5, 3), (-1, 7)), (-2.671, 4.692, 0.0)),
        RoomPlan("West", ((-5, -1), (-1, 3)), (-2.735, 1.442, 0.0)),
        RoomPlan("South west", ((-5, -5), (-1, -1)), (-2.869, -2.970, 0.0)),
        RoomPlan("North middle", ((1, 3), (5, 7)), (3.110, 4.857, 0.0)),
        RoomPlan("South middle", ((1, -5), (5, -1)), (2.612, -2.758, 0.0)),
        RoomPlan("North east", ((7, 3), (11, 7)), (8.744, 5.440, 0.0)),
        RoomPlan("East", ((7, -1), (11, 3)), (9.002, 1.457, 0.0)),
        RoomPlan("South east", ((7, -5), (11, -1)), (9.084, -2.518, 0.0)),
    ),
    poses=((0.0, 0.0, 0.0),),
    rows=(
        ((1.5, 2.45), (4.5, 2.45)),
        ((1.5, -0.45), (4.5, -0.45)),
        ((5.55, 3.6), (5.55, 4.6)),
        ((5.55, -1.6), (5.55, -2.6)),
        ((-0.45, 3.6), (-0.45, 4.6)),
    ),
    estimate_costs=False,
)

WAREHOUSE12 = MapPlan(
    name="warehouse12",
    origin=(-3.4, -7.15),
    size=(22.0, 14.0),
    walls=(
        # South of the aisle from west to east; gaps are doors.
        horizontal(-1.15, -3.4, 0.8),
        horizontal(-1.15, 3.0, 4.5),
        horizontal(-1.15, 6.1, 9.2),
        horizontal(-1.15, 10.7, 11.7),
        horizontal(-1.15, 13.9, 18.6),
        vertical(0.8, -7.15, -6.25),
        vertical(0.8, -4.75, -3.15),
        vertical(0.8, -1.75, -1.15),
        horizontal(-4.05, -3.4, 0.8),
        vertical(3.0, -7.15, -1.15),
        (6.4, -7.15, 8.0, -1.15),
        vertical(11.7, -7.15, -1.15),
        vertical(13.9, -7.15, -6.45),
        vertical(13.9, -4.85, -3.25),
        vertical(13.9, -1.95, -1.15),
        horizontal(-3.85, 13.9, 18.6),
        # North of the aisle.
        horizontal(1.15, -3.4, -1.9),
        horizontal(1.15, 0.1, 3.2),
        horizontal(1.15, 4.6, 6.2),
        horizontal(1.15, 8.4, 13.0),
        horizontal(1.15, 15.2, 18.6),
        vertical(1.8, 1.15, 4.75),
        horizontal(4.75, 0.2, 1.8),
        vertical(0.2, 4.75, 6.85),
        vertical(6.2, 1.15, 6.85),
        vertical(8.4, 1.15, 1.75),
        vertical(8.4, 3.0, 4.75),
        vertical(8.4, 6.15, 6.85),
        horizontal(3.85, 8.4, 13.0),
        vertical(13.0, 1.15, 6.85),
        vertical(15.2, 1.15, 1.85),
        vertical(15.2, 3.25, 4.95),
        vertical(15.2, 6.35, 6.85),
        horizontal(4.25, 15.2, 18.6),
    ),
    rooms=(
        RoomPlan("Tool store", ((-3.4, -4.05), (0.8, -1.15)), (-1.2, -2.5, 0.0)),
        RoomPlan("Battery store", ((-3.4, -7.15), (0.8, -4.05)), (-1.5, -5.6, 0.0)),
        RoomPlan("Paint shop", ((3.0, -7.15), (6.4, -7.15), (8.0, -1.15), (3.0, -1.15)), (4.9, -4.4, 0.0)),
        RoomPlan("Packing", ((6.4, -7.15), (11.7, -7.15), (11.7, -1.15), (8.0, -1.15)), (9.6, -3.9, 0.0)),
        RoomPlan("Returns", ((13.9, -3.85), (18.6, -1.15)), (16.2, -2.5, 0.0)),
        RoomPlan("Archive", ((13.9, -7.15), (18.6, -3.85)), (16.4, -5.5, 0.0)),
        RoomPlan(
            "Workshop",
            ((-3.4, 1.15), (1.8, 1.15), (1.8, 4.75), (0.2, 4.75), (0.2, 6.85), (-3.4, 6.85)),
            (-1.6, 3.9, 0.0),
        ),
        RoomPlan(
            "Steel store",
            ((1.8, 1.15), (6.2, 1.15), (6.2, 6.85), (0.2, 6.85), (0.2, 4.75), (1.8, 4.75)),
            (3.7, 4.6, 0.0),
        ),
        RoomPlan("Canteen", ((8.4, 3.85), (13.0, 6.85)), (10.4, 5.35, 0.0)),
        RoomPlan("Office", ((8.4, 1.15), (13.0, 3.85)), (10.7, 2.45, 0.0)),
        RoomPlan("Loading bay", ((15.2, 1.15), (18.6, 4.25)), (16.8, 2.65, 0.0)),
        RoomPlan("Cold store", ((15.2, 4.25), (18.6, 6.85)), (16.8, 5.55, 0.0)),
    ),
    poses=((0.6, 0.6, 0.0),),
    rows=(
        ((1.6, 0.6), (2.6, 0.6)),
        ((5.1, 0.6), (6.1, 0.6)),
        ((8.9, 0.6), (12.9, 0.6)),
        ((15.7, 0.6), (17.7, 0.6)),
        ((-2.8, 0.6), (-2.8, 0.6)),
        ((6.8, 2.6), (6.8, 5.6)),
        ((13.6, 2.6), (13.6, 5.6)),
    ),
    estimate_costs=True,
)

PRACTICE = MapPlan(
    name="practice",
    origin=(-4.5, -2.0),
    size=(9.0, 7.0),
    walls=(
        horizontal(1.4, -4.5, -2.8),
        horizontal(1.4, -1.2, 1.2),
        horizontal(1.4, 2.8, 4.5),
        vertical(0, 1.4, 5),
    ),
    rooms=(
        RoomPlan("Left room", ((-4.5, 1.4), (0, 5)), (-2.2, 3.4, 0.0)),
        RoomPlan("Right room", ((0, 1.4), (4.5, 5)), (2.2, 3.4, 0.0)),
    ),
    poses=((0.0, -0.4, 0.0),),
    rows=(((-3.0, -0.4), (-2.0, -0.4)), ((2.0, -0.4), (3.0, -0.4))),
    estimate_costs=True,
)

OFFICE = MapPlan(
    name="office",
    origin=(-2.0, -7.0),
    size=(26.0, 14.0),
    walls=(
        # A wall extends half its thickness beyond its ends: these gaps of 1.22 m are doors of 1.1 m.
        horizontal(1, -2, 0.39),
        horizontal(1, 1.61, 7.89),
        horizontal(1, 9.11, 11.89),
        horizontal(1, 13.11, 20.39),
        horizontal(1, 21.61, 24),
        vertical(4, 1, 7),
        vertical(11, 1, 7),
        vertical(17, 1, 4.39),
        vertical(17, 5.61, 7),
        horizontal(-1, -2, 2.39),
        horizontal(-1, 3.61, 5.89),
        horizontal(-1, 7.11, 14.39),
        horizontal(-1, 15.61, 19.39),
        horizontal(-1, 20.61, 24),
        vertical(5, -4.39, -1),
        vertical(5, -7, -5.61),
        vertical(11, -7, -1),
        vertical(18, -7, -1),
    ),
    cabinets=(
        (-1.95, 6.45, 0.6, 6.95),
        (3.45, 2.2, 3.95, 4.0),
        (5.6, 3.4, 7.2, 4.6),
        (8.0, 6.5, 10.0, 6.95),
        (12.0, 2.8, 13.2, 3.3),
        (15.0, 5.2, 16.0, 6.95),
        (19.0, 3.6, 20.6, 4.4),
        (23.45, 1.8, 23.95, 5.0),
        (-1.95, -4.4, -0.6, -3.8),
        (1.2, -6.95, 2.8, -6.4),
        (7.6, -4.6, 9.0, -3.4),
        (11.05, -3.6, 11.5, -1.4),
        (13.4, -5.4, 14.8, -4.6),
        (17.5, -3.0, 17.95, -1.6),
        (20.6, -3.4, 22.0, -2.6),
        (23.4, -6.95, 23.95, -5.4),
        (9.6, 0.6, 11.2, 0.95),
        (17.4, -0.95, 18.6, -0.6),
    ),
    rooms=(
        RoomPlan("Reception", ((-2, 1), (4, 7)), (0.2, 4.9, 0.0)),
        RoomPlan("Library", ((4, 1), (11, 7)), (8.6, 5.2, 0.0)),
        RoomPlan("Meeting room", ((11, 1), (17, 7)), (13.4, 5.4, 0.0)),
        RoomPlan("Kitchen", ((17, 1), (24, 7)), (21.6, 4.0, 0.0)),
        RoomPlan("Studio", ((18, -7), (24, -1)), (21.0, -5.0, 0.0)),
        RoomPlan("Laboratory", ((11, -7), (18, -1)), (16.2, -4.6, 0.0)),
        RoomPlan("Server room", ((5, -7), (11, -1)), (9.6, -5.6, 0.0)),
        RoomPlan("Archive", ((-2, -7), (5, -1)), (0.4, -5.0, 0.0)),
    ),
    poses=((0.0, 0.0, 0.0),),
    rows=(
        ((-1.3, 0.4), (-1.3, 0.4)),
        ((4.6, 0.4), (6.6, 0.4)),
        ((10.0, -0.4), (13.0, -0.4)),
        ((15.0, 0.4), (19.0, 0.4)),
    ),
    estimate_costs=True,
)


def draw(plan: MapPlan, resolution: float) -> OccupancyGrid:
    """Draw the grid of a plan. A cell is part of a wall if its center is inside the wall."""
    cols, rows = (round(side / resolution) for side in plan.size)
    x = plan.origin[0] + (np.arange(cols) + 0.5) * resolution
    y = (plan.origin[1] + (np.arange(rows) + 0.5) * resolution)[:, np.newaxis]
    left, bottom = plan.origin
    right, top = left + plan.size[0], bottom + plan.size[1]
    box = (
        horizontal(bottom, left, right),
        horizontal(top, left, right),
        vertical(left, bottom, top),
        vertical(right, bottom, top),
    )
    cells = np.full((rows, cols), FREE, dtype=np.int8)
    for x0, y0, x1, y1 in box + plan.walls:
        length = math.hypot(x1 - x0, y1 - y0)
        along = ((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / length
        across = ((y - y0) * (x1 - x0) - (x - x0) * (y1 - y0)) / length
        # A wall extends half its thickness beyond its ends, so that corners are closed.
        wall = (np.abs(across) <= WALL / 2) & (along >= -WALL / 2) & (along <= length + WALL / 2)
        cells[wall] = OCCUPIED
    for x0, y0, x1, y1 in plan.cabinets:
        cells[(x >= x0) & (x <= x1) & (y >= y0) & (y <= y1)] = OCCUPIED
    return OccupancyGrid(cells, resolution, Pose2(left, bottom, 0.0))


def rooms_yaml(plan: MapPlan) -> str:
    """Return the text of `rooms.yaml`."""

    def points(corners: tuple[tuple[float, ...], ...]) -> str:
        return ", ".join(f"[{', '.join(f'{float(number)!r}' for number in corner)}]" for corner in corners)

    lines = [
        "# Meters and radians in the map frame. region: two opposite corners of a box, or all corners in order.",
        "# goal and poses: x, y, yaw. Robots beyond the number of poses start along the rows, one every `spacing`.",
        "language: en",
        "rooms:",
    ]
    for number, room in enumerate(plan.rooms, start=1):
        lines += [
            f"  - number: {number}",
            f"    name: {quoted(room.name)}",
            f"    region: [{points(room.region)}]",
            f"    goal: {points((room.goal,))}",
        ]
    lines += ["starts:", f"  poses: [{points(plan.poses)}]", "  rows:"]
    lines += [f"    - [{points(row)}]" for row in plan.rows]
    lines += ["  spacing: 1.0", "  yaw: 0.0"]
    return "\n".join(lines) + "\n"


@dataclass(frozen=True)
class PathLength:
    """Length of a path between two poses: meters driven and radians turned."""

    length: float
    turned: float


def path_lengths(grid: OccupancyGrid, places: list[Pose2]) -> dict[tuple[int, int], PathLength]:
    """Measure the shortest paths between all places. Paths go to the eight neighbors of a cell, and are straightened.

    A path over a grid turns only by multiples of 45 degrees, and is up to 8 % too long. Therefore corners are removed
    if a straight line can skip them.
    """
    walls = np.pad(grid.cells != OCCUPIED, 1, constant_values=False)
    clearance = np.asarray(distance_transform_edt(walls))[1:-1, 1:-1] * grid.resolution
    passable = clearance > CLEARANCE
    index = np.arange(passable.size).reshape(passable.shape)
    rows, cols = passable.shape
    starts, ends, lengths = [], [], []
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        here = (slice(0, rows - down), slice(max(0, -right), cols - max(0, right)))
        there = (slice(down, rows), slice(max(0, right), cols - max(0, -right)))
        both = passable[here] & passable[there]
        starts.append(index[here][both])
        ends.append(index[there][both])
        lengths.append(np.full(both.sum(), math.hypot(down, right) * grid.resolution))
    edges = (np.concatenate(lengths), (np.concatenate(starts), np.concatenate(ends)))
    graph = coo_array(edges, shape=(passable.size, passable.size)).tocsr()
    nodes = [int(index[grid.cell_of(place.x, place.y)]) for place in places]
    _, before = dijkstra(graph, directed=False, indices=nodes, return_predecessors=True)
    found = {}
    for (first, start), (second, goal) in itertools.permutations(enumerate(places), 2):
        cells = [nodes[second]]
        while cells[-1] != nodes[first]:
            cells.append(int(before[first, cells[-1]]))
        path = [grid.centre_of(*divmod(cell, cols)) for cell in reversed(cells)]
        corners = taut(grid, passable, [(start.x, start.y), *path[1:-1], (goal.x, goal.y)])
        found[first, second] = measure(corners, start.theta, goal.theta)
    return found


def taut(grid: OccupancyGrid, passable: NDArray[np.bool_], path: list[Point]) -> list[Point]:
    """Return a path without the corners that a straight line can skip."""

    def straight(a: Point, b: Point) -> bool:
        steps = max(2, math.ceil(math.dist(a, b) / grid.resolution * 2))
        share = np.linspace(0, 1, steps)[:, np.newaxis]
        cells = grid.cells_of(np.array(a) * (1 - share) + np.array(b) * share)
        return bool(passable[cells[:, 0], cells[:, 1]].all())

    corners = [path[0]]
    here = 0
    while here < len(path) - 1:
        here = next(
            there for there in range(len(path) - 1, here, -1) if there == here + 1 or straight(path[here], path[there])
        )
        corners.append(path[here])
    return corners


def measure(corners: list[Point], start: float, goal: float) -> PathLength:
    """Return the length of a path, and the sum of the angles turned on it, from one heading to another."""
    headings = [math.atan2(y1 - y0, x1 - x0) for (x0, y0), (x1, y1) in itertools.pairwise(corners)]
    turned = sum(abs(wrap_angle(b - a)) for a, b in itertools.pairwise([start, *headings, goal]))
    return PathLength(sum(math.dist(a, b) for a, b in itertools.pairwise(corners)), turned)


def map_times(grid: OccupancyGrid, places: list[Pose2]) -> str:
    """Return the text of `mapTimes`: one row per start place, one column per destination.

    The first place is the corridor, which is the start of robot 1; the rooms follow.
    """
    found = path_lengths(grid, places)
    lines = [str(len(places))]
    for start in range(len(places)):
        row = []
        for goal in range(len(places)):
            path = found.get((start, goal))
            # No robot is sent to the corridor; the format uses 99 for its column. Therefore no cost may be 99.
            moves = path is not None and goal != 0
            row.append(str(min(98, round(path.length / SPEED + path.turned / TURN_RATE))) if moves and path else "99")
        lines.append(" ".join(row))
    return "\n".join(lines) + "\n"


def write(plan: MapPlan, folder: Path, resolution: float) -> None:
    """Draw one map, write its files, and print a summary."""
    write_grid(folder, draw(plan, resolution))
    (folder / "rooms.yaml").write_text(rooms_yaml(plan), encoding="utf-8")
    drawn = read_map(folder, FOOTPRINT)
    if plan.estimate_costs:
        places = [drawn.starts[0], *(room.goal for room in drawn.rooms)]
        (folder / "mapTimes").write_text(map_times(drawn.grid, places), encoding="ascii")
    size = f"{drawn.grid.cols} x {drawn.grid.rows} cells"
    print(f"{folder}: {size}, {len(drawn.rooms)} rooms, {len(drawn.starts)} starts")


def main() -> None:
    """Draw all maps."""
    parser = argparse.ArgumentParser(description="Draw the maps that come with the project.")
    parser.add_argument("--resolution", type=float, default=0.05, help="side of a cell, meters")
    parser.add_argument("--into", type=Path, default=Path("maps"), help="folder of the map folders")
    arguments = parser.parse_args()
    for plan in (ARENA8, WAREHOUSE12, OFFICE, PRACTICE):
        write(plan, arguments.into / plan.name, arguments.resolution)


if __name__ == "__main__":
    main()
