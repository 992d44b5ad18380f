"""One robot's own software."""

from dataclasses import dataclass

from sim.parameters.amcl import AmclParameters
from sim.parameters.costmap_2d import CostmapParameters
from sim.parameters.ekf import EkfParameters
from sim.parameters.global_planners import NavfnParameters
from sim.parameters.knobs import knob
from sim.parameters.local_planners import TrajectoryPlannerParameters
from sim.parameters.move_base import MoveBaseParameters


@dataclass(frozen=True, slots=True)
class RobotParameters:
    """One robot's own software."""

    localization: str = knob("amcl", "how it knows where it is", choices=("amcl", "ekf", "truth"))
    amcl: AmclParameters = knob(AmclParameters(), "particle filter")
    ekf: EkfParameters = knob(EkfParameters(), "Kalman filter")
    costmap: CostmapParameters = knob(CostmapParameters(), "costmaps")
    NavfnROS: NavfnParameters = knob(NavfnParameters(), "global planner")
    TrajectoryPlannerROS: TrajectoryPlannerParameters = knob(TrajectoryPlannerParameters(), "local planner")
    move_base: MoveBaseParameters = knob(MoveBaseParameters(), "navigator")
