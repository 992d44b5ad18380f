"""Messages that all actions have in common: ids, times, poses, goal lists."""

import struct
from collections.abc import Sequence

from sim.common.geometry import Pose2
from sim.numerics import elementary
from thbridge.ros2.actions import ActionGoalState, ActionGoalStatus, GoalInfo
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.message_fields import GoalInfoFields, GoalStatusArrayFields, TimeFields

_SECOND = 1_000_000_000
_CDR = struct.Struct("<4sI")
"""Header of a message in little-endian CDR, and the length of a sequence."""
_FIRST, _LATER = struct.Struct("<16siIb"), struct.Struct("<16s3xiIb")
"""action_msgs/GoalStatus, first in a sequence or not: id, seconds and nanoseconds of the acceptance, and the state."""


def time_of(distribution: Distribution, ns: int) -> object:
    """Return a builtin_interfaces/Time."""
    return distribution.make("builtin_interfaces/msg/Time", sec=ns // _SECOND, nanosec=ns % _SECOND)


def duration_of(distribution: Distribution, ns: int) -> object:
    """Return a builtin_interfaces/Duration."""
    return distribution.make("builtin_interfaces/msg/Duration", sec=ns // _SECOND, nanosec=ns % _SECOND)


def pose_stamped_of(distribution: Distribution, frame: str, now_ns: int, pose: Pose2) -> object:
    """Return a geometry_msgs/PoseStamped."""
    make = distribution.make
    cosine, sine = elementary.cos_sin(0.5 * pose.theta)
    return make(
        "geometry_msgs/msg/PoseStamped",
        header=make("std_msgs/msg/Header", stamp=time_of(distribution, now_ns), frame_id=frame),
        pose=make(
            "geometry_msgs/msg/Pose",
            position=make("geometry_msgs/msg/Point", x=pose.x, y=pose.y, z=0.0),
            orientation=make("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=sine, w=cosine),
        ),
    )


def nanoseconds(time: TimeFields) -> int:
    """Return a builtin_interfaces/Time or Duration in nanoseconds."""
    return int(time.sec) * _SECOND + int(time.nanosec)


def uuid_of(distribution: Distribution, goal_id: bytes) -> object:
    """Return a unique_identifier_msgs/UUID."""
    return distribution.make("unique_identifier_msgs/msg/UUID", uuid=goal_id)


def goal_info_of(distribution: Distribution, goal: GoalInfo) -> object:
    """Return an action_msgs/GoalInfo."""
    return distribution.make(
        "action_msgs/msg/GoalInfo", goal_id=uuid_of(distribution, goal.id), stamp=time_of(distribution, goal.stamp_ns)
    )


def encode_statuses(statuses: Sequence[ActionGoalStatus]) -> bytes:
    """Return an action_msgs/GoalStatusArray in CDR. It is encoded here because servers publish long lists often."""
    goals = (
        # Ids follow without a gap, and times begin at a multiple of 4 bytes.
        (_LATER if number else _FIRST).pack(goal.id, *divmod(goal.stamp_ns, _SECOND), int(state))
        for number, (goal, state) in enumerate(statuses)
    )
    return _CDR.pack(b"\0\1\0\0", len(statuses)) + b"".join(goals)


def goal_info(message: GoalInfoFields) -> GoalInfo:
    """Return the content of an action_msgs/GoalInfo."""
    return GoalInfo(message.goal_id.uuid.tobytes(), nanoseconds(message.stamp))


def goal_state(code: int) -> ActionGoalState:
    """Return the state with this code. Codes that do not exist are UNKNOWN."""
    return ActionGoalState(code) if code in {*ActionGoalState} else ActionGoalState.UNKNOWN


def goal_statuses(message: GoalStatusArrayFields) -> tuple[ActionGoalStatus, ...]:
    """Return the content of an action_msgs/GoalStatusArray."""
    return tuple(
        ActionGoalStatus(goal_info(status.goal_info), goal_state(status.status)) for status in message.status_list
    )
