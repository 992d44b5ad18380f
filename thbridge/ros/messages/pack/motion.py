"""Poses, transforms, paths and velocities."""

from collections.abc import Iterable, Sequence
from operator import add
from struct import Struct
from typing import NamedTuple

import numpy as np

from sim.common.geometry import Pose2
from sim.common.observations import Twist
from sim.numerics.float_array import FloatArray
from thbridge.ros.messages.pack.fields import UINT32, all_pose_fields, frame_names, head, header, pose_fields, pose_rows

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
    full = np.zeros((6, 6))
    full[:2, :2], full[:2, 5], full[5, :2], full[5, 5] = planar[:2, :2], planar[:2, 2], planar[2, :2], planar[2, 2]
    full[2, 2] = full[3, 3] = full[4, 4] = unmeasured
    return full.tobytes()


NO_COVARIANCE = covariance(np.zeros((3, 3)))


def transforms(tick: int, entries: Iterable[Transform]) -> bytes:
    """tf2_msgs/TFMessage with all entries at one time."""
    entries = tuple(entries)
    frames = [frame_names(entry.parent, entry.child) for entry in entries]
    return stamped_transforms(head(tick), frames, [pose_fields(pose.x, pose.y, pose.theta) for _, _, pose in entries])


def stamped_transforms(head: bytes, frames: Sequence[bytes], poses: Sequence[bytes]) -> bytes:
    """tf2_msgs/TFMessage of fields: a header without its frame, `frame_names` and `pose_fields` of each transform."""
    return head.join((UINT32.pack(len(poses)), *map(add, frames, poses)))


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
    frames, place = frame_names(frame, child_frame), pose_fields(pose.x, pose.y, pose.theta)
    return b"".join((head(tick), frames, place, pose_covariance, command(twist), twist_covariance))


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
    return beginning + beginning.join((UINT32.pack(len(poses)), *all_pose_fields(poses)))
