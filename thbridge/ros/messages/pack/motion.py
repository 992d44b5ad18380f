"""Poses, transforms, paths and velocities."""

from collections.abc import Iterable
from struct import Struct
from typing import NamedTuple

import numpy as np

from sim.common.geometry import FloatArray, Pose2
from sim.common.observations import Twist
from thbridge.ros.messages.pack.fields import UINT32, head, header, name, pose_fields, pose_rows

_TWIST = Struct("<6d")


class Transform(NamedTuple):
    """The pose of frame `child` in frame `parent`."""

    parent: str
    child: str
    pose: Pose2


def covariance(planar: FloatArray, unmeasured: float = 0.0) -> bytes:
    """The 6 x 6 covariance of x, y, z, roll, pitch, yaw from the (3, 3) one of x, y, theta.

    Args:
        planar: (3, 3); m^2, m rad, rad^2.
        unmeasured: variance of z, roll and pitch.
    """
    full = np.diag([0.0, 0.0, unmeasured, unmeasured, unmeasured, 0.0])
    full[np.ix_((0, 1, 5), (0, 1, 5))] = planar
    return full.tobytes()


NO_COVARIANCE = covariance(np.zeros((3, 3)))


def transforms(tick: int, entries: Iterable[Transform]) -> bytes:
    """tf2_msgs/TFMessage with all entries at one time."""
    beginning = head(tick)
    parts = [
        b"".join((beginning, name(parent), name(child), pose_fields(pose.x, pose.y, pose.theta)))
        for parent, child, pose in entries
    ]
    return UINT32.pack(len(parts)) + b"".join(parts)


def odometry(
    tick: int,
    frame: str,
    child_frame: str,
    pose: Pose2,
    twist: Twist,
    pose_covariance: bytes = NO_COVARIANCE,
    twist_covariance: bytes = NO_COVARIANCE,
) -> bytes:
    """nav_msgs/Odometry: pose of `child_frame` in `frame`, twist in `child_frame`; covariances from `covariance`."""
    return b"".join(
        (
            header(tick, frame),
            name(child_frame),
            pose_fields(pose.x, pose.y, pose.theta),
            pose_covariance,
            command(twist),
            twist_covariance,
        )
    )


def command(twist: Twist) -> bytes:
    """geometry_msgs/Twist."""
    return _TWIST.pack(twist.linear, 0.0, 0.0, 0.0, 0.0, twist.angular)


def pose_with_covariance(tick: int, frame: str, pose: Pose2, planar: FloatArray) -> bytes:
    """geometry_msgs/PoseWithCovarianceStamped; `planar` is the (3, 3) covariance of x, y, theta."""
    return header(tick, frame) + pose_fields(pose.x, pose.y, pose.theta) + covariance(planar)


def pose_array(tick: int, frame: str, poses: FloatArray) -> bytes:
    """geometry_msgs/PoseArray of (n, 3) poses."""
    return header(tick, frame) + UINT32.pack(len(poses)) + pose_rows(poses).tobytes()


def pose_stamped(tick: int, frame: str, pose: Pose2) -> bytes:
    """geometry_msgs/PoseStamped."""
    return header(tick, frame) + pose_fields(pose.x, pose.y, pose.theta)


def polygon(tick: int, frame: str, corners: FloatArray) -> bytes:
    """geometry_msgs/PolygonStamped of (v, 2) corners."""
    points = np.zeros((len(corners), 3), dtype="<f4")
    points[:, :2] = corners
    return header(tick, frame) + UINT32.pack(len(points)) + points.tobytes()


def path(tick: int, frame: str, poses: FloatArray) -> bytes:
    """nav_msgs/Path through (n, 3) poses, all stamped alike."""
    beginning = header(tick, frame)
    rows = np.empty(len(poses), dtype=[("header", f"V{len(beginning)}"), ("pose", "<f8", 7)])
    rows["header"] = np.void(beginning)
    rows["pose"] = pose_rows(poses)
    return beginning + UINT32.pack(len(poses)) + rows.tobytes()
