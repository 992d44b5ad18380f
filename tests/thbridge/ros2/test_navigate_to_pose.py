"""navigate_to_pose of a robot: goals become requests, and the messages of move_base become states and results."""

from typing import Any

import hypothesis.strategies as st
import pytest
from hypothesis import settings
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from sim.common.geometry import Pose2
from sim.robot.navigator.goals import Goal, NoPathReason
from tests.support.ros2.driven_robot import HERE, DrivenRobot
from tests.support.ros2.navigation_goals import goal_id, navigation_goal
from thbridge.ros.messages.records import CancelRequest, GoalRequest, SimpleGoal
from thbridge.ros.messages.stamps import stamp_ns
from thbridge.ros2.action_messages import nanoseconds
from thbridge.ros2.actions import FINAL, NO_ID, ActionGoalState, ActionResult, CancelCode
from thbridge.ros2.distribution import Distribution

KILTED = Distribution.of("kilted")
JAZZY = Distribution.of("jazzy")
ACCEPTED, EXECUTING, CANCELING = ActionGoalState.ACCEPTED, ActionGoalState.EXECUTING, ActionGoalState.CANCELING
SUCCEEDED, CANCELED, ABORTED = ActionGoalState.SUCCEEDED, ActionGoalState.CANCELED, ActionGoalState.ABORTED
A, B = goal_id(1), goal_id(2)
CLIENT = "/rviz"


def send(robot: DrivenRobot, goal: bytes, x: float = 3.0, frame: str = "map", tree: str = "") -> bool:
    message = navigation_goal(KILTED, x, frame, tree)
    return robot.navigate.receive_goal(goal, message, CLIENT) is not None


def states(robot: DrivenRobot) -> dict[bytes, ActionGoalState]:
    return {goal.id: state for goal, state in robot.navigate.goals.statuses}


def end(robot: DrivenRobot, goal: bytes) -> tuple[ActionGoalState, int, str]:
    result = robot.navigate.goals.result(goal)
    assert result is not None
    assert result.value is not None
    return result.state, result.value.error_code, result.value.error_msg


def under_way(distribution: Distribution = KILTED) -> DrivenRobot:
    """Return a robot that drives to the goal A."""
    robot = DrivenRobot(distribution)
    robot.step()
    assert send(robot, A)
    robot.step()
    return robot


def test_a_goal_becomes_a_request_and_its_end_a_result() -> None:
    robot = DrivenRobot(KILTED)
    robot.step()
    assert send(robot, A)
    assert robot.requested == [(CLIENT, GoalRequest(0, A.hex(), 0, Pose2(3.0, 0.0, 0.0), 0))]
    assert states(robot) == {A: ACCEPTED}
    robot.step()
    assert states(robot) == {A: EXECUTING}
    robot.arrive()
    robot.step()
    assert end(robot, A) == (SUCCEEDED, 0, "")


def test_an_id_is_accepted_only_once() -> None:
    robot = under_way()
    assert not send(robot, A)
    assert len(robot.requested) == 1


@pytest.mark.parametrize(
    ("reason", "kilted", "jazzy"),
    [
        ("goal_occupied", 206, 206),
        ("goal_outside", 204, 204),
        ("start_occupied", 205, 205),
        ("start_outside", 203, 203),
        ("no_way", 208, 208),
        ("robots_in_the_way", 104, 104),
        ("blocked_by_obstacle", 106, 106),
        ("stuck", 105, 105),
        ("lost", 9002, 202),
        ("gave_up", 9000, 100),
    ],
)
def test_each_reason_has_an_error_code_of_the_distribution(reason: NoPathReason, kilted: int, jazzy: int) -> None:
    for distribution, code in ((KILTED, kilted), (JAZZY, jazzy)):
        robot = under_way(distribution)
        robot.fail(reason, "the reason")
        robot.step()
        assert end(robot, A) == (ABORTED, code, "the reason")


def test_a_newer_goal_preempts() -> None:
    robot = under_way()
    assert send(robot, B)
    robot.step()
    assert states(robot) == {A: ABORTED, B: EXECUTING}
    assert end(robot, A) == (ABORTED, 0, "")


def test_of_two_goals_in_one_tick_the_second_counts() -> None:
    robot = DrivenRobot(KILTED)
    robot.step()
    send(robot, A)
    send(robot, B)
    robot.step()
    assert states(robot) == {A: ABORTED, B: EXECUTING}


