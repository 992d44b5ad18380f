"""Goals of a navigator, and their results."""

from dataclasses import dataclass
from typing import Literal

from sim.common.geometry import Pose2
from sim.robot.global_planning.path import PlanRefusalCode

NoPathReason = (
    PlanRefusalCode | Literal["blocked_by_obstacle", "stuck", "lost"] | Literal["gave_up", "called_off", "unanswered"]
)
"""Cause of the failure of a goal. The last three are for navigators of real robots: the navigator gave up for its own
reasons, another client withdrew the goal, or the navigator did not answer."""


@dataclass(frozen=True, slots=True)
class Goal:
    """A pose to drive to.

    Attributes:
        id: number chosen by the owner. The result contains it.
        base_in_map: wanted pose of the base.
        owner: client that set the goal. Goals of two owners differ even if their numbers are equal.
    """

    id: int
    base_in_map: Pose2
    owner: str = ""


@dataclass(frozen=True, slots=True)
class GoalReached:
    """Result of a goal: the base stands at the goal, within the goal tolerances."""

    goal: Goal


@dataclass(frozen=True, slots=True)
class NoPath:
    """Result of a goal that was given up.

    Attributes:
        reason: code of the cause for programs. Codes never change.
        sentence: the cause for people.
    """

    goal: Goal
    reason: NoPathReason
    sentence: str


@dataclass(frozen=True, slots=True)
class Cancelled:
    """Result of a goal that was withdrawn, or replaced by another goal."""

    goal: Goal


GoalResult = GoalReached | NoPath | Cancelled
