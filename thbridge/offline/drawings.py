"""Cleaning of architects' floor plans: removal of thin lines and letters that are not walls, scaling, rotation.

Plans show a door as an arc and a line, so all doors look closed. Furniture, labels and dimensions are thin lines, too.
Walls are thick lines, or two lines with hatching between them. So the hatching is filled (morphological closing), and
lines thinner than walls are removed (morphological opening).

Source: J. Serra, "Image Analysis and Mathematical Morphology", 1982 (opening and closing).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, find_objects, label, maximum_filter, minimum_filter, rotate

from sim.common.distance_fields import cells_away
from sim.common.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from sim.common.traversability import Mask, Point
from thbridge.offline.room_finding import FURNITURE, SPECK

WIDTHS = (2, 3, 4, 6, 8, 12)
"""Tested line widths, in this order, pixels."""
REACHED = 0.9
"""If at least this share of the floor is reached, the search for blocking lines is skipped."""
OPENED = 0.97
"""Share of the largest connected floor that any line width gives.

If no width connects nearly all floor, the first width that reaches this share is used.
"""
WALLED = 0.8
"""Share of the largest floor inside that any line width gives. A width with a smaller share also removes walls."""
CUSP = 4
"""Maximum extent of filled spots between thin lines that are not walls, as a multiple of the line width."""
OPENING = 2.5
"""Maximum width of an opening to the outside that is an entrance or a window, meters."""
PAPER = 0.9
"""If at least this share of the pixels on an image's border is blank, there is paper around the plan."""
GAINED = 1.1
"""A building counts as open if closed openings increase the floor inside by more than this factor."""
ROOM = 3.0
"""Minimum area of unreachable floor that is reported, square meters."""
NEAR = 1.5
"""Two pieces of lines count as blocking the same path if their distance is below this, meters."""

_TOUCHING = np.ones((3, 3), dtype=np.bool_)


@dataclass(frozen=True, slots=True, eq=False)
class CleanedDrawing:
    """A plan without its thin lines.

    Attributes:
        grid: the plan without thin lines, and with filled hatching.
        left_out: (rows, cols) cells of removed lines and letters.
    """

    grid: OccupancyGrid
    left_out: Mask


@dataclass(frozen=True, slots=True)
class BlockedPaths:
    """Thin lines that block the access to parts of a plan's floor.

    Attributes:
        reached: share of the floor that robots can reach with these lines.
        thinner: the blocking lines are thinner than this number of pixels.
        places: places where lines block paths, map frame. Places between the largest pieces of floor come first.
    """

    reached: float
    thinner: int
    places: tuple[Point, ...]


def squared(pixels: NDArray[np.uint8], ratio: float) -> NDArray[np.uint8]:
    """Return an image with square pixels. In the given image, the height of a pixel is `ratio` times its width."""
    rows = max(round(len(pixels) * ratio), 1)
    return pixels[np.minimum((np.arange(rows) / ratio).astype(np.int64), len(pixels) - 1)]


