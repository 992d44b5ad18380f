"""Values of the simulation as bytes of ROS 1 messages.

Written straight to the wire format: little-endian, fields in order, strings and lists with a 32-bit length before
them (roscpp_serialization). Ten robots say some 1,200 messages a second, for which message objects are too slow.

Every header's `seq` is the tick, so a gap in it says that nothing was due. Poses are of the plane: z, roll and pitch
are 0.
"""

import json
import math
from collections.abc import Iterable
from functools import lru_cache
from struct import Struct
from typing import NamedTuple

import numpy as np

from sim.geometry import FloatArray, Pose2
from sim.grid import OccupancyGrid
from sim.observations import Battery, Scan, Twist
from thbridge.ros.records import GameEvent, Input, Score, Session, Utterance
from thbridge.ros.stamps import stamp_ns

_UINT32 = Struct("<I")
_STAMP = Struct("<II")
_HEAD = Struct("<III")
_POSE = Struct("<7d")
_TWIST = Struct("<6d")
_LASER = Struct("<7f")
_BATTERY = Struct("<7f4B")
_MARKER = Struct("<3i7d3d4f2iB")
_GRID_META = Struct("<IIfII")
_GAME_EVENT = Struct("<ii")
_SCORE = Struct("<iII")
_UINT64 = Struct("<Q")
_INT64 = Struct("<q")

_POWER_SUPPLY_UNKNOWN = 0
_POWER_SUPPLY_STATUS_DISCHARGING = 2

ADD = 0
_DELETEALL = 3
_LINE_STRIP = 4
"""Of visualization_msgs/Marker."""
_LINE_WIDTH = 0.05
_LINE_COLOUR = (0.9, 0.4, 0.0, 1.0)
"""Metres; red, green, blue, opacity."""

SUCCEEDED = 3
ABORTED = 4
PREEMPTED = 2
"""How a goal ended, in the codes of actionlib_msgs/GoalStatus."""


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


def string(text: str) -> bytes:
    """A string field; also a whole std_msgs/String."""
    data = text.encode()
    return _UINT32.pack(len(data)) + data


_name = lru_cache(maxsize=1024)(string)
"""Frames come again with every message."""


def _stamp(tick: int) -> tuple[int, int]:
    return divmod(stamp_ns(tick), 1_000_000_000)


@lru_cache(maxsize=1)
def _head(tick: int) -> bytes:
    return _HEAD.pack(tick, *_stamp(tick))


def header(tick: int, frame: str = "") -> bytes:
    """std_msgs/Header."""
    return _head(tick) + _name(frame)


def _pose(x: float, y: float, theta: float) -> bytes:
    return _POSE.pack(x, y, 0.0, 0.0, 0.0, math.sin(theta / 2), math.cos(theta / 2))


def _poses(poses: FloatArray) -> FloatArray:
    """(n, 7) position and quaternion of (n, 3) poses."""
    rows = np.zeros((len(poses), 7))
    rows[:, :2] = poses[:, :2]
    rows[:, 5] = np.sin(poses[:, 2] / 2)
    rows[:, 6] = np.cos(poses[:, 2] / 2)
    return rows


def transforms(tick: int, entries: Iterable[Transform]) -> bytes:
    """tf2_msgs/TFMessage with all entries at one time."""
    head = _head(tick)
    parts = [
        b"".join((head, _name(parent), _name(child), _pose(pose.x, pose.y, pose.theta)))
        for parent, child, pose in entries
    ]
    return _UINT32.pack(len(parts)) + b"".join(parts)


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
            _name(child_frame),
            _pose(pose.x, pose.y, pose.theta),
            pose_covariance,
            command(twist),
            twist_covariance,
        )
    )


def command(twist: Twist) -> bytes:
    """geometry_msgs/Twist."""
    return _TWIST.pack(twist.linear, 0.0, 0.0, 0.0, 0.0, twist.angular)


def laser_scan(scan: Scan, frame: str, period: float) -> bytes:
    """sensor_msgs/LaserScan without intensities.

    Args:
        scan: all its beams were measured at one moment.
        frame: of the laser.
        period: seconds from one scan to the next.
    """
    mount = scan.mount
    angle_max = mount.angle_min + mount.angle_increment * (mount.beams - 1)
    return b"".join(
        (
            header(scan.tick, frame),
            _LASER.pack(
                mount.angle_min, angle_max, mount.angle_increment, 0.0, period, mount.range_min, mount.range_max
            ),
            _UINT32.pack(len(scan.ranges)),
            scan.ranges.astype("<f4", copy=False).tobytes(),
            _UINT32.pack(0),
        )
    )


def pose_with_covariance(tick: int, frame: str, pose: Pose2, planar: FloatArray) -> bytes:
    """geometry_msgs/PoseWithCovarianceStamped; `planar` is the (3, 3) covariance of x, y, theta."""
    return header(tick, frame) + _pose(pose.x, pose.y, pose.theta) + covariance(planar)


def pose_array(tick: int, frame: str, poses: FloatArray) -> bytes:
    """geometry_msgs/PoseArray of (n, 3) poses."""
    return header(tick, frame) + _UINT32.pack(len(poses)) + _poses(poses).tobytes()


def path(tick: int, frame: str, poses: FloatArray) -> bytes:
    """nav_msgs/Path through (n, 3) poses, all stamped alike."""
    head = header(tick, frame)
    rows = np.empty(len(poses), dtype=[("head", f"V{len(head)}"), ("pose", "<f8", 7)])
    rows["head"] = np.void(head)
    rows["pose"] = _poses(poses)
    return head + _UINT32.pack(len(poses)) + rows.tobytes()


