"""Output of a navigator in one tick."""

from typing import Literal

from sim.common.frozen import frozen
from sim.common.observations import Claim, Twist
from sim.numerics.float_array import FloatArray
from sim.robot.costmap.view import CostmapView
from sim.robot.navigator.goals import Goal, GoalResult

NavigatorState = Literal["idle", "planning", "controlling", "clearing"]


@frozen()
class Navigation:
    """Command, goal, plan and results of one robot in one tick.

    Attributes:
        command: the velocity it asks for.
        goal: the one it is driving to.
        state: move_base's: "planning" waits for a plan, "controlling" follows it, "clearing" tries to get free.
        plan: (m, 3) map poses still to be driven, the robot's own place first; empty without a goal. Broadcast to the
            team.
        times: (m,) times of these poses, broadcast with them; empty with a plan that is only wanted.
        local_plan: (k, 3) map poses the command would lead through.
        result: that of a goal that ended in this very tick.
        remaining: meters of the plan left.
        claim: with a plan that is only wanted: the priority of the robot that wants it.
        global_costmap: the costs that plans are made with, in the ticks when they are published.
        local_costmap: the same for commands.
        waits_for: the robot that this one lets go first, if it stands because of one.
        makes_way_for: the robot that has the right of way while this one waits for it, or drives aside or round it.
        fault: failure of a planner or recovery behavior of others in this very tick; empty without one.
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
    makes_way_for: int | None = None
    fault: str = ""
