"""Goals of a navigator, and the results they end with."""

from dataclasses import dataclass
from typing import Literal

from sim.common.geometry import Pose2
from sim.robot.global_planning.path import PlanRefusalCode

NoPathReason = (
    PlanRefusalCode | Literal["blocked_by_obstacle", "stuck", "lost"] | Literal["gave_up", "called_off", "unanswered"]
)
"""Cause for which a goal was given up. The last three are of real robots' navigators: one gave up for reasons of its
own, somebody else withdrew the goal, one did not answer."""


@dataclass(frozen=True, slots=True)
class Goal:
    """A pose to drive to.

    Attributes:
        id: the owner's number; comes back with the result.
        base_in_map: pose that the base shall end at.
        owner: who has set it; goals of two owners differ even if their numbers do not.
    """

    id: int
    base_in_map: Pose2
    owner: str = ""


@dataclass(frozen=True, slots=True)
class GoalReached:
    """The base stands at the goal, within the goal tolerances."""

    goal: Goal


@dataclass(frozen=True, slots=True)
class NoPath:
    """The goal was given up.

    Attributes:
        reason: the cause as a code, stable for programs.
        sentence: the cause for people.
    """

    goal: Goal
    reason: NoPathReason
    sentence: str


@dataclass(frozen=True, slots=True)
class Cancelled:
    """The goal was withdrawn, or another took its place."""

    goal: Goal


GoalResult = GoalReached | NoPath | Cancelled
