"""Distances from a map's cells to its walls, shared by all robots on the map."""

import sys
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sim.common.grid import OCCUPIED, OccupancyGrid
from sim.numerics.float_array import FloatArray

MAX_CLEARANCE = 2.0
"""Maximum clearance that is computed, meters. Larger clearances make no difference to a robot."""


BAND = 256
"""Number of rows computed at a time. Temporary arrays for all rows of a map of one hectare would need 100 MB."""


def cells_away(free: NDArray[np.bool_]) -> FloatArray:
    """Return (rows, cols) distances to the center of the nearest cell that is not free, in cells.

    The border is a wall.
    """
    padded = np.pad(free, 1)
    near_row, near_col = nearest_cells(~padded)[:, 1:-1, 1:-1]
    row, col = np.ogrid[1 : len(padded) - 1, 1 : padded.shape[1] - 1]
    away = np.empty(free.shape)
    for begin in range(0, len(free), BAND):
        band = slice(begin, begin + BAND)
        away[band] = (row[band] - near_row[band]) ** 2 + (col - near_col[band]) ** 2  # of integers
    return np.sqrt(away, out=away)


def nearest_cells(mask: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Return (2, rows, cols): row and column of the mask's cell nearest to each cell. The mask must not be empty."""
    # The two transforms have equal results. Programs with robots save the import of scipy, and programs that only read
    # maps save the import of the compiler.
    if "sim.common.grid_transforms" in sys.modules:
        from sim.common import grid_transforms  # noqa: PLC0415

        return grid_transforms.nearest_cells(mask)
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
    """Return the meters from each cell's center to the center of the nearest occupied cell, at most `max_distance`.

    The distance is exactly Euclidean, while ROS's likelihood field and inflation propagate it approximately.

    Returns:
        (rows, cols) float32 in [0, max_distance]. If no cell is occupied, all are `max_distance`. Read-only, because
        maps never change and all robots on a map share this array.
    """
    field = _distances(grid, max_distance)
    field.setflags(write=False)
    return field


@lru_cache(maxsize=8)
def near_walls(grid: OccupancyGrid, distance: float) -> NDArray[np.bool_]:
    """Return (rows, cols) True in cells whose center is within `distance` meters of the center of an occupied cell.

    Read-only, and shared by all robots on the map.
    """
    # Kernels compare distances in double precision. The same precision here gives the same result in every cell.
    near: NDArray[np.bool_] = _distances(grid, 2.0 * distance) <= np.float64(distance)
    near.setflags(write=False)
    return near


@lru_cache(maxsize=8)
def clearance_field(grid: OccupancyGrid) -> NDArray[np.float32]:
    """Return the approximate distance from each cell's center to the nearest side of an occupied cell, meters.

    Returns:
        (rows, cols) float32 from 0 to MAX_CLEARANCE, half a cell less than `distance_field`. All robots on a map share
        this array, so it must not be changed. It is still marked as writable: kernels also get writable copies of it,
        and for read-only arrays numba would compile each kernel a second time.
    """
    field: NDArray[np.float32] = np.maximum(
        _distances(grid, MAX_CLEARANCE) - np.float32(0.5 * grid.resolution), np.float32(0)
    )
    return field
