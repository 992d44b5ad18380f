"""What a navigator tells of one tick."""

from dataclasses import dataclass
from typing import Literal

from sim.common.geometry import FloatArray
from sim.common.observations import Claim, Twist
from sim.robot.costmap.view import CostmapView
from sim.robot.navigator.goals import Goal, GoalResult

NavigatorState = Literal["idle", "planning", "controlling", "clearing"]


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
        claim: beside a plan that is only wished for, whose wish it is.
        global_costmap: the costs that plans are made with, in the ticks when they are due to be shown.
        local_costmap: the same of commands.
        waits_for: the robot that this one lets go first, where it stands because of one.
    """

    command: Twist
    goal: Goal | None
    state: NavigatorState
    plan: FloatArray
    times: FloatArray
    local_plan: FloatArray
    result: GoalResult | None
    remaining: float
    claim: Claim | None = None
    global_costmap: CostmapView | None = None
    local_costmap: CostmapView | None = None
    waits_for: int | None = None
