"""Types of the messages of actions whose fields we read. At run time, they are classes that rosbags creates."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np
import numpy.typing as npt


class TimeFields(Protocol):
    """builtin_interfaces/Time or Duration."""

    sec: int
    nanosec: int


class UuidFields(Protocol):
    """unique_identifier_msgs/UUID."""

    uuid: npt.NDArray[np.uint8]


class PointFields(Protocol):
    """geometry_msgs/Point."""

    x: float
    y: float
    z: float


class QuaternionFields(Protocol):
    """geometry_msgs/Quaternion."""

    x: float
    y: float
    z: float
    w: float


class PoseFields(Protocol):
    """geometry_msgs/Pose."""

    position: PointFields
    orientation: QuaternionFields


class HeaderFields(Protocol):
    """std_msgs/Header."""

    stamp: TimeFields
    frame_id: str


class StampedPoseFields(Protocol):
    """geometry_msgs/PoseStamped."""

    header: HeaderFields
    pose: PoseFields


class GoalInfoFields(Protocol):
    """action_msgs/GoalInfo."""

    goal_id: UuidFields
    stamp: TimeFields


class GoalStatusFields(Protocol):
    """action_msgs/GoalStatus."""

    goal_info: GoalInfoFields
    status: int


class GoalStatusArrayFields(Protocol):
    """action_msgs/GoalStatusArray."""

    status_list: Sequence[GoalStatusFields]


class SendGoalRequestFields(Protocol):
    """Request of an action's service send_goal."""

    goal_id: UuidFields
    goal: object


class SendGoalResponseFields(Protocol):
    """Response of an action's service send_goal."""

    accepted: bool
    stamp: TimeFields


class CancelRequestFields(Protocol):
    """Request of action_msgs/CancelGoal."""

    goal_info: GoalInfoFields


class CancelResponseFields(Protocol):
    """Response of action_msgs/CancelGoal."""

    return_code: int
    goals_canceling: Sequence[GoalInfoFields]


class GetResultRequestFields(Protocol):
    """Request of an action's service get_result."""

    goal_id: UuidFields


class GetResultResponseFields(Protocol):
    """Response of an action's service get_result."""

    status: int
    result: object


class FeedbackMessageFields(Protocol):
    """Message on an action's topic feedback."""

    goal_id: UuidFields
    feedback: object


class NavigationGoalFields(Protocol):
    """Goal of nav2_msgs/NavigateToPose."""

    pose: StampedPoseFields
    behavior_tree: str


class NavigationResultFields(Protocol):
    """Result of nav2_msgs/NavigateToPose."""

    error_code: int
    error_msg: str


class WaypointsGoalFields(Protocol):
    """Goal of nav2_msgs/FollowWaypoints."""

    number_of_loops: int
    goal_index: int
    poses: Sequence[object]
