"""One robot's own software."""

from dataclasses import dataclass

from sim.parameters.amcl import AmclParameters
from sim.parameters.costmap_2d import CostmapParameters
from sim.parameters.ekf import EkfParameters
from sim.parameters.fake_localization import FakeLocalizationParameters
from sim.parameters.global_planners import NavfnParameters
from sim.parameters.knobs import knob
from sim.parameters.local_planners import TrajectoryPlannerParameters
from sim.parameters.move_base import MoveBaseParameters


@dataclass(frozen=True, slots=True)
class RobotParameters:
    """One robot's own software."""

    localization: str = knob(
        "amcl",
        "how it knows where it is; truth and fake_localization are the same",
        choices=("amcl", "ekf", "truth", "fake_localization"),
    )
    amcl: AmclParameters = knob(AmclParameters(), "particle filter")
    ekf: EkfParameters = knob(EkfParameters(), "Kalman filter")
    fake_localization: FakeLocalizationParameters = knob(
        FakeLocalizationParameters(), "the truth instead of an estimate"
    )
    costmap: CostmapParameters = knob(CostmapParameters(), "costmaps")
    NavfnROS: NavfnParameters = knob(NavfnParameters(), "global planner")
    TrajectoryPlannerROS: TrajectoryPlannerParameters = knob(TrajectoryPlannerParameters(), "local planner")
    move_base: MoveBaseParameters = knob(MoveBaseParameters(), "navigator")
