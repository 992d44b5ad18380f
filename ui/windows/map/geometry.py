"""Floor plan as the map draws it: boxes of equal cells, its extent, and a test for places without walls."""

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
from thbridge.roles.notices import FloorPlan

FREE, WALL, UNKNOWN = 0, 1, 2

Boxes = NDArray[np.int64]
"""(n, 4) boxes: first column, first row, columns, rows; in cells."""

Box = tuple[float, float, float, float]
"""Least x, least y, most x, most y; metres."""


@dataclass(frozen=True, slots=True, eq=False)
class MapGeometry:
    """A floor plan, unpacked.

    Attributes:
        origin: of the cells, map frame.
        resolution: metres a cell.
        floor: boxes of free cells.
        walls: boxes of walls.
        bounds: box around all that is known, map frame.
        walls_below: (rows + 1, cols + 1) number of wall cells below and left of each corner of cells: a summed-area
            table (Crow 1984), by which the walls in any box are counted with four look-ups.
    """

    origin: Pose2
    resolution: float
    floor: Boxes
    walls: Boxes
    bounds: Box
    walls_below: NDArray[np.int64]

    def is_clear(self, corners: FloatArray) -> NDArray[np.bool_]:
        """Return (n,) True for boxes of (n, 4, 2) corners in the map frame that hold no wall."""
        cells = self.origin.inverse().transform(corners.reshape(-1, 2)).reshape(-1, 4, 2) / self.resolution
        rows, cols = self.walls_below.shape
        low = np.clip(np.floor(cells.min(axis=1)), 0, (cols - 1, rows - 1)).astype(np.int64)
        high = np.clip(np.ceil(cells.max(axis=1)), 0, (cols - 1, rows - 1)).astype(np.int64)
        (left, bottom), (right, top) = low.T, high.T
        below = self.walls_below
        clear: NDArray[np.bool_] = below[top, right] + below[bottom, left] == below[bottom, right] + below[top, left]
        return clear


def unpack(floor_plan: FloorPlan) -> MapGeometry:
    """Unpack a floor plan; one whose cells cannot be read has rooms and no walls."""
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
        floor=boxes(cells == FREE),
        walls=boxes(walls),
        bounds=(least_x, least_y, most_x, most_y),
        walls_below=np.pad(np.cumsum(np.cumsum(walls, axis=0, dtype=np.int64), axis=1), ((1, 0), (1, 0))),
    )


def _cells(floor_plan: FloorPlan) -> NDArray[np.uint8]:
    rows, cols = floor_plan.height, floor_plan.width
    size = rows * cols
    if rows < 1 or cols < 1 or size > MOST_PIXELS:
        return np.full((1, 1), UNKNOWN, dtype=np.uint8)  # whoever says so is no keeper of ours
    try:
        packed = base64.b64decode(floor_plan.cells, validate=True)
        cells = np.frombuffer(zlib.decompressobj().decompress(packed, size), dtype=np.uint8)
    except (binascii.Error, zlib.error):
        cells = np.empty(0, dtype=np.uint8)
    if len(cells) != size:
        cells = np.full(size, UNKNOWN, dtype=np.uint8)
    return cells.reshape(rows, cols)


def boxes(mask: NDArray[np.bool_]) -> Boxes:
    """Return boxes that cover the true cells of a (rows, cols) mask once each.

    Runs of true cells in a row are merged with equal runs of the rows above: a few hundred boxes are painted instead of
    tens of thousands of cells."""
    found: list[tuple[int, int, int, int]] = []
    growing: dict[tuple[int, int], int] = {}
    padded = np.pad(mask, ((0, 1), (1, 1))).astype(np.int8)
    for row in range(len(padded)):
        edges = np.flatnonzero(np.diff(padded[row])).tolist()
        runs = set(zip(edges[::2], edges[1::2], strict=True))
        for run in [run for run in growing if run not in runs]:
            start = growing.pop(run)
            found.append((run[0], start, run[1] - run[0], row - start))
        for run in runs:
            growing.setdefault(run, row)
    return np.array(sorted(found), dtype=np.int64).reshape(-1, 4)


def contains(region: FloatArray, points: FloatArray) -> NDArray[np.bool_]:
    """Return (n,) True for those of (n, 2) points that lie in a region of (k, 2) corners; map frame."""
    corners = tuple((float(x), float(y)) for x, y in region)
    held: NDArray[np.bool_] = inside(corners, points[:, 0], points[:, 1])
    return held
