"""Action of test_msgs that counts, with the types of Kilted."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from rosbags.typesys import Stores

from thbridge.ros2.action_logic import ActionLogic
from thbridge.ros2.actions import ActionGoalState
from thbridge.ros2.distribution import DISTRIBUTIONS, Distribution
from thbridge.ros2.interface_texts import KILTED_TEXTS

FIBONACCI = "test_msgs/action/Fibonacci"
_TEXT = "int32 order\n---\nint32[] sequence\n---\nint32[] sequence\n"


@contextmanager
def counting_types() -> Iterator[Distribution]:
    """Return the types of Kilted, together with test_msgs/action/Fibonacci."""
    DISTRIBUTIONS["counting"] = (Stores.ROS2_KILTED, {**KILTED_TEXTS, FIBONACCI: _TEXT})
    try:
        yield Distribution("counting")
    finally:
        del DISTRIBUTIONS["counting"]


class CountingLogic(ActionLogic):
    """Logic of an action server that counts to `order`, by one in each step. A newer goal aborts the older one."""

    def __init__(self, distribution: Distribution) -> None:
        super().__init__(10_000_000_000)
        self._distribution = distribution
        self._now = 1_000_000_000
        self._orders: dict[bytes, int] = {}
        self._count = 0

    def receive_goal(self, goal_id: bytes, goal: Any, client: str) -> int | None:
        if not self.goals.accept(goal_id, self._now):
            return None
        for known in [*self._orders]:
            self._end(known, ActionGoalState.ABORTED)
        self._orders[goal_id], self._count = goal.order, 0
        return self._now

    def step(self) -> None:
        """Count by one."""
        self._now += 20_000_000
        self.goals.expire(self._now)
        for goal_id, order in [*self._orders.items()]:
            self.goals.execute(goal_id)
            self._count += 1
            if self.goals.state(goal_id) is ActionGoalState.CANCELING:
                self._end(goal_id, ActionGoalState.CANCELED)
            elif self._count >= order:
                self._end(goal_id, ActionGoalState.SUCCEEDED)
            else:
                counted = self._distribution.make(f"{FIBONACCI}_Feedback", sequence=[*range(self._count)])
                self._feedback.append((goal_id, counted))

    def _end(self, goal_id: bytes, state: ActionGoalState) -> None:
        del self._orders[goal_id]
        result = self._distribution.make(f"{FIBONACCI}_Result", sequence=[*range(self._count)])
        self.goals.end(goal_id, state, result, self._now)
