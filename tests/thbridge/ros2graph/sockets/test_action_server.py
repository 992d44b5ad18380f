"""Action servers and action clients on a graph in memory: what is sent arrives, and bad bytes do no harm."""

import logging
from typing import Any

import pytest

from tests.support.ros2.driven_robot import DrivenRobot
from tests.support.ros2.loopback import LoopbackGraph
from tests.support.ros2.navigation_goals import goal_id, navigation_goal, waypoints_goal
from thbridge.ros2.actions import (
    NO_ID,
    ActionGoalState,
    ActionGoalStatus,
    ActionResult,
    CancelAnswer,
    CancelCode,
    GoalInfo,
)
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.follow_waypoints import FOLLOW_WAYPOINTS
from thbridge.ros2.navigate_to_pose import NAVIGATE_TO_POSE
from thbridge.ros2graph.sockets.action_client import GraphActionClient
from thbridge.ros2graph.sockets.action_server import GraphActionServer
from thbridge.ros2graph.values.graph import NodeName

A, B = goal_id(1), goal_id(2)
NAME = "/robot1/navigate_to_pose"
SERVER, CLIENT = NodeName("/robot1", "bt_navigator"), NodeName("/", "operator")
EXECUTING, SUCCEEDED, CANCELED = ActionGoalState.EXECUTING, ActionGoalState.SUCCEEDED, ActionGoalState.CANCELED


class ServedRobot:
    """Robot with action servers on a graph, and a client of navigate_to_pose."""

    def __init__(self, name: str, limit: int = 100) -> None:
        self.graph = LoopbackGraph()
        self.kind = Distribution.of(name)
        self.robot = DrivenRobot(self.kind)
        self.asked: list[tuple[str, str]] = []
        self.limit = limit
        program = self.graph.program()
        self.servers = [
            GraphActionServer(program, SERVER, NAME, self.kind, NAVIGATE_TO_POSE, self.robot.navigate, self.admit),
            GraphActionServer(
                program,
                NodeName("/robot1", "waypoint_follower"),
                "/robot1/follow_waypoints",
                self.kind,
                FOLLOW_WAYPOINTS,
                self.robot.waypoints,
            ),
        ]
        self.statuses: list[tuple[ActionGoalStatus, ...]] = []
        self.feedback: list[tuple[bytes, Any]] = []
        self.client = GraphActionClient(
            self.graph.program(),
            CLIENT,
            NAME,
            self.kind,
            NAVIGATE_TO_POSE,
            lambda goal, feedback: self.feedback.append((goal, feedback)),
            self.statuses.append,
        )
        self.step()

    def admit(self, service: str, client: str) -> bool:
        self.asked.append((service, client))
        return len(self.asked) <= self.limit

    def step(self, ticks: int = 1) -> None:
        for _ in range(ticks):
            self.robot.step()
            for server in self.servers:
                server.publish()
        self.graph.deliver()

    def send(self, goal: bytes, x: float = 3.0) -> list[int | None]:
        answers: list[int | None] = []
        self.client.send_goal(goal, navigation_goal(self.kind, x), answers.append)
        self.graph.deliver()
        return answers


@pytest.mark.parametrize("name", ["jazzy", "kilted"])
def test_a_goal_with_feedback_status_and_result(name: str) -> None:
    served = ServedRobot(name)
    assert served.client.has_server
    (stamp,) = served.send(A)
    results: list[ActionResult[Any]] = []
    served.client.get_result(A, results.append)
    served.step(10)
    assert results == []
    assert [goal for goal, _ in served.feedback] == [A, A]
    assert served.statuses[-1] == ((GoalInfo(A, stamp), EXECUTING),)
    served.robot.arrive()
    served.step()
    ((state, value),) = results
    assert (state, value.error_code) == (SUCCEEDED, 0)
    assert served.statuses[-1] == ((GoalInfo(A, stamp), SUCCEEDED),)
    assert {client for _, client in served.asked} == {"/operator"}


