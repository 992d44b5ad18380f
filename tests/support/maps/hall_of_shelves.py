"""Hall with rows of shelves, large enough for a team."""

import math

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid


def hall(robots: int = 50) -> tuple[OccupancyGrid, list[Pose2]]:
    """Return a hall with rows of shelves, and the free places in it, in random but fixed order.

    For up to 50 robots it measures 26 m by 14 m. For more robots, both sides are multiplied by the same whole number,
    so that the floor per robot is not smaller.
    """
    scale = math.ceil(math.sqrt(robots / 50))
    rows, cols = 280 * scale, 520 * scale
    cells = np.zeros((rows, cols), np.int8)
    cells[[0, 1, -2, -1], :] = 100
    cells[:, [0, 1, -2, -1]] = 100
    for row in range(60, rows - 20, 80):
        for col in range(40, cols - 20, 80):
            cells[row : row + 8, col : col + 40] = 100
    places = [Pose2(1.0 + 1.5 * i, 1.0 + 2.0 * j, 0.0) for j in range(7 * scale) for i in range(17 * scale)]
    places = [place for place in places if _room_at(cells, place)]
    order = np.random.default_rng(0).permutation(len(places))
    return OccupancyGrid(cells, 0.05, Pose2(0.0, 0.0, 0.0)), [places[i] for i in order]


def _room_at(cells, place):
    row, col = round(place.y / 0.05), round(place.x / 0.05)
    return not cells[row - 12 : row + 12, col - 12 : col + 12].any()
