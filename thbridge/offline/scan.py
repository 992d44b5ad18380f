"""What a laser without noise would see on a map."""

import math

import numpy as np

from sim.common.geometry import FloatArray
from sim.common.grid import OccupancyGrid
from sim.common.raycast import Raycaster


def beam_angles(beams: int, angle_min: float, angle_max: float | None) -> FloatArray:
    """(beams,) radians, evenly from `angle_min` to `angle_max`, both included, as in sensor_msgs/LaserScan.

    Without an `angle_max` they go once around: the last beam is one step short of the first.
    """
    last = angle_min + math.tau * (beams - 1) / beams if angle_max is None else angle_max
    return np.linspace(angle_min, last, beams)


def scan(grid: OccupancyGrid, poses: FloatArray, angles: FloatArray, range_max: float) -> list[list[float | None]]:
    """Exact ranges from every pose.

    Args:
        grid: what beams meet: its occupied cells; unknown ones and the outside of the map let them pass.
        poses: (n, 3) of the laser in the map frame.
        angles: (m,) radians in the laser's frame.
        range_max: metres, finite.

    Returns:
        n lists of m ranges in metres; None where nothing is within `range_max`.
    """
    ranges = Raycaster.of(grid).ranges(poses, angles, range_max)
    return [[reach if math.isfinite(reach) else None for reach in row] for row in ranges.tolist()]
