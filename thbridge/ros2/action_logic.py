"""Interface between an action server on a graph and the part of the program that decides about its goals."""

from collections.abc import Sequence
from typing import Protocol

from thbridge.ros2.actions import ActionGoals, CancelAnswer


class ActionLogic(Protocol):
    """Logic of an action server. Goals, feedback and results are message objects of the action's types.

    Attributes:
        goals: the goals, with their results.
    """

    goals: ActionGoals[object]

    def receive_goal(self, goal_id: bytes, goal: object, client: str) -> int | None:
        """Process a new goal of a client's node.

        Returns:
            Time of its acceptance in nanoseconds. None if the goal is rejected.
        """

    def receive_cancel(self, goal_id: bytes, stamp_ns: int, client: str) -> CancelAnswer:
        """Process a cancel request of a client's node. See `ActionGoals.cancel`."""

    def take_feedback(self) -> Sequence[tuple[bytes, object]]:
        """Return the feedback since the last call, each with the id of its goal."""
