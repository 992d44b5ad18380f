"""Adaptive Monte Carlo localisation: ROS's amcl as a function of values.

Source: Thrun, Burgard, Fox, Probabilistic Robotics (2005), table 8.3, sized by KLD sampling (Fox 2003); amcl_node.cpp
and pf.c of ros-planning/navigation for when and in which order. Where this differs from amcl the docstrings say so.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sim.geometry import FloatArray, Pose2, wrap_angle
from sim.grid import FREE, OccupancyGrid
from sim.localization.clusters import Bins, bin_particles, summarise
from sim.localization.estimate import Estimate, Start, read_only
from sim.localization.likelihood_field import Beams, LikelihoodField
from sim.localization.motion import Alphas, increment, move, spread
from sim.localization.recovery import Recovery
from sim.localization.resampling import adaptive, systematic
from sim.noise import Stream
from sim.observations import Imu, LaserMount, Odometry, Scan
from sim.parameters import AmclParameters

CANDIDATES = 20
"""Places looked at for each particle drawn anew."""


@dataclass(frozen=True, slots=True, eq=False)
class Belief:
    """All that the filter remembers between two ticks.

    Attributes:
        particles: (n, 3) poses in the map at the last update; read-only.
        weights: (n,) their weights, summing to 1; read-only.
        base_in_odom: the odometry at the last update.
        odom_in_map: the correction found then.
        covariance: (3, 3) of the pose found then; read-only.
        updates: scans weighed since the start.
        recovery: how well the map explained them.
        requested: whether the next scan is weighed in any case.
    """

    particles: FloatArray
    weights: FloatArray
    base_in_odom: Pose2
    odom_in_map: Pose2
    covariance: FloatArray
    updates: int
    recovery: Recovery
    requested: bool = False


@dataclass(frozen=True, slots=True)
class Anywhere:
    """What a filter remembers that was told to forget where it was, and has seen no tick since."""


AmclState = Start | Anywhere | Belief


class Amcl:
    """A particle filter over (x, y, theta) that weighs scans against the map; see `Localizer`.

    Before the first `start` it believes to be at the map's origin, as amcl does.
    """

    def __init__(
        self, parameters: AmclParameters, grid: OccupancyGrid, mount: LaserMount, seed: int, robot: str
    ) -> None:
        """A filter for one robot.

        Args:
            parameters: its knobs.
            grid: the static map.
            mount: the laser whose scans `update` will bring.
            seed: the session's.
            robot: its name, e.g. "robot1": no two robots draw the same noise.
        """
        self._parameters = parameters
        self._grid = grid
        self._beams = Beams.of(mount, parameters.laser_max_beams, parameters.laser_max_range)
        self._field = LikelihoodField.of(
            grid,
            self._beams,
            parameters.laser_z_hit,
            parameters.laser_z_rand,
            parameters.laser_sigma_hit,
            parameters.laser_likelihood_max_dist,
        )
        self._alphas = Alphas(
            parameters.odom_alpha1, parameters.odom_alpha2, parameters.odom_alpha3, parameters.odom_alpha4
        )
        self._corrected = parameters.odom_model_type == "diff-corrected"
        self._free: NDArray[np.int64] = np.argwhere(grid.cells == FREE)
        self._start_noise = Stream.named(seed, robot, "amcl", "start")
        self._motion_noise = Stream.named(seed, robot, "amcl", "motion")
        self._resampling_noise = Stream.named(seed, robot, "amcl", "resampling")
        self._recovery_noise = Stream.named(seed, robot, "amcl", "recovery")
        variances = (parameters.initial_cov_xx, parameters.initial_cov_yy, parameters.initial_cov_aa)
        self._state: AmclState = Start(Pose2(0.0, 0.0, 0.0), read_only(np.diag(variances)))

    @property
    def state(self) -> AmclState:
        """Everything the next estimate depends on, besides what `update` will be told."""
        return self._state

    def restore(self, state: AmclState) -> None:
        """Go on from a state that `state` once gave."""
        self._state = state

    def start(self, base_in_map: Pose2, covariance: FloatArray) -> None:
        """Begin anew around this pose, at the next tick; the first scan from then on is weighed at once."""
        self._state = Start(base_in_map, read_only(covariance.copy()))

    def globalize(self) -> None:
        """Begin anew with no idea, at the next tick: uniform over the free cells and all headings."""
        self._state = Anywhere()

    def request_update(self) -> None:
        """Weigh the next scan even if the robot has not moved; the first scan after a start is weighed anyway."""
        if isinstance(self._state, Belief):
            self._state = replace(self._state, requested=True)

    def update(self, odometry: Odometry, imu: Imu, scan: Scan | None) -> Estimate:
        """Take in one tick; a scan is weighed when the robot has moved enough since the last one that was."""
        belief = self._state
        if isinstance(belief, Start):
            belief = self._state = self._scatter(belief, odometry)
        elif isinstance(belief, Anywhere):
            belief = self._state = self._scatter_everywhere(odometry)
        updated = scan is not None and self._due(belief, odometry.base_in_odom)
        if scan is not None and updated:
            belief = self._state = self._weigh(belief, odometry, scan)
        return Estimate(
            tick=odometry.tick,
            base_in_map=belief.odom_in_map.compose(odometry.base_in_odom),
            odom_in_map=belief.odom_in_map,
            covariance=belief.covariance,
            particles=belief.particles,
            updated=updated,
        )

    def _due(self, belief: Belief, base_in_odom: Pose2) -> bool:
        """Whether the robot moved enough along either axis of the odom frame, or turned enough (amcl_node.cpp)."""
        before, limit = belief.base_in_odom, self._parameters.update_min_d
        return (
            belief.updates == 0
            or belief.requested
            or abs(base_in_odom.x - before.x) > limit
            or abs(base_in_odom.y - before.y) > limit
            or abs(wrap_angle(base_in_odom.theta - before.theta)) > self._parameters.update_min_a
        )

    def _scatter(self, start: Start, odometry: Odometry) -> Belief:
        """As many particles as allowed, drawn around the start."""
        n = self._parameters.max_particles
        values, vectors = np.linalg.eigh(start.covariance)
        # A covariance may be singular (a heading known exactly), which Cholesky's factors do not bear.
        root = vectors * np.sqrt(np.maximum(values, 0.0))
        noise = self._start_noise.normals(odometry.tick, 3 * n).reshape(n, 3)
        particles = start.base_in_map.array() + noise @ root.T
        particles[:, 2] = (particles[:, 2] + math.pi) % (2.0 * math.pi) - math.pi
        return Belief(
            particles=read_only(particles),
            weights=read_only(np.full(n, 1.0 / n)),
            base_in_odom=odometry.base_in_odom,
            odom_in_map=start.base_in_map.compose(odometry.base_in_odom.inverse()),
            covariance=start.covariance,
            updates=0,
            recovery=Recovery(),
        )

    def _scatter_everywhere(self, odometry: Odometry) -> Belief:
        """As many particles as allowed, drawn over the whole map; its middle stands for a pose until a scan comes."""
        n = self._parameters.max_particles
        particles = self._candidates(n, odometry.tick)
        mean = Pose2(*particles.mean(axis=0).tolist())
        return Belief(
            particles=read_only(particles),
            weights=read_only(np.full(n, 1.0 / n)),
            base_in_odom=odometry.base_in_odom,
            odom_in_map=mean.compose(odometry.base_in_odom.inverse()),
            covariance=read_only(np.cov(particles.T, bias=True)),
            updates=0,
            recovery=Recovery(),
        )

    def _weigh(self, belief: Belief, odometry: Odometry, scan: Scan) -> Belief:
        """One turn of the filter: move, weigh, report, and every so often resample."""
        parameters = self._parameters
        particles = belief.particles
        # The first scan may come ticks after the start; whatever was driven until then counts all the same.
        moved = increment(belief.base_in_odom, odometry.base_in_odom)
        noise = self._motion_noise.normals(odometry.tick, 3 * len(particles))
        particles = move(particles, moved, spread(moved, self._alphas, self._corrected), noise)

        points = self._beams.end_points(scan)
        log_weights = self._field.log_likelihood(particles, points)
        weights = belief.weights * np.exp(log_weights - log_weights.max())
        total = weights.sum()
        weights = weights / total if total > 0.0 else belief.weights

        bins = bin_particles(particles)
        summary = summarise(particles, weights, bins)
        recovery = belief.recovery
        if len(points):
            recovery = recovery.after(
                self._field.agreement(summary.mean, points),
                parameters.recovery_alpha_slow,
                parameters.recovery_alpha_fast,
            )
        updates = belief.updates + 1
        if updates % parameters.resample_interval == 0:
            particles = self._resample(particles, weights, bins, recovery.lost, points, odometry.tick)
            weights = np.full(len(particles), 1.0 / len(particles))
        return Belief(
            particles=read_only(particles),
            weights=read_only(weights),
            base_in_odom=odometry.base_in_odom,
            odom_in_map=summary.mean.compose(odometry.base_in_odom.inverse()),
            covariance=read_only(summary.covariance),
            updates=updates,
            recovery=recovery,
        )

    def _resample(
        self, particles: FloatArray, weights: FloatArray, bins: Bins, lost: float, points: FloatArray, tick: int
    ) -> FloatArray:
        """The next generation: heirs of the present one and, when lost, newcomers from all over the map.

        Newcomers are drawn where the present scan fits (sensor resetting: Lenser and Veloso 2000); places drawn
        blindly, as by amcl, hardly ever lie near enough to the truth to survive.
        """
        parameters = self._parameters
        heirs_offset, newcomers, newcomers_offset = self._resampling_noise.uniforms(tick, 3)
        # Newcomers lie in so many bins that KLD sampling would ask for the greatest number of particles anyway.
        count = int(lost * parameters.max_particles + newcomers) if len(self._free) else 0
        if count == 0:
            heirs = adaptive(
                weights,
                bins.of_particle,
                heirs_offset,
                parameters.kld_err,
                parameters.kld_z,
                parameters.min_particles,
                parameters.max_particles,
            )
            return particles[heirs]
        candidates = self._candidates(count * CANDIDATES, tick)
        fit = self._field.log_likelihood(candidates, points)
        chosen = systematic(np.exp(fit - fit.max()), count, newcomers_offset)
        heirs = systematic(weights, parameters.max_particles - count, heirs_offset)
        return np.concatenate((particles[heirs], candidates[chosen]))

    def _candidates(self, count: int, tick: int) -> FloatArray:
        """(count, 3) poses in the middles of free cells, uniform over the map and all headings."""
        cell, heading = self._recovery_noise.uniforms(tick, 2 * count).reshape(2, count)
        cells = self._free[(cell * len(self._free)).astype(np.int64)]
        return np.column_stack((self._grid.centres_of(cells), heading * 2.0 * math.pi - math.pi))
