"""Scans of a laser without noise on a map."""

import math

import numpy as np

from sim.common.grid import OccupancyGrid
from sim.common.raycast import Raycaster
from sim.numerics.float_array import FloatArray


def beam_angles(beams: int, angle_min: float, angle_max: float | None) -> FloatArray:
    """Return (beams,) angles from `angle_min` to `angle_max`, both included, as in sensor_msgs/LaserScan; radians.

    If `angle_max` is None, the beams cover a full circle. Then the last beam is one step before the first beam.
    """
    last = angle_min + math.tau * (beams - 1) / beams if angle_max is None else angle_max
    return np.linspace(angle_min, last, beams)


def scan(grid: OccupancyGrid, poses: FloatArray, angles: FloatArray, range_max: float) -> list[list[float | None]]:
    """Return the exact ranges from every pose.

    Args:
        grid: the map. Beams end at occupied cells. They pass through unknown cells and the space outside the map.
        poses: (n, 3) poses of the laser in the map frame.
        angles: (m,) angles of the beams in the laser's frame, radians.
        range_max: maximum range, meters. It must be finite.

    Returns:
        n lists of m ranges in meters. A range is None if there is no occupied cell within `range_max`.
    """
    ranges = Raycaster.of(grid).ranges(poses, angles, range_max)
    return [[reach if math.isfinite(reach) else None for reach in row] for row in ranges.tolist()]
