"""The account of an action server, driven by a navigator of a few lines."""

from collections.abc import Sequence

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.observations import STANDSTILL
from sim.inputs import CancelGoal, SendGoal
from sim.robot.navigator.goals import Cancelled, Goal, GoalReached, GoalResult, NoPath
from sim.robot.navigator.navigation import Navigation
from thbridge.ros.actionlib import (
    LISTED,
    ActionRequest,
    ActionServerMessage,
    Feedback,
    GoalEnded,
    GoalSet,
    MoveBaseServer,
    StatusList,
)
from thbridge.ros.messages.goal_owners import GoalOwner
from thbridge.ros.messages.goal_status import GoalStatusCode
from thbridge.ros.messages.records import CancelRequest, GoalRequest, SimpleGoal

HERE = Pose2(1.0, 2.0, 0.5)
SECOND = 1_000_000_000
ALL = CancelRequest(0, "", 0)


class Robot:
    """A server with a navigator that does as it is told, and queues results as the real one does."""

    def __init__(self) -> None:
        self.server = MoveBaseServer(0)
        self.tick = 0
        self.goal: Goal | None = None
        self.results: list[GoalResult] = []
        self.inputs: list[SendGoal | CancelGoal] = []

    def go(self, goal: Goal) -> None:
        self.cancel()
        self.goal = goal

    def cancel(self) -> None:
        if self.goal is not None:
            self.results.append(Cancelled(self.goal))
        self.goal = None

    def end(self, result: type[GoalReached]) -> None:
        assert self.goal is not None
        self.results.append(result(self.goal))
        self.goal = None

    def step(self, *requests: ActionRequest, dead: bool = False) -> list[ActionServerMessage]:
        self.inputs = self.server.take(self.tick, requests)
        for item in self.inputs:
            self.go(item.goal) if isinstance(item, SendGoal) else self.cancel()
        if dead:
            self.goal, self.results = None, []
        result = self.results.pop(0) if self.results else None
        messages = self.server.follow(self.tick, None if dead else navigation(self.goal, result))
        self.tick += 1
        return messages

    def wait(self, ticks: int) -> list[ActionServerMessage]:
        return [messages for _ in range(ticks) for messages in self.step()]


def navigation(goal: Goal | None, result: GoalResult | None) -> Navigation:
    none = np.empty((0, 3))
    return Navigation(STANDSTILL, goal, "idle", none, np.empty(0), none, result, 0.0)


def goal(name: str, number: int, stamp_ns: int = 0) -> GoalRequest:
    return GoalRequest(0, name, stamp_ns, Pose2(float(number), 0.0, 0.0), number)


def ends(messages: Sequence[ActionServerMessage]) -> list[tuple[str, GoalStatusCode]]:
    return [(item.entry.goal.id, item.entry.status) for item in messages if isinstance(item, GoalEnded)]


def lists(messages: Sequence[ActionServerMessage]) -> list[list[tuple[str, GoalStatusCode]]]:
    return [[(e.goal.id, e.status) for e in item.entries] for item in messages if isinstance(item, StatusList)]


def test_a_goal_becomes_active_and_its_end_a_result() -> None:
    robot = Robot()
    robot.step()
    messages = robot.step(goal("a", 7))
    assert robot.inputs == [SendGoal(0, Goal(7, Pose2(7.0, 0.0, 0.0), GoalOwner.ROS_CLIENT))]
    assert lists(messages) == [[("a", GoalStatusCode.ACTIVE)]]
    robot.end(GoalReached)
    messages = robot.step()
    assert ends(messages) == [("a", GoalStatusCode.SUCCEEDED)]
    assert lists(messages)[-1] == [("a", GoalStatusCode.SUCCEEDED)]


def test_a_goal_that_is_given_up_is_aborted_with_the_reason() -> None:
    robot = Robot()
    robot.step(goal("a", 7))
    assert robot.goal is not None
    robot.results, robot.goal = [NoPath(robot.goal, "stuck", "it is stuck")], None
    (ended,) = [item for item in robot.step() if isinstance(item, GoalEnded)]
    assert (ended.entry.status, ended.entry.text) == (GoalStatusCode.ABORTED, "it is stuck")


def test_a_newer_goal_preempts() -> None:
    robot = Robot()
    robot.step(goal("a", 1))
    messages = robot.step(goal("b", 2))
    assert robot.inputs == [SendGoal(0, Goal(2, Pose2(2.0, 0.0, 0.0), GoalOwner.ROS_CLIENT))]
    assert ends(messages) == [("a", GoalStatusCode.PREEMPTED)]
    assert lists(messages)[-1] == [("a", GoalStatusCode.PREEMPTED), ("b", GoalStatusCode.ACTIVE)]
    assert ends(robot.wait(20)) == []


