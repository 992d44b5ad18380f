"""Action server compute_path_to_pose of one robot: it makes plans, and does not change the robot.

Each robot makes at most one plan per tick, so that clients cannot delay the session. Plans are no inputs.

Source: ros-navigation/navigation2, nav2_planner (planner_server.cpp).
Differences from Nav2: a goal does not preempt another goal; goals wait in their order. The planning time is 0. The
planner is always the robot's own planner, with the costs that its global costmap has at this time.
"""

from collections import deque
from collections.abc import Callable
from enum import IntEnum
from typing import Protocol, cast

import numpy as np

from sim.common.geometry import Pose2
from sim.numerics.float_array import FloatArray
from sim.robot.global_planning.path import PlanRefusal, PlanRefusalCode
from thbridge.ros.clients import InvalidMessage
from thbridge.ros.messages import pack, types
from thbridge.ros.messages.stamps import stamp_ns
from thbridge.ros.names import MAP_FRAME
from thbridge.ros2.action_logic import ActionLogic
from thbridge.ros2.actions import ActionGoalState
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.message_fields import StampedPoseFields
from thbridge.ros2.nav2_parameters import PLANNER
from thbridge.ros2.navigate_to_pose import RESULT_TIMEOUT_NS, planar_pose_of

COMPUTE_PATH_TO_POSE = "nav2_msgs/action/ComputePathToPose"
WAITING_GOALS = 20
"""Maximum number of goals that wait for their plan."""

MakePlan = Callable[[Pose2 | None, Pose2], FloatArray | PlanRefusal]
"""Function that makes a plan. Its arguments are the start (if None, the robot's own pose) and the goal."""


class PathError(IntEnum):
    """Error codes in results of ComputePathToPose."""

    NONE = 0
    UNKNOWN = 200
    INVALID_PLANNER = 201
    TF_ERROR = 202
    START_OUTSIDE_MAP = 203
    GOAL_OUTSIDE_MAP = 204
    START_OCCUPIED = 205
    GOAL_OCCUPIED = 206
    NO_VALID_PATH = 208


_OF_CODE: dict[PlanRefusalCode, PathError] = {
    "goal_occupied": PathError.GOAL_OCCUPIED,
    "goal_outside": PathError.GOAL_OUTSIDE_MAP,
    "start_occupied": PathError.START_OCCUPIED,
    "start_outside": PathError.START_OUTSIDE_MAP,
    "no_way": PathError.NO_VALID_PATH,
    "robots_in_the_way": PathError.NO_VALID_PATH,
    "blocked_by_obstacle": PathError.NO_VALID_PATH,
}


class PathGoalFields(Protocol):
    """Goal of nav2_msgs/ComputePathToPose."""

    goal: StampedPoseFields
    start: StampedPoseFields
    planner_id: str
    use_start: bool


class ComputePathServer(ActionLogic):
    """Logic of one robot's action server compute_path_to_pose.

    Args:
        distribution: message types.
        make_plan: makes a plan of the robot.
    """

    def __init__(self, distribution: Distribution, make_plan: MakePlan) -> None:
        super().__init__(RESULT_TIMEOUT_NS[distribution.name])
        self._distribution = distribution
        self._make_plan = make_plan
        self._to_path = distribution.from_ros1(types.PATH, "nav_msgs/msg/Path")
        self._waiting: deque[tuple[bytes, PathGoalFields]] = deque()
        self._tick = 0

    def receive_goal(self, goal_id: bytes, goal: object, client: str) -> int | None:
        """Process a new goal; see `ActionLogic`."""
        now = stamp_ns(self._tick)
        if len(self._waiting) >= WAITING_GOALS or not self.goals.accept(goal_id, now):
            return None
        self.goals.execute(goal_id)
        self._waiting.append((goal_id, cast(PathGoalFields, goal)))
        return now

    def follow(self, tick: int) -> None:
        """Process a tick of the session: make one plan, and end canceled goals."""
        self._tick = tick
        self.goals.expire(stamp_ns(tick))
        while self._waiting:
            goal_id, goal = self._waiting.popleft()
            if self.goals.state(goal_id) is ActionGoalState.CANCELING:
                self._end(goal_id, ActionGoalState.CANCELED)
            else:
                self._plan(goal_id, goal)
                break

    def _plan(self, goal_id: bytes, fields: PathGoalFields) -> None:
        if fields.planner_id not in ("", PLANNER):
            problem = f"there is no planner {fields.planner_id[:80]!r}; leave it empty, or use {PLANNER}"
            self._end(goal_id, ActionGoalState.ABORTED, PathError.INVALID_PLANNER, problem)
            return
        goal = planar_pose_of(fields.goal)
        start = planar_pose_of(fields.start) if fields.use_start else None
        for pose in (start, goal):
            if isinstance(pose, InvalidMessage):
                self._end(goal_id, ActionGoalState.ABORTED, PathError.TF_ERROR, pose.sentence)
                return
        plan = self._make_plan(cast("Pose2 | None", start), cast(Pose2, goal))
        if isinstance(plan, PlanRefusal):
            self._end(goal_id, ActionGoalState.ABORTED, _OF_CODE[plan.code], plan.sentence)
        else:
            self._end(goal_id, ActionGoalState.SUCCEEDED, poses=plan)

    def _end(
        self,
        goal_id: bytes,
        state: ActionGoalState,
        error: PathError = PathError.NONE,
        sentence: str = "",
        poses: FloatArray = np.empty((0, 3)),  # noqa: B008 - it is never changed
    ) -> None:
        path = self._distribution.decode("nav_msgs/msg/Path", self._to_path(pack.path(self._tick, MAP_FRAME, poses)))
        result = self._distribution.make(
            f"{COMPUTE_PATH_TO_POSE}_Result", path=path, error_code=int(error), error_msg=sentence
        )
        self.goals.end(goal_id, state, result, stamp_ns(self._tick))
