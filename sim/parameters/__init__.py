"""Parameters that an admin may set for a robot and for its world. Parameters that ROS also has use its names.

Each field declares its meaning, unit and bounds. The reader of study files, its error messages and the commented
template use these. The defaults are from the 2016 study (its robots, its planner), or from ROS if the study had none.
Sections have the names of ROS: `amcl`, `costmap_2d`, `move_base`, `TrajectoryPlannerROS`, `NavfnROS`.
"""

from sim.parameters.amcl import AmclParameters
from sim.parameters.costmap_2d import (
    CostmapParameters,
    GlobalCostmapParameters,
    InflationParameters,
    LocalCostmapParameters,
    ObservationSource,
    ObstacleParameters,
    RobotsParameters,
    StaticParameters,
)
from sim.parameters.declaration import param
from sim.parameters.ekf import EkfParameters, UkfParameters
from sim.parameters.fake_localization import FakeLocalizationParameters
from sim.parameters.global_planners import GlobalPlannerParameters, NavfnParameters
from sim.parameters.local_planners import DwaPlannerParameters, TrajectoryPlannerParameters
from sim.parameters.move_base import MoveBaseParameters, RecoveryBehavior
from sim.parameters.part_names import PartKind, installed_names
from sim.parameters.reconfiguration import (
    DeclaredParameter,
    ParameterRejection,
    declared_parameters,
    live_parameters,
    reconfigurable,
    reconfigured,
)
from sim.parameters.robot import MIN_MAX_PAIRS, RobotParameters
from sim.parameters.ros_defaults import not_in_ros, parameters_of, with_ros_defaults
from sim.parameters.world import LaserParameters, OdometryNoise, WorldParameters
