"""Action server follow_waypoints of one robot: a client of its navigate_to_pose that visits poses one after the other.

Each pose becomes a goal of navigate_to_pose, which the session records as an input. So a replay needs no client.

Source: ros-navigation/navigation2, nav2_waypoint_follower (waypoint_follower.cpp), of Jazzy and Kilted.
Differences from Nav2: no tasks run at waypoints. A cancel request cancels only the goal of this action. A goal that
preempts another goal also starts at its own goal_index. The numbers of poses and of missed waypoints are limited.
"""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import cast

from thbridge.ros.actionlib import FEEDBACK_PERIOD
from thbridge.ros.messages.stamps import stamp_ns
from thbridge.ros2.action_logic import ActionLogic
from thbridge.ros2.actions import ActionGoalState, CancelAnswer
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.message_fields import NavigationResultFields, WaypointsGoalFields
from thbridge.ros2.navigate_to_pose import NAVIGATE_TO_POSE, RESULT_TIMEOUT_NS, NavigateToPoseServer
from thbridge.ros2.navigation_errors import NO_ERROR, ErrorResult, WaypointError, waypoint_error

FOLLOW_WAYPOINTS = "nav2_msgs/action/FollowWaypoints"
STOP_ON_FAILURE = True
"""Value in sessions. It is fixed, because recordings have no changes of parameters outside a robot's software."""
WAYPOINTS = 1000
"""Maximum number of poses of a goal, and of missed waypoints in its result."""


@dataclass(slots=True, eq=False)
class _WaypointTrip:
    """Goal that the robot follows.

    Attributes:
        goal_id: its id.
        client: node of the client that set it.
        poses: its poses, as geometry_msgs/PoseStamped.
        index: index of the present pose.
        loops: number of further rounds through all poses.
        sent: number of goals for navigate_to_pose so far.
        leg: id of the present goal of navigate_to_pose.
        missed: messages about waypoints that the robot did not reach.
    """

    goal_id: bytes
    client: str
    poses: Sequence[object]
    index: int
    loops: int
    sent: int = 0
    leg: bytes = b""
    missed: list[object] = field(default_factory=list)


