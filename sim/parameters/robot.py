"""Parameters of one robot's software."""

from dataclasses import dataclass
from typing import ClassVar

from sim.parameters.amcl import AmclParameters
from sim.parameters.costmap_2d import (
    GlobalCostmapParameters,
    InflationParameters,
    LocalCostmapParameters,
    ObservationSource,
    ObstacleParameters,
    RobotsParameters,
)
from sim.parameters.declaration import param
from sim.parameters.ekf import EkfParameters, UkfParameters
from sim.parameters.fake_localization import FakeLocalizationParameters
from sim.parameters.global_planners import GlobalPlannerParameters, NavfnParameters
from sim.parameters.local_planners import DwaPlannerParameters, TrajectoryPlannerParameters
from sim.parameters.move_base import MoveBaseParameters

_LASER = ObstacleParameters(
    obstacle_range=1.5,
    observation_sources=(ObservationSource(clearing=True, inf_is_valid=True),),
    # This is larger than the usual error in the poses of this robot and of the others.
    explained_distance=0.2,
    clear_between_beams=True,
)
# With at most 1000 particles, the error is about as small as with 5000 (2.1 and 2.0 cm on tours of the office). Our
# lasers have a noise of 2 cm, while amcl assumes 20 cm. A sigma of 10 cm instead of 20 cm reduces the error on these
# tours from 3.2 to 2.1 cm, and among eight robots from 3.4 to 1.6 cm.
_AMCL = AmclParameters(max_particles=1000, kld_err=0.05, laser_max_beams=60, laser_sigma_hit=0.1)
_INFLATION = InflationParameters(inflation_radius=0.5)

BUILT_IN_LOCALIZERS = ("amcl", "ekf", "ukf", "truth", "fake_localization")

MIN_MAX_PAIRS = (
    ("amcl", "min_particles", "max_particles"),
    ("TrajectoryPlannerROS", "min_vel_x", "max_vel_x"),
    ("TrajectoryPlannerROS", "min_in_place_vel_theta", "max_vel_theta"),
)
"""Sections of a robot's software, each with two parameters.

The first value must not exceed the second value.
"""


@dataclass(frozen=True, slots=True)
class RobotParameters:
    """Parameters of one robot's software."""

    not_in_ros: ClassVar[frozenset[str]] = frozenset({"localization", "ekf", "ukf"})

    localization: str = param(
        "amcl",
        "localizer: built in or installed; truth and fake_localization are the same",
        choices=BUILT_IN_LOCALIZERS,
        plugins="thbridge.localizers",
    )
    amcl: AmclParameters = param(_AMCL, "particle filter")
    ekf: EkfParameters = param(EkfParameters(), "Kalman filter, extended (ekf) or unscented (ukf)")
    ukf: UkfParameters = param(UkfParameters(), "sigma points of the unscented Kalman filter")
    fake_localization: FakeLocalizationParameters = param(
        FakeLocalizationParameters(), "localization by the true pose instead of an estimate"
    )
    global_costmap: GlobalCostmapParameters = param(
        GlobalCostmapParameters(
            robot_radius=None,
            track_unknown_space=True,
            publish_frequency=0.2,
            obstacle_layer=_LASER,
            # A driving robot soon leaves its present position. So plans do not avoid this position.
            robots_layer=RobotsParameters(under_way=False),
            inflation_layer=_INFLATION,
        ),
        "costmap of the whole map, for plans",
    )
    local_costmap: LocalCostmapParameters = param(
        LocalCostmapParameters(
            width=4.0,
            height=4.0,
            robot_radius=None,
            track_unknown_space=True,
            publish_frequency=1.0,
            obstacle_layer=_LASER,
            inflation_layer=_INFLATION,
        ),
        "costmap that moves with the robot, for velocity commands",
    )
    NavfnROS: NavfnParameters = param(NavfnParameters(), "global planner navfn")
    GlobalPlanner: GlobalPlannerParameters = param(GlobalPlannerParameters(), "global planner global_planner")
    TrajectoryPlannerROS: TrajectoryPlannerParameters = param(
        # These are the velocities and weights of the 2016 study. There are few samples, because a whole team must
        # be simulated fast enough.
        TrajectoryPlannerParameters(
            acc_lim_x=10.0,
            acc_lim_theta=10.0,
            max_vel_x=1.0,
            min_vel_x=0.1,
            sim_granularity=0.1,
            angular_sim_granularity=0.1,
            vx_samples=5,
            vtheta_samples=15,
            path_distance_bias=0.8,
            goal_distance_bias=0.6,
            occdist_scale=0.02,
            meter_scoring=True,
            latch_xy_goal_tolerance=True,
            heading_lookahead=0.4,
            escape_reset_dist=0.12,
        ),
        "local planner with trajectory rollout",
    )
    DWAPlannerROS: DwaPlannerParameters = param(
        # The limits of velocity and acceleration are the same as those of TrajectoryPlannerROS.
        DwaPlannerParameters(
            acc_lim_x=10.0,
            acc_lim_theta=10.0,
            max_vel_trans=1.0,
            max_vel_x=1.0,
            sim_granularity=0.05,
            vx_samples=6,
            latch_xy_goal_tolerance=True,
        ),
        "local planner with the dynamic window approach",
    )
    move_base: MoveBaseParameters = param(
        # Commands are sent at the rate of laser scans. There is a timeout, because robots that stand among
        # other robots must detect that they are stuck.
        MoveBaseParameters(controller_frequency=10.0, oscillation_timeout=10.0),
        "navigator",
    )
