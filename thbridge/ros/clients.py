"""Decoders of ROS clients' messages to robots: pose estimates, goals, velocities, plan requests.

Messages of clients may be invalid. The result of any bytes is a value, or an `InvalidMessage` with a sentence for the
log.
"""

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import Twist
from sim.numerics import elementary
from sim.numerics.float_array import FloatArray
from thbridge.ros.messages.cursor import FLOAT32, Cursor
from thbridge.ros.messages.unpack.robots import read_grid
from thbridge.ros.names import MAP_FRAME, frame_name

T = TypeVar("T")

_GOAL_ID_LENGTH = 512
"""Maximum length of a goal id. actionlib's ids consist of node, number and time. Every status list repeats the ids."""
_PLANAR = np.ix_((0, 1, 5), (0, 1, 5))
"""Indices of x, y and yaw among x, y, z, roll, pitch, yaw."""
FARTHEST = 1e6
"""Maximum coordinate in meters. No map is so large, and squares of larger numbers lose precision."""
_FLAT = elementary.cos(math.radians(10.0))
"""Cosine of the maximum tilt of a goal. move_base also treats a few degrees as noise, and a larger tilt as an error."""


@dataclass(frozen=True, slots=True)
class InvalidMessage:
    """Message that cannot be used. `sentence` is the reason."""

    sentence: str


@dataclass(frozen=True, slots=True, eq=False)
class PoseEstimate:
    """Pose of a robot with its (3, 3) covariance of x, y, theta."""

    base_in_map: Pose2
    covariance: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class MapRequest:
    """Request of nav_msgs/SetMap: a map, and the robot's pose on it."""

    grid: OccupancyGrid
    estimate: PoseEstimate


@dataclass(frozen=True, slots=True)
class LoggerLevel:
    """Request of roscpp/SetLoggerLevel: a logger's name, and its new level as a word."""

    logger: str
    level: str


@dataclass(frozen=True, slots=True)
class ActionGoal:
    """Goal with the id and time stamp of its client. `pose` is an `InvalidMessage` if the pose cannot be used."""

    goal_id: str
    stamp_ns: int
    pose: Pose2 | InvalidMessage


@dataclass(frozen=True, slots=True)
class ActionCancel:
    """Goals to cancel: the goal with this id, and all goals up to this time. If both are empty, cancel all goals."""

    goal_id: str
    stamp_ns: int


@dataclass(frozen=True, slots=True)
class PlanRequest:
    """Request of nav_msgs/GetPlan: start (None for the robot's own pose), goal, tolerance around the goal in meters."""

    start: Pose2 | None
    goal: Pose2
    tolerance: float


def _decoder(decode: Callable[[Cursor], T | InvalidMessage]) -> Callable[[bytes], T | InvalidMessage]:
    """Return a decoder of bytes. For bytes that are not a message of this type, it returns an `InvalidMessage`."""

    @functools.wraps(decode)
    def of_bytes(data: bytes) -> T | InvalidMessage:
        try:
            return decode(Cursor(data))
        except ValueError as error:
            return InvalidMessage(str(error))

    return of_bytes


@_decoder
def pose_estimate(cursor: Cursor) -> PoseEstimate | InvalidMessage:
    """Decode geometry_msgs/PoseWithCovarianceStamped of `initialpose` or of robot_localization's `set_pose`."""
    return _pose_estimate(cursor)


@_decoder
def map_request(cursor: Cursor) -> MapRequest | InvalidMessage:
    """Return the request of nav_msgs/SetMap."""
    grid = read_grid(cursor)
    estimate = _pose_estimate(cursor)
    return estimate if isinstance(estimate, InvalidMessage) else MapRequest(grid, estimate)


def _pose_estimate(cursor: Cursor) -> PoseEstimate | InvalidMessage:
    _, frame = cursor.header()
    pose = _pose_in_map(cursor, frame)
    covariance = cursor.reals(36).reshape(6, 6)[_PLANAR]
    if isinstance(pose, InvalidMessage):
        return pose
    if not is_covariance(covariance):
        return InvalidMessage("its covariance is not one: it has to be finite and positive semi-definite")
    return PoseEstimate(pose, covariance)


