"""Decoders of robots' messages: odometry, poses, transforms, scans, maps, paths."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import Twist
from sim.numerics import elementary_arrays
from sim.numerics.float_array import FloatArray
from thbridge.ros.messages.cursor import FLOAT32, INT32, UINT32, Cursor
from thbridge.ros.messages.pack import ADD, Transform
from thbridge.ros.messages.plausible import is_plausible
from thbridge.ros.messages.unpack.poses import read_pose

_COVARIANCE = 36
_HEAD = 16
"""Number of bytes of a header before the frame's name."""
_POSE_STAMPED = _HEAD + 7 * 8
"""Number of bytes of a geometry_msgs/PoseStamped without the frame's name."""
_PLANAR = (0, 1, 5)
"""Indices of x, y and yaw in ROS's covariances."""
_MARKER_REST = 3 * 8 + 4 * 4 + 2 * 4 + 1
"""Number of bytes of the fields scale, color, lifetime and frame_locked of a marker."""


@dataclass(frozen=True, slots=True)
class OdometryMessage:
    """nav_msgs/Odometry without covariances: pose of `child_frame` in `frame`, twist in `child_frame`."""

    stamp_ns: int
    frame: str
    child_frame: str
    pose: Pose2
    twist: Twist


@dataclass(frozen=True, slots=True, eq=False)
class PoseInFrame:
    """geometry_msgs/PoseWithCovarianceStamped, or PoseStamped, which has no covariance.

    Attributes:
        stamp_ns: time stamp of the pose.
        frame: the frame of the pose.
        pose: the pose in the plane.
        covariance: (3, 3) covariance of x, y, yaw. NaN for a PoseStamped.
    """

    stamp_ns: int
    frame: str
    pose: Pose2
    covariance: FloatArray


@dataclass(frozen=True, slots=True)
class BatteryCharge:
    """sensor_msgs/BatteryState: charge, and its fraction of the capacity. Values that are not measured are NaN."""

    charge: float
    percentage: float


@dataclass(frozen=True, slots=True)
class SpatialTransform:
    """geometry_msgs/TransformStamped: three-dimensional pose of frame `child` in frame `parent`.

    Attributes:
        position: x, y, z in meters.
        orientation: quaternion x, y, z, w.
    """

    stamp_ns: int
    parent: str
    child: str
    position: tuple[float, float, float]
    orientation: tuple[float, float, float, float]


@dataclass(frozen=True, slots=True, eq=False)
class LaserScan:
    """sensor_msgs/LaserScan without the times between beams and without intensities.

    Attributes:
        frame: frame of the laser. Beam i has the angle `angle_min + i * angle_increment` in its x-y plane.
        ranges: (n,) meters, unchanged.
    """

    stamp_ns: int
    frame: str
    angle_min: float
    angle_max: float
    angle_increment: float
    range_min: float
    range_max: float
    ranges: NDArray[np.float32]


def odometry(data: bytes) -> OdometryMessage:
    """Decode nav_msgs/Odometry."""
    cursor = Cursor(data)
    stamp_ns, frame = cursor.header()
    child_frame, pose = cursor.string(), read_pose(cursor)
    cursor.reals(_COVARIANCE)
    return OdometryMessage(stamp_ns, frame, child_frame, pose, _twist(cursor))


def twist(data: bytes) -> Twist:
    """Decode geometry_msgs/Twist."""
    return _twist(Cursor(data))


def _twist(cursor: Cursor) -> Twist:
    linear_x, _, _, _, _, angular_z = cursor.reals(6).tolist()
    return Twist(linear_x, angular_z)


def transforms(data: bytes) -> list[tuple[int, Transform]]:
    """Decode tf2_msgs/TFMessage or its predecessor tf/tfMessage to time stamps in nanoseconds and transforms."""
    cursor = Cursor(data)
    entries = []
    for _ in range(cursor.integer(UINT32)):
        stamp_ns, parent = cursor.header()
        entries.append((stamp_ns, Transform(parent, cursor.string(), read_pose(cursor))))
    return entries


