"""Obstacles around a lost robot, in the base frame.

They are from the last scan alone, because the robot cannot rely on maps.
"""

import math

import numpy as np

from sim.common.distance_fields import nearest_cells
from sim.common.observations import Scan
from sim.numerics import elementary, elementary_arrays
from sim.numerics.float_array import FloatArray
from sim.robot.costmap.costs import CostFrame
from sim.robot.local_planning.braking import WALL_MARGIN, Surroundings

_REACH = 1.2
"""Distance from the base within which obstacles matter, meters.

It is enough for turns in place and a slow step forward.
"""
_RESOLUTION = 0.025
_NO_BODIES = np.empty((0, 0, 2))


def _end_points(scan: Scan) -> FloatArray:
    """Return (beams, 2) end points of beams, base frame. Beams that met nothing end at the laser's maximum range."""
    mount, ranges = scan.mount, scan.ranges.astype(np.float64)
    ranges = np.where(ranges < mount.range_max, ranges, mount.range_max)
    angles = mount.angles()
    in_laser = ranges[:, np.newaxis] * np.stack((elementary_arrays.cos(angles), elementary_arrays.sin(angles)), axis=1)
    points: FloatArray = mount.laser_in_base.transform(in_laser)
    return points


def seen_around(scan: Scan, corners: int) -> Surroundings:
    """Return the obstacles that a scan shows near the robot. The base is at the origin.

    Args:
        scan: the latest scan.
        corners: number of corners of the robot's footprint.
    """
    cells = math.ceil(_REACH / _RESOLUTION)
    at = np.floor(_end_points(scan) / _RESOLUTION).astype(np.int64) + cells
    near = at[((at >= 0) & (at < 2 * cells)).all(axis=1)]
    seen = np.zeros((2 * cells, 2 * cells), dtype=np.bool_)
    seen[near[:, 1], near[:, 0]] = True
    if len(near) == 0:
        clearance = np.full(seen.shape, _REACH, dtype=np.float32)
    else:
        near_row, near_col = nearest_cells(seen)
        row, col = np.indices(seen.shape, sparse=True)
        squares = (row - near_row) ** 2 + (col - near_col) ** 2  # of integers
        clearance = np.asarray(np.sqrt(squares) * _RESOLUTION, dtype=np.float32)
    frame = CostFrame(-cells * _RESOLUTION, -cells * _RESOLUTION, _RESOLUTION)
    return Surroundings(clearance, frame, _NO_BODIES.reshape(0, corners, 2), np.empty(0))


def may_turn(scan: Scan, radius: float) -> bool:
    """Return True if the space behind the robot, which the laser does not see, leaves room to turn.

    A straight wall behind the robot extends to both sides, so the outermost beams end on it. In the worst case, the
    wall is on the line between the ends of these two beams.

    Args:
        scan: the latest scan.
        radius: circumscribed radius of the robot, meters.
    """
    points = _end_points(scan)
    first, last = points[0], points[-1]
    along = last - first
    length = float((along * along).sum())
    share = min(1.0, max(0.0, -float((first * along).sum()) / length)) if length > 0.0 else 0.0
    return elementary.hypot(*(first + share * along)) > radius + WALL_MARGIN


def room_ahead(scan: Scan, footprint: FloatArray) -> float:
    """Return the distance straight ahead to the first obstacle in a scan, meters, or inf if there is no obstacle.

    Args:
        scan: the latest scan.
        footprint: (n, 2) padded corners of the robot.
    """
    points = _end_points(scan)
    right, left, front = footprint[:, 1].min(), footprint[:, 1].max(), footprint[:, 0].max()
    before = points[(points[:, 1] > right) & (points[:, 1] < left) & (points[:, 0] > 0.0)]
    return float(before[:, 0].min(initial=np.inf) - front)
