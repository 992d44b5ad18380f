"""Action server navigate_to_pose of one robot: Nav2's view of the robot's action server move_base.

A goal of a client becomes a request to move_base, which the session records as an input. States, feedback and results
are read from the messages of move_base. So goals of the game, of `goal_pose` and of a ROS 1 graph appear here as well.

Source: ros-navigation/navigation2, nav2_bt_navigator (navigate_to_pose.cpp), nav2_behavior_tree
(bt_action_server_impl.hpp), nav2_util (simple_action_server.hpp), of Jazzy and Kilted.
Differences from Nav2: a goal that cannot be used always ends at once, and never stops the robot. There is one behavior
tree, without a name. A dead robot rejects goals.
"""

import hashlib
from collections.abc import Callable, Iterator, Sequence
from typing import TypeAlias, cast

from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND
from sim.robot.navigator.goals import NoPath, NoPathReason
from sim.robot.navigator.navigation import Navigation
from thbridge.ros.actionlib import REPLACED
from thbridge.ros.clients import InvalidMessage, planar_pose
from thbridge.ros.messages import unpack
from thbridge.ros.messages.goal_status import GoalStatus, GoalStatusCode
from thbridge.ros.messages.records import CancelRequest, GoalRequest
from thbridge.ros.messages.stamps import stamp_ns
from thbridge.ros.names import MAP_FRAME, RobotNames
from thbridge.ros.topics import RosMessage
from thbridge.ros2.action_logic import ActionLogic
from thbridge.ros2.action_messages import duration_of, pose_stamped_of
from thbridge.ros2.actions import ActionGoalState, CancelAnswer
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.message_fields import NavigationGoalFields, StampedPoseFields
from thbridge.ros2.navigation_errors import NO_ERROR, ErrorResult, NavigationError, navigation_error

NAVIGATE_TO_POSE = "nav2_msgs/action/NavigateToPose"
RESULT_TIMEOUT_NS = {"jazzy": 900_000_000_000, "kilted": 10_000_000_000}
"""Time for which Nav2's servers keep results. Jazzy has a parameter for it (action_server_result_timeout)."""
UNTAKEN_NS = 2_000_000_000
"""A goal that move_base does not list for this time has failed."""
_MOVING = 0.01
"""Minimum speed for an estimate of the remaining time, m/s."""
_NEAR = 0.1
"""Minimum distance to the goal for an estimate of the remaining time, meters."""

AskRobot: TypeAlias = Callable[[str, GoalRequest | CancelRequest], None]
"""Callback with the name of a client's node and its request to a robot."""


