"""Goals of an action server: one result each, whatever clients do."""

import hypothesis.strategies as st
import pytest
from hypothesis import settings
from hypothesis.stateful import Bundle, RuleBasedStateMachine, consumes, invariant, multiple, rule

from thbridge.ros2.actions import (
    FINAL,
    GOALS,
    NO_ID,
    WAITING,
    ActionGoals,
    ActionGoalState,
    ActionResult,
    CancelCode,
    GoalInfo,
)

A, B = b"a" * 16, b"b" * 16
ACCEPTED, EXECUTING, CANCELING = ActionGoalState.ACCEPTED, ActionGoalState.EXECUTING, ActionGoalState.CANCELING
SUCCEEDED, CANCELED, UNKNOWN = ActionGoalState.SUCCEEDED, ActionGoalState.CANCELED, ActionGoalState.UNKNOWN


def goals_of(*ids: bytes) -> ActionGoals[str]:
    """Accept goals at the times 1, 2, ... ns."""
    goals: ActionGoals[str] = ActionGoals(100)
    for at, goal_id in enumerate(ids, start=1):
        assert goals.accept(goal_id, at)
    return goals


def test_an_id_is_accepted_only_once() -> None:
    goals = goals_of(A)
    assert not goals.accept(A, 2)
    assert goals.statuses == ((GoalInfo(A, 1), ACCEPTED),)


def test_the_result_is_sent_to_all_who_wait_and_to_all_who_ask_later() -> None:
    goals = goals_of(A)
    received: list[ActionResult[str]] = []
    goals.ask_result(A, received.append)
    goals.ask_result(A, received.append)
    goals.execute(A)
    assert received == []
    goals.end(A, SUCCEEDED, "there", 5)
    goals.ask_result(A, received.append)
    assert received == 3 * [(SUCCEEDED, "there")]
    goals.end(A, CANCELED, "not there", 6)
    assert goals.result(A) == (SUCCEEDED, "there")


def test_an_unknown_goal_has_no_result() -> None:
    received: list[ActionResult[str]] = []
    goals_of(A).ask_result(B, received.append)
    assert received == [(UNKNOWN, None)]


@pytest.mark.parametrize(
    ("goal_id", "stamp_ns", "canceled"),
    [(A, 0, [A]), (NO_ID, 0, [A, B]), (NO_ID, 1, [A]), (NO_ID, 2, [A, B]), (B, 1, [A, B]), (b"c" * 16, 1, [A])],
)
def test_goals_are_canceled_by_id_by_time_and_all(goal_id: bytes, stamp_ns: int, canceled: list[bytes]) -> None:
    goals = goals_of(A, B)
    answer = goals.cancel(goal_id, stamp_ns)
    assert (answer.code, [goal.id for goal in answer.goals]) == (CancelCode.NONE, canceled)
    assert [goal.id for goal, state in goals.statuses if state is CANCELING] == canceled


def test_cancel_requests_for_one_goal_that_cannot_be_canceled_have_a_code() -> None:
    goals = goals_of(A, B)
    assert goals.cancel(b"c" * 16, 0) == (CancelCode.UNKNOWN_GOAL_ID, ())
    goals.end(A, SUCCEEDED, "", 3)
    goals.cancel(B, 0)
    assert goals.cancel(A, 0) == (CancelCode.GOAL_TERMINATED, ())
    assert goals.cancel(B, 0) == (CancelCode.GOAL_TERMINATED, ())
    assert goals.cancel(NO_ID, 0) == (CancelCode.NONE, ())


def test_results_are_kept_for_some_time() -> None:
    goals = goals_of(A, B)
    goals.end(A, SUCCEEDED, "", 5)
    goals.changed = False
    goals.expire(105)
    assert goals.state(A) is SUCCEEDED
    goals.expire(106)
    assert goals.state(A) is UNKNOWN
    assert goals.state(B) is ACCEPTED
    assert not goals.changed


