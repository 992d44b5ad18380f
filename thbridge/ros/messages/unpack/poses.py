"""Decoder of geometry_msgs/Pose, reduced to the plane."""

import math

from sim.common.geometry import Pose2
from sim.numerics import elementary
from thbridge.ros.messages.cursor import Cursor


def read_pose(cursor: Cursor) -> Pose2:
    """Read a pose in space as a pose in the plane. If its quaternion contains NaN, its yaw is NaN."""
    x, y, _, qx, qy, qz, qw = cursor.spatial_pose()
    yaw = elementary.atan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz))
    return Pose2(x, y, yaw if yaw < math.pi else -math.pi)