def test_feedback_is_not_made_if_no_client_receives_it() -> None:
    kind = Distribution.of("kilted")
    robot = DrivenRobot(kind)
    GraphActionServer(LoopbackGraph().program(), SERVER, NAME, kind, NAVIGATE_TO_POSE, robot.navigate)
    robot.navigate.receive_goal(A, navigation_goal(kind, 3.0), "/operator")
    robot.step(10)
    assert robot.navigate.goals.state(A) is EXECUTING
    assert robot.navigate.take_feedback() == []


def test_a_repeated_id_is_rejected_and_an_unknown_goal_has_no_result() -> None:
    served = ServedRobot("kilted")
    served.send(A)
    assert served.send(A) == [None]
    results: list[ActionResult[Any]] = []
    served.client.get_result(B, results.append)
    served.graph.deliver()
    ((state, value),) = results
    assert (state, value.error_code) == (ActionGoalState.UNKNOWN, 0)


def test_cancel_requests_have_answers() -> None:
    served = ServedRobot("kilted")
    (stamp,) = served.send(A)
    served.step()
    answers: list[CancelAnswer] = []
    served.client.cancel(GoalInfo(B, 0), answers.append)
    served.client.cancel(GoalInfo(NO_ID, 0), answers.append)
    served.graph.deliver()
    assert answers == [(CancelCode.UNKNOWN_GOAL_ID, ()), (CancelCode.NONE, (GoalInfo(A, stamp),))]
    served.step()
    assert served.statuses[-1][0].state is CANCELED


def test_a_late_client_gets_the_status_list() -> None:
    served = ServedRobot("kilted")
    served.send(A)
    served.step()
    statuses: list[tuple[ActionGoalStatus, ...]] = []
    program = served.graph.program()
    GraphActionClient(program, CLIENT, NAME, served.kind, NAVIGATE_TO_POSE, on_status=statuses.append)
    served.graph.deliver()
    assert [[goal.goal.id for goal in entries] for entries in statuses] == [[A]]


def test_too_many_requests_are_rejected() -> None:
    served = ServedRobot("kilted", limit=1)
    served.send(A)
    assert served.send(B) == [None]
    answers: list[CancelAnswer] = []
    served.client.cancel(GoalInfo(A, 0), answers.append)
    served.graph.deliver()
    assert answers == [(CancelCode.REJECTED, ())]


def test_waypoints_over_the_graph() -> None:
    served = ServedRobot("kilted")
    client = GraphActionClient(
        served.graph.program(), CLIENT, "/robot1/follow_waypoints", served.kind, FOLLOW_WAYPOINTS
    )
    results: list[ActionResult[Any]] = []
    client.send_goal(A, waypoints_goal(served.kind, [1.0, 2.0]), lambda _: client.get_result(A, results.append))
    served.graph.deliver()
    for _ in range(2):
        served.step()
        served.robot.arrive()
        served.step()
    assert [state for state, _ in results] == [SUCCEEDED]


@pytest.mark.parametrize("service", ["send_goal", "cancel_goal", "get_result"])
@pytest.mark.parametrize("data", [b"", b"\x00\x01\x00\x00", bytes(15), b"\xff" * 200])
def test_bad_bytes_are_ignored(service: str, data: bytes, caplog: pytest.LogCaptureFixture) -> None:
    served = ServedRobot("kilted")
    with caplog.at_level(logging.WARNING):
        served.graph.servers[f"{NAME}/_action/{service}"](data, bytes(16), lambda response: None)
    assert len(caplog.records) == 1
    assert f"{NAME}: ignoring a request of" in caplog.text


@pytest.mark.parametrize("topic", ["feedback", "status"])
def test_bad_bytes_do_not_harm_a_client(topic: str, caplog: pytest.LogCaptureFixture) -> None:
    served = ServedRobot("kilted")
    with caplog.at_level(logging.WARNING):
        (writer,) = [each for each in served.graph.writers if each.topic == f"{NAME}/_action/{topic}"]
        writer.write(b"\x00\x01\x00\x00\xff\xff\xff\x7f")
        served.graph.deliver()
    assert len(caplog.records) == 1
