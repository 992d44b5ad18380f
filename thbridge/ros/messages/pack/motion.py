"""Encoders of poses, transforms, paths and velocities."""

from collections.abc import Iterable, Sequence
from struct import Struct
from typing import NamedTuple

import numpy as np

from sim.common.geometry import Pose2
from sim.common.observations import Twist
from sim.numerics.float_array import FloatArray
from thbridge.ros.messages.pack.fields import (
    UINT32,
    all_pose_fields,
    fill_poses,
    frame_names,
    head,
    header,
    pieces,
    pose_fields,
    pose_rows,
)

_TWIST = Struct("<6d")
_POINT32 = Struct("<3f")


class Transform(NamedTuple):
    """Pose of frame `child` in frame `parent`."""

    parent: str
    child: str
    pose: Pose2


def covariance(planar: FloatArray, unmeasured: float = 0.0) -> bytes:
    """Return the 6 x 6 covariance of x, y, z, roll, pitch, yaw from the (3, 3) covariance of x, y, theta.

    Args:
        planar: (3, 3) covariance; m^2, m rad, rad^2.
        unmeasured: variance of z, roll and pitch.
    """
    full = np.zeros((6, 6))
    full[:2, :2], full[:2, 5], full[5, :2], full[5, 5] = planar[:2, :2], planar[:2, 2], planar[2, :2], planar[2, 2]
    full[2, 2] = full[3, 3] = full[4, 4] = unmeasured
    return full.tobytes()


NO_COVARIANCE = covariance(np.zeros((3, 3)))


def transforms(tick: int, entries: Iterable[Transform]) -> bytes:
    """Encode tf2_msgs/TFMessage. All transforms have the same time stamp."""
    beginning = head(tick)
    return stamped_transforms(
        [
            b"".join((beginning, frame_names(parent, child), pose_fields(pose.x, pose.y, pose.theta)))
            for parent, child, pose in entries
        ]
    )


def stamped_transforms(entries: Sequence[bytes]) -> bytes:
    """Encode tf2_msgs/TFMessage. Each entry consists of `head`, `frame_names` and `pose_fields`."""
    return UINT32.pack(len(entries)) + b"".join(entries)


def odometry(
    tick: int,
    frame: str,
    child_frame: str,
    pose: Pose2,
    twist: Twist,
    pose_covariance: bytes = NO_COVARIANCE,
    twist_covariance: bytes = NO_COVARIANCE,
) -> bytes:
    """Encode nav_msgs/Odometry: pose of `child_frame` in `frame`, twist in `child_frame`. See also `covariance`."""
    frames, place = frame_names(frame, child_frame), pose_fields(pose.x, pose.y, pose.theta)
    return b"".join((head(tick), frames, place, pose_covariance, command(twist), twist_covariance))


class OdometryRows:
    """Encoder of nav_msgs/Odometry for many robots and ticks together.

    It does not encode header and child frame, which are the first fields.

    Args:
        covariance: covariance of poses and twists, from the function `covariance`.
    """

    def __init__(self, covariance: bytes) -> None:
        self._covariance = np.frombuffer(covariance)
        self._kept = np.empty((0, 85))

    def packed(self, poses: FloatArray, twists: FloatArray) -> list[bytes]:
        """Return the bytes for each of (n, 3) poses and (n, 2) twists: m/s forward, rad/s counterclockwise."""
        if len(poses) > len(self._kept):
            # Numbers of a row: 7 for the pose, 36 for its covariance, 6 for the twist, 36 for its covariance.
            self._kept = np.zeros((len(poses), 85))
            self._kept[:, 7:43] = self._kept[:, 49:] = self._covariance
        rows = self._kept[: len(poses)]
        fill_poses(rows, poses)
        rows[:, 43] = twists[:, 0]
        rows[:, 48] = twists[:, 1]
        return pieces(rows)


def command(twist: Twist) -> bytes:
    """Encode geometry_msgs/Twist."""
    return _TWIST.pack(twist.linear, 0.0, 0.0, 0.0, 0.0, twist.angular)


def pose_with_covariance(tick: int, frame: str, pose: Pose2, planar: FloatArray) -> bytes:
    """Encode geometry_msgs/PoseWithCovarianceStamped. `planar` is the (3, 3) covariance of x, y, theta."""
    return header(tick, frame) + pose_fields(pose.x, pose.y, pose.theta) + covariance(planar)


def pose_array(tick: int, frame: str, poses: FloatArray) -> bytes:
    """Encode geometry_msgs/PoseArray of (n, 3) poses."""
    return header(tick, frame) + UINT32.pack(len(poses)) + pose_rows(poses).tobytes()


def pose_stamped(tick: int, frame: str, pose: Pose2) -> bytes:
    """Encode geometry_msgs/PoseStamped."""
    return header(tick, frame) + pose_fields(pose.x, pose.y, pose.theta)


def polygon(tick: int, frame: str, corners: Iterable[Sequence[float]]) -> bytes:
    """Encode geometry_msgs/PolygonStamped. Each corner is x, y."""
    points = [_POINT32.pack(x, y, 0.0) for x, y in corners]
    return header(tick, frame) + UINT32.pack(len(points)) + b"".join(points)


def path(tick: int, frame: str, poses: FloatArray) -> bytes:
    """Encode nav_msgs/Path of (n, 3) poses. All poses have the same time stamp."""
    # Each pose has its own header. Joining by the header writes it before every pose.
    beginning = header(tick, frame)
    return beginning + beginning.join((UINT32.pack(len(poses)), *all_pose_fields(poses)))
