"""The admin's knobs: every parameter of a robot and of its world, under its ROS name where ROS has one.

Each field carries its meaning, unit and bounds, from which the study file's reader, its error messages and its
commented template are made. Defaults are those of the 2016 study (its robots, its planner) and else ROS's own.
Names of the sections follow ROS: `amcl`, `costmap_2d`, `move_base`, `TrajectoryPlannerROS`, `NavfnROS`.
"""

from dataclasses import dataclass, field
from typing import TypeVar

T = TypeVar("T")


def knob(
    default: T,
    help: str,  # noqa: A002 - the word that argument parsers use for it
    unit: str = "",
    minimum: float | None = None,
    maximum: float | None = None,
    choices: tuple[str, ...] = (),
) -> T:
    """A dataclass field that an admin may set, with what a reader of the file needs to know about it.

    Args:
        default: the value when the file is silent; immutable.
        help: one sentence for the admin.
        unit: SI, e.g. "m", "m/s", "rad"; empty for a pure number.
        minimum: least allowed value, inclusive.
        maximum: greatest allowed value, inclusive.
        choices: the allowed words; empty when free.
    """
    metadata = {"help": help, "unit": unit, "minimum": minimum, "maximum": maximum, "choices": choices}
    # Every parameter class is frozen, so one default may serve all.
    return field(default=default, metadata=metadata)


@dataclass(frozen=True, slots=True)
class OdometryNoise:
    """How the wheels err, drawn anew every tick (Probabilistic Robotics, table 5.6)."""

    alpha1: float = knob(0.02, "error in turning per turning", minimum=0, maximum=10)
    alpha2: float = knob(0.02, "error in turning per metre driven", minimum=0, maximum=10)
    alpha3: float = knob(0.02, "error in distance per metre driven", minimum=0, maximum=10)
    alpha4: float = knob(0.02, "error in distance per turning", minimum=0, maximum=10)


@dataclass(frozen=True, slots=True)
class LaserParameters:
    """The laser every robot carries, and how it errs."""

    beams: int = knob(181, "number of beams", minimum=2, maximum=4000)
    field_of_view: float = knob(4.71238898, "angle between the first and the last beam", "rad", 0.01, 6.2831853)
    range_min: float = knob(0.05, "nearest distance it can measure", "m", 0, 10)
    range_max: float = knob(8.0, "farthest distance it can measure", "m", 0.1, 100)
    x: float = knob(0.1, "where it sits, forward of the robot's centre", "m", -2, 2)
    rate: int = knob(10, "sweeps per second; must divide 50", "Hz", 1, 50)
    range_noise: float = knob(0.02, "standard deviation of a range", "m", 0, 5)
    dropout: float = knob(0.005, "share of beams that return nothing", "", 0, 1)


@dataclass(frozen=True, slots=True)
class WorldParameters:
    """What is true of the robots and their sensors, whatever their software believes."""

    footprint: tuple[tuple[float, float], ...] = knob(
        ((0.25, 0.25), (-0.25, 0.25), (-0.25, -0.25), (0.25, -0.25), (0.35, 0.0)), "corners of the body", "m"
    )
    max_vel_x: float = knob(1.0, "speed the motors reach", "m/s", 0.01, 20)
    max_vel_theta: float = knob(1.5, "rate of turn the motors reach", "rad/s", 0.01, 20)
    acc_lim_x: float = knob(10.0, "acceleration of the motors", "m/s^2", 0.01, 100)
    acc_lim_theta: float = knob(10.0, "angular acceleration of the motors", "rad/s^2", 0.01, 100)
    gyro_noise: float = knob(0.01, "standard deviation of the measured rate of turn", "rad/s", 0, 10)
    odometry: OdometryNoise = knob(OdometryNoise(), "noise of the wheels")
    laser: LaserParameters = knob(LaserParameters(), "the laser")


