"""Bytes of ROS 1 messages as values: what reports and replays read back from bags, ours and others'.

Poses come from three dimensions; their yaw is taken and the rest left. Every function raises ValueError when the bytes
are not a message of its type.
"""

import json
import math
from dataclasses import dataclass
from struct import Struct, error

import numpy as np
from numpy.typing import NDArray

from sim.geometry import FloatArray, Pose2
from sim.grid import OccupancyGrid
from thbridge.ros.pack import ADD, Transform
from thbridge.ros.records import GameEvent, Input, Score, Session, Utterance

_UINT8 = Struct("<B")
_INT32 = Struct("<i")
_UINT32 = Struct("<I")
_INT64 = Struct("<q")
_UINT64 = Struct("<Q")
_FLOAT32 = Struct("<f")
_STAMP = Struct("<II")
_POSE = Struct("<7d")
_MARKER_REST = 3 * 8 + 4 * 4 + 2 * 4 + 1
"""Bytes of a marker's scale, colour, lifetime and frame_locked."""


@dataclass(frozen=True, slots=True)
class Odometry:
    """nav_msgs/Odometry: pose of `child_frame` in `frame`; twists and covariances are left out."""

    stamp_ns: int
    frame: str
    child_frame: str
    pose: Pose2


@dataclass(frozen=True, slots=True)
class PoseInFrame:
    """geometry_msgs/PoseWithCovarianceStamped; the covariance is left out."""

    stamp_ns: int
    frame: str
    pose: Pose2


@dataclass(frozen=True, slots=True)
class Charge:
    """sensor_msgs/BatteryState: what is left of what there was, NaN where nobody measured it."""

    charge: float
    percentage: float


@dataclass(frozen=True, slots=True)
class GoalStart:
    """move_base_msgs/MoveBaseActionGoal: the goal's name and its pose in `frame`."""

    goal_id: str
    frame: str
    pose: Pose2


@dataclass(frozen=True, slots=True)
class GoalEnd:
    """move_base_msgs/MoveBaseActionResult: the goal's name, its status in actionlib's codes, and why."""

    goal_id: str
    status: int
    text: str


@dataclass(frozen=True, slots=True)
class SpatialTransform:
    """geometry_msgs/TransformStamped: the pose of frame `child` in frame `parent`, in three dimensions.

    Attributes:
        position: x, y, z; metres.
        orientation: a quaternion x, y, z, w.
    """

    stamp_ns: int
    parent: str
    child: str
    position: tuple[float, float, float]
    orientation: tuple[float, float, float, float]


@dataclass(frozen=True, slots=True, eq=False)
class LaserScan:
    """sensor_msgs/LaserScan; times between beams and intensities are left out.

    Attributes:
        frame: of the laser; beam i looks along `angle_min + i * angle_increment` in its x-y plane.
        ranges: (n,) metres, as the driver wrote them.
    """

    stamp_ns: int
    frame: str
    angle_min: float
    angle_max: float
    angle_increment: float
    range_min: float
    range_max: float
    ranges: NDArray[np.float32]