@pytest.mark.parametrize(("frame", "tree", "kilted", "jazzy"), [("odom", "", 9002, 202), ("map", "dance.xml", 9001, 0)])
def test_a_goal_that_cannot_be_used_is_aborted_and_the_robot_drives_on(
    frame: str, tree: str, kilted: int, jazzy: int
) -> None:
    for distribution, code in ((KILTED, kilted), (JAZZY, jazzy)):
        robot = under_way(distribution)
        assert send(robot, B, frame=frame, tree=tree)
        state, error, sentence = end(robot, B)
        assert (state, error) == (ABORTED, code)
        assert frame in sentence or tree in sentence
        robot.step()
        assert states(robot) == {A: EXECUTING, B: ABORTED}
        assert len(robot.requested) == 1


@pytest.mark.parametrize(("goal", "stamp"), [(A, 0), (NO_ID, 0), (NO_ID, stamp_ns(9))])
def test_a_goal_is_canceled_by_id_by_time_and_with_all(goal: bytes, stamp: int) -> None:
    robot = under_way()
    answer = robot.navigate.receive_cancel(goal, stamp, CLIENT)
    assert (answer.code, [each.id for each in answer.goals]) == (CancelCode.NONE, [A])
    assert robot.requested[1:] == [(CLIENT, CancelRequest(0, A.hex(), 0))]
    assert states(robot) == {A: CANCELING}
    robot.step()
    assert end(robot, A) == (CANCELED, 0, "")


def test_a_goal_is_canceled_before_it_starts() -> None:
    robot = DrivenRobot(KILTED)
    robot.step()
    send(robot, A)
    robot.navigate.receive_cancel(A, 0, CLIENT)
    robot.step()
    assert end(robot, A) == (CANCELED, 0, "")
    assert robot.goal is None


def test_goals_of_the_game_and_of_goal_pose_are_listed() -> None:
    robot = DrivenRobot(KILTED)
    robot.step()
    robot.drive(Goal(7, Pose2(1.0, 1.0, 0.0)))
    robot.step()
    robot.ask(SimpleGoal(0, Pose2(2.0, 2.0, 0.0), 0))
    robot.step()
    assert [*states(robot).values()] == [ABORTED, EXECUTING]
    robot.drive(Goal(7, Pose2(1.0, 1.0, 0.0)))
    robot.step()
    assert [*states(robot).values()] == [ABORTED, ABORTED, EXECUTING]
    robot.stop()
    robot.step()
    assert [*states(robot).values()] == [ABORTED, ABORTED, CANCELED]
    again = DrivenRobot(KILTED)
    again.step()
    again.drive(Goal(7, Pose2(1.0, 1.0, 0.0)))
    again.step()
    assert [*states(again)] == [*states(robot)][:1]


def test_all_goals_are_canceled_even_those_of_others() -> None:
    robot = DrivenRobot(KILTED)
    robot.step()
    robot.drive(Goal(7, Pose2(1.0, 1.0, 0.0)))
    robot.step()
    robot.navigate.receive_cancel(NO_ID, 0, CLIENT)
    robot.step()
    assert [*states(robot).values()] == [CANCELED]
    assert robot.goal is None


def test_a_cancel_request_of_ros_1_cancels_too() -> None:
    robot = under_way()
    robot.ask(CancelRequest(0, "", 0))
    robot.step()
    assert end(robot, A) == (CANCELED, 0, "")


def test_goals_of_a_robot_that_dies_are_aborted_and_a_dead_robot_rejects_goals() -> None:
    robot = under_way()
    robot.step(dead=True)
    assert end(robot, A) == (ABORTED, 9000, "the robot stopped working")
    assert not send(robot, B)
    robot.step(3)
    assert end(robot, A) == (ABORTED, 9000, "the robot stopped working")
    assert send(robot, B)
    robot.step()
    assert states(robot) == {A: ABORTED, B: EXECUTING}


def test_a_goal_that_move_base_does_not_take_is_aborted() -> None:
    robot = under_way()
    robot.ask(GoalRequest(0, B.hex(), 0, Pose2(2.0, 2.0, 0.0), 99))
    robot.step()
    robot.arrive()
    robot.step()
    # A client of ROS 1 has used the same id before, so move_base ignores this goal.
    assert send(robot, B)
    robot.step(100)
    assert states(robot)[B] is ACCEPTED
    robot.step()
    assert end(robot, B)[:2] == (ABORTED, 9000)


