"""Every goal that a real robot is given ends, in whichever way its server, its network or other clients behave."""

import pytest

from sim.common.geometry import Pose2
from sim.robot.navigator.goals import Cancelled, Goal, GoalReached, NoPath
from thbridge.ros.messages.goal_owners import GoalOwner
from thbridge.ros.messages.goal_status import GoalId, GoalStatus, GoalStatusCode
from thbridge.ros.remote.goals import (
    CANCEL_RETRY_NS,
    CANCEL_TIMEOUT_NS,
    LOST_TIMEOUT_NS,
    PREEMPTION_WINDOW_NS,
    UNLISTED_TIMEOUT_NS,
    MoveBaseClient,
    OutgoingCancel,
    OutgoingGoal,
    reason_of,
)
from thbridge.ros.remote.pose import STALE_NS

SECOND = 1_000_000_000
HERE, THERE = Pose2(0.0, 0.0, 0.0), Pose2(3.0, 1.0, 0.5)
GOAL = Goal(7, THERE)
PREFIX = "/us-robot1-"


class Server:
    """A client, and what its server would say to it."""

    def __init__(self) -> None:
        self.client = MoveBaseClient(PREFIX)
        self.now = 100 * SECOND
        self.listed: dict[str, tuple[GoalStatusCode, str]] = {}
        self.lost = self.silent = False
        self.client.receive_status([], self.now)

    def sent(self) -> list[str]:
        outgoing, self.client.outgoing = self.client.outgoing, []
        self.cancels = [item.name for item in outgoing if isinstance(item, OutgoingCancel)]
        return [item.goal_id.id for item in outgoing if isinstance(item, OutgoingGoal)]

    def go(self, goal: Goal = GOAL) -> str:
        self.client.go(goal, self.now)
        (name,) = self.sent()
        return name

    def entries(self) -> list[GoalStatus]:
        return [GoalStatus(GoalId(name, 0), *how) for name, how in self.listed.items()]

    def run(self, seconds: float, status: bool = True) -> None:
        for _ in range(round(seconds * 10)):
            self.now += SECOND // 10
            if status:
                self.client.receive_status(self.entries(), self.now)
            self.client.step(self.now, lost=self.lost, stale=self.silent)


@pytest.fixture
def server() -> Server:
    return Server()


@pytest.mark.parametrize("by_result", [True, False])
@pytest.mark.parametrize(
    ("status", "text", "end"),
    [
        (GoalStatusCode.SUCCEEDED, "Goal reached.", GoalReached(GOAL)),
        (GoalStatusCode.ABORTED, "Not a valid plan.", NoPath(GOAL, "no_way", "Not a valid plan.")),
        (GoalStatusCode.REJECTED, "", NoPath(GOAL, "gave_up", "the goal was rejected, without a reason")),
        (GoalStatusCode.LOST, "", NoPath(GOAL, "gave_up", "the goal was lost, without a reason")),
    ],
)  # fmt: skip
def test_a_goal_ends_as_the_server_says_by_result_or_by_list(server, by_result, status, text, end):
    name = server.go()
    server.listed[name] = (GoalStatusCode.ACTIVE, "")
    server.run(1)
    assert server.client.goal(server.now, HERE) == GOAL
    assert server.client.active
    if by_result:
        server.client.receive_result(GoalStatus(GoalId(name, 0), status, text), server.now)
    server.listed[name] = (status, text)
    server.run(1)
    assert server.client.results == [end]
    assert server.client.goal(server.now, HERE) is None


def test_texts_of_move_base_are_understood():
    assert (
        reason_of("Failed to find a valid control. Even after executing recovery behaviors.") == "blocked_by_obstacle"
    )
    assert reason_of("Robot is oscillating. Even after executing recovery behaviors.") == "stuck"
    assert reason_of("out of coffee") == "gave_up"


def test_a_goal_that_is_taken_back_is_cancelled(server):
    name = server.go()
    server.listed[name] = (GoalStatusCode.ACTIVE, "")
    server.run(0.5)
    server.client.cancel(server.now)
    server.client.cancel(server.now)
    assert server.sent() == []
    assert server.cancels == [name]
    server.listed[name] = (GoalStatusCode.PREEMPTED, "")
    server.run(0.1)
    assert server.client.results == [Cancelled(GOAL)]


def test_a_cancel_that_nobody_obeys_ends_the_goal_all_the_same_and_is_repeated(server):
    name = server.go()
    server.listed[name] = (GoalStatusCode.ACTIVE, "")
    server.run(0.5)
    server.client.cancel(server.now)
    server.sent()
    server.run(CANCEL_TIMEOUT_NS / SECOND + 0.5)
    assert server.client.results == [Cancelled(GOAL)]
    server.run(3 * CANCEL_RETRY_NS / SECOND)
    server.sent()
    assert 2 <= len(server.cancels) <= 4
    assert set(server.cancels) == {name}


