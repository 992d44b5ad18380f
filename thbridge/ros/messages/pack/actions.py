"""Messages between the clients and the server of the action move_base."""

from collections.abc import Sequence
from functools import lru_cache
from struct import Struct

from sim.common.geometry import Pose2
from thbridge.ros.messages.goal_status import GoalId, GoalStatus
from thbridge.ros.messages.pack.fields import UINT32, header, stamp, string
from thbridge.ros.messages.pack.motion import pose_stamped

_TWO_UINT16 = Struct("<HH")


def goal_id(goal: GoalId) -> bytes:
    """Encode actionlib_msgs/GoalID. This message also cancels a goal."""
    return stamp(goal.stamp_ns) + string(goal.id)


@lru_cache(maxsize=1024)
def _status(entry: GoalStatus) -> bytes:
    """Encode actionlib_msgs/GoalStatus.

    Results are cached, because lists repeat a status five times per second, and feedback ten times per second.
    """
    return goal_id(entry.goal) + bytes((entry.status,)) + string(entry.text)


def move_base_goal(tick: int, goal: GoalId, frame: str, pose: Pose2) -> bytes:
    """Encode move_base_msgs/MoveBaseActionGoal, which requests a drive to a pose in `frame`."""
    return header(tick) + goal_id(goal) + pose_stamped(tick, frame, pose)


def recovery_status(tick: int, frame: str, base: Pose2, number: int, total: int, behaviour: str) -> bytes:
    """Encode move_base_msgs/RecoveryStatus: recovery behavior `number` (from 0) of `total` begins at a pose."""
    return pose_stamped(tick, frame, base) + _TWO_UINT16.pack(number, total) + string(behaviour)


def goal_status_array(tick: int, entries: Sequence[GoalStatus]) -> bytes:
    """Encode actionlib_msgs/GoalStatusArray."""
    return header(tick) + UINT32.pack(len(entries)) + b"".join(map(_status, entries))


def move_base_feedback(tick: int, entry: GoalStatus, base: bytes) -> bytes:
    """Encode move_base_msgs/MoveBaseActionFeedback. `base` is a complete geometry_msgs/PoseStamped."""
    return header(tick) + _status(entry) + base


def move_base_result(tick: int, entry: GoalStatus) -> bytes:
    """Encode move_base_msgs/MoveBaseActionResult of a goal that ended at this tick. The result itself has no fields."""
    return header(tick) + _status(entry)
