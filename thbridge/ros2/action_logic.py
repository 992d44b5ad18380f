"""Part of an action server that decides about its goals. It does not know the graph."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence

from thbridge.ros2.actions import ActionGoals, CancelAnswer


class ActionLogic(ABC):
    """Logic of an action server. Goals, feedback and results are message objects of the action's types.

    Args:
        result_timeout_ns: time after the end of a goal for which its result is kept.

    Attributes:
        goals: the goals, with their results.
        has_listeners: returns False if no client receives feedback. Then no feedback is made.
    """

    def __init__(self, result_timeout_ns: int) -> None:
        self.goals: ActionGoals[object] = ActionGoals(result_timeout_ns)
        self.has_listeners: Callable[[], bool] = lambda: True
        self._feedback: list[tuple[bytes, object]] = []

    @abstractmethod
    def receive_goal(self, goal_id: bytes, goal: object, client: str) -> int | None:
        """Process a new goal of a client's node.

        Returns:
            Time of its acceptance in nanoseconds. None if the goal is rejected.
        """

    def receive_cancel(self, goal_id: bytes, stamp_ns: int, client: str) -> CancelAnswer:
        """Process a cancel request of a client's node. See `ActionGoals.cancel`."""
        return self.goals.cancel(goal_id, stamp_ns)

    def take_feedback(self) -> Sequence[tuple[bytes, object]]:
        """Return the feedback since the last call, each with the id of its goal."""
        feedback, self._feedback = self._feedback, []
        return feedback