class FollowWaypointsServer(ActionLogic):
    """Logic of one robot's action server follow_waypoints.

    Args:
        distribution: message types.
        navigate: the robot's action server navigate_to_pose.
        stop_on_failure: if True, a missed waypoint ends the goal.
    """

    def __init__(
        self, distribution: Distribution, navigate: NavigateToPoseServer, *, stop_on_failure: bool = STOP_ON_FAILURE
    ) -> None:
        super().__init__(RESULT_TIMEOUT_NS[distribution.name])
        self.stop_on_failure = stop_on_failure
        self._distribution = distribution
        self._navigate = navigate
        self._now = stamp_ns(0)
        self._trip: _WaypointTrip | None = None

    def receive_goal(self, goal_id: bytes, goal: object, client: str) -> int | None:
        """Process a new goal; see `ActionLogic`. It preempts the previous goal."""
        if not self.goals.accept(goal_id, self._now):
            return None
        if self._trip is not None:
            canceling = self.goals.state(self._trip.goal_id) is ActionGoalState.CANCELING
            self._end(self._trip, ActionGoalState.CANCELED if canceling else ActionGoalState.ABORTED)
        self.goals.execute(goal_id)
        fields = cast(WaypointsGoalFields, goal)
        trip = _WaypointTrip(goal_id, client, fields.poses, fields.goal_index, fields.number_of_loops)
        if not trip.index < len(trip.poses) <= WAYPOINTS:
            sentence = f"goal_index is {trip.index}, and there are {len(trip.poses)} poses; send 1 to {WAYPOINTS} poses"
            self._abort(trip, WaypointError.NO_VALID_WAYPOINTS, sentence)
        else:
            self._trip = trip
            self._send(trip)
        return self._now

    def receive_cancel(self, goal_id: bytes, stamp_ns: int, client: str) -> CancelAnswer:
        """Process a cancel request; see `ActionLogic`."""
        answer = self.goals.cancel(goal_id, stamp_ns)
        trip = self._trip
        if trip is not None and any(goal.id == trip.goal_id for goal in answer.goals):
            self._navigate.receive_cancel(trip.leg, 0, client)
        return answer

    def follow(self, tick: int) -> None:
        """Process a tick of the session, after navigate_to_pose has processed it."""
        self._now = stamp_ns(tick)
        self.goals.expire(self._now)
        trip = self._trip
        if trip is None:
            return
        result = self._navigate.goals.result(trip.leg)
        if result is not None:
            if self.goals.state(trip.goal_id) is ActionGoalState.CANCELING:
                self._end(trip, ActionGoalState.CANCELED)
                return
            if result.state is not ActionGoalState.SUCCEEDED and not self._miss(
                trip, cast(NavigationResultFields | None, result.value)
            ):
                return
            self._advance(trip)
        if self._trip is trip and tick % FEEDBACK_PERIOD == 0 and self.has_listeners():
            feedback = self._distribution.make(f"{FOLLOW_WAYPOINTS}_Feedback", current_waypoint=trip.index)
            self._feedback.append((trip.goal_id, feedback))

    def _send(self, trip: _WaypointTrip) -> None:
        """Send the robot to the present pose."""
        trip.sent += 1
        trip.leg = hashlib.sha256(trip.goal_id + str(trip.sent).encode()).digest()[:16]
        pose = trip.poses[trip.index]
        goal = self._distribution.make(f"{NAVIGATE_TO_POSE}_Goal", pose=pose, behavior_tree="")
        # If navigate_to_pose rejects the goal, its result is "unknown", and the waypoint is missed.
        self._navigate.receive_goal(trip.leg, goal, trip.client)

    def _advance(self, trip: _WaypointTrip) -> None:
        trip.index += 1
        if trip.index == len(trip.poses):
            if trip.loops == 0:
                self._end(trip, ActionGoalState.SUCCEEDED)
                return
            trip.index, trip.loops = 0, trip.loops - 1
        self._send(trip)

    def _miss(self, trip: _WaypointTrip, result: NavigationResultFields | None) -> bool:
        """Store a missed waypoint with the result of its goal. Return False if this ends the goal."""
        make, pose = self._distribution.make, trip.poses[trip.index]
        unknown = ErrorResult(int(WaypointError.UNKNOWN), "navigate_to_pose rejected the goal")
        code, sentence = unknown if result is None else ErrorResult(result.error_code, result.error_msg)
        if self._distribution.name == "jazzy":
            missed = make("nav2_msgs/msg/MissedWaypoint", index=trip.index, goal=pose, error_code=code)
        else:
            missed = make(
                "nav2_msgs/msg/WaypointStatus",
                waypoint_status=3,  # FAILED
                waypoint_index=trip.index,
                waypoint_pose=pose,
                error_code=code,
                error_msg=sentence,
            )
        trip.missed.append(missed)
        if self.stop_on_failure:
            self._abort(
                trip,
                WaypointError.STOP_ON_MISSED_WAYPOINT,
                f"the robot missed waypoint {trip.index}, and stop_on_failure is set",
            )
        elif len(trip.missed) == WAYPOINTS:
            self._abort(trip, WaypointError.UNKNOWN, f"the robot missed {WAYPOINTS} waypoints")
        return self._trip is trip

    def _abort(self, trip: _WaypointTrip, error: WaypointError, sentence: str) -> None:
        code = waypoint_error(self._distribution.name, error)
        self._end(trip, ActionGoalState.ABORTED, ErrorResult(int(code), sentence))

    def _end(self, trip: _WaypointTrip, state: ActionGoalState, error: ErrorResult = NO_ERROR) -> None:
        self._trip = None
        result = self._distribution.make(
            f"{FOLLOW_WAYPOINTS}_Result",
            missed_waypoints=trip.missed,
            error_code=error.code,
            error_msg=error.sentence,
        )
        self.goals.end(trip.goal_id, state, result, self._now)