def test_feedback_has_pose_time_distance_and_recoveries() -> None:
    robot = DrivenRobot(KILTED)
    robot.recoveries = 5
    robot.step(5)
    send(robot, A)
    robot.remaining, robot.speed = 4.0, 0.5
    robot.step(2)
    robot.recoveries = 2  # The list of behaviors has begun again.
    robot.step(9)
    received = robot.navigate.take_feedback()
    assert [goal for goal, _ in received] == 3 * [A]
    feedback: Any = received[-1][1]
    position = feedback.current_pose.pose.position
    assert (position.x, position.y, feedback.current_pose.header.frame_id) == (HERE.x, HERE.y, "map")
    assert nanoseconds(feedback.current_pose.header.stamp) == stamp_ns(15)
    assert nanoseconds(feedback.navigation_time) == stamp_ns(15) - stamp_ns(4)
    assert nanoseconds(feedback.estimated_time_remaining) == 8_000_000_000
    assert (feedback.distance_remaining, feedback.number_of_recoveries) == (4.0, 2)
    assert robot.navigate.take_feedback() == []


def test_a_robot_that_stands_has_no_remaining_time() -> None:
    robot = under_way()
    robot.remaining = 4.0
    robot.step(5)
    ((_, feedback),) = robot.navigate.take_feedback()
    assert nanoseconds(feedback.estimated_time_remaining) == 0


def test_results_are_kept_as_long_as_nav2_keeps_them() -> None:
    for distribution, seconds in ((KILTED, 10), (JAZZY, 900)):
        robot = under_way(distribution)
        robot.arrive()
        robot.step()
        robot.navigate.goals.expire(stamp_ns(robot.tick - 1) + seconds * 1_000_000_000)
        assert states(robot) == {A: SUCCEEDED}
        robot.navigate.goals.expire(stamp_ns(robot.tick) + seconds * 1_000_000_000)
        assert states(robot) == {}


class Clients(RuleBasedStateMachine):
    """Clients send, cancel and ask in any order, while the game and failures also move the robot."""

    def __init__(self) -> None:
        super().__init__()
        self.robot = DrivenRobot(KILTED)
        self.robot.step()
        self.server = self.robot.navigate
        self.results: dict[bytes, list[ActionResult[Any]]] = {}
        self.game = 0

    @rule(frame=st.sampled_from(["map", "map", "map", "odom"]))
    def send(self, frame: str) -> None:
        goal = (len(self.results) + 1).to_bytes(16, "big")
        if send(self.robot, goal, frame=frame):
            received = self.results.setdefault(goal, [])
            self.server.goals.ask_result(goal, received.append)

    @rule(back=st.integers(1, 3), everything=st.booleans())
    def cancel(self, back: int, everything: bool) -> None:
        goal = max(1, len(self.results) + 1 - back).to_bytes(16, "big")
        self.server.receive_cancel(NO_ID if everything else goal, 0, CLIENT)

    @rule()
    def cancel_by_ros_1(self) -> None:
        self.robot.ask(CancelRequest(0, "", 0))

    @rule()
    def play(self) -> None:
        self.game += 1
        self.robot.drive(Goal(self.game, Pose2(1.0, 1.0, 0.0)))

    @precondition(lambda self: self.robot.goal is not None)
    @rule(arrives=st.booleans())
    def finish(self, arrives: bool) -> None:
        self.robot.arrive() if arrives else self.robot.fail("stuck", "the robot is stuck")

    @rule(ticks=st.integers(1, 8), dead=st.sampled_from([False, False, False, True]))
    def wait(self, ticks: int, dead: bool) -> None:
        self.robot.step(ticks, dead=dead)

    @invariant()
    def goals_have_at_most_one_result_and_only_one_is_under_way(self) -> None:
        assert all(len(received) <= 1 for received in self.results.values())
        assert sum(state is EXECUTING for state in states(self.robot).values()) <= 1

    def teardown(self) -> None:
        self.robot.step(3)
        self.server.receive_cancel(NO_ID, 0, CLIENT)
        self.robot.step(2)
        assert all(state in FINAL for state in states(self.robot).values())
        assert all(len(received) == 1 for received in self.results.values())
        assert all(received[0].state in FINAL for received in self.results.values())
        assert self.robot.goal is None


Clients.TestCase.settings = settings(max_examples=60, stateful_step_count=30, deadline=None)
TestClients = Clients.TestCase