class NavigateToPoseServer(ActionLogic):
    """Logic of one robot's action server navigate_to_pose.

    Args:
        robot: its index in the team.
        distribution: message types.
        numbers: numbers of the goals of ROS clients. All sources of such goals share it.
        ask: callback for requests to the robot.

    Attributes:
        topics: topics of the session whose messages `follow` needs.
    """

    def __init__(self, robot: int, distribution: Distribution, numbers: Iterator[int], ask: AskRobot) -> None:
        super().__init__(RESULT_TIMEOUT_NS[distribution.name])
        self._robot = robot
        self._distribution = distribution
        self._numbers = numbers
        self._ask = ask
        names = RobotNames.of(robot)
        self._handlers: dict[str, Callable[[bytes], None]] = {
            names.topic("move_base/status"): self._receive_status,
            names.topic("move_base/feedback"): self._receive_feedback,
            names.topic("move_base/result"): lambda data: self._receive_end(unpack.goal_result(data)),
        }
        self.topics = frozenset(self._handlers)
        self._now = stamp_ns(0)
        self._navigation: Navigation | None = None
        self._dead = False
        self._recoveries = 0
        # Ids of goals in move_base, and here. Ended goals of move_base are not in it.
        self._ids: dict[str, bytes] = {}

    # Requests of clients

    def receive_goal(self, goal_id: bytes, goal: object, client: str) -> int | None:
        """Process a new goal; see `ActionLogic`."""
        fields = cast(NavigationGoalFields, goal)
        pose, behavior_tree = planar_pose_of(fields.pose), fields.behavior_tree
        if self._dead or not self.goals.accept(goal_id, self._now):
            return None
        if behavior_tree:
            sentence = f"there is no behavior tree {behavior_tree!r}; leave it empty"
            self._abort(goal_id, NavigationError.FAILED_TO_LOAD_BEHAVIOR_TREE, sentence)
        elif isinstance(pose, InvalidMessage):
            self._abort(goal_id, NavigationError.TF_ERROR, pose.sentence)
        else:
            self._ids[goal_id.hex()] = goal_id
            self._ask(client, GoalRequest(self._robot, goal_id.hex(), 0, pose, next(self._numbers)))
        return self._now

    def receive_cancel(self, goal_id: bytes, stamp_ns: int, client: str) -> CancelAnswer:
        """Process a cancel request; see `ActionLogic`. All goals at move_base are canceled by their own ids."""
        answer = self.goals.cancel(goal_id, stamp_ns)
        canceled = {goal.id for goal in answer.goals}
        for text, known in self._ids.items():
            if known in canceled:
                self._ask(client, CancelRequest(self._robot, text, 0))
        return answer

    # The session

    def follow(self, tick: int, messages: Sequence[RosMessage], navigation: Navigation | None, recoveries: int) -> None:
        """Process a tick of the session.

        Args:
            tick: number of the tick.
            messages: messages of this tick on `topics`, in their order.
            navigation: output of the robot's navigator. None if the robot is dead.
            recoveries: number of recovery behaviors that the robot has begun in this tick.
        """
        self._now, self._navigation, self._dead = stamp_ns(tick), navigation, navigation is None
        self._recoveries += recoveries
        for message in messages:
            self._handlers[message.topic.name](message.data)
        if self._dead:
            for goal_id in [*self._ids.values()]:
                self._abort(goal_id, NavigationError.UNKNOWN, "the robot stopped working")
        for goal in self.goals.active:
            if self.goals.state(goal.id) is ActionGoalState.ACCEPTED and self._now - goal.stamp_ns > UNTAKEN_NS:
                self._abort(goal.id, NavigationError.UNKNOWN, "the robot did not take the goal")
        if tick % TICKS_PER_SECOND == 0:
            self.goals.expire(self._now)

    def _receive_status(self, data: bytes) -> None:
        for entry in unpack.goal_status_array(data):
            if entry.status not in {GoalStatusCode.ACTIVE, GoalStatusCode.PREEMPTING}:
                continue
            goal_id = self._ids.get(entry.goal.id)
            if goal_id is None:
                goal_id = self._id_of(entry)
                if not self.goals.accept(goal_id, self._now):
                    continue  # This goal has ended here before its end at move_base.
                self._ids[entry.goal.id] = goal_id
            if self.goals.state(goal_id) is ActionGoalState.ACCEPTED:
                self._recoveries = 0
                self.goals.execute(goal_id)
            if entry.status is GoalStatusCode.PREEMPTING:
                self.goals.cancel(goal_id, 0)

    def _receive_feedback(self, data: bytes) -> None:
        if not self.has_listeners():
            return
        entry, _, pose = unpack.move_base_feedback(data)
        goal_id = self._ids.get(entry.goal.id)
        navigation = self._navigation
        if goal_id is None or navigation is None:
            return
        since = next(goal.stamp_ns for goal in self.goals.active if goal.id == goal_id)
        speed, remaining = abs(navigation.command.linear), navigation.remaining
        estimate = remaining / speed if speed > _MOVING and remaining > _NEAR else 0.0
        make = self._distribution.make
        feedback = make(
            f"{NAVIGATE_TO_POSE}_Feedback",
            current_pose=pose_stamped_of(self._distribution, MAP_FRAME, self._now, pose),
            navigation_time=duration_of(self._distribution, self._now - since),
            estimated_time_remaining=duration_of(self._distribution, round(estimate * 1e9)),
            number_of_recoveries=self._recoveries,
            distance_remaining=remaining,
        )
        self._feedback.append((goal_id, feedback))

    def _receive_end(self, entry: GoalStatus) -> None:
        goal_id = self._ids.get(entry.goal.id)
        if goal_id is None:
            return
        if entry.status is GoalStatusCode.SUCCEEDED:
            self._end(goal_id, ActionGoalState.SUCCEEDED, NO_ERROR)
        elif entry.status is GoalStatusCode.ABORTED:
            self._abort(goal_id, self._reason_of(entry.text), entry.text)
        elif self.goals.state(goal_id) is not ActionGoalState.CANCELING and self._is_replaced(entry):
            # Nav2 aborts a goal that a newer goal preempts, with an empty result.
            self._end(goal_id, ActionGoalState.ABORTED, NO_ERROR)
        else:
            self._end(goal_id, ActionGoalState.CANCELED, NO_ERROR)

    def _is_replaced(self, entry: GoalStatus) -> bool:
        """Return True if a newer goal has ended a goal. If this is a goal of the game, move_base gives no reason."""
        return entry.text == REPLACED or (self._navigation is not None and self._navigation.goal is not None)

    def _reason_of(self, sentence: str) -> NoPathReason | NavigationError:
        """Return the reason that the navigator gave with a sentence in this tick."""
        result = None if self._navigation is None else self._navigation.result
        if isinstance(result, NoPath) and result.sentence == sentence:
            return result.reason
        return NavigationError.UNKNOWN

    def _id_of(self, entry: GoalStatus) -> bytes:
        """Return the id of a goal that no client of this action has set. It is the same in every run."""
        text = f"{self._robot} {entry.goal.id} {entry.goal.stamp_ns}"
        return hashlib.sha256(text.encode()).digest()[:16]

    def _abort(self, goal_id: bytes, reason: NoPathReason | NavigationError, sentence: str) -> None:
        error = ErrorResult(navigation_error(self._distribution.name, reason), sentence)
        self._end(goal_id, ActionGoalState.ABORTED, error)

    def _end(self, goal_id: bytes, state: ActionGoalState, error: ErrorResult) -> None:
        self._ids = {text: known for text, known in self._ids.items() if known != goal_id}
        code, sentence = error
        result = self._distribution.make(f"{NAVIGATE_TO_POSE}_Result", error_code=int(code), error_msg=sentence)
        self.goals.end(goal_id, state, result, self._now)


def planar_pose_of(message: StampedPoseFields) -> Pose2 | InvalidMessage:
    """Return the pose of a geometry_msgs/PoseStamped."""
    position, turn = message.pose.position, message.pose.orientation
    numbers = position.x, position.y, position.z, turn.x, turn.y, turn.z, turn.w
    return planar_pose(message.header.frame_id, *numbers)
