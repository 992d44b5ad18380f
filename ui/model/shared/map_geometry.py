"""Floor plan in the form that the map draws, with its extent and a test for walls at a place."""

import base64
import binascii
import zlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import Pose2
from sim.common.traversability import inside
from sim.numerics.float_array import FloatArray
from thbridge.files.image_files import MOST_PIXELS
from thbridge.roles.shared.notices import FloorPlan

FREE, WALL, UNKNOWN = 0, 1, 2

Box = tuple[float, float, float, float]
"""Smallest x, smallest y, greatest x, greatest y; meters."""


@dataclass(frozen=True, slots=True, eq=False)
class MapGeometry:
    """Unpacked floor plan.

    Attributes:
        origin: origin of the cells, map frame.
        resolution: meters per cell.
        cells: (rows, cols) FREE, WALL or UNKNOWN; other values have no meaning. Row 0 is at the origin.
        bounds: box around the known cells and the rooms, map frame.
        walls_below: (rows + 1, cols + 1) number of wall cells below and left of each corner of a cell. This is a
            summed-area table (Crow 1984), which gives the number of wall cells in any box with four look-ups.
    """

    origin: Pose2
    resolution: float
    cells: NDArray[np.uint8]
    bounds: Box
    walls_below: NDArray[np.int64]

    def is_clear(self, corners: FloatArray) -> NDArray[np.bool_]:
        """Return (n,) True for boxes of (n, 4, 2) corners in the map frame that contain no wall."""
        cells = self.origin.inverse().transform(corners.reshape(-1, 2)).reshape(-1, 4, 2) / self.resolution
        rows, cols = self.walls_below.shape
        low = np.clip(np.floor(cells.min(axis=1)), 0, (cols - 1, rows - 1)).astype(np.int64)
        high = np.clip(np.ceil(cells.max(axis=1)), 0, (cols - 1, rows - 1)).astype(np.int64)
        (left, bottom), (right, top) = low.T, high.T
        below = self.walls_below
        clear: NDArray[np.bool_] = below[top, right] + below[bottom, left] == below[bottom, right] + below[top, left]
        return clear


def unpack(floor_plan: FloorPlan) -> MapGeometry:
    """Unpack a floor plan. If its cells cannot be read, the result has rooms but no walls."""
    cells = _cells(floor_plan)
    origin = Pose2(*floor_plan.origin)
    rows, cols = np.nonzero(cells != UNKNOWN)
    corners = [np.array(room.region, dtype=np.float64).reshape(-1, 2) for room in floor_plan.rooms]
    if len(rows):
        left, right = cols.min() * floor_plan.resolution, (cols.max() + 1) * floor_plan.resolution
        bottom, top = rows.min() * floor_plan.resolution, (rows.max() + 1) * floor_plan.resolution
        corners.append(origin.transform(np.array([[left, bottom], [right, bottom], [right, top], [left, top]])))
    known = np.concatenate(corners) if corners else np.array([[-1.0, -1.0], [1.0, 1.0]])
    (least_x, least_y), (most_x, most_y) = known.min(axis=0).tolist(), known.max(axis=0).tolist()
    walls = cells == WALL
    return MapGeometry(
        origin=origin,
        resolution=floor_plan.resolution,
        cells=cells,
        bounds=(least_x, least_y, most_x, most_y),
        walls_below=np.pad(np.cumsum(np.cumsum(walls, axis=0, dtype=np.int64), axis=1), ((1, 0), (1, 0))),
    )


def _cells(floor_plan: FloorPlan) -> NDArray[np.uint8]:
    rows, cols = floor_plan.height, floor_plan.width
    size = rows * cols
    if rows < 1 or cols < 1 or size > MOST_PIXELS:
        return np.full((1, 1), UNKNOWN, dtype=np.uint8)  # Our keeper never sends such sizes.
    try:
        packed = base64.b64decode(floor_plan.cells, validate=True)
        cells = np.frombuffer(zlib.decompressobj().decompress(packed, size), dtype=np.uint8)
    except (binascii.Error, zlib.error):
        cells = np.empty(0, dtype=np.uint8)
    if len(cells) != size:
        cells = np.full(size, UNKNOWN, dtype=np.uint8)
    return cells.reshape(rows, cols)


def contains(region: FloatArray, points: FloatArray) -> NDArray[np.bool_]:
    """Return (n,) True for each of (n, 2) points that is in a region of (k, 2) corners; map frame."""
    corners = tuple((float(x), float(y)) for x, y in region)
    held: NDArray[np.bool_] = inside(corners, points[:, 0], points[:, 1])
    return held