def joined(pixels: NDArray[np.uint8], factor: int) -> NDArray[np.uint8]:
    """Return a smaller gray image. Each pixel is the mean of `factor` x `factor` pixels. White is added at edges."""
    rows, cols = (-(-side // factor) * factor for side in pixels.shape)
    whole = np.pad(pixels, ((0, rows - len(pixels)), (0, cols - pixels.shape[1])), constant_values=pixels.max())
    means = whole.reshape(rows // factor, factor, cols // factor, factor).mean(axis=(1, 3))
    return np.asarray(np.rint(means), dtype=np.uint8)


def turned(pixels: NDArray[np.uint8], degrees: float) -> NDArray[np.uint8]:
    """Return a gray image rotated counterclockwise. New pixels at its edges get the brightest shade of the image."""
    if degrees % 90.0 == 0.0:
        return np.rot90(pixels, round(degrees / 90.0))
    return np.asarray(rotate(pixels, degrees, order=1, mode="constant", cval=float(pixels.max())), dtype=np.uint8)


def without_thin_lines(grid: OccupancyGrid, thinner: int) -> CleanedDrawing:
    """Remove lines and letters thinner than `thinner` pixels. Fill gaps between lines up to this width.

    Also remove filled spots where two lines meet, for example the arcs of a double door.
    """
    ink: Mask = grid.cells != FREE
    # Strokes of letters may be as thick as thin walls. So remove small things first.
    solid = ink & ~_small_things(ink, minimum_filter(ink, 2 * thinner), FURNITURE / grid.resolution)
    across = 2 * thinner + 1
    filled: Mask = minimum_filter(maximum_filter(solid, across), across)
    kept: Mask = filled & maximum_filter(_opened(filled, thinner), 3)
    kept &= ~_small_things(kept, _opened(ink, thinner), CUSP * thinner)
    cells = np.where(kept, np.where(ink, grid.cells, OCCUPIED), FREE).astype(np.int8)
    return CleanedDrawing(OccupancyGrid(cells, grid.resolution, grid.origin), ink & ~kept)


def _opened(mask: Mask, width: int) -> Mask:
    """Return the cells of a mask that a square of this width can cover without leaving the mask."""
    # A square with an even width has no middle cell. So the erosion is shifted to one side, and the dilation must be
    # shifted to the other side.
    opened: Mask = maximum_filter(minimum_filter(mask, width), width, origin=-((width + 1) % 2))
    return opened


def blocked_paths(grid: OccupancyGrid, inscribed: float) -> BlockedPaths | None:
    """Find thin lines that block floor. None if nearly all floor is reached, or if thin lines are not the cause.

    Args:
        grid: the plan.
        inscribed: radius of the robot's inner circle, meters.
    """
    areas, sizes = _closed_floors(grid, inscribed)
    reached = int(sizes.max())
    if reached >= REACHED * sizes.sum():
        return None
    cleaned = {width: without_thin_lines(grid, width) for width in WIDTHS}
    floors = {width: _closed_floors(one.grid, inscribed)[1] for width, one in cleaned.items()}
    most = max(int(floor.max()) for floor in floors.values())
    if reached >= REACHED * most:
        return None
    whole = max(int(floor.sum()) for floor in floors.values())
    opened = [width for width, floor in floors.items() if floor.max() >= max(REACHED * floor.sum(), WALLED * whole)]
    width = next(iter(opened), None) or next(width for width, floor in floors.items() if floor.max() >= OPENED * most)
    places = _closing(grid, cleaned[width].left_out, areas, sizes, inscribed)
    return BlockedPaths(reached / max(int(sizes.sum()), 1), width, tuple(places))


def reached_floor(grid: OccupancyGrid, inscribed: float) -> tuple[float, tuple[tuple[Point, float], ...]]:
    """Return the share of a plan's floor that is connected for a robot with this inner radius (meters), and the rest.

    Returns:
        The share (0 without floor), and the other parts that are at least as large as a room, the largest part first.
        Each other part has its middle (map frame) and its area (square meters).
    """
    areas, sizes = _closed_floors(grid, inscribed)
    parts = [number for number in np.argsort(-sizes)[1:] if sizes[number] * grid.resolution**2 >= ROOM]
    boxes = find_objects(areas)
    middles = [grid.centre_of(*(int((side.start + side.stop) // 2) for side in boxes[part - 1])) for part in parts]
    others = tuple(
        (middle, float(sizes[part]) * grid.resolution**2) for middle, part in zip(middles, parts, strict=True)
    )
    return float(sizes.max() / max(int(sizes.sum()), 1)), others


def closed_to_outside(grid: OccupancyGrid, inscribed: float) -> tuple[OccupancyGrid, tuple[Point, ...]]:
    """Close the entrances and windows of a building that is drawn on paper. The paper becomes unknown.

    Args:
        grid: the plan without its thin lines.
        inscribed: radius of the robot's inner circle, meters.

    Returns:
        The plan, and the openings (map frame), the widest opening first. If the building is closed or has no paper
        around it, the plan is unchanged and there are no openings.
    """
    outside = _outside(grid)
    if outside is None:
        return grid, ()
    closed = OccupancyGrid(np.where(outside, UNKNOWN, grid.cells).astype(np.int8), grid.resolution, grid.origin)
    areas, sizes = _floors_inside(closed, inscribed)
    if sizes.max() <= GAINED * _floors_inside(grid, inscribed)[1].max():
        return grid, ()
    near = (
        np.asarray(distance_transform_edt(areas != sizes.argmax())) * grid.resolution <= inscribed + 2 * grid.resolution
    )
    sills = find_objects(label(near & outside, structure=_TOUCHING)[0])
    sills.sort(key=lambda box: -max(side.stop - side.start for side in box))
    return closed, tuple(grid.centre_of(*(int((side.start + side.stop) // 2) for side in box)) for box in sills)


def _small_things(mask: Mask, solid: Mask, extent: float) -> Mask:
    """Return the connected pieces of a mask with an extent of at most `extent` cells and without solid cells."""
    things, _ = label(mask, structure=_TOUCHING)
    thick = np.zeros(int(things.max()) + 1, dtype=np.bool_)
    thick[np.unique(things[solid])] = True
    small = np.zeros(mask.shape, dtype=np.bool_)
    for number, box in enumerate(find_objects(things), start=1):
        if not thick[number] and max(side.stop - side.start for side in box) <= extent:
            small[box] |= things[box] == number
    return small


def _outside(grid: OccupancyGrid) -> Mask | None:
    """Return the paper around a building, or None without paper. A disc that is wider than entrances can reach it."""
    free: Mask = grid.cells == FREE
    border = np.concatenate([free[0], free[-1], free[:, 0], free[:, -1]])
    if border.mean() < PAPER:
        return None
    # Remove specks. Otherwise the disc could not pass the ends of dimension lines at a corner.
    free |= _small_things(~free, np.zeros_like(free), SPECK / grid.resolution)
    reach = OPENING / 2 / grid.resolution
    margin = math.ceil(reach) + 1
    paper = np.pad(free, 2 * margin, constant_values=True)
    areas, _ = label(cells_away(paper) > reach)
    around = areas == areas[margin, margin]
    inner = slice(2 * margin, -2 * margin)
    outside: Mask = (cells_away(~around) <= reach)[inner, inner] & free
    return outside


def _closed_floors(grid: OccupancyGrid, inscribed: float) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    """Return the floor inside a plan with closed openings, numbered as in `_floors_inside`."""
    return _floors_inside(closed_to_outside(grid, inscribed)[0], inscribed)


def _floors_inside(grid: OccupancyGrid, inscribed: float) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    """Return the number of the connected floor at each cell, from 1, inside the image's border.

    Also return the size in cells of each connected floor, by the number of the floor.
    """
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
    """Return places of thin lines between two pieces of floor, ordered by the size of these pieces, largest first."""
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
