"""Occupancy grids: the meaning of a map's cells, and their position in the world.

Grids are (rows, cols) with row 0 and column 0 at the map's origin, as in nav_msgs/OccupancyGrid.
"""

import math
import zlib
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import Pose2
from sim.numerics import elementary
from sim.numerics.float_array import FloatArray

Cells = NDArray[np.int8]
"""(rows, cols): 0 free, 100 occupied, all other values unknown or undecided."""

MapMode = Literal["trinary", "scale", "raw"]

FREE = 0
OCCUPIED = 100
UNKNOWN = -1

NOWHERE = (-1, -1)
"""Row and column of a point that is not finite. They are outside every grid."""


class GridFrame(NamedTuple):
    """Pose and resolution of a grid in the world, in the form for compiled kernels.

    Attributes:
        x: x of the grid's origin (outer corner of cell (0, 0)) in the map frame, meters.
        y: y of the origin.
        cos: cosine of the origin's yaw.
        sin: sine of the origin's yaw.
        resolution: side of a cell, meters.
    """

    x: float
    y: float
    cos: float
    sin: float
    resolution: float


@dataclass(frozen=True, slots=True, eq=False)
class OccupancyGrid:
    """A map: cells, their size, and the pose of the grid's corner in the map frame.

    Attributes:
        cells: (rows, cols) int8; 0 free, 100 occupied, -1 unknown. Values between come from maps read in `scale` or
            `raw` mode. Localization and planning consider only 0 as free and only 100 as occupied. Read-only.
        resolution: side of a cell, meters.
        origin: pose of the outer corner of cell (0, 0) in the map frame.
    """

    cells: Cells
    resolution: float
    origin: Pose2
    _hash: int = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Copy the cells, so that later writing by the caller does not change a map in use.

        Raises:
            ValueError: the cells are not a two-dimensional non-empty array, or the resolution is not positive.
        """
        if self.cells.ndim != 2 or self.cells.size == 0:
            raise ValueError(f"cells must be a non-empty array (rows, cols), not of shape {self.cells.shape}")
        if not (self.resolution > 0 and math.isfinite(self.resolution)):
            raise ValueError(f"resolution must be positive, not {self.resolution}")
        cells = np.array(self.cells, dtype=np.int8, order="C")
        cells.setflags(write=False)
        object.__setattr__(self, "cells", cells)
        # If these numbers were int, numba would compile the kernels a second time.
        origin = Pose2(float(self.origin.x), float(self.origin.y), float(self.origin.theta))
        object.__setattr__(self, "origin", origin)
        # Computed once, because it is needed for each lookup of a table that robots on a map share.
        object.__setattr__(self, "_hash", hash((self.resolution, origin, cells.shape, zlib.crc32(cells.data))))

    def __eq__(self, other: object) -> bool:
        """Return True if origin, resolution and cells are equal."""
        if not isinstance(other, OccupancyGrid):
            return NotImplemented
        return self is other or (
            self.resolution == other.resolution
            and self.origin == other.origin
            and np.array_equal(self.cells, other.cells)
        )

    def __hash__(self) -> int:
        """Return a hash that is consistent with equality."""
        return self._hash

    @property
    def rows(self) -> int:
        """Cells along the grid's own y axis (ROS: height)."""
        return int(self.cells.shape[0])

    @property
    def cols(self) -> int:
        """Cells along the grid's own x axis (ROS: width)."""
        return int(self.cells.shape[1])

    @property
    def frame(self) -> GridFrame:
        """Pose and resolution of the grid, for compiled kernels."""
        yaw = self.origin.theta
        return GridFrame(self.origin.x, self.origin.y, *elementary.cos_sin(yaw), self.resolution)

    def cell_of(self, x: float, y: float) -> tuple[int, int]:
        """Return (row, col) of the cell that contains a world point.

        Outside the grid, they may be negative or too large.
        """
        frame = self.frame
        dx, dy = x - frame.x, y - frame.y
        col = (frame.cos * dx + frame.sin * dy) / frame.resolution
        row = (frame.cos * dy - frame.sin * dx) / frame.resolution
        if not (math.isfinite(row) and math.isfinite(col)):
            return NOWHERE
        return math.floor(row), math.floor(col)

    def centre_of(self, row: int, col: int) -> tuple[float, float]:
        """Return the world point of a cell's center, meters."""
        frame = self.frame
        along = (col + 0.5) * frame.resolution
        across = (row + 0.5) * frame.resolution
        x = frame.x + frame.cos * along - frame.sin * across
        y = frame.y + frame.sin * along + frame.cos * across
        return float(x), float(y)

    def contains(self, row: int, col: int) -> bool:
        """Return True if this row and this column are inside the grid."""
        return 0 <= row < self.rows and 0 <= col < self.cols

    def value_at(self, x: float, y: float) -> int:
        """Return the value of the cell at a world point, or unknown outside the grid."""
        row, col = self.cell_of(x, y)
        return int(self.cells[row, col]) if self.contains(row, col) else UNKNOWN

    def cells_of(self, points: FloatArray) -> NDArray[np.int64]:
        """Return (n, 2) rows and columns of (n, 2) world points. They may be outside the grid."""
        in_grid = self.origin.inverse().transform(points)
        return np.floor(in_grid[:, ::-1] / self.resolution).astype(np.int64)

    def centres_of(self, cells: NDArray[np.int64]) -> FloatArray:
        """Return (n, 2) world points of the centers of (n, 2) rows and columns."""
        centres = cells[:, ::-1].astype(np.float64) + 0.5
        return self.origin.transform(centres * self.resolution)