@dataclass(frozen=True, slots=True)
class AmclParameters:
    """Particle filter localisation, under amcl's names; the defaults are amcl's where the comment does not say more."""

    min_particles: int = knob(100, "least number of particles", "", 1, 100000)
    max_particles: int = knob(1000, "greatest number of particles (amcl: 5000)", "", 1, 100000)
    kld_err: float = knob(0.05, "largest error between true and estimated distribution (amcl: 0.01)", "", 0, 1)
    kld_z: float = knob(0.99, "normal quantile of 1 - p, p: how sure the error is below kld_err", "", 0, 5)
    update_min_d: float = knob(0.2, "metres to drive before the filter is updated", "m", 0, 5)
    update_min_a: float = knob(0.523599, "angle to turn before the filter is updated", "rad", 0, 6.2832)
    resample_interval: int = knob(2, "updates from one resampling to the next", "", 1, 20)
    recovery_alpha_slow: float = knob(0.001, "decay of the slow average of the weights", "", 0, 0.5)
    recovery_alpha_fast: float = knob(0.1, "decay of the fast average of the weights", "", 0, 1)
    initial_cov_xx: float = knob(0.25, "variance of the first pose", "m^2", 0)
    initial_cov_yy: float = knob(0.25, "variance of the first pose", "m^2", 0)
    initial_cov_aa: float = knob(0.06853891945200942, "variance of the first heading", "rad^2", 0)
    laser_max_beams: int = knob(60, "beams of a scan that are used (amcl: 30)", "", 2, 4000)
    laser_max_range: float = knob(-1.0, "farther readings are not used; -1: the laser's own limit", "m", -1)
    laser_z_hit: float = knob(0.95, "weight of a good reading", "", 0, 1)
    laser_z_rand: float = knob(0.05, "weight of a random reading", "", 0, 1)
    laser_sigma_hit: float = knob(0.1, "standard deviation of a good reading (amcl: 0.2)", "m", 0.001, 10)
    laser_likelihood_max_dist: float = knob(2.0, "distances to walls are capped here", "m", 0, 20)
    odom_model_type: str = knob(
        "diff",
        "how the odom_alphas are read: for standard deviations, as amcl does by default, or corrected, for variances",
        choices=("diff", "diff-corrected"),
    )
    odom_alpha1: float = knob(0.2, "believed error in turning per turning", "", 0, 10)
    odom_alpha2: float = knob(0.2, "believed error in turning per metre", "", 0, 10)
    odom_alpha3: float = knob(0.2, "believed error in distance per metre", "", 0, 10)
    odom_alpha4: float = knob(0.2, "believed error in distance per turning", "", 0, 10)


@dataclass(frozen=True, slots=True)
class EkfParameters:
    """Extended Kalman filter localisation: odometry and gyroscope, corrected by matching scans to the map."""

    update_min_d: float = knob(0.2, "metres to drive before a scan is matched", "m", 0, 5)
    update_min_a: float = knob(0.523599, "angle to turn before a scan is matched", "rad", 0, 6.2832)
    initial_cov_xx: float = knob(0.25, "variance of the first pose", "m^2", 0)
    initial_cov_yy: float = knob(0.25, "variance of the first pose", "m^2", 0)
    initial_cov_aa: float = knob(0.06853891945200942, "variance of the first heading", "rad^2", 0)
    laser_max_beams: int = knob(60, "beams of a scan that are matched", "", 2, 4000)
    laser_max_range: float = knob(-1.0, "farther readings are not used; -1: the laser's own limit", "m", -1)
    odom_alpha1: float = knob(0.01, "believed variance in turning per turning", "", 0, 10)
    odom_alpha2: float = knob(0.01, "believed variance in turning per metre", "", 0, 10)
    odom_alpha3: float = knob(0.01, "believed variance in distance per metre", "", 0, 10)
    odom_alpha4: float = knob(0.01, "believed variance in distance per turning", "", 0, 10)
    gyro_noise: float = knob(0.01, "believed standard deviation of the measured rate of turn", "rad/s", 0, 10)