def test_a_newer_goal_ends_the_older_one_whose_end_is_then_nobodys(server):
    old = server.go()
    new = server.go(Goal(8, HERE))
    assert server.client.results == [Cancelled(GOAL)]
    server.client.receive_result(GoalStatus(GoalId(old, 0), GoalStatusCode.SUCCEEDED, ""), server.now)
    server.listed[new] = (GoalStatusCode.ACTIVE, "")
    server.run(0.5)
    assert server.client.results == [Cancelled(GOAL)]
    assert server.client.goal(server.now, HERE) == Goal(8, HERE)


def test_stamps_of_goals_rise_even_within_one_moment(server):
    server.client.go(GOAL, server.now)
    server.client.go(GOAL, server.now)
    first, second = (item.goal_id for item in server.client.outgoing if isinstance(item, OutgoingGoal))
    assert first.stamp_ns < second.stamp_ns
    assert first.id != second.id


def test_a_restarted_server_gets_the_goal_once_more(server):
    name = server.go()
    server.listed[name] = (GoalStatusCode.ACTIVE, "")
    server.run(1)
    server.listed.clear()
    server.run(UNLISTED_TIMEOUT_NS / SECOND + 0.5)
    (again,) = server.sent()
    assert again != name
    assert server.client.goal(server.now, HERE) == GOAL
    server.listed[again] = (GoalStatusCode.SUCCEEDED, "")
    server.run(0.1)
    assert server.client.results == [GoalReached(GOAL)]


def test_a_server_that_takes_no_goal_is_given_up(server):
    server.go()
    server.run(2 * UNLISTED_TIMEOUT_NS / SECOND + 1.0)
    assert len(server.sent()) == 1
    (end,) = server.client.results
    assert (end.goal, end.reason) == (GOAL, "unanswered")


def test_a_server_that_falls_silent_is_given_up_and_its_goal_cancelled_when_it_is_back(server):
    name = server.go()
    server.listed[name] = (GoalStatusCode.ACTIVE, "")
    server.run(1)
    server.run(STALE_NS / SECOND - 0.5, status=False)
    assert server.client.results == []
    server.run(1, status=False)
    (end,) = server.client.results
    assert end.reason == "unanswered"
    server.run(0.2)
    server.sent()
    assert server.cancels == [name]


def test_a_silent_robot_has_no_goal(server):
    server.go()
    server.silent = True
    server.run(0.1)
    (end,) = server.client.results
    assert end.reason == "unanswered"


def test_a_robot_that_stays_lost_gives_up_and_is_stopped(server):
    name = server.go()
    server.listed[name] = (GoalStatusCode.ACTIVE, "")
    server.lost = True
    server.run(LOST_TIMEOUT_NS / SECOND - 0.5)
    server.lost = False
    server.run(1)
    server.lost = True
    server.run(LOST_TIMEOUT_NS / SECOND - 0.5)
    assert server.client.results == []
    server.run(1)
    server.sent()
    assert server.cancels[0] == name
    (end,) = server.client.results
    assert end.reason == "lost"


def test_another_clients_goal_takes_over_and_is_not_fought(server):
    name = server.go()
    server.listed[name] = (GoalStatusCode.ACTIVE, "")
    server.run(1)
    server.client.receive_goal("rviz-1", HERE, server.now)
    server.listed[name] = (GoalStatusCode.PREEMPTED, "")
    server.listed["rviz-1"] = (GoalStatusCode.ACTIVE, "")
    server.run(1)
    assert server.client.results == [Cancelled(GOAL)]
    assert server.client.goal(server.now, THERE) == Goal(0, HERE, GoalOwner.STRANGER)
    server.client.cancel(server.now)
    assert server.sent() == []
    assert server.cancels == []
    server.listed["rviz-1"] = (GoalStatusCode.SUCCEEDED, "")
    server.run(2)
    assert server.client.goal(server.now, HERE) is None


def test_a_goal_that_somebody_else_cancels_is_called_off(server):
    name = server.go()
    server.listed[name] = (GoalStatusCode.PREEMPTED, "")
    server.run(PREEMPTION_WINDOW_NS / SECOND - 0.2)
    assert server.client.goal(server.now, HERE) == GOAL
    server.run(0.5)
    (end,) = server.client.results
    assert end.reason == "called_off"


def test_goals_of_an_earlier_run_are_cancelled(server):
    server.listed[PREFIX + "3-1.0"] = (GoalStatusCode.ACTIVE, "")
    server.listed["somebody"] = (GoalStatusCode.ACTIVE, "")
    server.run(0.2)
    server.sent()
    assert server.cancels == [PREFIX + "3-1.0"]
