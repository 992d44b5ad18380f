"""Messages between the clients and the server of the action move_base."""

from dataclasses import dataclass

from sim.common.geometry import Pose2
from thbridge.ros.messages.cursor import UINT8, UINT32, Cursor
from thbridge.ros.messages.goal_status import GoalId, GoalStatus, GoalStatusCode
from thbridge.ros.messages.unpack.poses import read_pose


@dataclass(frozen=True, slots=True)
class MoveBaseGoal:
    """move_base_msgs/MoveBaseActionGoal: id of the goal, and its pose in `frame`."""

    goal_id: str
    frame: str
    pose: Pose2


@dataclass(frozen=True, slots=True)
class MoveBaseResult:
    """move_base_msgs/MoveBaseActionResult: id of the goal, its status as a code of actionlib, and the reason."""

    goal_id: str
    status: int
    text: str


def move_base_goal(data: bytes) -> MoveBaseGoal:
    """Decode move_base_msgs/MoveBaseActionGoal."""
    cursor = Cursor.behind_header(data)
    cursor.stamp()
    goal_id = cursor.string()
    _, frame = cursor.header()
    return MoveBaseGoal(goal_id, frame, read_pose(cursor))


def move_base_result(data: bytes) -> MoveBaseResult:
    """Decode move_base_msgs/MoveBaseActionResult."""
    cursor = Cursor.behind_header(data)
    cursor.stamp()
    return MoveBaseResult(cursor.string(), cursor.integer(UINT8), cursor.string())


def goal_result(data: bytes) -> GoalStatus:
    """Decode move_base_msgs/MoveBaseActionResult as the final status of its goal."""
    cursor = Cursor.behind_header(data)
    return _status(cursor)


def goal_id(data: bytes) -> GoalId:
    """Decode actionlib_msgs/GoalID."""
    return _goal_id(Cursor(data))


def goal_status_array(data: bytes) -> list[GoalStatus]:
    """Decode actionlib_msgs/GoalStatusArray."""
    cursor = Cursor.behind_header(data)
    return [_status(cursor) for _ in range(cursor.integer(UINT32))]


def move_base_feedback(data: bytes) -> tuple[GoalStatus, str, Pose2]:
    """Decode move_base_msgs/MoveBaseActionFeedback to the status of the goal, the frame, and the base's pose in it."""
    cursor = Cursor.behind_header(data)
    status = _status(cursor)
    _, frame = cursor.header()
    return status, frame, read_pose(cursor)


def _goal_id(cursor: Cursor) -> GoalId:
    stamp_ns = cursor.stamp()
    return GoalId(cursor.string(), stamp_ns)


def _status(cursor: Cursor) -> GoalStatus:
    return GoalStatus(_goal_id(cursor), GoalStatusCode(cursor.integer(UINT8)), cursor.string())