def is_covariance(matrix: FloatArray) -> bool:
    """Return True if a (3, 3) matrix is a covariance of a pose, which is positive semi-definite and not too large."""
    if matrix.shape != (3, 3) or not bool((np.abs(matrix) <= FARTHEST * FARTHEST).all()):
        return False
    # Add slightly more than the rounding error to the diagonal. Then all leading minors must be positive (Sylvester).
    more = 1e-9 * max(1.0, float(np.trace(matrix)))
    (xx, xy, xa), (_, yy, ya), (_, _, aa) = (0.5 * (matrix + matrix.T) + more * np.eye(3)).tolist()
    plane = xx * yy - xy * xy
    whole = xx * (yy * aa - ya * ya) - xy * (xy * aa - ya * xa) + xa * (xy * ya - yy * xa)
    return bool(xx > 0.0 and plane > 0.0 and whole > 0.0)


@_decoder
def goal_pose(cursor: Cursor) -> Pose2 | InvalidMessage:
    """Decode geometry_msgs/PoseStamped."""
    _, frame = cursor.header()
    return _pose_in_map(cursor, frame)


@_decoder
def action_goal(cursor: Cursor) -> ActionGoal | InvalidMessage:
    """Decode move_base_msgs/MoveBaseActionGoal."""
    cursor.header()
    stamp_ns, goal_id = cursor.stamp(), _goal_id(cursor)
    _, frame = cursor.header()
    return ActionGoal(goal_id, stamp_ns, _pose_in_map(cursor, frame))


@_decoder
def action_cancel(cursor: Cursor) -> ActionCancel | InvalidMessage:
    """Decode actionlib_msgs/GoalID."""
    stamp_ns = cursor.stamp()
    return ActionCancel(_goal_id(cursor), stamp_ns)


@_decoder
def velocity(cursor: Cursor) -> Twist | InvalidMessage:
    """Decode geometry_msgs/Twist. A robot with two wheels uses only linear x and angular z."""
    six = cursor.reals(6)
    if not np.isfinite(six).all():
        return InvalidMessage("it is not finite")
    return Twist(float(six[0]), float(six[5]))


@_decoder
def logger_level(cursor: Cursor) -> LoggerLevel | InvalidMessage:
    """Return the request of roscpp/SetLoggerLevel."""
    return LoggerLevel(cursor.string(), cursor.string())


@_decoder
def plan_request(cursor: Cursor) -> PlanRequest | InvalidMessage:
    """Return the request of nav_msgs/GetPlan. A start without a frame means the robot's own pose, as in move_base."""
    _, start_frame = cursor.header()
    start: Pose2 | InvalidMessage | None = None
    if start_frame:
        start = _pose_in_map(cursor, start_frame)
    else:
        # The pose is not used, but the goal comes after it.
        cursor.spatial_pose()
    _, goal_frame = cursor.header()
    goal = _pose_in_map(cursor, goal_frame)
    (tolerance,) = FLOAT32.unpack(cursor.take(FLOAT32.size))
    if isinstance(start, InvalidMessage):
        return start
    if isinstance(goal, InvalidMessage):
        return goal
    if not (math.isfinite(tolerance) and tolerance >= 0.0):
        return InvalidMessage(f"its tolerance of {tolerance} m is none")
    return PlanRequest(start, goal, float(tolerance))


def _goal_id(cursor: Cursor) -> str:
    goal_id = cursor.string()
    if len(goal_id) > _GOAL_ID_LENGTH:
        raise ValueError(f"its goal has a name of more than {_GOAL_ID_LENGTH} characters")
    return goal_id


def _pose_in_map(cursor: Cursor, frame: str) -> Pose2 | InvalidMessage:
    return planar_pose(frame, *cursor.spatial_pose())


def planar_pose(
    frame: str, x: float, y: float, z: float, qx: float, qy: float, qz: float, qw: float
) -> Pose2 | InvalidMessage:
    """Return the planar pose of a position and a quaternion in a frame."""
    if frame_name(frame) != MAP_FRAME:
        return InvalidMessage(f"its frame is {frame!r}; give it in the frame {MAP_FRAME!r}")
    length = math.sqrt(qx * qx + qy * qy + qz * qz + qw * qw)
    # The sum is finite only if all these numbers are finite.
    if not math.isfinite(x + y + z + length):
        return InvalidMessage("its pose is not finite")
    if max(abs(x), abs(y)) > FARTHEST:
        return InvalidMessage("its pose is farther away than any map is large")
    if length < 1e-6:
        return InvalidMessage("its quaternion is empty; no rotation is (0, 0, 0, 1)")
    qx, qy, qz, qw = qx / length, qy / length, qz / length, qw / length
    if 1.0 - 2.0 * (qx * qx + qy * qy) < _FLAT:
        return InvalidMessage("its pose is tilted; robots here drive in the plane")
    yaw = elementary.atan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz))
    # Headings here are in [-pi, pi), but the arctangent may be pi.
    return Pose2(x, y, yaw if yaw < math.pi else -math.pi)
