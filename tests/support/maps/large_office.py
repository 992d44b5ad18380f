"""Office of 100 m x 100 m: 2000 x 2000 cells, 64 rooms, and 64 crossings of corridors."""

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import OCCUPIED, OccupancyGrid
from thbridge.files.map_files import Map, MapRoom
from thbridge.hunt.rooms import Room

RESOLUTION = 0.05
PITCH = 250
"""Distance from one room to the next, cells."""
CORRIDOR = 40
DOOR = 24
SIDE = 8
"""Number of rows, and of rooms in a row."""


def large_office(side: int = SIDE) -> Map:
    """Return a square grid of rooms, 10.5 m wide, with two desks each, and corridors of 2 m around all of them."""
    cells = np.zeros((side * PITCH, side * PITCH), np.int8)
    cells[:2] = cells[-2:] = OCCUPIED
    cells[:, :2] = cells[:, -2:] = OCCUPIED
    rooms = []
    for row in range(side):
        for col in range(side):
            block = cells[row * PITCH : (row + 1) * PITCH, col * PITCH : (col + 1) * PITCH]
            begin, end = CORRIDOR // 2, PITCH - CORRIDOR // 2
            block[begin:end, begin : begin + 2] = block[begin:end, end - 2 : end] = OCCUPIED
            block[begin : begin + 2, begin:end] = block[end - 2 : end, begin:end] = OCCUPIED
            # Each room has a door in the south, every second room also one in the north: there are many paths, and not
            # all of them are straight.
            block[begin : begin + 2, PITCH // 2 - DOOR // 2 : PITCH // 2 + DOOR // 2] = 0
            if (row + col) % 2:
                block[end - 2 : end, PITCH // 3 : PITCH // 3 + DOOR] = 0
            block[60:80, 50:110] = block[150:190, 160:180] = OCCUPIED
            x, y = (col + 0.5) * PITCH * RESOLUTION, (row + 0.5) * PITCH * RESOLUTION
            half = (PITCH - CORRIDOR) / 2 * RESOLUTION
            region = ((x - half, y - half), (x + half, y - half), (x + half, y + half), (x - half, y + half))
            rooms.append(MapRoom(Room(row * side + col + 1), f"Room {row * side + col + 1}", region, Pose2(x, y, 0.0)))
    starts = [
        Pose2((col + 0.25) * PITCH * RESOLUTION, row * PITCH * RESOLUTION, 0.0)
        for row in range(1, side)
        for col in range(side)
    ]
    return Map(
        "large office", OccupancyGrid(cells, RESOLUTION, Pose2(0.0, 0.0, 0.0)), tuple(rooms), tuple(starts), None
    )
