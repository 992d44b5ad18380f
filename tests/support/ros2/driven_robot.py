"""Robot of a session whose navigator does what a test says; its messages are those that a session publishes."""

from collections.abc import Sequence
from itertools import count

import numpy as np

from sim.common.geometry import Pose2
from sim.common.observations import Twist
from sim.inputs import CancelGoal, SendGoal
from sim.robot.navigator.goals import Cancelled, Goal, GoalReached, GoalResult, NoPath, NoPathReason
from sim.robot.navigator.navigation import Navigation
from thbridge.ros.actionlib import ActionRequest, Feedback, GoalEnded, GoalSet, MoveBaseServer, StatusList
from thbridge.ros.messages import pack
from thbridge.ros.messages.records import CancelRequest, GoalRequest
from thbridge.ros.messages.stamps import stamp_ns
from thbridge.ros.names import MAP_FRAME, RobotNames
from thbridge.ros.topics import Planners, RobotTopics, RosMessage
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.follow_waypoints import FollowWaypointsServer
from thbridge.ros2.navigate_to_pose import NavigateToPoseServer

HERE = Pose2(1.0, 2.0, 0.5)
NO_POSES = np.empty((0, 3))


class DrivenRobot:
    """Robot 1 of a session with its action servers. Requests take effect in the next tick.

    Attributes:
        navigate: its action server navigate_to_pose.
        waypoints: its action server follow_waypoints.
        tick: number of the next tick.
        goal: goal of its navigator.
        remaining: remaining length of its plan, meters.
        speed: its velocity command, m/s.
        recoveries: number of recovery behaviors that it has begun.
        requested: all requests so far, with their clients.
    """

    def __init__(self, distribution: Distribution) -> None:
        self.navigate = NavigateToPoseServer(0, distribution, count(), self._ask)
        self.waypoints = FollowWaypointsServer(distribution, self.navigate)
        self.tick = 0
        self.goal: Goal | None = None
        self.remaining = 0.0
        self.speed = 0.0
        self.recoveries = 0
        self.requested: list[tuple[str, GoalRequest | CancelRequest]] = []
        self._server = MoveBaseServer(0)
        self._topics = RobotTopics(RobotNames.of(0), Planners())
        self._asked: list[ActionRequest] = []
        self._recoveries_before = 0
        self._results: list[GoalResult] = []

    def _ask(self, client: str, request: GoalRequest | CancelRequest) -> None:
        self.requested.append((client, request))
        self._asked.append(request)

    def ask(self, *requests: ActionRequest) -> None:
        """Send requests of other clients: windows, ROS 1."""
        self._asked += requests

    def drive(self, goal: Goal) -> None:
        """Send the navigator to a goal, as the game does."""
        self.stop()
        self.goal = goal

    def stop(self) -> None:
        """Cancel the goal of the navigator, as the game does."""
        if self.goal is not None:
            self._results.append(Cancelled(self.goal))
        self.goal = None

    def arrive(self) -> None:
        """Reach the goal in the next tick."""
        assert self.goal is not None
        self._results.append(GoalReached(self.goal))
        self.goal = None

    def fail(self, reason: NoPathReason, sentence: str) -> None:
        """Give the goal up in the next tick."""
        assert self.goal is not None
        self._results.append(NoPath(self.goal, reason, sentence))
        self.goal = None

    def step(self, ticks: int = 1, *, dead: bool = False) -> None:
        """Simulate ticks."""
        for _ in range(ticks):
            self._step(dead)

    def _step(self, dead: bool) -> None:
        asked, self._asked = self._asked, []
        for item in self._server.take(self.tick, asked):
            match item:
                case SendGoal(_, goal):
                    self.drive(goal)
                case CancelGoal():
                    self.stop()
        if dead:
            self.goal, self._results = None, []
        result = self._results.pop(0) if self._results else None
        command = Twist(self.speed, 0.0)
        empty = np.empty(0)
        navigation = Navigation(command, self.goal, "idle", NO_POSES, empty, NO_POSES, result, self.remaining)
        begun = self.recoveries - (self._recoveries_before if self.recoveries >= self._recoveries_before else 0)
        self._recoveries_before = self.recoveries
        messages = self._published(None if dead else navigation)
        own = [message for message in messages if message.topic.name in self.navigate.topics]
        self.navigate.follow(self.tick, own, None if dead else navigation, begun)
        self.waypoints.follow(self.tick)
        self.tick += 1

    def _published(self, navigation: Navigation | None) -> Sequence[RosMessage]:
        tick, topics, messages = self.tick, self._topics, []
        believed = pack.pose_stamped(tick, MAP_FRAME, HERE)
        for message in self._server.follow(tick, navigation):
            match message:
                case GoalSet(goal, base):
                    packed = topics.goal, pack.move_base_goal(tick, goal, MAP_FRAME, base)
                case StatusList(entries):
                    packed = topics.status, pack.goal_status_array(tick, entries)
                case Feedback(entry):
                    packed = topics.feedback, pack.move_base_feedback(tick, entry, believed)
                case GoalEnded(entry):
                    packed = topics.result, pack.move_base_result(tick, entry)
            messages.append(RosMessage(packed[0], stamp_ns(tick), packed[1]))
        return messages