def test_of_two_goals_in_one_tick_the_first_is_recalled() -> None:
    robot = Robot()
    messages = robot.step(goal("a", 1), goal("b", 2))
    assert ends(messages) == [("a", GoalStatusCode.RECALLED)]
    assert [item.goal.id for item in robot.inputs if isinstance(item, SendGoal)] == [2]


def test_an_older_goal_than_the_one_under_way_is_recalled() -> None:
    robot = Robot()
    robot.step(goal("a", 1, 5 * SECOND))
    messages = robot.step(goal("b", 2, 4 * SECOND))
    assert ends(messages) == [("b", GoalStatusCode.RECALLED)]
    assert robot.inputs == []


@pytest.mark.parametrize(
    "cancel", [CancelRequest(0, "a", 0), ALL, CancelRequest(0, "", 3 * SECOND), CancelRequest(0, "x", 3 * SECOND)]
)
def test_a_goal_is_taken_back_by_name_by_time_and_with_all(cancel: CancelRequest) -> None:
    robot = Robot()
    robot.step(goal("a", 1, 2 * SECOND))
    messages = robot.step(cancel)
    assert robot.inputs == [CancelGoal(0)]
    assert [dict(entries)["a"] for entries in lists(messages)] == [GoalStatusCode.PREEMPTING, GoalStatusCode.PREEMPTED]
    assert ends(messages) == [("a", GoalStatusCode.PREEMPTED)]


@pytest.mark.parametrize("cancel", [CancelRequest(0, "b", 0), CancelRequest(0, "", 1 * SECOND)])
def test_other_goals_go_on(cancel: CancelRequest) -> None:
    robot = Robot()
    robot.step(goal("a", 1, 2 * SECOND))
    assert ends(robot.step(cancel)) == []
    assert robot.inputs == []


def test_a_goal_that_was_taken_back_before_it_came_is_recalled() -> None:
    robot = Robot()
    assert lists(robot.step(CancelRequest(0, "a", 0)))[-1] == [("a", GoalStatusCode.RECALLING)]
    assert ends(robot.step(goal("a", 1))) == [("a", GoalStatusCode.RECALLED)]
    assert robot.inputs == []


def test_goals_of_before_the_last_cancel_are_recalled_and_those_without_a_time_are_not() -> None:
    robot = Robot()
    robot.step(CancelRequest(0, "", 9 * SECOND))
    assert ends(robot.step(goal("a", 1, 9 * SECOND))) == [("a", GoalStatusCode.RECALLED)]
    assert ends(robot.step(goal("b", 2))) == []
    assert ends(robot.step(goal("c", 3, 9 * SECOND + 1))) == [("b", GoalStatusCode.PREEMPTED)]


def test_a_goal_that_is_taken_back_in_its_own_tick_never_moves_the_robot() -> None:
    robot = Robot()
    assert ends(robot.step(goal("a", 1), CancelRequest(0, "a", 0))) == [("a", GoalStatusCode.PREEMPTED)]
    assert robot.inputs == []


def test_the_same_goal_twice_is_one() -> None:
    robot = Robot()
    robot.step(goal("a", 1))
    messages = robot.step(goal("a", 2))
    assert (robot.inputs, ends(messages)) == ([], [])


def test_a_goal_without_name_or_time_gets_both() -> None:
    robot = Robot()
    robot.wait(25)
    messages = robot.step(goal("", 1))
    (entry,) = next(item for item in messages if isinstance(item, StatusList)).entries
    assert entry.goal == ("/robot1/move_base-1-1.500000000", 1_500_000_000)


def test_a_goal_that_cannot_be_used_is_aborted_and_stops_the_robot() -> None:
    robot = Robot()
    robot.step(goal("a", 1))
    messages = robot.step(GoalRequest(0, "b", 0, None, 2, "its quaternion is none"))
    assert ends(messages) == [("a", GoalStatusCode.PREEMPTED), ("b", GoalStatusCode.ABORTED)]
    assert robot.inputs == [CancelGoal(0)]
    last = [item for item in messages if isinstance(item, GoalEnded)][-1]
    assert last.entry.text == "its quaternion is none"


def test_a_place_that_was_pointed_at_becomes_a_goal_with_a_name() -> None:
    robot = Robot()
    messages = robot.step(SimpleGoal(0, Pose2(1.0, 1.0, 0.0), 4))
    (set_goal,) = [item for item in messages if isinstance(item, GoalSet)]
    assert lists(messages)[-1] == [(set_goal.goal.id, GoalStatusCode.ACTIVE)]
    assert robot.inputs == [SendGoal(0, Goal(4, Pose2(1.0, 1.0, 0.0), GoalOwner.ROS_CLIENT))]


