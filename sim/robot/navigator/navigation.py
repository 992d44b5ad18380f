"""Output of a navigator in one tick."""

from typing import Literal

from sim.common.frozen import frozen
from sim.common.observations import Claim, Twist
from sim.numerics.float_array import FloatArray
from sim.robot.costmap.view import ShownCostmap
from sim.robot.navigator.goals import Goal, GoalResult

NavigatorState = Literal["idle", "planning", "controlling", "clearing"]


@frozen()
class Navigation:
    """Command, goal, plan and results of one robot in one tick.

    Attributes:
        command: the velocity command.
        goal: the present goal.
        state: state of move_base: "planning" waits for a plan, "controlling" follows it, "clearing" runs a recovery
            behavior.
        plan: (m, 3) map poses of the remaining path, starting with the robot's pose. Empty if the robot
            has no goal. The robot broadcasts the plan.
        times: (m,) times of these poses, also broadcast. They are empty if other robots block the plan and are asked to
            clear it.
        local_plan: (k, 3) map poses along the trajectory of the command.
        result: result of a goal that ended in this tick.
        remaining: remaining length of the plan, meters.
        claim: priority of the robot that wants the plan, if others are asked to clear it.
        global_costmap: costs for plans, in ticks when they are published.
        local_costmap: costs for commands, in ticks when they are published.
        waits_for: robot that goes first, while this robot stands and waits for it. Otherwise None.
        makes_way_for: robot with the right of way, while this robot waits for it, drives aside, or drives around it.
        fault: failure of an installed planner or recovery behavior in this tick. Empty if nothing failed.
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
    global_costmap: ShownCostmap | None = None
    local_costmap: ShownCostmap | None = None
    waits_for: int | None = None
    makes_way_for: int | None = None
    fault: str = ""