def transform_pieces(data: bytes) -> list[tuple[str, str, bytes]]:
    """Decode tf2_msgs/TFMessage to the parent frame, the child frame and the bytes of each transform."""
    cursor = Cursor(data)
    pieces = []
    for _ in range(cursor.integer(UINT32)):
        rest = cursor.remaining()
        _, parent = cursor.header()
        child = cursor.string()
        cursor.spatial_pose()
        pieces.append((parent, child, rest[: len(rest) - len(cursor.remaining())]))
    return pieces


def spatial_transforms(data: bytes) -> list[SpatialTransform]:
    """Decode tf2_msgs/TFMessage in three dimensions, for example for a laser that is mounted upside down."""
    cursor = Cursor(data)
    entries = []
    for _ in range(cursor.integer(UINT32)):
        stamp_ns, parent = cursor.header()
        child = cursor.string()
        x, y, z, qx, qy, qz, qw = cursor.spatial_pose()
        entries.append(SpatialTransform(stamp_ns, parent, child, (x, y, z), (qx, qy, qz, qw)))
    return entries


def laser_scan(data: bytes) -> LaserScan:
    """Decode sensor_msgs/LaserScan."""
    cursor = Cursor(data)
    stamp_ns, frame = cursor.header()
    angle_min, angle_max, increment, _, _, range_min, range_max = (cursor.real() for _ in range(7))
    ranges = np.frombuffer(cursor.take(4 * cursor.integer(UINT32)), dtype="<f4")
    return LaserScan(stamp_ns, frame, angle_min, angle_max, increment, range_min, range_max, ranges)


def pose_with_covariance(data: bytes) -> PoseInFrame:
    """Decode geometry_msgs/PoseWithCovarianceStamped."""
    cursor = Cursor(data)
    stamp_ns, frame = cursor.header()
    pose = read_pose(cursor)
    return PoseInFrame(stamp_ns, frame, pose, cursor.reals(_COVARIANCE).reshape(6, 6)[np.ix_(_PLANAR, _PLANAR)])


def pose_array(data: bytes) -> FloatArray:
    """Decode geometry_msgs/PoseArray to (n, 3) x, y, yaw in the frame of the message."""
    cursor = Cursor.behind_header(data)
    return _planar(cursor.reals(7 * cursor.integer(UINT32)).reshape(-1, 7))


def polygon(data: bytes) -> FloatArray:
    """Decode geometry_msgs/PolygonStamped to (v, 2) corners in the frame of the message."""
    cursor = Cursor.behind_header(data)
    points = np.frombuffer(cursor.take(3 * FLOAT32.size * cursor.integer(UINT32)), dtype="<f4").reshape(-1, 3)
    return points[:, :2].astype(np.float64)


def frame_of(data: bytes) -> str:
    """Return the frame in the header of a message. The header must be the first field."""
    return Cursor(data).header()[1]


def pose_stamped(data: bytes) -> PoseInFrame:
    """Decode geometry_msgs/PoseStamped."""
    cursor = Cursor(data)
    stamp_ns, frame = cursor.header()
    return PoseInFrame(stamp_ns, frame, read_pose(cursor), np.full((3, 3), np.nan))


def occupancy_grid(data: bytes) -> OccupancyGrid:
    """Decode nav_msgs/OccupancyGrid."""
    return read_grid(Cursor(data))


