"""Fields that many messages have: strings, stamps, headers, poses."""

from functools import lru_cache
from struct import Struct

import numpy as np

from sim.numerics import elementary, elementary_arrays
from sim.numerics.float_array import FloatArray
from thbridge.ros.messages.stamps import stamp_ns

UINT32 = Struct("<I")
_STAMP = Struct("<II")
_HEAD = Struct("<III")
_POSE = Struct("<7d")
_FLOAT64 = Struct("<d")


def string(text: str) -> bytes:
    """A string field; also a whole std_msgs/String."""
    data = text.encode()
    return UINT32.pack(len(data)) + data


def float64(value: float) -> bytes:
    """A float64 field; also a whole std_msgs/Float64."""
    return _FLOAT64.pack(value)


def boolean(value: bool) -> bytes:
    """A bool field; also a whole std_msgs/Bool."""
    return b"\1" if value else b"\0"


name = lru_cache(maxsize=1024)(string)
"""A string field of a name, cached: of a frame, which every message repeats, or of a part of a robot."""


def stamp(nanoseconds: int) -> bytes:
    """A time field."""
    return _STAMP.pack(*divmod(nanoseconds, 1_000_000_000))


@lru_cache(maxsize=1024)
def frame_names(frame: str, child_frame: str) -> bytes:
    """Two frames' names, one after the other, cached as well."""
    return string(frame) + string(child_frame)


@lru_cache(maxsize=1)
def head(tick: int) -> bytes:
    """A header without its frame. Ticks counted from 1970 (real robots) do not fit into `seq`, which then wraps."""
    return _HEAD.pack(tick & 0xFFFFFFFF, *divmod(stamp_ns(tick), 1_000_000_000))


def header(tick: int, frame: str = "") -> bytes:
    """std_msgs/Header."""
    return head(tick) + name(frame)


def pose_fields(x: float, y: float, theta: float) -> bytes:
    """geometry_msgs/Pose."""
    w, z = elementary.cos_sin(theta / 2)
    return _POSE.pack(x, y, 0.0, 0.0, 0.0, z, w)


def pose_rows(poses: FloatArray) -> FloatArray:
    """(n, 7) position and quaternion of (n, 3) poses."""
    rows = np.zeros((len(poses), 7))
    rows[:, :2] = poses[:, :2]
    halves = poses[:, 2] / 2
    rows[:, 5] = elementary_arrays.sin(halves)
    rows[:, 6] = elementary_arrays.cos(halves)
    return rows


def all_pose_fields(poses: FloatArray) -> list[bytes]:
    """`pose_fields` of each of (n, 3) poses, at much less cost than one by one."""
    return _pieces(pose_rows(poses))


def all_twist_fields(twists: FloatArray) -> list[bytes]:
    """geometry_msgs/Twist of each of (n, 2) planar velocities: m/s forward, rad/s anti-clockwise."""
    rows = np.zeros((len(twists), 6))
    rows[:, 0] = twists[:, 0]
    rows[:, 5] = twists[:, 1]
    return _pieces(rows)


def _pieces(rows: FloatArray) -> list[bytes]:
    packed, size = rows.tobytes(), rows.itemsize * rows.shape[1]
    return [packed[at : at + size] for at in range(0, len(packed), size)]
