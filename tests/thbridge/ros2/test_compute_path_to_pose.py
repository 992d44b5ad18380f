"""Plans on request: one per tick, with Nav2's error codes."""

from typing import Any

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.numerics.float_array import FloatArray
from sim.robot.global_planning.path import PlanRefusal, PlanRefusalCode
from thbridge.ros2.actions import ActionGoalState, CancelCode
from thbridge.ros2.compute_path_to_pose import COMPUTE_PATH_TO_POSE, WAITING_GOALS, ComputePathServer, PathError
from thbridge.ros2.distribution import Distribution

TYPES = Distribution.of("kilted")
PLAN = np.array([[0.0, 0.0, 0.0], [1.0, 0.5, 0.25], [2.0, 1.0, 0.5]])


class Planner:
    """Planner that makes always the same plan."""

    def __init__(self, plan: FloatArray | PlanRefusal = PLAN) -> None:
        self.asked: list[tuple[Pose2 | None, Pose2]] = []
        self.server = ComputePathServer(TYPES, self._make)
        self._plan = plan

    def _make(self, start: Pose2 | None, goal: Pose2) -> FloatArray | PlanRefusal:
        self.asked.append((start, goal))
        return self._plan

    def send(self, number: int, **fields: object) -> bool:
        """Send a goal, and return True if it was accepted."""
        given = {"goal": pose(2.0), **fields}
        goal = TYPES.make(f"{COMPUTE_PATH_TO_POSE}_Goal", **given)
        return self.server.receive_goal(bytes([number + 1] * 16), goal, "/client") is not None

    def result(self, number: int) -> tuple[ActionGoalState, Any]:
        found = self.server.goals.result(bytes([number + 1] * 16))
        assert found is not None
        return found.state, found.value


def pose(x: float, frame: str = "map") -> object:
    position = TYPES.make("geometry_msgs/msg/Point", x=x, y=1.0)
    return TYPES.make(
        "geometry_msgs/msg/PoseStamped",
        header=TYPES.make("std_msgs/msg/Header", frame_id=frame),
        pose=TYPES.make("geometry_msgs/msg/Pose", position=position),
    )


def test_a_plan_begins_at_the_robot_or_at_the_given_start() -> None:
    planner = Planner()
    assert planner.send(1)
    assert planner.send(2, start=pose(0.5), use_start=True, planner_id="GridBased")
    planner.server.follow(50)
    assert planner.server.goals.state(bytes([3] * 16)) is ActionGoalState.EXECUTING
    planner.server.follow(51)
    assert planner.asked == [(None, Pose2(2.0, 1.0, 0.0)), (Pose2(0.5, 1.0, 0.0), Pose2(2.0, 1.0, 0.0))]
    state, result = planner.result(1)
    assert (state, result.error_code) == (ActionGoalState.SUCCEEDED, 0)
    assert (result.path.header.frame_id, result.path.header.stamp.sec) == ("map", 2)
    assert [each.pose.position.x for each in result.path.poses] == [0.0, 1.0, 2.0]


def test_refusals_have_codes_of_nav2() -> None:
    codes: dict[PlanRefusalCode, PathError] = {
        "goal_outside": PathError.GOAL_OUTSIDE_MAP,
        "start_occupied": PathError.START_OCCUPIED,
        "robots_in_the_way": PathError.NO_VALID_PATH,
    }
    for code, error in codes.items():
        planner = Planner(PlanRefusal(code, "no path"))
        planner.send(1)
        planner.server.follow(1)
        state, result = planner.result(1)
        assert (state, result.error_code, result.error_msg) == (ActionGoalState.ABORTED, error, "no path")
        assert len(result.path.poses) == 0
        assert TYPES.constant(f"{COMPUTE_PATH_TO_POSE}_Result", error.name) == error


@pytest.mark.parametrize(
    ("fields", "error", "sentence"),
    [
        ({"planner_id": "Smac"}, PathError.INVALID_PLANNER, "there is no planner 'Smac'"),
        ({"goal": pose(1.0, "odom")}, PathError.TF_ERROR, "odom"),
        ({"start": pose(float("nan")), "use_start": True}, PathError.TF_ERROR, "not finite"),
    ],
)
def test_unusable_goals_are_aborted(fields: dict[str, object], error: PathError, sentence: str) -> None:
    planner = Planner()
    assert planner.send(1, **fields)
    planner.server.follow(1)
    state, result = planner.result(1)
    assert (state, result.error_code, planner.asked) == (ActionGoalState.ABORTED, error, [])
    assert sentence in result.error_msg


def test_few_goals_wait_and_canceled_goals_need_no_plan() -> None:
    planner = Planner()
    assert [planner.send(number) for number in range(WAITING_GOALS + 1)] == [True] * WAITING_GOALS + [False]
    answers = [planner.server.receive_cancel(bytes([number + 1] * 16), 0, "/client") for number in range(5)]
    assert {answer.code for answer in answers} == {CancelCode.NONE}
    planner.server.follow(1)
    assert len(planner.asked) == 1
    assert [planner.result(number)[0] for number in range(6)] == [ActionGoalState.CANCELED] * 5 + [
        ActionGoalState.SUCCEEDED
    ]
    assert planner.server.receive_cancel(bytes([6] * 16), 0, "/client").code is CancelCode.GOAL_TERMINATED