def read_grid(cursor: Cursor) -> OccupancyGrid:
    """Read a nav_msgs/OccupancyGrid."""
    cursor.header()
    cursor.stamp()
    resolution = round(cursor.real(), 6)  # 0.05 is not exact in float32, but positions need it.
    cols, rows = cursor.integer(UINT32), cursor.integer(UINT32)
    origin = read_pose(cursor)
    if not is_plausible(origin.x, origin.y, origin.theta, resolution):
        raise ValueError(f"a map with cells of {resolution} m has its origin at {origin.x}, {origin.y}, {origin.theta}")
    cells: NDArray[np.int8] = np.frombuffer(cursor.take(cursor.integer(UINT32)), dtype=np.int8)
    if cells.size != rows * cols:
        raise ValueError(f"a map of {rows} x {cols} cells contains {cells.size} values")
    return OccupancyGrid(cells.reshape(rows, cols), resolution, origin)


def outlines(data: bytes) -> list[tuple[str, FloatArray]]:
    """Decode visualization_msgs/MarkerArray to namespace and (v, 2) points of each added marker that has points."""
    return [(marker.namespace, marker.points) for marker in _markers(data) if len(marker.points)]


def room_labels(data: bytes) -> dict[int, str]:
    """Decode visualization_msgs/MarkerArray to names of rooms by number."""
    return {marker.number: marker.text for marker in _markers(data)}


class _Marker(NamedTuple):
    """visualization_msgs/Marker with the action ADD: namespace, id, (v, 2) points, text."""

    namespace: str
    number: int
    points: FloatArray
    text: str


def _markers(data: bytes) -> Iterator[_Marker]:
    cursor = Cursor(data)
    for _ in range(cursor.integer(UINT32)):
        cursor.header()
        namespace, number = cursor.string(), cursor.integer(INT32)
        cursor.take(INT32.size)
        action = cursor.integer(INT32)
        pose = read_pose(cursor)
        cursor.take(_MARKER_REST)
        points = cursor.reals(3 * cursor.integer(UINT32)).reshape(-1, 3)[:, :2]
        cursor.take(4 * FLOAT32.size * cursor.integer(UINT32))
        text = cursor.string()
        cursor.string()
        cursor.take(1)
        if action == ADD:
            yield _Marker(namespace, number, pose.transform(points), text)


def battery_state(data: bytes) -> BatteryCharge:
    """Decode sensor_msgs/BatteryState."""
    cursor = Cursor.behind_header(data)
    _voltage, _temperature, _current, charge, _capacity, _design, percentage = (cursor.real() for _ in range(7))
    return BatteryCharge(charge, percentage)


def path(data: bytes) -> FloatArray:
    """Decode nav_msgs/Path to (n, 3) x, y, yaw in the frame of the message."""
    cursor = Cursor.behind_header(data)
    count = cursor.integer(UINT32)
    # A forged count must not reserve memory.
    if count * _POSE_STAMPED > len(cursor.remaining()):
        raise ValueError("the message ends too early")
    alike = _poses_alike(cursor.remaining(), count)
    if alike is not None:
        return _planar(alike)
    poses = np.empty((count, 3))
    for row in poses:
        cursor.header()
        row[:] = read_pose(cursor).array()
    return poses


def _poses_alike(data: bytes, count: int) -> FloatArray | None:
    """Return (n, 7) poses of a path, decoded together. If names of frames have different lengths, return None."""
    if not count or len(data) < _HEAD:
        return None
    length = int.from_bytes(data[_HEAD - 4 : _HEAD], "little")
    row = np.dtype(
        {"names": ["length", "pose"], "formats": ["<u4", ("<f8", 7)], "offsets": [_HEAD - 4, _HEAD + length]}
    )
    if len(data) != count * row.itemsize:
        return None
    rows = np.frombuffer(data, dtype=row)
    return rows["pose"] if (rows["length"] == length).all() else None


def _planar(rows: FloatArray) -> FloatArray:
    """Return (n, 3) x, y, yaw of (n, 7) positions and quaternions."""
    x, y, z, w = rows[:, 3:].T
    # Numbers in bags of other programs may have any size. So results may not be finite, and need no warning.
    with np.errstate(over="ignore", invalid="ignore"):
        yaw = elementary_arrays.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return np.column_stack((rows[:, :2], np.where(yaw < np.pi, yaw, -np.pi)))
