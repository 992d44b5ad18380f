"""Free space of a map, from which random poses are drawn for a robot that may be anywhere."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sim.common.grid import FREE, OCCUPIED, GridFrame, OccupancyGrid
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.numerics.noise_arrays import NoiseStream

ELSEWHERE = (1.0, 0.5)
"""Minimum difference between poses that count as different places, in meters or radians."""


@lru_cache(maxsize=8)
def _free_cells(grid: OccupancyGrid) -> NDArray[np.uint32]:
    """Return the (n,) numbers of free cells, counted row by row. Read-only, because all robots on a map share them.

    They are computed at the first use, because most robots never search the whole map.
    """
    candidates = (grid.cells == FREE, grid.cells != OCCUPIED)
    free = next((cells for cells in candidates if cells.any()), np.ones_like(grid.cells, dtype=np.bool_))
    cells = np.flatnonzero(free).astype(np.uint32)
    cells.setflags(write=False)
    return cells


@njit(cache=True)
def _poses(free: NDArray[np.uint32], cols: int, frame: GridFrame, drawn: FloatArray) -> FloatArray:
    """Convert (2 n,) uniforms to (n, 3) poses. The first half selects cells, the second half headings."""
    n = drawn.size // 2
    out = np.empty((n, 3))
    for i in range(n):
        cell = int(free[int(drawn[i] * free.size)])
        x, y = (cell % cols + 0.5) * frame.resolution, (cell // cols + 0.5) * frame.resolution
        out[i, 0] = frame.x + frame.cos * x - frame.sin * y
        out[i, 1] = frame.y + frame.sin * x + frame.cos * y
        out[i, 2] = drawn[n + i] * 2.0 * math.pi - math.pi
    return out


@njit(cache=True)
def elsewhere(poses: FloatArray, x: float, y: float, theta: float) -> NDArray[np.bool_]:
    """Return an (n,) mask of the (n, 3) poses that are not at the place of (x, y, theta), see `ELSEWHERE`."""
    out = np.empty(poses.shape[0], dtype=np.bool_)
    for i in range(poses.shape[0]):
        dx, dy = poses[i, 0] - x, poses[i, 1] - y
        turned = abs(wrap_angle(poses[i, 2] - theta)) > ELSEWHERE[1]
        out[i] = turned or dx * dx + dy * dy > ELSEWHERE[0] * ELSEWHERE[0]
    return out


@dataclass(frozen=True, slots=True, eq=False)
class FreeSpace:
    """The free cells of a map. If the map has no free cells, these are all cells that are not occupied.

    Attributes:
        grid: the map.
    """

    grid: OccupancyGrid

    def draw(self, count: int, noise: NoiseStream, tick: int) -> FloatArray:
        """Draw (count, 3) poses in the centers of free cells, uniform over the map and all headings.

        Source: AmclNode::uniformPoseGenerator.
        """
        drawn = noise.uniforms(tick, 2 * count)
        return _poses(_free_cells(self.grid), self.grid.cols, self.grid.frame, drawn)
