"""Floor plan as shapes for the map in a browser."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thbridge.roles.shared.notices import FloorPlan
from ui.model.shared.map_geometry import UNKNOWN, WALL, unpack


@dataclass(frozen=True, slots=True)
class FloorRoom:
    """Room on the map: its number, its name, and x, y, x, y, ... of its corners in centimeters."""

    room: int
    name: str
    corners: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class FloorShapes:
    """Shapes of a floor plan; lengths are centimeters in the map frame, paths are SVG in units of cells.

    Attributes:
        box: smallest x, smallest y, greatest x, greatest y of the known floor.
        origin: x, y of the lower left corner of the cells, and the angle of their rows in thousandths of a radian.
        resolution: size of a cell.
        walls: outline of all walls as an SVG path, y upward; to be filled by the rule `evenodd`.
        unknown: outline of all unknown cells.
        rooms: the rooms.
        footprint: x, y, x, y, ... of the corners of a robot's body in its own frame.
    """

    box: tuple[int, int, int, int]
    origin: tuple[int, int, int]
    resolution: float
    walls: str
    unknown: str
    rooms: tuple[FloorRoom, ...]
    footprint: tuple[int, ...]


def floor_shapes(plan: FloorPlan) -> FloorShapes:
    """Return the shapes of a floor plan."""
    geometry = unpack(plan)
    left, bottom, right, top = (round(100.0 * edge) for edge in geometry.bounds)
    origin = geometry.origin
    return FloorShapes(
        box=(left, bottom, right, top),
        origin=(round(100.0 * origin.x), round(100.0 * origin.y), round(1000.0 * origin.theta)),
        resolution=100.0 * geometry.resolution,
        walls=outline(geometry.cells == WALL),
        unknown=outline(geometry.cells == UNKNOWN),
        rooms=tuple(FloorRoom(room.room, room.name, _centimeters(room.region)) for room in plan.rooms),
        footprint=_centimeters(plan.footprint),
    )


def outline(inside: NDArray[np.bool_]) -> str:
    """Return the outline of the True cells of a (rows, cols) grid as an SVG path, in units of cells, from the corner of
    cell [0, 0].

    Each edge between a True and a False cell belongs to one closed loop. An edge has the True cell on its left. Runs of
    edges in the same direction become one line.
    """
    padded = np.pad(inside, 1)
    # Edges by their start: corner (x, y) -> direction; a corner where two diagonal cells meet has two edges.
    edges: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for step, here, beyond, start in (
        ((1, 0), padded[1:, :], padded[:-1, :], (0, 0)),
        ((-1, 0), padded[:-1, :], padded[1:, :], (1, 0)),
        ((0, 1), padded[:, :-1], padded[:, 1:], (0, 0)),
        ((0, -1), padded[:, 1:], padded[:, :-1], (0, 1)),
    ):
        rows, cols = np.nonzero(here & ~beyond)
        for row, col in zip(rows.tolist(), cols.tolist(), strict=True):
            # `row`, `col` count padded cells, so the corner of cell [0, 0] is at 1 without the padding.
            x = col - 1 + start[0] if step[1] == 0 else col
            y = row if step[1] == 0 else row - 1 + start[1]
            edges.setdefault((x, y), []).append(step)
    parts: list[str] = []
    while edges:
        first = next(iter(edges))
        parts.append(_loop(edges, first))
    return "".join(parts)


def _loop(edges: dict[tuple[int, int], list[tuple[int, int]]], first: tuple[int, int]) -> str:
    """Remove one closed loop from the edges and return its path."""
    x, y = first
    path, last = [f"M{x} {y}"], (0, 0)
    while True:
        steps = edges[x, y]
        # At a corner of two diagonal cells, turn left, so that each loop surrounds one of the cells.
        step = max(steps, key=lambda each: last[0] * each[1] - last[1] * each[0])
        steps.remove(step)
        if not steps:
            del edges[x, y]
        x, y = x + step[0], y + step[1]
        letter, place = ("H", x) if step[1] == 0 else ("V", y)
        if step == last:
            path[-1] = f"{letter}{place}"
        else:
            path.append(f"{letter}{place}")
        last = step
        if (x, y) == first:
            return "".join(path) + "Z"


def _centimeters(points: tuple[tuple[float, float], ...]) -> tuple[int, ...]:
    return tuple(round(100.0 * number) for point in points for number in point)