def test_the_numbers_of_goals_and_of_waiting_clients_are_limited() -> None:
    goals = goals_of(*(bytes([number]) * 16 for number in range(1, GOALS + 1)))
    assert not goals.accept(b"x" * 16, 0)
    goals.end(b"\x05" * 16, SUCCEEDED, "", 0)
    assert goals.accept(b"x" * 16, 0)
    assert goals.state(b"\x05" * 16) is UNKNOWN
    received: list[ActionResult[str]] = []
    for _ in range(WAITING + 1):
        goals.ask_result(b"x" * 16, received.append)
    assert received == [(UNKNOWN, None)]
    goals.end(b"x" * 16, SUCCEEDED, "", 0)
    assert received[1:] == WAITING * [(SUCCEEDED, "")]


class AnyOrder(RuleBasedStateMachine):
    """Clients send, cancel and ask in any order; the server starts and ends goals in any order."""

    known = Bundle("known")

    def __init__(self) -> None:
        super().__init__()
        self.goals: ActionGoals[str] = ActionGoals(50)
        self.now = 0
        self.accepted: set[bytes] = set()
        self.ended: dict[bytes, tuple[ActionGoalState, str]] = {}
        self.asked: list[tuple[bytes, list[ActionResult[str]]]] = []

    @rule(target=known, number=st.integers(1, 8))
    def send(self, number: int) -> object:
        self.now += 1
        goal_id = bytes([number]) * 16
        fresh = goal_id not in self.accepted or self.goals.state(goal_id) is UNKNOWN
        assert self.goals.accept(goal_id, self.now) is fresh
        if not fresh:
            return multiple()
        self.accepted.add(goal_id)
        self.ended.pop(goal_id, None)
        return goal_id

    @rule(goal_id=known)
    def start(self, goal_id: bytes) -> None:
        self.goals.execute(goal_id)

    @rule(goal_id=st.one_of(known, st.just(NO_ID)), stamp_ns=st.sampled_from([0, 0, 3, 10]))
    def cancel(self, goal_id: bytes, stamp_ns: int) -> None:
        before = dict(self.goals.statuses)
        answer = self.goals.cancel(goal_id, stamp_ns)
        assert bool(answer.goals) is False or answer.code is CancelCode.NONE
        after = dict(self.goals.statuses)
        assert {goal for goal in after if after[goal] != before[goal]} == {*answer.goals}

    @rule(goal_id=known)
    def ask(self, goal_id: bytes) -> None:
        received: list[ActionResult[str]] = []
        self.goals.ask_result(goal_id, received.append)
        if received and received[0].state is UNKNOWN:
            assert self.goals.state(goal_id) is UNKNOWN
        else:
            self.asked.append((goal_id, received))

    @rule(goal_id=consumes(known), state=st.sampled_from([*FINAL]))
    def end(self, goal_id: bytes, state: ActionGoalState) -> None:
        self.now += 1
        waiting = [received for asked, received in self.asked if asked == goal_id and not received]
        if self.goals.state(goal_id) in {ACCEPTED, EXECUTING, CANCELING}:
            self.ended[goal_id] = (state, str(self.now))
        self.goals.end(goal_id, state, str(self.now), self.now)
        assert all(received == [self.ended[goal_id]] for received in waiting)

    @rule(later=st.integers(0, 80))
    def expire(self, later: int) -> None:
        self.now += later
        self.goals.expire(self.now)

    @invariant()
    def each_request_has_at_most_one_result(self) -> None:
        for goal_id, received in self.asked:
            assert len(received) <= 1
            if goal_id in self.ended and self.goals.state(goal_id) in FINAL:
                assert self.goals.result(goal_id) == self.ended[goal_id]

    @invariant()
    def active_goals_are_not_forgotten(self) -> None:
        states = {goal.id: state for goal, state in self.goals.statuses}
        for goal_id in self.accepted - self.ended.keys():
            assert states[goal_id] in {ACCEPTED, EXECUTING, CANCELING}


AnyOrder.TestCase.settings = settings(max_examples=25, stateful_step_count=25, deadline=None)
TestAnyOrder = AnyOrder.TestCase