def interpret_image(
    pixels: NDArray[np.uint8], negate: bool, occupied_thresh: float, free_thresh: float, mode: MapMode = "trinary"
) -> Cells:
    """Return the cells of a map image, exactly as ROS reads it.

    Dark pixels are occupied. The occupancy of a cell is `(255 - mean) / 255`, or `mean / 255` with `negate`. Above
    `occupied_thresh` the cell is occupied, and below `free_thresh` it is free. Between the two, mode `trinary` makes it
    unknown, and `scale` gives it a value from 1 to 99 in proportion. `raw` uses the mean itself, as a signed byte.

    Args:
        pixels: (rows, cols) gray, or (rows, cols, channels) RGB or RGBA. Row 0 is the top of the picture.
        negate: True if bright pixels are occupied.
        occupied_thresh: 0 to 1.
        free_thresh: 0 to 1, less than `occupied_thresh`.
        mode: map.yaml's `mode`.

    Returns:
        (rows, cols). Row 0 is the bottom of the picture.

    Source: ros-planning/navigation, map_server/src/image_loader.cpp, with its peculiarities. An alpha channel is
        averaged with the colors in `trinary` mode, but not in the other modes. In `scale` mode, a cell
        is unknown if the last of several channels (blue, without an alpha channel) is 0.
    """
    planes = pixels[:, :, np.newaxis] if pixels.ndim == 2 else pixels
    channels = planes.shape[2]
    averaged = 3 if channels == 4 and mode != "trinary" else channels
    sums = planes[::-1, :, :averaged].sum(axis=2, dtype=np.uint16)
    # An image has many pixels but few shades, so convert each shade only once.
    shades = np.arange(255 * averaged + 1) / averaged
    if negate:
        shades = 255 - shades
    if mode == "raw":
        means: Cells = shades.astype(np.uint8).view(np.int8)[sums]
        return means
    occ = (255 - shades) / 255.0
    cells = np.full(occ.shape, UNKNOWN, dtype=np.int8)
    between = (occ >= free_thresh) & (occ <= occupied_thresh)
    if mode == "scale":
        ratio = (occ - free_thresh) / (occupied_thresh - free_thresh)
        cells[between] = (1 + 98 * ratio[between]).astype(np.int8)
    cells[occ < free_thresh] = FREE
    cells[occ > occupied_thresh] = OCCUPIED
    drawn: Cells = cells[sums]
    if mode == "scale" and channels > 1:
        drawn[between[sums] & (planes[::-1, :, -1] < 1)] = UNKNOWN
    return drawn
