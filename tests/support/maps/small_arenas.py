"""Small arenas: two or three rooms at a corridor."""

import numpy as np

from sim.common.geometry import IDENTITY
from sim.common.grid import FREE, OCCUPIED, OccupancyGrid
from sim.robot.costmap.footprint import radii
from thbridge.files.map_files import FOOTPRINT
from thbridge.offline.arena import arena_of
from thbridge.offline.room_finding import find_rooms


def three_rooms() -> OccupancyGrid:
    """Return an arena of 12 m x 8 m.

    It has a corridor of 2 m at the bottom, three rooms above it with doors of 1.2 m, and a door from room 1 to room 2.
    """
    cells = np.full((80, 120), FREE, dtype=np.int8)
    cells[[0, -1], :] = OCCUPIED
    cells[:, [0, -1]] = OCCUPIED
    cells[20, :] = OCCUPIED
    cells[20:, [40, 80]] = OCCUPIED
    for col in (14, 54, 94):
        cells[20, col : col + 12] = FREE
    cells[40:50, 40] = FREE
    return OccupancyGrid(cells, 0.1, IDENTITY)


GRID = three_rooms()
FOUND = arena_of(GRID, find_rooms(GRID, *radii(np.array(FOOTPRINT))), 2, ["West", "Middle", "East"])


def two_rooms() -> OccupancyGrid:
    """Return an arena of 8 m x 4 m: a room, a corridor and a room, with doors 1 m wide at the bottom of both walls."""
    cells = np.full((40, 80), FREE, dtype=np.int8)
    cells[[0, -1], :] = OCCUPIED
    cells[:, [0, -1]] = OCCUPIED
    cells[11:, [30, 49]] = OCCUPIED
    return OccupancyGrid(cells, 0.1, IDENTITY)
