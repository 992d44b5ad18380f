"""Distances of a map's cells from its walls, shared by all robots on the map."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sim.common.grid import OCCUPIED, OccupancyGrid
from sim.numerics.float_array import FloatArray

MAX_CLEARANCE = 2.0
"""Greatest clearance that is told apart, meters: to a robot farther from the walls it makes no difference."""


BAND = 256
"""Rows that are worked out at a time: what is needed besides for a whole map of a hectare would be 100 MB."""


def cells_away(free: NDArray[np.bool_]) -> FloatArray:
    """Return (rows, cols) cells from each cell's center to that of the nearest one that is not free; the border is a wall."""
    padded = np.pad(free, 1)
    near_row, near_col = nearest_cells(~padded)[:, 1:-1, 1:-1]
    row, col = np.ogrid[1 : len(padded) - 1, 1 : padded.shape[1] - 1]
    away = np.empty(free.shape)
    for begin in range(0, len(free), BAND):
        band = slice(begin, begin + BAND)
        away[band] = (row[band] - near_row[band]) ** 2 + (col - near_col[band]) ** 2  # of integers
    return np.sqrt(away, out=away)


def nearest_cells(mask: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Return (2, rows, cols) row and column of the cell nearest to each one of those in a mask, which must not be empty."""
    # Reading a study needs no scipy, whose import would take half of the time.
    from scipy.ndimage import distance_transform_edt  # noqa: PLC0415

    nearest: NDArray[np.int32] = distance_transform_edt(~mask, return_distances=False, return_indices=True)
    return nearest


def _distances(grid: OccupancyGrid, max_distance: float) -> NDArray[np.float32]:
    occupied = grid.cells == OCCUPIED
    field = np.full(grid.cells.shape, max_distance, dtype=np.float32)
    if occupied.any():
        near_row, near_col = nearest_cells(occupied)
        row, col = np.indices(occupied.shape, sparse=True)
        for begin in range(0, grid.rows, BAND):
            band = slice(begin, begin + BAND)
            squares = (row[band] - near_row[band]) ** 2 + (col - near_col[band]) ** 2  # of integers
            field[band] = np.minimum(np.sqrt(squares) * grid.resolution, max_distance)
    return field


@lru_cache(maxsize=8)
def distance_field(grid: OccupancyGrid, max_distance: float) -> NDArray[np.float32]:
    """Meters from each cell's center to the center of the nearest occupied cell, capped.

    Exact Euclidean distance, where ROS's likelihood field and inflation propagate it approximately.

    Returns:
        (rows, cols) float32 in [0, max_distance]; `max_distance` everywhere when no cell is occupied. Read-only: a map
        never changes, and all robots on it share one field.
    """
    field = _distances(grid, max_distance)
    field.setflags(write=False)
    return field


@lru_cache(maxsize=8)
def near_walls(grid: OccupancyGrid, distance: float) -> NDArray[np.bool_]:
    """Return (rows, cols) True in cells whose center is within so many meters of that of an occupied one.

    Read-only, and shared by all robots on the map.
    """
    # To the last bit as the distances themselves would be compared, by kernels, as numbers of double precision.
    near: NDArray[np.bool_] = _distances(grid, 2.0 * distance) <= np.float64(distance)
    near.setflags(write=False)
    return near


@lru_cache(maxsize=8)
def clearance_field(grid: OccupancyGrid) -> NDArray[np.float32]:
    """Meters from each cell's center to the nearest side of an occupied cell, about; at most MAX_CLEARANCE.

    Returns:
        (rows, cols) float32, half a cell less than `distance_field`, and at least 0. All robots on a map share one, so
        it must not be written to. Its flag for writing stays set all the same: the kernels that take it also take
        writable copies, and numba compiles a kernel once for each of the two.
    """
    field: NDArray[np.float32] = np.maximum(
        _distances(grid, MAX_CLEARANCE) - np.float32(0.5 * grid.resolution), np.float32(0)
    )
    return field
