"""Bytes of ROS 1 messages as values: what reports and replays read back from bags, ours and others'.

Poses come from three dimensions; their yaw is taken and the rest left. Every function raises ValueError when the bytes
are not a message of its type.
"""

import json
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.geometry import FloatArray, Pose2
from sim.grid import OccupancyGrid
from thbridge.ros.cursor import FLOAT32, INT32, INT64, UINT8, UINT32, UINT64, Cursor
from thbridge.ros.pack import ADD, Transform
from thbridge.ros.records import GameEvent, Input, Score, Session, Utterance

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


def odometry(data: bytes) -> Odometry:
    """nav_msgs/Odometry."""
    cursor = Cursor(data)
    stamp_ns, frame = cursor.header()
    return Odometry(stamp_ns, frame, cursor.string(), cursor.pose())


def transforms(data: bytes) -> list[tuple[int, Transform]]:
    """tf2_msgs/TFMessage (and its forerunner tf/tfMessage): each transform with its stamp, nanoseconds."""
    cursor = Cursor(data)
    entries = []
    for _ in range(cursor.integer(UINT32)):
        stamp_ns, parent = cursor.header()
        entries.append((stamp_ns, Transform(parent, cursor.string(), cursor.pose())))
    return entries


def spatial_transforms(data: bytes) -> list[SpatialTransform]:
    """As `transforms`, with all three dimensions: a laser may hang upside down."""
    cursor = Cursor(data)
    entries = []
    for _ in range(cursor.integer(UINT32)):
        stamp_ns, parent = cursor.header()
        child = cursor.string()
        x, y, z, qx, qy, qz, qw = cursor.seven()
        entries.append(SpatialTransform(stamp_ns, parent, child, (x, y, z), (qx, qy, qz, qw)))
    return entries


def laser_scan(data: bytes) -> LaserScan:
    """sensor_msgs/LaserScan."""
    cursor = Cursor(data)
    stamp_ns, frame = cursor.header()
    angle_min, angle_max, increment, _, _, range_min, range_max = (cursor.real() for _ in range(7))
    ranges = np.frombuffer(cursor.take(4 * cursor.integer(UINT32)), dtype="<f4")
    return LaserScan(stamp_ns, frame, angle_min, angle_max, increment, range_min, range_max, ranges)


def pose_with_covariance(data: bytes) -> PoseInFrame:
    """geometry_msgs/PoseWithCovarianceStamped."""
    cursor = Cursor(data)
    stamp_ns, frame = cursor.header()
    return PoseInFrame(stamp_ns, frame, cursor.pose())


def occupancy_grid(data: bytes) -> OccupancyGrid:
    """nav_msgs/OccupancyGrid."""
    cursor = Cursor(data)
    cursor.header()
    cursor.stamp()
    resolution = round(cursor.real(), 6)  # a float32 of 0.05 is not 0.05, and grids are placed by it
    cols, rows = cursor.integer(UINT32), cursor.integer(UINT32)
    origin = cursor.pose()
    cells: NDArray[np.int8] = np.frombuffer(cursor.take(cursor.integer(UINT32)), dtype=np.int8)
    if cells.size != rows * cols:
        raise ValueError(f"a map of {rows} x {cols} cells has {cells.size} of them")
    return OccupancyGrid(cells.reshape(rows, cols), resolution, origin)


def outlines(data: bytes) -> list[tuple[str, FloatArray]]:
    """visualization_msgs/MarkerArray: of the markers that are added and have points, namespace and (v, 2) points."""
    cursor = Cursor(data)
    found = []
    for _ in range(cursor.integer(UINT32)):
        cursor.header()
        name = cursor.string()
        cursor.take(2 * INT32.size)
        action = cursor.integer(INT32)
        place = cursor.pose()
        cursor.take(_MARKER_REST)
        points = cursor.reals(3 * cursor.integer(UINT32)).reshape(-1, 3)[:, :2]
        cursor.take(4 * FLOAT32.size * cursor.integer(UINT32))
        cursor.string()
        cursor.string()
        cursor.take(1)
        if action == ADD and len(points):
            found.append((name, place.transform(points)))
    return found


def battery_state(data: bytes) -> Charge:
    """sensor_msgs/BatteryState."""
    cursor = Cursor(data)
    cursor.header()
    _voltage, _temperature, _current, charge, _capacity, _design, percentage = (cursor.real() for _ in range(7))
    return Charge(charge, percentage)


def move_base_goal(data: bytes) -> GoalStart:
    """move_base_msgs/MoveBaseActionGoal."""
    cursor = Cursor(data)
    cursor.header()
    cursor.stamp()
    goal_id = cursor.string()
    _, frame = cursor.header()
    return GoalStart(goal_id, frame, cursor.pose())


def move_base_result(data: bytes) -> GoalEnd:
    """move_base_msgs/MoveBaseActionResult."""
    cursor = Cursor(data)
    cursor.header()
    cursor.stamp()
    return GoalEnd(cursor.string(), cursor.integer(UINT8), cursor.string())


def session(data: bytes) -> Session:
    """thbridge_msgs/Session."""
    cursor = Cursor(data)
    cursor.header()
    study, seed = cursor.string(), cursor.integer(UINT64)
    versions = json.loads(cursor.string())
    if not isinstance(versions, dict):
        raise ValueError("the versions are not a JSON object")
    told = {str(name): str(version) for name, version in versions.items()}
    program = cursor.string()
    roles = tuple(cursor.string() for _ in range(cursor.integer(UINT32)))
    return Session(study, seed, told, program, roles, cursor.string())


def game_event(data: bytes) -> GameEvent:
    """thbridge_msgs/GameEvent."""
    cursor = Cursor(data)
    cursor.header()
    kind = cursor.string()
    robot, room = _robot(cursor.integer(INT32)), _room(cursor.integer(INT32))
    return GameEvent(kind, robot, room, cursor.string())


def score(data: bytes) -> Score:
    """thbridge_msgs/Score."""
    cursor = Cursor(data)
    cursor.header()
    points, visited, rooms = cursor.integer(INT32), cursor.integer(UINT32), cursor.integer(UINT32)
    energy = np.frombuffer(cursor.take(8 * cursor.integer(UINT32)), dtype="<f8")
    return Score(points, visited, rooms, tuple(energy.tolist()))


def utterance(data: bytes) -> Utterance:
    """thbridge_msgs/Utterance."""
    cursor = Cursor(data)
    cursor.header()
    dialogue, speaker = cursor.integer(INT64), cursor.string()
    robot, room = cursor.integer(INT32) - 1, _room(cursor.integer(INT32))
    return Utterance(dialogue, speaker, robot, room, cursor.string(), cursor.string(), cursor.string())


def outside_input(data: bytes) -> Input:
    """thbridge_msgs/Input."""
    cursor = Cursor(data)
    cursor.header()
    return Input(cursor.string(), cursor.string(), cursor.string(), cursor.string())


def _robot(number: int) -> int | None:
    return None if number == 0 else number - 1


def _room(number: int) -> int | None:
    return None if number < 0 else number
