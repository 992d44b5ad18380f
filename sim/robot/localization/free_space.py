"""Free space of a map, from which poses are drawn for a robot that does not know where it is."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import FloatArray
from sim.common.grid import FREE, OCCUPIED, OccupancyGrid
from sim.common.noise_arrays import NoiseStream


@lru_cache(maxsize=8)
def _free_cells(grid: OccupancyGrid) -> NDArray[np.int64]:
    """(n, 2) rows and columns, see `FreeSpace`; read-only: all robots on a map share them."""
    candidates = (grid.cells == FREE, grid.cells != OCCUPIED)
    free = next((cells for cells in candidates if cells.any()), np.ones_like(grid.cells, dtype=np.bool_))
    cells: NDArray[np.int64] = np.argwhere(free)
    cells.setflags(write=False)
    return cells


@dataclass(frozen=True, slots=True, eq=False)
class FreeSpace:
    """The free cells of a map; where the map has none, all cells that are not occupied.

    Attributes:
        grid: the map.
        cells: (n, 2) rows and columns.
    """

    grid: OccupancyGrid
    cells: NDArray[np.int64]

    @classmethod
    def of(cls, grid: OccupancyGrid) -> "FreeSpace":
        """The free cells of a map."""
        return cls(grid, _free_cells(grid))

    def draw(self, count: int, noise: NoiseStream, tick: int) -> FloatArray:
        """(count, 3) poses in the middles of free cells, uniform over the map and all headings.

        Source: AmclNode::uniformPoseGenerator.
        """
        cell, heading = noise.uniforms(tick, 2 * count).reshape(2, count)
        cells = self.cells[(cell * len(self.cells)).astype(np.int64)]
        return np.column_stack((self.grid.centres_of(cells), heading * 2.0 * math.pi - math.pi))
