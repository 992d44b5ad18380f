"""Adaptive Monte Carlo localisation: ROS's amcl as a function of values.

The belief is a cloud of weighted poses, the particles. When the robot has moved enough and a scan is there, every
particle moves by the odometry with an error of its own (`motion`), and its weight is multiplied by how well the scan
fits the map from there (`likelihood_field`, `beam`). The pose reported is the mean of the heaviest cluster
(`clusters`). Every so often a new generation is drawn in proportion to the weights, as many particles as the cloud's
spread asks for (`resampling`). Meanwhile `scan_agreement` watches how well the map explains the scans at the reported
pose: where it does so badly, the robot is lost, and part of each generation comes from all over the map until the
particles settle in one place that explains the scans.

Source: Thrun, Burgard, Fox, Probabilistic Robotics (2005), table 8.3, sized by KLD sampling (Fox 2003); amcl_node.cpp
and pf.c of ros-planning/navigation for when and in which order. Where this differs from amcl the docstrings say so.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from sim.common.frozen import frozen
from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import Imu, LaserMount, Odometry, Scan
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray
from sim.numerics.matrices import covariance_of, product, root
from sim.numerics.noise_arrays import NoiseStream
from sim.parameters import AmclParameters, RobotParameters
from sim.robot.localization.beam import BeamModel
from sim.robot.localization.clusters import CloudSummary, ParticleBins, bin_particles, summarise
from sim.robot.localization.estimate import Estimate, PosePrior, read_only
from sim.robot.localization.free_space import FreeSpace
from sim.robot.localization.likelihood_field import Beams, LikelihoodField
from sim.robot.localization.motion import Alphas, MotionModel
from sim.robot.localization.resampling import adaptive, systematic, tempered
from sim.robot.localization.scan_agreement import ScanAgreement

CANDIDATES_PER_PARTICLE = 20
"""Places looked at for each particle drawn anew."""
MIN_CANDIDATES = 50_000
"""At least so many, so that one lies near enough to the right place in a map of some hundred square metres."""
MAX_CANDIDATES = 400_000
"""At most so many: a quarter of a second's work with 60 beams."""

FITTING_SHARE = 0.01
"""Share of the candidates that must remain effective when newcomers are drawn by how well a scan fits."""
NEWCOMER_JITTER = (0.05, 0.05, 0.05)
"""Metres, metres, radians by which newcomers at one place differ."""

CONVERGED_DISTANCE = 0.5
"""Metres from the mean, along either axis, within which all particles must lie for beams to be skipped (pf.c)."""

EFFECTIVE_SHARE = 0.1
"""Share of equal particles that every scan must leave effective, see `tempered`."""

JITTER = (0.01, 0.01, 0.01)
"""Metres, metres, radians by which heirs of one particle differ. The odometry of a robot that turns on the spot
does not spread their places: without this they would all become one.

Source: Musso, Oudjane and Le Gland, Improving regularised particle filters (2001).
"""

SURE_SHARE = 0.8
"""Share of the weight that the heaviest cluster must hold for a lost robot to be found."""

SETTLED_SCANS = 5
"""Scans in a row for which that must hold, and which the map must explain."""

SCATTER_SHARE = 0.5
"""Share of the particles that are drawn from all over the map when a robot turns out to be lost; the others stay, for
it may be wrong in that."""
SEARCH_SHARE = 0.2
"""The same share every time that particles are drawn until the robot is found."""

RETRY_TICKS = 25
"""Ticks until a robot that is lost, or whose scans are badly explained, weighs the next one even if it stands."""


INITIAL_AGREEMENT = ScanAgreement()
"""The agreement that a filter begins with."""


@frozen(eq=False)
class ParticleBelief:
    """All that the filter remembers between two ticks.

    Attributes:
        particles: (n, 3) poses in the map at the last update; read-only.
        weights: (n,) their weights, summing to 1; read-only.
        tick: that of the last update.
        base_in_odom: the odometry then.
        odom_in_map: the correction found then.
        covariance: (3, 3) of the pose found then; read-only.
        updates: scans weighed since the start.
        agreement: share of them that the map explains.
        lost: the verdict, see `Estimate`.
        settled: scans in a row after which a lost robot seemed found.
        uniform: True while the particles lie all over the map, and no scan has been weighed.
        requested: True when the next scan is weighed in any case.
    """

    particles: FloatArray
    weights: FloatArray
    tick: int
    base_in_odom: Pose2
    odom_in_map: Pose2
    covariance: FloatArray
    updates: int = 0
    agreement: ScanAgreement = INITIAL_AGREEMENT
    lost: bool = False
    settled: int = 0
    uniform: bool = False
    requested: bool = False


