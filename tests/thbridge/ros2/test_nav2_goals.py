"""Goals of a real Nav2 robot in the form of move_base: every goal of our client ends with its reason."""

import pytest

from sim.common.geometry import Pose2
from sim.robot.navigator.goals import Cancelled, Goal, GoalReached, NoPath, NoPathReason
from thbridge.ros.messages import pack, types, unpack
from thbridge.ros.messages.goal_owners import GoalOwner
from thbridge.ros.messages.goal_status import GoalId
from thbridge.ros.messages.stamps import tick_of
from thbridge.ros.remote.goals import UNLISTED_TIMEOUT_NS, MoveBaseClient, OutgoingGoal
from thbridge.ros.remote.pose import STALE_NS
from thbridge.ros.topics import RosMessage, Topic
from thbridge.ros2.actions import ActionGoalState, ActionGoalStatus, ActionResult, GoalInfo
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.nav2_goals import FEEDBACK_GAP_NS, LEASE_NS, RESULT_WAIT_NS, Nav2Cancel, Nav2Goal, Nav2Goals
from thbridge.study.real_robots import FleetNames

SECOND = 1_000_000_000
KILTED = Distribution.of("kilted")
NAMED = FleetNames().names(1)
PREFIX = "/us-robot1-"
HERE, THERE = Pose2(0.0, 0.0, 0.0), Pose2(3.0, 1.0, 0.5)
GOAL = Goal(7, THERE)
OTHER = b"o" * 16
ACCEPTED, EXECUTING = ActionGoalState.ACCEPTED, ActionGoalState.EXECUTING
SUCCEEDED, CANCELED, ABORTED = ActionGoalState.SUCCEEDED, ActionGoalState.CANCELED, ActionGoalState.ABORTED


class Nav2:
    """A client of move_base whose messages go to a server of navigate_to_pose that a test plays."""

    def __init__(self) -> None:
        self.client = MoveBaseClient(PREFIX)
        self.goals = Nav2Goals(NAMED, PREFIX)
        self.now = 100 * SECOND
        self.alive = True
        self.feeds = False
        self.sent: list[Nav2Goal] = []
        self.canceled: list[bytes] = []
        self.run(0.1)

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds * 50)):
            self.now += SECOND // 50
            if self.feeds and self.sent:
                self.goals.receive_feedback(self.sent[-1].goal_id, self.now)
            for part, data in self.goals.step(self.now, has_server=self.alive):
                if part == "status":
                    self.client.receive_status(unpack.goal_status_array(data), self.now)
                else:
                    self.client.receive_result(unpack.goal_result(data), self.now)
            self.client.step(self.now, lost=False, stale=False)
            self.forward()

    def forward(self) -> None:
        outgoing, self.client.outgoing = self.client.outgoing, []
        for item in outgoing:
            tick = tick_of(self.now)
            if isinstance(item, OutgoingGoal):
                topic = Topic(NAMED.action("goal"), types.MOVE_BASE_GOAL)
                data = pack.move_base_goal(tick, item.goal_id, "map", item.base_in_map)
            else:
                topic = Topic(NAMED.action("cancel"), types.GOAL_ID)
                data = pack.goal_id(GoalId(item.name, 0))
            match self.goals.request_of(RosMessage(topic, self.now, data)):
                case Nav2Goal() as goal:
                    self.sent.append(goal)
                case Nav2Cancel(goal_id):
                    self.canceled.append(goal_id)

    def go(self, goal: Goal = GOAL) -> bytes:
        self.client.go(goal, self.now)
        self.forward()
        return self.sent[-1].goal_id

    def drive(self) -> bytes:
        goal_id = self.go()
        self.goals.receive_answer(goal_id, accepted=True)
        self.list((goal_id, EXECUTING))
        self.run(0.1)
        return goal_id

    def list(self, *entries: tuple[bytes, ActionGoalState]) -> None:
        statuses = tuple(ActionGoalStatus(GoalInfo(goal_id, 0), state) for goal_id, state in entries)
        self.goals.receive_statuses(statuses, self.now)

    def result(self, goal_id: bytes, state: ActionGoalState, code: int = 0, sentence: str = "") -> None:
        value = KILTED.make("nav2_msgs/action/NavigateToPose_Result", error_code=code, error_msg=sentence)
        self.goals.receive_result(goal_id, ActionResult(state, value), self.now)


@pytest.fixture
def nav2() -> Nav2:
    return Nav2()


def test_a_goal_is_sent_with_its_pose_and_is_under_way(nav2: Nav2) -> None:
    goal_id = nav2.drive()
    assert nav2.sent == [Nav2Goal(goal_id, THERE)]
    assert nav2.client.active
    assert nav2.client.goal(nav2.now, HERE) == GOAL
    nav2.result(goal_id, SUCCEEDED)
    nav2.run(0.1)
    assert nav2.client.results == [GoalReached(GOAL)]


