"""follow_waypoints of a robot: its waypoints become goals of navigate_to_pose, one after the other."""

from collections.abc import Sequence
from typing import Any

import pytest

from sim.common.geometry import Pose2
from sim.parameters import RobotParameters
from sim.robot.navigator.goals import Goal
from tests.support.ros2.driven_robot import DrivenRobot
from tests.support.ros2.navigation_goals import goal_id, waypoints_goal
from thbridge.ros.messages.records import CancelRequest, GoalRequest
from thbridge.ros2.actions import NO_ID, ActionGoalState, CancelCode
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.follow_waypoints import WAYPOINTS
from thbridge.ros2.nav2_parameters import robot_nodes

KILTED = Distribution.of("kilted")
JAZZY = Distribution.of("jazzy")
SUCCEEDED, CANCELED, ABORTED = ActionGoalState.SUCCEEDED, ActionGoalState.CANCELED, ActionGoalState.ABORTED
A, B = goal_id(1), goal_id(2)
CLIENT = "/operator"


def send(
    robot: DrivenRobot, goal: bytes, xs: Sequence[float], index: int = 0, loops: int = 0, kind: Distribution = KILTED
) -> None:
    message = waypoints_goal(kind, xs, index, loops)
    assert robot.waypoints.receive_goal(goal, message, CLIENT) is not None


def following(*xs: float, loops: int = 0, kind: Distribution = KILTED, stop_on_failure: bool = True) -> DrivenRobot:
    robot = DrivenRobot(kind)
    robot.waypoints.stop_on_failure = stop_on_failure
    robot.step()
    send(robot, A, xs, loops=loops, kind=kind)
    robot.step()
    return robot


def visited(robot: DrivenRobot) -> list[float]:
    goals = [request for _, request in robot.requested if isinstance(request, GoalRequest)]
    return [goal.base_in_map.x for goal in goals if goal.base_in_map is not None]


def arrive(robot: DrivenRobot) -> None:
    robot.arrive()
    robot.step(2)  # In the second tick, the next goal arrives.


def result(robot: DrivenRobot, goal: bytes) -> tuple[ActionGoalState, Any]:
    found = robot.waypoints.goals.result(goal)
    assert found is not None
    return found.state, found.value


def test_poses_are_visited_one_after_the_other() -> None:
    robot = following(1.0, 2.0, 3.0)
    for xs in ([1.0], [1.0, 2.0], [1.0, 2.0, 3.0]):
        assert visited(robot) == xs
        arrive(robot)
    state, value = result(robot, A)
    assert (state, list(value.missed_waypoints), value.error_code) == (SUCCEEDED, [], 0)
    assert {client for client, _ in robot.requested} == {CLIENT}


def test_loops_and_the_first_index() -> None:
    robot = DrivenRobot(KILTED)
    robot.step()
    send(robot, A, [1.0, 2.0], index=1, loops=1)
    robot.step()
    for _ in range(3):
        arrive(robot)
    assert visited(robot) == [2.0, 1.0, 2.0]
    assert result(robot, A)[0] is SUCCEEDED


def test_feedback_has_the_present_waypoint() -> None:
    robot = following(1.0, 2.0)
    robot.step(5)
    arrive(robot)
    robot.step(5)
    feedback = robot.waypoints.take_feedback()
    assert [(goal, message.current_waypoint) for goal, message in feedback] == [(A, 0), (A, 1)]


@pytest.mark.parametrize(("kind", "error"), [(KILTED, 603), (JAZZY, 0)])
def test_a_missed_waypoint_ends_the_goal(kind: Distribution, error: int) -> None:
    robot = following(1.0, 2.0, kind=kind)
    robot.fail("stuck", "the robot is stuck")
    robot.step(2)
    state, value = result(robot, A)
    assert (state, value.error_code) == (ABORTED, error)
    (missed,) = value.missed_waypoints
    if kind is KILTED:
        assert (missed.waypoint_index, missed.waypoint_status, missed.error_code) == (0, 3, 105)
        assert (missed.waypoint_pose.pose.position.x, missed.error_msg) == (1.0, "the robot is stuck")
    else:
        assert (missed.index, missed.error_code, missed.goal.pose.position.x) == (0, 105, 1.0)
    assert visited(robot) == [1.0]
    name = "nav2_msgs/action/FollowWaypoints_Result"
    assert len(kind.decode(name, kind.encode(name, value)).missed_waypoints) == 1  # type: ignore[attr-defined]


def test_without_stop_on_failure_the_next_waypoint_follows() -> None:
    robot = following(1.0, 2.0, stop_on_failure=False)
    robot.fail("no_way", "no path")
    robot.step(2)
    arrive(robot)
    state, value = result(robot, A)
    assert (state, [missed.waypoint_index for missed in value.missed_waypoints]) == (SUCCEEDED, [0])
    assert visited(robot) == [1.0, 2.0]


def test_the_parameter_stop_on_failure_is_what_the_server_does() -> None:
    (node,) = [each for each in robot_nodes(0, RobotParameters(), 0.05) if each.name == "waypoint_follower"]
    parameter = node.parameters["stop_on_failure"]
    assert parameter.read_only
    assert parameter.value is DrivenRobot(KILTED).waypoints.stop_on_failure


def test_a_goal_of_another_client_makes_the_robot_miss_the_waypoint() -> None:
    robot = following(1.0, 2.0)
    robot.drive(Goal(7, Pose2(9.0, 9.0, 0.0)))
    robot.step(2)
    assert result(robot, A)[0] is ABORTED
    assert robot.goal is not None


@pytest.mark.parametrize("canceled", [A, NO_ID])
def test_cancel_ends_the_goal_and_stops_the_robot(canceled: bytes) -> None:
    robot = following(1.0, 2.0)
    answer = robot.waypoints.receive_cancel(canceled, 0, CLIENT)
    assert (answer.code, [goal.id for goal in answer.goals]) == (CancelCode.NONE, [A])
    robot.step()
    assert result(robot, A)[0] is CANCELED
    assert robot.goal is None
    assert isinstance(robot.requested[-1][1], CancelRequest)
    robot.step(10)
    assert visited(robot) == [1.0]


def test_a_newer_goal_preempts() -> None:
    robot = following(1.0, 2.0)
    send(robot, B, [5.0])
    assert result(robot, A)[0] is ABORTED
    robot.step()
    arrive(robot)
    assert result(robot, B)[0] is SUCCEEDED
    assert visited(robot) == [1.0, 5.0]


@pytest.mark.parametrize(("xs", "index"), [([], 0), ([1.0], 1), ([1.0] * (WAYPOINTS + 1), 0)])
def test_a_goal_without_valid_waypoints_is_aborted(xs: list[float], index: int) -> None:
    robot = following(1.0)
    send(robot, B, xs, index)
    state, value = result(robot, B)
    assert (state, value.error_code) == (ABORTED, 602)
    assert "poses" in value.error_msg


def test_endless_loops_of_missed_waypoints_end() -> None:
    robot = DrivenRobot(KILTED)
    robot.waypoints.stop_on_failure = False
    robot.step(dead=True)
    send(robot, A, [1.0], loops=2**32 - 1)
    robot.step(WAYPOINTS, dead=True)
    state, value = result(robot, A)
    assert (state, value.error_code, len(value.missed_waypoints)) == (ABORTED, 600, WAYPOINTS)
    assert value.missed_waypoints[0].error_code == 600
