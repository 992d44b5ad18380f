"""Goals of an action server: their states, cancel requests, and the clients that wait for their results.

This is the part of an action server that is the same for all actions. It has no sockets and no clock.

Source: ros2/rcl, rcl_action (action_server.c, goal_state_machine.c); ros2/rclpy, action/server.py.
Differences from ROS: the numbers of goals and of waiting clients are limited. If there are too many goals, the oldest
ended goal is forgotten before its time. All cancel requests for active goals are accepted.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Generic, NamedTuple, TypeAlias, TypeVar

R = TypeVar("R")

GOALS = 64
"""Maximum number of goals that a server knows. The status list contains all of them."""
WAITING = 64
"""Maximum number of requests that wait for the result of one goal."""
NO_ID = bytes(16)
"""Id in cancel requests that are not for a single goal."""


class ActionGoalState(IntEnum):
    """State of a goal, in the codes of action_msgs/GoalStatus."""

    UNKNOWN = 0
    ACCEPTED = 1
    EXECUTING = 2
    CANCELING = 3
    SUCCEEDED = 4
    CANCELED = 5
    ABORTED = 6


FINAL = frozenset({ActionGoalState.SUCCEEDED, ActionGoalState.CANCELED, ActionGoalState.ABORTED})
"""States of ended goals."""
_CANCELABLE = frozenset({ActionGoalState.ACCEPTED, ActionGoalState.EXECUTING})


class CancelCode(IntEnum):
    """Answer to a cancel request, in the codes of action_msgs/CancelGoal."""

    NONE = 0
    REJECTED = 1
    UNKNOWN_GOAL_ID = 2
    GOAL_TERMINATED = 3


class GoalInfo(NamedTuple):
    """action_msgs/GoalInfo: the 16 bytes of a goal's UUID, and the time of its acceptance in nanoseconds."""

    id: bytes
    stamp_ns: int


class ActionGoalStatus(NamedTuple):
    """action_msgs/GoalStatus: a goal with its state."""

    goal: GoalInfo
    state: ActionGoalState


class CancelAnswer(NamedTuple):
    """Response of action_msgs/CancelGoal: a code, and the goals that are canceled."""

    code: CancelCode
    goals: tuple[GoalInfo, ...] = ()


class ActionResult(NamedTuple, Generic[R]):
    """Final state of a goal, with its result. The result is None if the goal is unknown; clients get an empty one."""

    state: ActionGoalState
    value: R | None


OnResult: TypeAlias = Callable[[ActionResult[R]], None]
"""Function that sends the result of a goal to a client."""


@dataclass(slots=True, eq=False)
class _ServedGoal(Generic[R]):
    """Goal of an action server.

    Attributes:
        info: its id and the time of its acceptance.
        state: its state.
        value: its result. None before its end.
        ended_ns: time of its end.
        waiting: clients that wait for its result.
    """

    info: GoalInfo
    state: ActionGoalState = ActionGoalState.ACCEPTED
    value: R | None = None
    ended_ns: int = 0
    waiting: list[OnResult[R]] = field(default_factory=list)


