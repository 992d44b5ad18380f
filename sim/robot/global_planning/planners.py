"""Choice of a robot's global planner."""

from sim.parameters import GlobalPlannerParameters, NavfnParameters
from sim.robot.global_planning.global_planner import GlobalPlanner
from sim.robot.global_planning.navfn import Navfn
from sim.robot.global_planning.potential_planner import PotentialPlanner
from sim.robot.global_planning.wave import Workspace


def global_planner(
    base_global_planner: str,
    navfn: NavfnParameters,
    global_planner: GlobalPlannerParameters,
    space: Workspace | None = None,
) -> PotentialPlanner:
    """Make the global planner that `move_base: base_global_planner` names.

    Args:
        base_global_planner: move_base's parameter of that name.
        navfn: parameters if it is navfn.
        global_planner: parameters if it is global_planner.
        space: see `PotentialPlanner`.
    """
    if base_global_planner == "global_planner/GlobalPlanner":
        return PotentialPlanner(GlobalPlanner(global_planner), space)
    return PotentialPlanner(Navfn(navfn), space)
