"""move_base: from a goal to commands, with its goal states and recovery behaviours."""

from dataclasses import dataclass
from typing import Literal

from sim.geometry import FloatArray, Pose2
from sim.observations import Twist

NavigatorState = Literal["idle", "planning", "controlling", "clearing"]


@dataclass(frozen=True, slots=True)
class Goal:
    """A pose to drive to.

    Attributes:
        id: the caller's number; comes back with the result.
        base_in_map: where the base shall end.
    """

    id: int
    base_in_map: Pose2


@dataclass(frozen=True, slots=True)
class Arrived:
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
    reason: str
    sentence: str


@dataclass(frozen=True, slots=True)
class Cancelled:
    """The goal was withdrawn, or another took its place."""

    goal: Goal


@dataclass(frozen=True, slots=True)
class Navigation:
    """What a robot does about its goal in one tick.

    Attributes:
        command: the velocity it asks for.
        goal: the one under way.
        state: move_base's: "planning" waits for a plan, "controlling" follows it, "clearing" tries to get free.
        plan: (m, 3) map poses still to be driven, the robot's own place first; empty without a goal. The path that
            its neighbours hear.
        times: (m,) the times that its neighbours hear with it; empty beside a plan that is only wished for.
        local_plan: (k, 3) map poses the command would lead through.
        result: how a goal ended in this very tick.
        remaining: metres of the plan left.
    """

    command: Twist
    goal: Goal | None
    state: NavigatorState
    plan: FloatArray
    times: FloatArray
    local_plan: FloatArray
    result: Arrived | NoPath | Cancelled | None
    remaining: float