def map_meta_data(tick: int, grid: OccupancyGrid) -> bytes:
    """nav_msgs/MapMetaData; the map counts as loaded at this tick."""
    seconds, nanoseconds = _stamp(tick)
    origin = grid.origin
    return _GRID_META.pack(seconds, nanoseconds, grid.resolution, grid.cols, grid.rows) + _pose(
        origin.x, origin.y, origin.theta
    )


def occupancy_grid(tick: int, frame: str, grid: OccupancyGrid) -> bytes:
    """nav_msgs/OccupancyGrid."""
    return b"".join(
        (header(tick, frame), map_meta_data(tick, grid), _UINT32.pack(grid.cells.size), grid.cells.tobytes())
    )


def outlines(tick: int, frame: str, bodies: Iterable[tuple[str, FloatArray]]) -> bytes:
    """visualization_msgs/MarkerArray with the outlines of bodies; it takes all earlier ones away.

    Args:
        tick: when the bodies were so.
        frame: theirs.
        bodies: name, and (v, 2) corners in turn.
    """
    parts = [_marker(tick, frame, _DELETEALL, 0, "", np.empty((0, 2)))]
    for number, (name, corners) in enumerate(bodies):
        parts.append(_marker(tick, frame, ADD, number, name, np.vstack((corners, corners[:1]))))
    return _UINT32.pack(len(parts)) + b"".join(parts)


def _marker(tick: int, frame: str, action: int, number: int, name: str, line: FloatArray) -> bytes:
    """visualization_msgs/Marker: a line strip; its namespace and text are the body's name."""
    points = np.zeros((len(line), 3))
    points[:, :2] = line
    at_origin = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
    for_ever, unlocked, none = (0, 0), 0, _UINT32.pack(0)
    return b"".join(
        (
            header(tick, frame),
            string(name),
            _MARKER.pack(
                number, _LINE_STRIP, action, *at_origin, _LINE_WIDTH, 0.0, 0.0, *_LINE_COLOUR, *for_ever, unlocked
            ),
            _UINT32.pack(len(points)),
            points.astype("<f8", copy=False).tobytes(),
            none,  # colours of single points
            string(name),
            none,  # mesh
            bytes((0,)),
        )
    )


def battery_state(battery: Battery, robot: str) -> bytes:
    """sensor_msgs/BatteryState; charge and capacity are the game's energy, what nobody measures is NaN.

    Args:
        battery: its charge may be below zero, its capacity is positive.
        robot: the serial number to give.
    """
    share = battery.charge / battery.capacity
    measured = (math.nan, math.nan, math.nan, battery.charge, battery.capacity, battery.capacity, share)
    present = 1
    cells = _UINT32.pack(0)
    return b"".join(
        (
            header(battery.tick),
            _BATTERY.pack(
                *measured, _POWER_SUPPLY_STATUS_DISCHARGING, _POWER_SUPPLY_UNKNOWN, _POWER_SUPPLY_UNKNOWN, present
            ),
            cells,
            cells,
            string(""),
            string(robot),
        )
    )


def _goal_id(tick: int, goal_id: str) -> bytes:
    return _STAMP.pack(*_stamp(tick)) + string(goal_id)


def move_base_goal(tick: int, frame: str, goal_id: str, pose: Pose2) -> bytes:
    """move_base_msgs/MoveBaseActionGoal: drive to a pose in `frame`."""
    return header(tick) + _goal_id(tick, goal_id) + header(tick, frame) + _pose(pose.x, pose.y, pose.theta)


def move_base_result(tick: int, goal_id: str, goal_tick: int, status: int, text: str) -> bytes:
    """move_base_msgs/MoveBaseActionResult.

    Args:
        tick: when the goal ended.
        goal_id: as in its goal.
        goal_tick: when it was set.
        status: SUCCEEDED, ABORTED or PREEMPTED.
        text: why, for people.
    """
    return header(tick) + _goal_id(goal_tick, goal_id) + bytes((status,)) + string(text)


def session(tick: int, record: Session) -> bytes:
    """thbridge_msgs/Session."""
    versions = json.dumps(record.versions, sort_keys=True)
    return b"".join(
        (
            header(tick),
            string(record.study),
            _UINT64.pack(record.seed),
            string(versions),
            string(record.program),
            _UINT32.pack(len(record.roles)),
            *(string(role) for role in record.roles),
            string(record.participant),
        )
    )


def game_event(tick: int, record: GameEvent) -> bytes:
    """thbridge_msgs/GameEvent; robot 0 and room -1 mean none."""
    numbers = _GAME_EVENT.pack(_robot(record.robot), _room(record.room))
    return header(tick) + string(record.kind) + numbers + string(record.json)


def score(tick: int, record: Score) -> bytes:
    """thbridge_msgs/Score."""
    energy = np.array(record.energy, dtype="<f8")
    numbers = _SCORE.pack(record.score, record.visited, record.rooms)
    return header(tick) + numbers + _UINT32.pack(len(energy)) + energy.tobytes()


def utterance(tick: int, record: Utterance) -> bytes:
    """thbridge_msgs/Utterance; room -1 means none."""
    return b"".join(
        (
            header(tick),
            _INT64.pack(record.dialogue),
            string(record.speaker),
            _GAME_EVENT.pack(_robot(record.robot), _room(record.room)),
            string(record.scenario),
            string(record.text),
            string(record.move),
        )
    )


def outside_input(tick: int, record: Input) -> bytes:
    """thbridge_msgs/Input."""
    return header(tick) + b"".join(string(text) for text in (record.kind, record.sender, record.line, record.json))


def _robot(robot: int | None) -> int:
    return 0 if robot is None else robot + 1


def _room(room: int | None) -> int:
    return -1 if room is None else room
