"""Distances of a map's cells from its walls, shared by all robots on the map."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from sim.common.grid import OCCUPIED, OccupancyGrid

MAX_CLEARANCE = 2.0
"""Greatest clearance that is told apart, metres: to a robot farther from the walls it makes no difference."""


@lru_cache(maxsize=8)
def distance_field(grid: OccupancyGrid, max_distance: float) -> NDArray[np.float32]:
    """Metres from each cell's centre to the centre of the nearest occupied cell, capped.

    Exact Euclidean distance, where ROS's likelihood field and inflation propagate it approximately.

    Returns:
        (rows, cols) float32 in [0, max_distance]; `max_distance` everywhere when no cell is occupied. Read-only: a map
        never changes, and all robots on it share one field.
    """
    open_cells = grid.cells != OCCUPIED
    field = np.full(grid.cells.shape, max_distance, dtype=np.float32)
    if not open_cells.all():
        metres = np.asarray(distance_transform_edt(open_cells)) * grid.resolution
        field = np.minimum(metres, max_distance).astype(np.float32)
    field.setflags(write=False)
    return field


@lru_cache(maxsize=8)
def clearance_field(grid: OccupancyGrid) -> NDArray[np.float32]:
    """Metres from each cell's centre to the nearest side of an occupied cell, about; at most MAX_CLEARANCE.

    Returns:
        (rows, cols) float32, half a cell less than `distance_field`, and at least 0. All robots on a map share one, so
        it must not be written to. Its flag for writing stays set all the same: the kernels that take it also take
        writable copies, and numba compiles a kernel once for each of the two.
    """
    field: NDArray[np.float32] = np.maximum(
        distance_field(grid, MAX_CLEARANCE) - np.float32(0.5 * grid.resolution), np.float32(0)
    )
    return field