@dataclass(frozen=True, slots=True)
class UniformPrior:
    """State of a filter that was told to forget where it was, and has seen no tick since."""


AmclState = PosePrior | UniformPrior | ParticleBelief


def saved(parameters: AmclParameters, estimate: Estimate) -> AmclParameters:
    """Parameters with which a new filter begins where this estimate ends, as amcl writes to the parameter server."""
    pose, variances = estimate.base_in_map, np.diag(estimate.covariance)
    return replace(
        parameters,
        initial_pose_x=pose.x,
        initial_pose_y=pose.y,
        initial_pose_a=pose.theta,
        initial_cov_xx=float(variances[0]),
        initial_cov_yy=float(variances[1]),
        initial_cov_aa=float(variances[2]),
    )


class Amcl:
    """A particle filter over (x, y, theta) that weighs scans against the map; see `Localizer`.

    Before the first `start` it believes to be where its parameters say, as amcl does: at the map's origin by default.

    Attributes:
        state: everything the next estimate depends on, besides the arguments of `update`.
    """

    def __init__(
        self, parameters: AmclParameters, grid: OccupancyGrid, mount: LaserMount, seed: int, robot: str
    ) -> None:
        """A filter for one robot.

        Args:
            parameters: amcl's.
            grid: the static map.
            mount: the laser whose scans `update` will bring.
            seed: the session's.
            robot: its name, e.g. "robot1": no two robots draw the same noise.
        """
        self._grid = grid
        self._mount = mount
        self._use(parameters)
        self._free_space = FreeSpace(grid)
        # Walls may lie anywhere in their cells: an error that all particles share, and none can show.
        self._unknowable = np.diag((1.0, 1.0, 0.0)) * (grid.resolution * grid.resolution) / 12.0
        self._start_noise = NoiseStream.named(seed, robot, "amcl", "start")
        self._motion_noise = NoiseStream.named(seed, robot, "amcl", "motion")
        self._resampling_noise = NoiseStream.named(seed, robot, "amcl", "resampling")
        self._jitter_noise = NoiseStream.named(seed, robot, "amcl", "jitter")
        self._recovery_noise = NoiseStream.named(seed, robot, "amcl", "recovery")
        pose = Pose2(parameters.initial_pose_x, parameters.initial_pose_y, wrap_angle(parameters.initial_pose_a))
        variances = (parameters.initial_cov_xx, parameters.initial_cov_yy, parameters.initial_cov_aa)
        self.state: AmclState = PosePrior(pose, read_only(np.diag(variances)))

    def _use(self, parameters: AmclParameters) -> None:
        """Make the models that these parameters ask for."""
        self._parameters = parameters
        self._beams = Beams.of(
            self._mount, parameters.laser_max_beams, parameters.laser_max_range, parameters.laser_min_range
        )
        self._field = LikelihoodField.of(
            self._grid,
            self._beams,
            parameters.laser_z_hit,
            parameters.laser_z_rand,
            parameters.laser_sigma_hit,
            parameters.laser_likelihood_max_dist,
        )
        self._beam_model = BeamModel.of(self._grid, self._beams, parameters)
        alphas = Alphas(
            parameters.odom_alpha1,
            parameters.odom_alpha2,
            parameters.odom_alpha3,
            parameters.odom_alpha4,
            parameters.odom_alpha5,
        )
        self._motion = MotionModel(parameters.odom_model_type, alphas)

    def start(self, base_in_map: Pose2, covariance: FloatArray) -> None:
        """Begin anew around this pose, at the next tick; the first scan from then on is weighed at once."""
        self.state = PosePrior(base_in_map, read_only(covariance.copy()))

    def globalize(self) -> None:
        """Begin anew at the next tick, uniformly over the free cells and all headings."""
        self.state = UniformPrior()

    def request_update(self) -> None:
        """Weigh the next scan even if the robot has not moved; the first scan after a start is weighed anyway."""
        if isinstance(self.state, ParticleBelief):
            self.state = replace(self.state, requested=True)

    def configure(self, parameters: RobotParameters) -> None:
        """Go on with these parameters; a smaller cloud is drawn with the next generation.

        Differs: amcl draws its particles anew, around the pose that it last reported.
        """
        if parameters.amcl != self._parameters:
            self._use(parameters.amcl)

    @property
    def awaits_scan(self) -> bool:
        """True once it has begun: only scans are weighed."""
        return isinstance(self.state, ParticleBelief)

    def update(self, odometry: Odometry, imu: Imu, scan: Scan | None) -> Estimate:
        """Take in one tick; a scan is weighed when the robot has moved enough since the last one that was."""
        belief = self.state
        if isinstance(belief, PosePrior):
            belief = self.state = self._scatter(belief, odometry)
        elif isinstance(belief, UniformPrior):
            belief = self.state = self._scatter_everywhere(odometry)
        updated = scan is not None and self._due(belief, odometry)
        if scan is not None and updated:
            belief = self.state = self._weigh(belief, odometry, scan)
        return Estimate(
            tick=odometry.tick,
            base_in_map=belief.odom_in_map.compose(odometry.base_in_odom),
            odom_in_map=belief.odom_in_map,
            covariance=belief.covariance,
            particles=belief.particles,
            updated=updated,
            lost=belief.lost,
        )

    def _due(self, belief: ParticleBelief, odometry: Odometry) -> bool:
        """Return True when the robot moved enough along an axis of the odom frame, or turned enough (amcl_node.cpp)."""
        before, now, limit = belief.base_in_odom, odometry.base_in_odom, self._parameters.update_min_d
        return (
            belief.updates == 0
            or belief.requested
            or abs(now.x - before.x) > limit
            or abs(now.y - before.y) > limit
            or abs(wrap_angle(now.theta - before.theta)) > self._parameters.update_min_a
            or ((belief.lost or belief.agreement.doubtful) and odometry.tick - belief.tick >= RETRY_TICKS)
        )

    def _scatter(self, start: PosePrior, odometry: Odometry) -> ParticleBelief:
        """Draw as many particles as allowed around a pose that is known."""
        n = self._parameters.max_particles
        noise = self._start_noise.normals(odometry.tick, 3 * n).reshape(n, 3)
        particles = start.base_in_map.array() + product(noise, np.ascontiguousarray(root(start.covariance).T))
        particles[:, 2] = (particles[:, 2] + math.pi) % (2.0 * math.pi) - math.pi
        return ParticleBelief(
            particles=read_only(particles),
            weights=read_only(np.full(n, 1.0 / n)),
            tick=odometry.tick,
            base_in_odom=odometry.base_in_odom,
            odom_in_map=start.base_in_map.compose(odometry.base_in_odom.inverse()),
            covariance=start.covariance,
        )

    def _scatter_everywhere(self, odometry: Odometry) -> ParticleBelief:
        """Draw as many particles as allowed over the whole map; their mean stands for a pose until a scan comes."""
        n = self._parameters.max_particles
        particles = self._free_space.draw(n, self._recovery_noise, odometry.tick)
        mean = Pose2(*particles.mean(axis=0).tolist())
        return ParticleBelief(
            particles=read_only(particles),
            weights=read_only(np.full(n, 1.0 / n)),
            tick=odometry.tick,
            base_in_odom=odometry.base_in_odom,
            odom_in_map=mean.compose(odometry.base_in_odom.inverse()),
            covariance=read_only(covariance_of(particles)),
            lost=True,
            uniform=True,
        )

    def _weigh(self, belief: ParticleBelief, odometry: Odometry, scan: Scan) -> ParticleBelief:
        """Do one round of the filter: move, weigh, report, and every so often resample.

        Raises:
            ValueError: the scan has another number of beams than the laser that the filter was made for.
        """
        if len(scan.ranges) != self._beams.mount.beams:
            raise ValueError(f"a scan of {len(scan.ranges)} beams from a laser of {self._beams.mount.beams}")
        parameters = self._parameters
        points, ranges = self._beams.end_points(scan), self._beams.ranges(scan)
        if belief.uniform and len(points):
            # A uniform cloud of this size would hold no particle near the truth; so the scan is looked for in a sample
            # that is many times larger.
            particles = self._newcomers(parameters.max_particles, points, odometry.tick)
            weights: FloatArray = np.full(len(particles), 1.0 / len(particles))
        else:
            # The first scan may come ticks after the start; whatever was driven until then counts all the same.
            noise = self._motion_noise.normals(odometry.tick, 3 * len(belief.particles))
            particles = self._motion.move(belief.particles, belief.base_in_odom, odometry.base_in_odom, noise)
            weights = belief.weights * tempered(self._log_likelihood(particles, points, ranges), EFFECTIVE_SHARE)
            total = weights.sum()
            weights = weights / total if total > 0.0 else belief.weights

        bins = bin_particles(particles)
        summary = summarise(particles, weights, bins)
        recovery = belief.agreement
        agreement = self._beam_model.agreement(summary.mean, ranges)
        if agreement is not None and belief.lost:
            recovery = recovery.searching(agreement)
        elif agreement is not None:
            recovery = recovery.after(agreement, parameters.recovery_alpha_slow, parameters.recovery_alpha_fast)
        settled = belief.settled + 1 if recovery.explained and self._sure(summary) else 0
        lost = settled < SETTLED_SCANS if belief.lost else recovery.lost
        newcomers = self._share_of_newcomers(lost, belief.lost)
        updates = belief.updates + 1
        # With selective resampling, a cloud whose effective number (1 / sum of squares) is above half of its particles
        # is kept: drawing anew would only lose hypotheses (Grisetti, Stachniss, Burgard 2007).
        due = updates % parameters.resample_interval == 0 and not (
            parameters.selective_resampling and newcomers == 0.0 and 2.0 / (weights * weights).sum() > len(weights)
        )
        if due or newcomers == SCATTER_SHARE:
            particles = self._resample(particles, weights, bins, newcomers, points, odometry.tick)
            weights = np.full(len(particles), 1.0 / len(particles))
        return ParticleBelief(
            particles=read_only(particles),
            weights=read_only(weights),
            tick=odometry.tick,
            base_in_odom=odometry.base_in_odom,
            odom_in_map=summary.mean.compose(odometry.base_in_odom.inverse()),
            covariance=read_only(summary.covariance + self._unknowable),
            updates=updates,
            agreement=recovery,
            lost=lost,
            settled=settled,
            uniform=belief.uniform and not len(points),
        )

    def _sure(self, summary: CloudSummary) -> bool:
        """Return True when nearly all particles agree on one place."""
        parameters = self._parameters
        levels = (parameters.std_warn_level_x, parameters.std_warn_level_y, parameters.std_warn_level_yaw)
        return summary.weight >= SURE_SHARE and bool((np.sqrt(summary.variances) <= levels).all())

    def _share_of_newcomers(self, lost: bool, was_lost: bool) -> float:
        """Share of the next generation, 0..1, that is to come from all over the map."""
        never = self._parameters.recovery_alpha_slow == 0.0 and self._parameters.recovery_alpha_fast == 0.0
        if never or not lost:
            return 0.0
        return SEARCH_SHARE if was_lost else SCATTER_SHARE

    def _log_likelihood(self, particles: FloatArray, points: FloatArray, ranges: FloatArray) -> FloatArray:
        """(n,) log likelihood of a scan from each particle, by the model that the parameters name."""
        parameters = self._parameters
        if parameters.laser_model_type == "beam":
            return self._beam_model.log_likelihood(particles, ranges)
        skips = parameters.laser_model_type == "likelihood_field_prob" and parameters.do_beamskip
        if skips and np.ptp(particles[:, :2], axis=0).max() <= 2.0 * CONVERGED_DISTANCE:
            points = self._field.explained(
                particles,
                points,
                parameters.beam_skip_distance,
                parameters.beam_skip_threshold,
                parameters.beam_skip_error_threshold,
            )
        return self._field.log_likelihood(particles, points)

    def _resample(
        self,
        particles: FloatArray,
        weights: FloatArray,
        bins: ParticleBins,
        share: float,
        points: FloatArray,
        tick: int,
    ) -> FloatArray:
        """Draw the next generation: heirs of the present one and a share of newcomers from all over the map."""
        parameters = self._parameters
        heirs_offset, newcomers = self._resampling_noise.uniforms(tick, 2)
        # Newcomers lie in so many bins that KLD sampling would ask for the greatest number of particles anyway.
        count = int(share * parameters.max_particles + newcomers) if len(points) else 0
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
            return self._jittered(particles[heirs], tick)
        heirs = systematic(weights, parameters.max_particles - count, heirs_offset)
        return np.concatenate((self._jittered(particles[heirs], tick), self._newcomers(count, points, tick)))

    def _jittered(self, particles: FloatArray, tick: int, spread: tuple[float, float, float] = JITTER) -> FloatArray:
        """(n, 3) particles, each a little off, so that no two are the same."""
        noise = self._jitter_noise.normals(tick, 3 * len(particles)).reshape(-1, 3)
        return particles + noise * spread

    def _newcomers(self, count: int, points: FloatArray, tick: int) -> FloatArray:
        """(count, 3) places from all over the map where a scan fits, drawn in proportion to how well.

        Source: Lenser and Veloso, Sensor resetting localization for poorly modelled mobile robots (2000). Differs:
            amcl draws blindly; such places hardly ever lie near enough to the truth to survive.
        """
        places = max(MIN_CANDIDATES, min(count * CANDIDATES_PER_PARTICLE, MAX_CANDIDATES))
        candidates = self._free_space.draw(places, self._recovery_noise, tick)
        fit = self._field.log_likelihood(candidates, points)
        offset = self._resampling_noise.uniforms(tick, 3)[2]
        chosen: FloatArray = candidates[systematic(tempered(fit, FITTING_SHARE), count, offset)]
        return self._jittered(chosen, tick + 1, NEWCOMER_JITTER)
