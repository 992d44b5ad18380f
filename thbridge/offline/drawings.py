"""Floor plans as architects draw them: lines and letters that are no walls, other scales, turned paper.

Doors are drawn shut, by an arc and a line; furniture, labels and dimensions are thin lines, too. Walls are thick, or
two lines with hatching between. So hatching is filled (closing), and what is thinner than walls is left out (opening).

Source: J. Serra, "Image Analysis and Mathematical Morphology", 1982 (opening and closing).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import find_objects, label, maximum_filter, minimum_filter, rotate

from sim.common.distance_fields import cells_away
from sim.common.grid import FREE, OCCUPIED, OccupancyGrid
from sim.common.traversability import Mask, Point
from thbridge.offline.room_finding import FURNITURE

WIDTHS = (2, 3, 4, 6, 8, 12)
"""Widths of lines that are tried in turn, pixels."""
REACHED = 0.9
"""Share of the floor that is reached from which on nothing is looked for that closes the rest."""
OPENED = 0.97
"""Share of the most floor that any width opens, from which on a width is enough."""
NEAR = 1.5
"""Meters within which pieces of lines block the same path."""

_TOUCHING = np.ones((3, 3), dtype=np.bool_)


@dataclass(frozen=True, slots=True, eq=False)
class CleanedDrawing:
    """A plan without its thin lines.

    Attributes:
        grid: what is left, with hatching filled.
        left_out: (rows, cols) cells of lines and letters that are not in it.
    """

    grid: OccupancyGrid
    left_out: Mask


@dataclass(frozen=True, slots=True)
class BlockedPaths:
    """Thin lines that keep a part of a plan's floor out of reach.

    Attributes:
        reached: share of the floor that is reached with them.
        thinner: pixels: lines thinner than this block the paths.
        places: where they do, map frame, the largest first.
    """

    reached: float
    thinner: int
    places: tuple[Point, ...]


def squared(pixels: NDArray[np.uint8], ratio: float) -> NDArray[np.uint8]:
    """Return an image whose pixels are `ratio` times as high as they are wide with square pixels of their width."""
    rows = max(round(len(pixels) * ratio), 1)
    return pixels[np.minimum((np.arange(rows) / ratio).astype(np.int64), len(pixels) - 1)]


def turned(pixels: NDArray[np.uint8], degrees: float) -> NDArray[np.uint8]:
    """Return a grey image turned counterclockwise, on paper of its brightest shade that holds all of it."""
    if degrees % 90.0 == 0.0:
        return np.rot90(pixels, round(degrees / 90.0))
    return np.asarray(rotate(pixels, degrees, order=1, mode="constant", cval=float(pixels.max())), dtype=np.uint8)


def without_thin_lines(grid: OccupancyGrid, thinner: int) -> CleanedDrawing:
    """Leave out lines and letters that are thinner than this, pixels; what is between lines so near is filled."""
    ink: Mask = grid.cells != FREE
    solid = ink & ~_loose(ink, thinner, FURNITURE / grid.resolution)
    across = 2 * thinner + 1
    filled: Mask = minimum_filter(maximum_filter(solid, across), across)
    kept: Mask = filled & maximum_filter(_opened(filled, thinner), 3)
    cells = np.where(kept, np.where(ink, grid.cells, OCCUPIED), FREE).astype(np.int8)
    return CleanedDrawing(OccupancyGrid(cells, grid.resolution, grid.origin), ink & ~kept)


def _opened(mask: Mask, width: int) -> Mask:
    """Cells over which a square of this width can be moved within a mask."""
    # An even square has no middle: what is eroded to one side is dilated to the other.
    opened: Mask = maximum_filter(minimum_filter(mask, width), width, origin=-((width + 1) % 2))
    return opened


def blocked_paths(grid: OccupancyGrid, inscribed: float) -> BlockedPaths | None:
    """Find the thin lines that keep floor out of reach; None where nearly all is reached, or it is not they.

    Args:
        grid: the plan.
        inscribed: radius of the robot's inner circle, metres.
    """
    areas, sizes = _floors_inside(grid, inscribed)
    reached = int(sizes.max())
    if reached >= REACHED * sizes.sum():
        return None
    cleaned = {width: without_thin_lines(grid, width) for width in WIDTHS}
    opened = {width: int(_floors_inside(one.grid, inscribed)[1].max()) for width, one in cleaned.items()}
    most = max(opened.values())
    if reached >= REACHED * most:
        return None
    width = next(width for width, floor in opened.items() if floor >= OPENED * most)
    places = _closing(grid, cleaned[width].left_out, areas, sizes, inscribed)
    return BlockedPaths(reached / max(int(sizes.sum()), 1), width, tuple(places))


def reached_floor(grid: OccupancyGrid, inscribed: float) -> float:
    """Share of the floor within a plan that is connected for a robot of this inner radius, metres; 0 without floor."""
    _, sizes = _floors_inside(grid, inscribed)
    return float(sizes.max() / max(int(sizes.sum()), 1))


def _loose(ink: Mask, thinner: int, extent: float) -> Mask:
    """Letters and small things of thin lines that touch no wall; strokes of letters may be as thick as thin walls."""
    things, _ = label(ink, structure=_TOUCHING)
    core = minimum_filter(ink, 2 * thinner)
    thick = np.zeros(int(things.max()) + 1, dtype=np.bool_)
    thick[np.unique(things[core])] = True
    loose = np.zeros(ink.shape, dtype=np.bool_)
    for number, box in enumerate(find_objects(things), start=1):
        if not thick[number] and max(side.stop - side.start for side in box) <= extent:
            loose[box] |= things[box] == number
    return loose


def _floors_inside(grid: OccupancyGrid, inscribed: float) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    """Numbers of connected floor that does not run off the image, from 1, and the cells of each; that of 0 counts 0."""
    labels, count = label(cells_away(grid.cells == FREE) * grid.resolution > inscribed)
    areas = np.asarray(labels, dtype=np.int32)
    margin = math.ceil(inscribed / grid.resolution) + 1
    border = np.ones(areas.shape, dtype=np.bool_)
    border[margin:-margin, margin:-margin] = False
    inside = np.ones(count + 1, dtype=np.bool_)
    inside[areas[border]] = False
    inside[0] = False
    areas = np.where(inside[areas], areas, 0).astype(np.int32)
    sizes = np.bincount(areas.ravel(), minlength=count + 1)
    sizes[0] = 0
    return areas, sizes


def _closing(
    grid: OccupancyGrid, thin: Mask, areas: NDArray[np.int32], sizes: NDArray[np.int64], inscribed: float
) -> list[Point]:
    """Places of thin lines between floor and other floor, those between the largest first."""
    lines, _ = label(thin, structure=_TOUCHING)
    reach = math.ceil(inscribed / grid.resolution) + 2
    found: list[tuple[int, Point]] = []
    for number, box in enumerate(find_objects(lines), start=1):
        around = tuple(slice(max(side.start - reach, 0), side.stop + reach) for side in box)
        near = cells_away(lines[around] != number) <= reach
        beside = np.setdiff1d(np.unique(areas[around][near]), [0])
        if len(beside) > 1:
            row, col = (int((side.start + side.stop) // 2) for side in box)
            found.append((int(np.sort(sizes[beside])[-2]), grid.centre_of(row, col)))
    apart: list[Point] = []
    for _, (x, y) in sorted(found, key=lambda one: -one[0]):
        if all(abs(x - other_x) + abs(y - other_y) > NEAR for other_x, other_y in apart):
            apart.append((x, y))
    return apart
