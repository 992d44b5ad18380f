"""Parameters of particle filter localization, with the names of ROS's amcl."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from sim.parameters.declaration import live, param


@dataclass(frozen=True, slots=True)
class AmclParameters:
    """Particle filter localization, with the parameter names and defaults of ROS's amcl node."""

    not_in_ros: ClassVar[frozenset[str]] = frozenset({"odom_noise_learning_rate"})
    ros_only: ClassVar[Mapping[str, str]] = {
        "use_map_topic": "get the map from a topic instead of a service",
        "first_map_only": "ignore later maps",
        "gui_publish_rate": "publishing rate of scans and paths for displays",
        "save_pose_rate": "rate at which the last pose is stored on the parameter server",
        "odom_frame_id": "name of the odometry frame in tf",
        "base_frame_id": "name of the robot frame in tf",
        "global_frame_id": "name of the map frame in tf",
        "transform_tolerance": "time by which transforms are postdated",
        "tf_broadcast": "publish the transform map -> odom in tf",
        "force_update_after_initialpose": "use a scan immediately after initialpose; always done here",
        "force_update_after_set_map": "use a scan immediately after set_map",
        "bag_scan_period": "time between scans when amcl reads a bag instead of topics",
        "restore_defaults": "a button of dynamic_reconfigure",
    }

    min_particles: int = live(100, "minimum number of particles", "", 1, 100000)
    max_particles: int = live(5000, "maximum number of particles", "", 1, 100000)
    kld_err: float = live(
        0.01, "maximum error between the true and the estimated distribution (KLD sampling)", "", 0, 1
    )
    kld_z: float = live(
        0.99, "upper standard normal quantile of 1 - p; p is the probability that the error is below kld_err", "", 0, 5
    )
    update_min_d: float = live(0.2, "distance driven before the next filter update", "m", 0, 5)
    update_min_a: float = live(0.5235987755982988, "angle turned before the next filter update", "rad", 0, 6.2832)
    resample_interval: int = live(2, "number of filter updates between two resamplings", "", 1, 20)
    selective_resampling: bool = param(
        False, "resample only if the effective number of particles is below half of the number of particles"
    )
    recovery_alpha_slow: float = live(0.001, "decay rate of the slow average of scan agreement", "", 0, 0.5)
    recovery_alpha_fast: float = live(
        0.1,
        "decay rate of the fast average of scan agreement; a lost filter never recovers if both decay rates are 0",
        "",
        0,
        1,
    )
    std_warn_level_x: float = param(0.2, "standard deviation of x below which a lost robot counts as found", "m", 0)
    std_warn_level_y: float = param(0.2, "standard deviation of y below which a lost robot counts as found", "m", 0)
    std_warn_level_yaw: float = param(
        0.1, "standard deviation of the heading below which a lost robot counts as found", "rad", 0
    )
    initial_pose_x: float = param(0.0, "initial x if no other start pose is given", "m")
    initial_pose_y: float = param(0.0, "initial y if no other start pose is given", "m")
    initial_pose_a: float = param(0.0, "initial heading if no other start pose is given", "rad")
    initial_cov_xx: float = param(0.25, "initial variance of x", "m^2", 0)
    initial_cov_yy: float = param(0.25, "initial variance of y", "m^2", 0)
    initial_cov_aa: float = param(0.06853891945200942, "initial variance of the heading", "rad^2", 0)
    laser_model_type: str = live(
        "likelihood_field",
        "sensor model that weighs scans",
        choices=("likelihood_field", "likelihood_field_prob", "beam"),
    )
    laser_min_range: float = live(-1.0, "ignore readings nearer than this; -1: use the laser's minimum range", "m", -1)
    laser_max_range: float = live(-1.0, "ignore readings farther than this; -1: use the laser's maximum range", "m", -1)
    laser_max_beams: int = live(30, "number of beams of a scan that are used", "", 2, 4000)
    laser_z_hit: float = live(0.95, "mixture weight of readings that hit a wall of the map", "", 0, 1)
    laser_z_short: float = live(
        0.1, "mixture weight of readings cut short by something that is not on the map (beam)", "", 0, 1
    )
    laser_z_max: float = live(0.05, "mixture weight of readings at the maximum range (beam)", "", 0, 1)
    laser_z_rand: float = live(0.05, "mixture weight of random readings", "", 0, 1)
    laser_sigma_hit: float = live(0.2, "standard deviation of readings that hit a wall of the map", "m", 0.001, 10)
    laser_lambda_short: float = live(0.1, "exponential decay of short readings with distance (beam)", "1/m", 0, 10)
    laser_likelihood_max_dist: float = live(2.0, "use larger distances to walls as this distance", "m", 0, 20)
    do_beamskip: bool = live(
        False,
        "ignore beams that most particles do not explain, once the particles have converged (likelihood_field_prob)",
    )
    beam_skip_distance: float = live(
        0.5, "a beam that ends within this distance of a wall counts as explained", "m", 0, 2
    )
    beam_skip_threshold: float = live(0.3, "ignore a beam if a smaller proportion of particles explains it", "", 0, 1)
    beam_skip_error_threshold: float = param(
        0.9, "use all beams if a larger proportion of them is unexplained", "", 0, 1
    )
    odom_model_type: str = live(
        "diff",
        "type of drive (diff or omni); odom_alpha1..5 are standard deviations, as in amcl's first models, "
        "or variances (-corrected)",
        choices=("diff", "diff-corrected", "omni", "omni-corrected"),
    )
    odom_alpha1: float = live(0.2, "expected noise of measured rotation due to rotation", "", 0, 10)
    odom_alpha2: float = live(0.2, "expected noise of measured rotation due to driving", "", 0, 10)
    odom_alpha3: float = live(0.2, "expected noise of measured distance due to driving", "", 0, 10)
    odom_alpha4: float = live(0.2, "expected noise of measured distance due to rotation", "", 0, 10)
    odom_alpha5: float = live(0.2, "expected noise of sideways motion due to driving (omni)", "", 0, 10)
    odom_noise_learning_rate: float = live(
        0.2,
        "rate at which the filter learns from scans that odometry is noisier than odom_alpha1..5; 0: it never learns",
        "",
        0,
        1,
    )

    @property
    def recovers(self) -> bool:
        """False if both decay rates are 0. The filter then searches only near the tracked pose."""
        return self.recovery_alpha_slow > 0.0 or self.recovery_alpha_fast > 0.0
