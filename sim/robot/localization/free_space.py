"""Free space of a map, from which poses are drawn for a robot that does not know where it is."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sim.common.grid import FREE, OCCUPIED, OccupancyGrid
from sim.numerics.float_array import FloatArray
from sim.numerics.noise_arrays import NoiseStream


@lru_cache(maxsize=8)
def _free_cells(grid: OccupancyGrid) -> NDArray[np.uint32]:
    """(n,) free cells, numbered row by row; read-only: all robots on a map share them.

    They are found when they are first needed: most robots never have to look for themselves all over the map.
    """
    candidates = (grid.cells == FREE, grid.cells != OCCUPIED)
    free = next((cells for cells in candidates if cells.any()), np.ones_like(grid.cells, dtype=np.bool_))
    cells = np.flatnonzero(free).astype(np.uint32)
    cells.setflags(write=False)
    return cells


@dataclass(frozen=True, slots=True, eq=False)
class FreeSpace:
    """The free cells of a map; where the map has none, all cells that are not occupied.

    Attributes:
        grid: the map.
    """

    grid: OccupancyGrid

    def draw(self, count: int, noise: NoiseStream, tick: int) -> FloatArray:
        """(count, 3) poses in the middles of free cells, uniform over the map and all headings.

        Source: AmclNode::uniformPoseGenerator.
        """
        cell, heading = noise.uniforms(tick, 2 * count).reshape(2, count)
        free = _free_cells(self.grid)
        drawn = free[(cell * len(free)).astype(np.int64)].astype(np.int64)
        cells = np.column_stack(np.divmod(drawn, self.grid.cols))
        return np.column_stack((self.grid.centres_of(cells), heading * 2.0 * math.pi - math.pi))
