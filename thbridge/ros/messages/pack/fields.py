"""Fields of many messages: strings, stamps, headers, poses."""

from functools import cache, lru_cache
from struct import Struct
from types import ModuleType

import numpy as np

from sim.common.geometry import Pose2
from sim.numerics import elementary
from sim.numerics.float_array import FloatArray
from thbridge.ros.messages.stamps import stamp_ns

UINT32 = Struct("<I")
_STAMP = Struct("<II")
_HEAD = Struct("<III")
_POSE = Struct("<7d")
POSE_BYTES = _POSE.size
_FLOAT64 = Struct("<d")


def string(text: str) -> bytes:
    """Encode a string field. Its bytes are also a complete std_msgs/String."""
    data = text.encode()
    return UINT32.pack(len(data)) + data


def float64(value: float) -> bytes:
    """Encode a float64 field. Its bytes are also a complete std_msgs/Float64."""
    return _FLOAT64.pack(value)


def boolean(value: bool) -> bytes:
    """Encode a bool field. Its bytes are also a complete std_msgs/Bool."""
    return b"\1" if value else b"\0"


name = lru_cache(maxsize=1024)(string)
"""Encoder of names of frames and of parts of robots, with a cache, because messages repeat these names."""


def stamp(nanoseconds: int) -> bytes:
    """Encode a time field."""
    return _STAMP.pack(*divmod(nanoseconds, 1_000_000_000))


@lru_cache(maxsize=1024)
def frame_names(frame: str, child_frame: str) -> bytes:
    """Encode the names of two frames, one after the other, with a cache."""
    return string(frame) + string(child_frame)


@lru_cache(maxsize=1)
def head(tick: int) -> bytes:
    """Encode a header without its frame.

    `seq` has 32 bits. Ticks of real robots count from 1970 and do not fit, so `seq` starts again at 0.
    """
    return _HEAD.pack(tick & 0xFFFFFFFF, *divmod(stamp_ns(tick), 1_000_000_000))


def header(tick: int, frame: str = "") -> bytes:
    """Encode std_msgs/Header."""
    return head(tick) + name(frame)


def pose_fields(x: float, y: float, theta: float) -> bytes:
    """Encode geometry_msgs/Pose."""
    w, z = elementary.cos_sin(theta / 2)
    return _POSE.pack(x, y, 0.0, 0.0, 0.0, z, w)


def compiled_pose(pose: Pose2) -> bytes:
    """Return `pose_fields` of a pose. Compiled code computes it: faster, but the first call imports the compiler."""
    row = np.zeros((1, 7))
    row[0, 0], row[0, 1], row[0, 6] = pose.x, pose.y, pose.theta
    _kernels().turn_headings(row)
    return row.tobytes()


def pose_rows(poses: FloatArray) -> FloatArray:
    """Return (n, 7) position and quaternion of (n, 3) poses."""
    rows = np.zeros((len(poses), 7))
    fill_poses(rows, poses)
    return rows


def fill_poses(rows: FloatArray, poses: FloatArray) -> None:
    """Write (n, 3) poses to the first 7 columns of (n, m) rows. These columns must be 0."""
    rows[:, :2] = poses[:, :2]
    rows[:, 6] = poses[:, 2]
    _kernels().turn_headings(rows)


@cache
def _kernels() -> ModuleType:
    """Import the compiler at the first call. Windows pack messages, but no poses, so they never import it."""
    from thbridge.ros.messages.pack import kernels  # noqa: PLC0415

    return kernels


def all_pose_fields(poses: FloatArray) -> list[bytes]:
    """Return `pose_fields` of each of (n, 3) poses. This is much faster than single calls."""
    return pieces(pose_rows(poses))


def pieces(rows: FloatArray) -> list[bytes]:
    """Return the bytes of each of (n, m) rows."""
    packed: list[bytes] = rows.view(f"V{rows.itemsize * rows.shape[1]}").ravel().tolist()
    return packed
