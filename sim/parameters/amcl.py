"""Particle filter localisation, under amcl's names."""

from dataclasses import dataclass

from sim.parameters.knobs import knob


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