def test_the_game_is_a_client_whose_goals_always_count() -> None:
    robot = Robot()
    robot.step(goal("a", 1, 10**18))  # a client that takes the time from the wall
    robot.go(Goal(5, HERE))
    messages = robot.step()
    assert [item.goal.id for item in messages if isinstance(item, GoalSet)] == ["robot1-5"]
    assert ends(messages) == [("a", GoalStatusCode.PREEMPTED)]
    robot.end(GoalReached)
    assert ends(robot.step()) == [("robot1-5", GoalStatusCode.SUCCEEDED)]


def test_clients_can_take_back_the_games_goal_and_the_game_can_set_it_again() -> None:
    robot = Robot()
    robot.go(Goal(5, HERE))
    robot.step()
    assert ends(robot.step(ALL)) == [("robot1-5", GoalStatusCode.PREEMPTED)]
    assert robot.goal is None
    robot.go(Goal(5, HERE))
    assert lists(robot.step())[-1] == [("robot1-5", GoalStatusCode.ACTIVE)]


def test_a_goal_of_the_game_that_ends_in_its_first_tick_is_told_whole() -> None:
    robot = Robot()
    robot.go(Goal(5, HERE))
    robot.cancel()
    messages = robot.step()
    assert [type(item) for item in messages if not isinstance(item, StatusList)] == [GoalSet, GoalEnded]
    assert ends(messages) == [("robot1-5", GoalStatusCode.PREEMPTED)]


def test_a_client_and_the_game_in_one_tick_end_each_goal_once() -> None:
    robot = Robot()
    robot.go(Goal(5, HERE))
    robot.step()
    robot.server.take(robot.tick, [goal("a", 100)])
    robot.go(Goal(100, Pose2(100.0, 0.0, 0.0), GoalOwner.ROS_CLIENT))
    robot.go(Goal(6, HERE))
    messages = robot.step() + robot.wait(5)
    assert ends(messages) == [("robot1-5", GoalStatusCode.PREEMPTED), ("a", GoalStatusCode.PREEMPTED)]
    assert lists(messages)[-1][-1] == ("robot1-6", GoalStatusCode.ACTIVE)


def test_status_comes_five_times_a_second_and_feedback_ten_times_while_under_way() -> None:
    robot = Robot()
    messages = robot.wait(50)
    assert len(lists(messages)) == 5
    assert not any(isinstance(item, Feedback) for item in messages)
    robot.step(goal("a", 1))
    inputs = [item for item in robot.wait(50) if isinstance(item, Feedback)]
    assert len(inputs) == 10
    assert inputs[0].entry.goal.id == "a"


def test_goals_stay_listed_for_five_seconds_after_their_end() -> None:
    robot = Robot()
    robot.step(goal("a", 1))
    robot.end(GoalReached)
    robot.step()
    assert lists(robot.wait(240))[-1] == [("a", GoalStatusCode.SUCCEEDED)]
    assert lists(robot.wait(30))[-1] == []


def test_the_list_of_goals_that_ended_has_a_bound_and_the_newest_are_on_it() -> None:
    robot = Robot()
    for number in range(200):
        robot.step(goal(f"{number}", number))
    listed = [name for name, _ in lists(robot.wait(10))[-1]]
    assert listed == [f"{number}" for number in range(200 - LISTED - 1, 200)]
    for number in range(200):
        robot.step(CancelRequest(0, f"never came {number}", 0))
    assert len(lists(robot.wait(10))[-1]) == LISTED + 1


def test_a_dead_robot_hears_and_says_nothing_and_ends_its_goal_when_it_revives() -> None:
    robot = Robot()
    robot.step(goal("a", 1))
    assert robot.step(dead=True) == []
    assert robot.step(goal("b", 2), ALL, dead=True) == []
    messages = robot.step()
    assert ends(messages) == [("a", GoalStatusCode.PREEMPTED)]
    robot.step(goal("c", 3))
    assert robot.inputs == [SendGoal(0, Goal(3, Pose2(3.0, 0.0, 0.0), GoalOwner.ROS_CLIENT))]


def test_two_accounts_of_the_same_requests_are_alike() -> None:
    first, second = Robot(), Robot()
    requests = [(), (goal("a", 1),), (goal("", 2), CancelRequest(0, "a", 0)), (ALL,), (goal("z", 4, 3 * SECOND),)]
    assert [first.step(*some) for some in requests] == [second.step(*some) for some in requests]