class _Cursor:
    """Walks through the fields of a message."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._at = 0

    def take(self, count: int) -> bytes:
        end = self._at + count
        if end > len(self._data):
            raise ValueError("the message ends too early")
        taken = self._data[self._at : end]
        self._at = end
        return taken

    def integer(self, form: Struct) -> int:
        try:
            (value,) = form.unpack_from(self._data, self._at)
        except error:
            raise ValueError("the message ends too early") from None
        self._at += form.size
        return int(value)

    def real(self) -> float:
        (value,) = _FLOAT32.unpack(self.take(_FLOAT32.size))
        return float(value)

    def reals(self, count: int) -> FloatArray:
        return np.frombuffer(self.take(8 * count), dtype="<f8").astype(np.float64)

    def string(self) -> str:
        return self.take(self.integer(_UINT32)).decode(errors="replace")

    def stamp(self) -> int:
        seconds, nanoseconds = _STAMP.unpack(self.take(_STAMP.size))
        return int(seconds) * 1_000_000_000 + int(nanoseconds)

    def header(self) -> tuple[int, str]:
        self.take(_UINT32.size)
        return self.stamp(), self.string()

    def seven(self) -> tuple[float, float, float, float, float, float, float]:
        x, y, z, qx, qy, qz, qw = _POSE.unpack(self.take(_POSE.size))
        return x, y, z, qx, qy, qz, qw

    def pose(self) -> Pose2:
        x, y, _, qx, qy, qz, qw = self.seven()
        yaw = math.atan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz))
        return Pose2(x, y, yaw if yaw < math.pi else -math.pi)


def odometry(data: bytes) -> Odometry:
    """nav_msgs/Odometry."""
    cursor = _Cursor(data)
    stamp_ns, frame = cursor.header()
    return Odometry(stamp_ns, frame, cursor.string(), cursor.pose())


def transforms(data: bytes) -> list[tuple[int, Transform]]:
    """tf2_msgs/TFMessage (and its forerunner tf/tfMessage): each transform with its stamp, nanoseconds."""
    cursor = _Cursor(data)
    entries = []
    for _ in range(cursor.integer(_UINT32)):
        stamp_ns, parent = cursor.header()
        entries.append((stamp_ns, Transform(parent, cursor.string(), cursor.pose())))
    return entries


def spatial_transforms(data: bytes) -> list[SpatialTransform]:
    """As `transforms`, with all three dimensions: a laser may hang upside down."""
    cursor = _Cursor(data)
    entries = []
    for _ in range(cursor.integer(_UINT32)):
        stamp_ns, parent = cursor.header()
        child = cursor.string()
        x, y, z, qx, qy, qz, qw = cursor.seven()
        entries.append(SpatialTransform(stamp_ns, parent, child, (x, y, z), (qx, qy, qz, qw)))
    return entries


def laser_scan(data: bytes) -> LaserScan:
    """sensor_msgs/LaserScan."""
    cursor = _Cursor(data)
    stamp_ns, frame = cursor.header()
    angle_min, angle_max, increment, _, _, range_min, range_max = (cursor.real() for _ in range(7))
    ranges = np.frombuffer(cursor.take(4 * cursor.integer(_UINT32)), dtype="<f4")
    return LaserScan(stamp_ns, frame, angle_min, angle_max, increment, range_min, range_max, ranges)


def pose_with_covariance(data: bytes) -> PoseInFrame:
    """geometry_msgs/PoseWithCovarianceStamped."""
    cursor = _Cursor(data)
    stamp_ns, frame = cursor.header()
    return PoseInFrame(stamp_ns, frame, cursor.pose())


def occupancy_grid(data: bytes) -> OccupancyGrid:
    """nav_msgs/OccupancyGrid."""
    cursor = _Cursor(data)
    cursor.header()
    cursor.stamp()
    resolution = round(cursor.real(), 6)  # a float32 of 0.05 is not 0.05, and grids are placed by it
    cols, rows = cursor.integer(_UINT32), cursor.integer(_UINT32)
    origin = cursor.pose()
    cells: NDArray[np.int8] = np.frombuffer(cursor.take(cursor.integer(_UINT32)), dtype=np.int8)
    if cells.size != rows * cols:
        raise ValueError(f"a map of {rows} x {cols} cells has {cells.size} of them")
    return OccupancyGrid(cells.reshape(rows, cols), resolution, origin)


def outlines(data: bytes) -> list[tuple[str, FloatArray]]:
    """visualization_msgs/MarkerArray: of the markers that are added and have points, namespace and (v, 2) points."""
    cursor = _Cursor(data)
    found = []
    for _ in range(cursor.integer(_UINT32)):
        cursor.header()
        name = cursor.string()
        cursor.take(2 * _INT32.size)
        action = cursor.integer(_INT32)
        place = cursor.pose()
        cursor.take(_MARKER_REST)
        points = cursor.reals(3 * cursor.integer(_UINT32)).reshape(-1, 3)[:, :2]
        cursor.take(4 * _FLOAT32.size * cursor.integer(_UINT32))
        cursor.string()
        cursor.string()
        cursor.take(1)
        if action == ADD and len(points):
            found.append((name, place.transform(points)))
    return found


def battery_state(data: bytes) -> Charge:
    """sensor_msgs/BatteryState."""
    cursor = _Cursor(data)
    cursor.header()
    _voltage, _temperature, _current, charge, _capacity, _design, percentage = (cursor.real() for _ in range(7))
    return Charge(charge, percentage)


def move_base_goal(data: bytes) -> GoalStart:
    """move_base_msgs/MoveBaseActionGoal."""
    cursor = _Cursor(data)
    cursor.header()
    cursor.stamp()
    goal_id = cursor.string()
    _, frame = cursor.header()
    return GoalStart(goal_id, frame, cursor.pose())


def move_base_result(data: bytes) -> GoalEnd:
    """move_base_msgs/MoveBaseActionResult."""
    cursor = _Cursor(data)
    cursor.header()
    cursor.stamp()
    return GoalEnd(cursor.string(), cursor.integer(_UINT8), cursor.string())


def session(data: bytes) -> Session:
    """thbridge_msgs/Session."""
    cursor = _Cursor(data)
    cursor.header()
    study, seed = cursor.string(), cursor.integer(_UINT64)
    versions = json.loads(cursor.string())
    if not isinstance(versions, dict):
        raise ValueError("the versions are not a JSON object")
    return Session(study, seed, {str(name): str(version) for name, version in versions.items()})


def game_event(data: bytes) -> GameEvent:
    """thbridge_msgs/GameEvent."""
    cursor = _Cursor(data)
    cursor.header()
    kind = cursor.string()
    robot, room = _robot(cursor.integer(_INT32)), _room(cursor.integer(_INT32))
    return GameEvent(kind, robot, room, cursor.string())


def score(data: bytes) -> Score:
    """thbridge_msgs/Score."""
    cursor = _Cursor(data)
    cursor.header()
    points, visited, rooms = cursor.integer(_INT32), cursor.integer(_UINT32), cursor.integer(_UINT32)
    energy = np.frombuffer(cursor.take(8 * cursor.integer(_UINT32)), dtype="<f8")
    return Score(points, visited, rooms, tuple(energy.tolist()))


def utterance(data: bytes) -> Utterance:
    """thbridge_msgs/Utterance."""
    cursor = _Cursor(data)
    cursor.header()
    dialogue, speaker = cursor.integer(_INT64), cursor.string()
    robot, room = cursor.integer(_INT32) - 1, _room(cursor.integer(_INT32))
    return Utterance(dialogue, speaker, robot, room, cursor.string(), cursor.string(), cursor.string())


def person_input(data: bytes) -> Input:
    """thbridge_msgs/Input."""
    cursor = _Cursor(data)
    cursor.header()
    return Input(cursor.string(), cursor.string())


def _robot(number: int) -> int | None:
    return None if number == 0 else number - 1


def _room(number: int) -> int | None:
    return None if number < 0 else number
