"""Particle filter localization, under amcl's names."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from sim.parameters.declaration import live, param


@dataclass(frozen=True, slots=True)
class AmclParameters:
    """Particle filter localization, under amcl's names and with the defaults that amcl's node runs with."""

    not_in_ros: ClassVar[frozenset[str]] = frozenset({"odom_noise_learning_rate"})
    ros_only: ClassVar[Mapping[str, str]] = {
        "use_map_topic": "whether the map comes from a topic or a service",
        "first_map_only": "whether later maps are ignored",
        "gui_publish_rate": "how often scans and paths are shown",
        "save_pose_rate": "how often the last pose goes to the parameter server",
        "odom_frame_id": "the name of the odometry's frame in tf",
        "base_frame_id": "the name of the robot's frame in tf",
        "global_frame_id": "the name of the map's frame in tf",
        "transform_tolerance": "how far transforms are stamped into the future",
        "tf_broadcast": "whether map -> odom goes to tf",
        "force_update_after_initialpose": "whether a scan is weighed at once after initialpose, as it always is here",
        "force_update_after_set_map": "whether a scan is weighed at once after set_map",
        "bag_scan_period": "the time between scans when a bag is read instead of topics",
        "restore_defaults": "a button of dynamic_reconfigure",
    }

    min_particles: int = live(100, "least number of particles", "", 1, 100000)
    max_particles: int = live(5000, "greatest number of particles", "", 1, 100000)
    kld_err: float = live(0.01, "largest error between true and estimated distribution", "", 0, 1)
    kld_z: float = live(0.99, "normal quantile of 1 - p, p: how sure the error is below kld_err", "", 0, 5)
    update_min_d: float = live(0.2, "metres to drive before the filter is updated", "m", 0, 5)
    update_min_a: float = live(0.5235987755982988, "angle to turn before the filter is updated", "rad", 0, 6.2832)
    resample_interval: int = live(2, "updates from one resampling to the next", "", 1, 20)
    selective_resampling: bool = param(False, "resample only when less than half of the particles are effective")
    recovery_alpha_slow: float = live(0.001, "decay of the slow average of how well scans fit", "", 0, 0.5)
    recovery_alpha_fast: float = live(
        0.1, "decay of the fast average of how well scans fit; 0 for both: never recover", "", 0, 1
    )
    std_warn_level_x: float = param(0.2, "a lost robot is found when its place is this sure", "m", 0)
    std_warn_level_y: float = param(0.2, "a lost robot is found when its place is this sure", "m", 0)
    std_warn_level_yaw: float = param(0.1, "a lost robot is found when its heading is this sure", "rad", 0)
    initial_pose_x: float = param(0.0, "where the robot begins when nobody tells", "m")
    initial_pose_y: float = param(0.0, "where the robot begins when nobody tells", "m")
    initial_pose_a: float = param(0.0, "how it is turned when nobody tells", "rad")
    initial_cov_xx: float = param(0.25, "variance of the first pose", "m^2", 0)
    initial_cov_yy: float = param(0.25, "variance of the first pose", "m^2", 0)
    initial_cov_aa: float = param(0.06853891945200942, "variance of the first heading", "rad^2", 0)
    laser_model_type: str = live(
        "likelihood_field",
        "how scans are weighed",
        choices=("likelihood_field", "likelihood_field_prob", "beam"),
    )
    laser_min_range: float = live(-1.0, "nearer readings are not used; -1: the laser's own limit", "m", -1)
    laser_max_range: float = live(-1.0, "farther readings are not used; -1: the laser's own limit", "m", -1)
    laser_max_beams: int = live(30, "beams of a scan that are used", "", 2, 4000)
    laser_z_hit: float = live(0.95, "weight of a good reading", "", 0, 1)
    laser_z_short: float = live(0.1, "weight of a reading cut short by something unmapped (beam)", "", 0, 1)
    laser_z_max: float = live(0.05, "weight of a beam that comes back from nowhere (beam)", "", 0, 1)
    laser_z_rand: float = live(0.05, "weight of a random reading", "", 0, 1)
    laser_sigma_hit: float = live(0.2, "standard deviation of a good reading", "m", 0.001, 10)
    laser_lambda_short: float = live(0.1, "decay of short readings with distance (beam)", "1/m", 0, 10)
    laser_likelihood_max_dist: float = live(2.0, "distances to walls are capped here", "m", 0, 20)
    do_beamskip: bool = live(
        False, "leave out beams that most particles cannot explain, once they agree (likelihood_field_prob)"
    )
    beam_skip_distance: float = live(0.5, "a beam that ends this near a wall is explained", "m", 0, 2)
    beam_skip_threshold: float = live(0.3, "share of the particles that must explain a beam", "", 0, 1)
    beam_skip_error_threshold: float = param(0.9, "share of unexplained beams from which on none is left out", "", 0, 1)
    odom_model_type: str = live(
        "diff",
        "wheels or sliding, and how odom_alphas are read: for standard deviations, as in amcl's first models, or "
        "corrected, for variances",
        choices=("diff", "diff-corrected", "omni", "omni-corrected"),
    )
    odom_alpha1: float = live(0.2, "believed error in turning per turning", "", 0, 10)
    odom_alpha2: float = live(0.2, "believed error in turning per metre", "", 0, 10)
    odom_alpha3: float = live(0.2, "believed error in distance per metre", "", 0, 10)
    odom_alpha4: float = live(0.2, "believed error in distance per turning", "", 0, 10)
    odom_alpha5: float = live(0.2, "believed error sideways per metre (omni)", "", 0, 10)
    odom_noise_learning_rate: float = live(
        0.2, "how fast scans teach that odometry is worse than odom_alpha1..5 say; 0: never", "", 0, 1
    )

    @property
    def recovers(self) -> bool:
        """True unless both decays are 0: the filter then never looks for the robot where it does not track it."""
        return self.recovery_alpha_slow > 0.0 or self.recovery_alpha_fast > 0.0