@pytest.mark.parametrize(
    ("code", "reason"),
    [
        (208, "no_way"),
        (206, "goal_occupied"),
        (204, "goal_outside"),
        (106, "blocked_by_obstacle"),
        (105, "stuck"),
        (104, "robots_in_the_way"),
        (9002, "lost"),
        (202, "lost"),
        (9003, "gave_up"),
        (0, "gave_up"),
    ],
)
@pytest.mark.parametrize("list_first", [True, False])
def test_the_error_code_gives_the_reason(nav2: Nav2, code: int, reason: NoPathReason, list_first: bool) -> None:
    goal_id = nav2.drive()
    if list_first:
        nav2.list((goal_id, ABORTED))
        nav2.run(0.5)
        assert nav2.client.results == []
    nav2.result(goal_id, ABORTED, code, "so it is")
    nav2.run(0.1 if code else RESULT_WAIT_NS / SECOND + 0.1)
    assert nav2.client.results == [NoPath(GOAL, reason, f"so it is (Nav2 error {code})")]


def test_a_result_that_is_lost_is_read_from_the_list(nav2: Nav2) -> None:
    goal_id = nav2.drive()
    nav2.list((goal_id, SUCCEEDED))
    nav2.run(RESULT_WAIT_NS / SECOND + 0.3)
    assert nav2.client.results == [GoalReached(GOAL)]


def test_a_rejected_goal_fails(nav2: Nav2) -> None:
    nav2.goals.receive_answer(nav2.go(), accepted=False)
    nav2.run(0.1)
    assert nav2.client.results == [NoPath(GOAL, "gave_up", "navigate_to_pose rejected the goal")]


def test_our_cancel_request_ends_the_goal(nav2: Nav2) -> None:
    goal_id = nav2.drive()
    nav2.client.cancel(nav2.now)
    nav2.run(0.1)
    assert nav2.canceled == [goal_id]
    nav2.result(goal_id, CANCELED)
    nav2.run(0.1)
    assert nav2.client.results == [Cancelled(GOAL)]


def test_a_cancel_request_of_another_client_is_a_failure(nav2: Nav2) -> None:
    nav2.result(nav2.drive(), CANCELED)
    nav2.run(1.2)
    assert nav2.client.results == [NoPath(GOAL, "called_off", "another client canceled the goal")]


def test_a_goal_of_another_client_comes_first(nav2: Nav2) -> None:
    goal_id = nav2.drive()
    nav2.result(goal_id, ABORTED)
    nav2.run(0.2)
    nav2.list((goal_id, ABORTED), (OTHER, EXECUTING))
    nav2.run(0.2)
    assert nav2.client.results == [Cancelled(GOAL)]
    assert nav2.client.goal(nav2.now, HERE) == Goal(0, HERE, GoalOwner.STRANGER)
    nav2.list((OTHER, SUCCEEDED))
    nav2.run(0.2)
    assert nav2.client.goal(nav2.now, HERE) is None


def test_goals_of_an_earlier_run_are_canceled_but_not_those_of_others(nav2: Nav2) -> None:
    earlier = Nav2().drive()
    nav2.list((earlier, EXECUTING), (OTHER, EXECUTING))
    nav2.run(0.1)
    assert nav2.canceled == [earlier]


def test_after_a_restart_of_the_server_the_goal_is_sent_again(nav2: Nav2) -> None:
    goal_id = nav2.drive()
    nav2.alive = False
    nav2.run(0.2)
    nav2.alive = True
    nav2.run(UNLISTED_TIMEOUT_NS / SECOND + 0.5)
    assert [goal.base_in_map for goal in nav2.sent] == [THERE, THERE]
    assert nav2.sent[-1].goal_id != goal_id
    assert nav2.client.resent == 1


def test_a_server_that_vanishes_ends_the_goal(nav2: Nav2) -> None:
    nav2.drive()
    nav2.alive = False
    nav2.run(STALE_NS / SECOND + 0.5)
    assert nav2.client.results == [NoPath(GOAL, "unanswered", "the action server has become silent")]
    assert nav2.client.is_silent(nav2.now)


def test_feedback_that_stops_ends_the_goal_and_the_server_counts_as_silent(nav2: Nav2) -> None:
    nav2.feeds = True
    goal_id = nav2.drive()
    nav2.run(10.0)
    assert nav2.client.results == []
    nav2.feeds = False
    nav2.run((STALE_NS + FEEDBACK_GAP_NS) / SECOND + 0.5)
    assert nav2.client.results == [NoPath(GOAL, "unanswered", "the action server has become silent")]
    assert nav2.client.is_silent(nav2.now)
    nav2.feeds = True
    nav2.run(0.5)
    assert not nav2.client.is_silent(nav2.now)
    assert nav2.canceled == [goal_id]
    nav2.feeds = False
    nav2.run(LEASE_NS / SECOND + 1.0)
    assert not nav2.client.is_silent(nav2.now)


def test_a_server_without_feedback_is_present_as_long_as_it_is_on_the_graph(nav2: Nav2) -> None:
    nav2.drive()
    nav2.run(20.0)
    assert nav2.client.results == []
    assert not nav2.client.is_silent(nav2.now)