class ActionGoals(Generic[R]):
    """All goals that an action server knows, in the order of their acceptance.

    Args:
        result_timeout_ns: time after the end of a goal for which its result is kept.

    Attributes:
        changed: True if the status list must be published. The publisher sets it to False.
    """

    def __init__(self, result_timeout_ns: int) -> None:
        self.changed = True
        self._result_timeout_ns = result_timeout_ns
        self._goals: dict[bytes, _ServedGoal[R]] = {}

    @property
    def statuses(self) -> tuple[ActionGoalStatus, ...]:
        """The status list."""
        return tuple(ActionGoalStatus(goal.info, goal.state) for goal in self._goals.values())

    @property
    def active(self) -> tuple[GoalInfo, ...]:
        """Goals that have not ended."""
        return tuple(goal.info for goal in self._goals.values() if goal.state not in FINAL)

    def state(self, goal_id: bytes) -> ActionGoalState:
        """Return the state of a goal."""
        goal = self._goals.get(goal_id)
        return ActionGoalState.UNKNOWN if goal is None else goal.state

    def result(self, goal_id: bytes) -> ActionResult[R] | None:
        """Return the result of a goal. Return None before its end. The result of an unknown goal is UNKNOWN."""
        goal = self._goals.get(goal_id)
        if goal is None:
            return ActionResult(ActionGoalState.UNKNOWN, None)
        return ActionResult(goal.state, goal.value) if goal.state in FINAL else None

    def accept(self, goal_id: bytes, now_ns: int) -> bool:
        """Add a goal. Return False if its id is already in use, or if too many goals are active."""
        if goal_id in self._goals:
            return False
        if len(self._goals) >= GOALS:
            oldest = next((known for known, goal in self._goals.items() if goal.state in FINAL), None)
            if oldest is None:
                return False
            del self._goals[oldest]
        self._goals[goal_id] = _ServedGoal(GoalInfo(goal_id, now_ns))
        self.changed = True
        return True

    def execute(self, goal_id: bytes) -> None:
        """Start an accepted goal. Goals in other states do not change."""
        goal = self._goals.get(goal_id)
        if goal is not None and goal.state is ActionGoalState.ACCEPTED:
            goal.state, self.changed = ActionGoalState.EXECUTING, True

    def cancel(self, goal_id: bytes, stamp_ns: int) -> CancelAnswer:
        """Cancel goals. They change to CANCELING, and end later.

        Args:
            goal_id: id of a goal, or `NO_ID`.
            stamp_ns: all goals up to this time are canceled, and the goal with the id. With 0, only the goal with the
                id is canceled. With 0 and `NO_ID`, all goals are canceled.
        """
        if goal_id != NO_ID and stamp_ns == 0:
            goal = self._goals.get(goal_id)
            if goal is None:
                return CancelAnswer(CancelCode.UNKNOWN_GOAL_ID)
            if goal.state not in _CANCELABLE:
                return CancelAnswer(CancelCode.GOAL_TERMINATED)
            canceled = [goal]
        else:
            everything = goal_id == NO_ID and stamp_ns == 0
            canceled = [
                goal
                for goal in self._goals.values()
                if goal.state in _CANCELABLE
                and (everything or goal.info.stamp_ns <= stamp_ns or goal.info.id == goal_id)
            ]
        for goal in canceled:
            goal.state, self.changed = ActionGoalState.CANCELING, True
        return CancelAnswer(CancelCode.NONE, tuple(goal.info for goal in canceled))

    def end(self, goal_id: bytes, state: ActionGoalState, value: R, now_ns: int) -> None:
        """End a goal, and send its result to all clients that wait for it. The end of an ended goal is ignored."""
        goal = self._goals.get(goal_id)
        if goal is None or goal.state in FINAL:
            return
        goal.state, goal.value, goal.ended_ns, self.changed = state, value, now_ns, True
        waiting, goal.waiting = goal.waiting, []
        for send in waiting:
            send(ActionResult(state, value))

    def ask_result(self, goal_id: bytes, send: OnResult[R]) -> None:
        """Send the result of a goal to a client when the goal ends. If it has ended or is unknown, send it at once."""
        result = self.result(goal_id)
        if result is not None:
            send(result)
        elif len(self._goals[goal_id].waiting) < WAITING:
            self._goals[goal_id].waiting.append(send)
        else:
            send(ActionResult(ActionGoalState.UNKNOWN, None))

    def expire(self, now_ns: int) -> None:
        """Forget goals that ended long ago."""
        for goal in [*self._goals.values()]:
            if goal.state in FINAL and now_ns - goal.ended_ns > self._result_timeout_ns:
                # As in rcl, this alone is no reason to publish the status list.
                del self._goals[goal.info.id]