@dataclass(frozen=True, slots=True)
class ObstacleParameters:
    """Marking and clearing by the laser (costmap_2d's ObstacleLayer)."""

    obstacle_range: float = knob(1.5, "farther readings do not mark", "m", 0, 50)
    raytrace_range: float = knob(1.5, "farther space is not cleared", "m", 0, 50)


@dataclass(frozen=True, slots=True)
class InflationParameters:
    """Costs around obstacles (costmap_2d's InflationLayer)."""

    inflation_radius: float = knob(0.5, "costs reach this far from an obstacle", "m", 0, 50)
    cost_scaling_factor: float = knob(10.0, "how fast the costs fall with the distance", "1/m", 0, 100)


@dataclass(frozen=True, slots=True)
class CostmapParameters:
    """Layered costmaps, under costmap_2d's names."""

    update_frequency: float = knob(5.0, "updates per second", "Hz", 0.1, 50)
    width: float = knob(4.0, "side of the rolling local map", "m", 1, 50)
    footprint_padding: float = knob(0.01, "added to every corner of the footprint", "m", 0, 1)
    obstacle_layer: ObstacleParameters = knob(ObstacleParameters(), "marking and clearing by the laser")
    inflation_layer: InflationParameters = knob(InflationParameters(), "costs around obstacles")


@dataclass(frozen=True, slots=True)
class TrajectoryPlannerParameters:
    """The local planner, under base_local_planner's names; the values are those of the 2016 study."""

    max_vel_x: float = knob(1.0, "greatest forward speed", "m/s", 0, 20)
    min_vel_x: float = knob(0.1, "least forward speed while moving", "m/s", 0, 20)
    max_vel_theta: float = knob(1.0, "greatest rate of turn", "rad/s", 0, 20)
    min_in_place_vel_theta: float = knob(0.4, "least rate of turn in place", "rad/s", 0, 20)
    acc_lim_x: float = knob(10.0, "acceleration the planner counts on", "m/s^2", 0.01, 100)
    acc_lim_theta: float = knob(10.0, "angular acceleration the planner counts on", "rad/s^2", 0.01, 100)
    sim_time: float = knob(1.7, "seconds a trajectory is rolled out", "s", 0.1, 10)
    sim_granularity: float = knob(0.1, "distance between checked points of a trajectory (ROS: 0.025)", "m", 0.005, 5)
    vx_samples: int = knob(5, "forward speeds tried (ROS: 20)", "", 1, 300)
    vtheta_samples: int = knob(15, "rates of turn tried (ROS: 20)", "", 1, 300)
    pdist_scale: float = knob(0.8, "weight of keeping to the path", "", 0, 10)
    gdist_scale: float = knob(0.6, "weight of getting to the goal", "", 0, 10)
    occdist_scale: float = knob(0.02, "weight of keeping off obstacles", "", 0, 10)
    xy_goal_tolerance: float = knob(0.10, "how near the goal counts as reached", "m", 0.001, 5)
    yaw_goal_tolerance: float = knob(0.05, "how well the heading must agree at the goal", "rad", 0.001, 3.15)
    latch_xy_goal_tolerance: bool = knob(True, "once at the goal, only turn (ROS: false)")


@dataclass(frozen=True, slots=True)
class NavfnParameters:
    """The global planner, under navfn's names."""

    allow_unknown: bool = knob(True, "plans may cross unknown space")


@dataclass(frozen=True, slots=True)
class MoveBaseParameters:
    """The navigator, under move_base's names."""

    controller_frequency: float = knob(10.0, "commands per second (ROS: 20)", "Hz", 1, 50)
    planner_patience: float = knob(5.0, "seconds without a plan before recovery", "s", 0, 100)
    oscillation_timeout: float = knob(10.0, "seconds without progress before recovery; 0: never (ROS: 0)", "s", 0, 600)
    oscillation_distance: float = knob(0.5, "moving this far counts as progress", "m", 0, 10)
    recovery_behavior_enabled: bool = knob(True, "try to get free before giving up")


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
