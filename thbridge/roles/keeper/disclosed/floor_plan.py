"""Floor plan of a game's map, compressed for one line of the text protocol."""

import base64
import zlib
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sim.common.grid import FREE, OCCUPIED, OccupancyGrid
from thbridge.roles.shared.notices import FloorPlan, RoomOutline

MOST_PACKED = 40_000
"""Maximum number of characters of the compressed cells. For more characters, the map's resolution is halved."""


def floor_plan_of(
    name: str, grid: OccupancyGrid, rooms: Sequence[RoomOutline], footprint: tuple[tuple[float, float], ...]
) -> FloorPlan:
    """Return the floor plan of a map.

    If the compressed map is too long for one line, its resolution is halved: 2 x 2 cells become one cell. The new cell
    is a wall if one of the four cells is a wall. Otherwise it is free if one of them is free. This is repeated.

    Args:
        name: name of the map.
        grid: the cells of the map.
        rooms: outlines of the rooms, in order.
        footprint: corners of a robot's body in its own frame, meters.
    """
    codes: NDArray[np.uint8] = np.full(grid.cells.shape, 2, dtype=np.uint8)
    codes[grid.cells == FREE] = 0
    codes[grid.cells == OCCUPIED] = 1
    resolution = grid.resolution
    while len(packed := _packed(codes)) > MOST_PACKED:
        codes, resolution = _halved(codes), 2.0 * resolution
    height, width = codes.shape
    x, y, theta = grid.origin.array().tolist()
    return FloorPlan(name, resolution, (x, y, theta), width, height, packed, tuple(rooms), footprint)


def _packed(codes: NDArray[np.uint8]) -> str:
    return base64.b64encode(zlib.compress(codes.tobytes(), 9)).decode("ascii")


def _halved(codes: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return the codes at half the resolution. Cells beyond the last row or column count as unknown."""
    rows, cols = codes.shape
    even = np.pad(codes, ((0, rows % 2), (0, cols % 2)), constant_values=2)
    blocks = even.reshape(even.shape[0] // 2, 2, even.shape[1] // 2, 2)
    wall, free = (blocks == 1).any(axis=(1, 3)), (blocks == 0).any(axis=(1, 3))
    return np.where(wall, 1, np.where(free, 0, 2)).astype(np.uint8)
