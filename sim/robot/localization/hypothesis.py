"""A hypothesis about the robot's pose: a cloud of particles that is moved, weighed by scans and resampled.

Every particle moves by the odometry with its own random error (`motion`). Its weight is multiplied by the scan's
likelihood at its new pose (`likelihood_field`, `beam`). The mean of the heaviest cluster (`clusters`) represents the
cloud. From time to time, a new generation is drawn in proportion to the weights. The cloud's spread determines the
number of its particles (`resampling`). `scan_agreement` monitors how well the map explains the scans from this mean.

Source: Thrun, Burgard, Fox, Probabilistic Robotics (2005), table 8.3, sized by KLD sampling (Fox 2003).
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from sim.common.frozen import frozen
from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import LaserMount, Scan
from sim.numerics.float_array import FloatArray
from sim.numerics.noise_arrays import NoiseStream
from sim.parameters import AmclParameters
from sim.robot.localization.beam import BeamModel
from sim.robot.localization.clusters import CloudSummary, bin_particles, summarise
from sim.robot.localization.estimate import read_only
from sim.robot.localization.free_space import FreeSpace, elsewhere
from sim.robot.localization.likelihood_field import Beams, LikelihoodField
from sim.robot.localization.motion import AS_BELIEVED, Alphas, MotionModel, NoiseScales
from sim.robot.localization.resampling import adaptive, systematic, tempered
from sim.robot.localization.scan_agreement import ScanAgreement

CANDIDATES_PER_PARTICLE = 20
"""Candidate poses for each newly drawn particle."""
MIN_CANDIDATES = 50_000
"""Minimum number of candidates.

With this number of candidates, at least one is close enough to the true pose on a map of some hundred square meters.
"""
MAX_CANDIDATES = 400_000
"""Maximum number of candidates."""
ROUGH_BEAMS = 15
"""Maximum number of beams for a first comparison of candidates.

Most candidates fit so badly that a few beams show it.
"""
ROUGH_SHARE = 0.1
"""Share of the candidates that are compared with all beams: the best candidates in the first comparison. It is 10 x
`FITTING_SHARE`."""

MOST_BESIDES = 2000
"""Maximum number of particles in a search that excludes the surroundings of a given pose.

It can be small because only the best particle matters.
"""
CANDIDATES_BESIDES = 10_000
"""Maximum number of candidates in such a search, except at the first scan of the search."""

FITTING_SHARE = 0.01
"""Minimum effective number of candidates, as a share of the number of candidates.

This applies when newcomers are drawn in proportion to a scan's likelihood.
"""
NEWCOMER_JITTER = (0.05, 0.05, 0.05)
"""Standard deviations of newcomers at the same place: meters, meters, radians."""

NEARBY = (0.5, 0.5, 0.25)
"""Standard deviations of newcomers around a pose: meters, meters, radians."""
NEARBY_SHARE = 0.2
"""Share of a generation that is drawn around the hypothesis's own pose while scans fit this pose badly."""

MOST_NEAR = 500
"""Maximum number of particles in a search around the present pose and the previous pose."""
CLEARLY_BETTER = 0.1
"""Additional share of a scan that the result of this search must explain.

Among other robots, slightly better poses are found by accident.
"""

CONVERGED_DISTANCE = 0.5
"""Beams are skipped only if all particles are within this distance of the mean along either axis, meters (pf.c)."""

EFFECTIVE_SHARE = 0.1
"""Minimum effective number of particles after every scan, as a share of the number of particles.

This applies to particles that have equal weights before the scan; see `tempered`.
"""

JITTER = (0.01, 0.01, 0.01)
"""Standard deviations of copies of a particle: meters, meters, radians. While a robot turns in place, the odometry
noise does not spread the positions of particles. Without these deviations, all would become copies of one particle.

Source: Musso, Oudjane and Le Gland, Improving regularised particle filters (2001).
"""

SURE_SHARE = 0.8
"""Share of the weight that the heaviest cluster must have so that the pose counts as certain."""

PULL = 1.2
"""Standard deviation of the pull of unmapped things if all beams end on them, as a share of `laser_sigma_hit`. Walls of
the map near these things attract the points, in the same direction for all particles."""
_PULLED = np.diag((1.0, 1.0, 1.0 / 9.0))
"""Factors of the squared pull for x, y and heading. For the heading, walls are assumed to be three meters away."""

INITIAL_AGREEMENT = ScanAgreement()
"""Agreement of a new hypothesis before its first scan."""


@frozen(eq=False)
class Hypothesis:
    """A cloud of particles that is tracked independently, and the agreement of scans and map at its pose.

    Attributes:
        particles: (n, 3) poses in the map at the last update. Read-only.
        weights: (n,) weights of the particles, with a sum of 1. Read-only.
        mean: pose of the hypothesis at the last update.
        covariance: (3, 3) covariance of this pose. Read-only.
        updates: number of scans weighed since the hypothesis was created.
        agreement: share of the scans that the map explains.
        settled: number of scans with a narrow cloud since nearly all particles agreed on one pose that fits the map.
        noise_scales: factors of the odometry noise, relative to the parameters.
        share: share of the weight in the heaviest cluster at the last update.
    """

    particles: FloatArray
    weights: FloatArray
    mean: Pose2
    covariance: FloatArray
    updates: int = 0
    agreement: ScanAgreement = INITIAL_AGREEMENT
    settled: int = 0
    noise_scales: NoiseScales = AS_BELIEVED
    share: float = 1.0


def widened(place: Hypothesis, spread: tuple[float, float, float], draws: FloatArray) -> Hypothesis:
    """Return the hypothesis with its particles moved by (3 n,) standard normals times `spread`."""
    covariance = place.covariance + np.diag([each * each for each in spread])
    particles = place.particles + draws.reshape(-1, 3) * spread
    return replace(place, particles=read_only(particles), covariance=read_only(covariance))


@dataclass(frozen=True, slots=True, eq=False)
class ScanView:
    """The part of a scan that is used.

    Attributes:
        tick: time of the scan.
        points: (m, 2) end points of the beams, base frame, see `Beams.end_points`.
        ranges: (k,) ranges of the beams, see `Beams.ranges`.
    """

    tick: int
    points: FloatArray
    ranges: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class CloudNoise:
    """Streams of random numbers for one cloud of a robot."""

    motion: NoiseStream
    resampling: NoiseStream
    jitter: NoiseStream
    places: NoiseStream

    @classmethod
    def named(cls, seed: int, *names: str) -> "CloudNoise":
        """Return the streams for a seed and a path of names."""
        motion, resampling, jitter, places = (
            NoiseStream.named(seed, *names, kind) for kind in ("motion", "resampling", "jitter", "recovery")
        )
        return cls(motion, resampling, jitter, places)


class CloudFilter:
    """Models that track hypotheses on one map with one laser.

    Args:
        parameters: parameters of amcl.
        grid: the static map.
        mount: the laser.
    """

    def __init__(self, parameters: AmclParameters, grid: OccupancyGrid, mount: LaserMount) -> None:
        self._parameters = parameters
        self._beams = Beams.of(
            mount, parameters.laser_max_beams, parameters.laser_max_range, parameters.laser_min_range
        )
        self._field = LikelihoodField.of(
            grid,
            self._beams,
            parameters.laser_z_hit,
            parameters.laser_z_rand,
            parameters.laser_sigma_hit,
            parameters.laser_likelihood_max_dist,
        )
        self._beam_model = BeamModel.of(grid, self._beams, parameters)
        alphas = Alphas(
            parameters.odom_alpha1,
            parameters.odom_alpha2,
            parameters.odom_alpha3,
            parameters.odom_alpha4,
            parameters.odom_alpha5,
        )
        self._motion = MotionModel(parameters.odom_model_type, alphas)
        self._free_space = FreeSpace(grid)
        # A wall may be anywhere in its cell. All particles have this error in common, so their spread does not show it.
        self._unknowable = np.diag((1.0, 1.0, 0.0)) * (grid.resolution * grid.resolution) / 12.0

    def view(self, scan: Scan, tick: int) -> ScanView:
        """Return the part of a scan that is used.

        Raises:
            ValueError: the scan and the filter's laser have different numbers of beams.
        """
        if len(scan.ranges) != self._beams.mount.beams:
            raise ValueError(f"a scan has {len(scan.ranges)} beams, but the laser has {self._beams.mount.beams}")
        return ScanView(tick, self._beams.end_points(scan), self._beams.ranges(scan))

    def looked_for(self, view: ScanView, noise: CloudNoise, besides: Pose2 | None = None) -> Hypothesis:
        """Return a hypothesis with the maximum number of particles, at poses on the whole map that fit a scan.

        A uniform cloud of this size would have no particle near the truth. So the particles are drawn from a sample of
        poses that is many times larger, in proportion to the scan's likelihood.
        """
        count = self._parameters.max_particles
        count = count if besides is None else min(count, MOST_BESIDES)
        particles = self._anywhere(count, view, noise, besides)
        return self._weighed(None, particles, np.full(len(particles), 1.0 / len(particles)), view, True)

    def followed(
        self, before: Hypothesis, left: Pose2, reached: Pose2, view: ScanView, noise: CloudNoise,
        searching: float = 0.0, besides: Pose2 | None = None,
    ) -> Hypothesis:  # fmt: skip
        """Return a hypothesis after a motion and a scan, resampled if this is due.

        Args:
            before: the hypothesis at the last update.
            left: odometry pose at that time.
            reached: present odometry pose.
            view: the scan.
            noise: random numbers of this cloud.
            searching: share of the next generation that is drawn from the whole map.
            besides: pose in the map. Poses near it are excluded from the search.
        """
        parameters = self._parameters
        draws = noise.motion.normals(view.tick, 3 * len(before.particles))
        particles = self._motion.move(before.particles, left, reached, draws, before.noise_scales)
        weights = before.weights * tempered(self._log_likelihood(particles, view), EFFECTIVE_SHARE)
        total = weights.sum()
        weights = weights / total if total > 0.0 else before.weights
        now = self._weighed(before, particles, weights, view, searching > 0.0)
        rate = parameters.odom_noise_learning_rate
        if rate > 0.0 and searching == 0.0 and len(view.points):
            usual = before.agreement.is_usual
            misled = parameters.recovers and usual(before.agreement.last) and not usual(now.agreement.last)
            if misled and (found := self._found_near(before, now, view, noise)) is not None:
                return found
            scales = self._motion.learned(before.noise_scales, rate, draws, before.weights, weights)
            now = replace(now, noise_scales=scales)
        # With selective resampling, a cloud is kept if its effective number (1 / sum of squared weights) is above half
        # of its number of particles. Resampling would then only lose hypotheses (Grisetti, Stachniss, Burgard 2007).
        due = now.updates % parameters.resample_interval == 0 and not (
            parameters.selective_resampling and searching == 0.0 and 2.0 / (weights * weights).sum() > len(weights)
        )
        return self._drawn(now, view, noise, searching, besides) if due else now

    def _found_near(self, before: Hypothesis, now: Hypothesis, view: ScanView, noise: CloudNoise) -> Hypothesis | None:
        """Search for poses that fit the scan, half of them around the last pose and half around the pose by odometry.

        The last scan was explained as well as usual, but this scan is not. So the odometry between them may be wrong:
        it was reset, or its error exceeds the spread of the particles. Return None if no pose explains the scan clearly
        better than the present pose and as well as usual. In this case the scan itself may be misleading, or the robot
        was kidnapped.

        The factors of the odometry noise do not change. If they grew with every such scan, the cloud would soon be too
        wide for scans that are a meter apart.
        """
        count = min(self._parameters.max_particles, MOST_NEAR)
        candidates = noise.places.normals(view.tick, 3 * count * CANDIDATES_PER_PARTICLE).reshape(-1, 3) * NEARBY
        candidates[::2] += before.mean.array()
        candidates[1::2] += now.mean.array()
        particles = self._fitting(count, candidates, FITTING_SHARE, view, noise)
        found = self._weighed(before, particles, np.full(count, 1.0 / count), view, False)
        better = found.agreement.last - now.agreement.last
        if better < CLEARLY_BETTER or not before.agreement.is_usual(found.agreement.last):
            return None
        return replace(found, noise_scales=before.noise_scales)

    def _weighed(
        self, before: Hypothesis | None, particles: FloatArray, weights: FloatArray, view: ScanView, searching: bool
    ) -> Hypothesis:
        parameters = self._parameters
        summary = summarise(particles, weights, bin_particles(particles))
        agreement = before.agreement if before else INITIAL_AGREEMENT
        found = self._beam_model.agreement(summary.mean, view.ranges)
        if found is not None and searching:
            agreement = agreement.searching(found.share)
        elif found is not None:
            agreement = agreement.after(found.share, parameters.recovery_alpha_slow, parameters.recovery_alpha_fast)
        pull = PULL * parameters.laser_sigma_hit * (found.cut_short if found is not None else 0.0)
        # A wide cloud is no reason to doubt the pose. So the scan is not counted, but the count is not reset either.
        agreed = summary.weight >= SURE_SHARE and agreement.explained
        settled = (before.settled if before else 0) + self._narrow(summary) if agreed else 0
        return Hypothesis(
            particles=read_only(particles),
            weights=read_only(weights),
            mean=summary.mean,
            covariance=read_only(summary.covariance + self._unknowable + pull * pull * _PULLED),
            updates=before.updates + 1 if before else 1,
            agreement=agreement,
            settled=settled,
            share=summary.weight,
        )

    def _narrow(self, summary: CloudSummary) -> bool:
        """Return True if the heaviest cluster is as narrow as the parameters require."""
        parameters = self._parameters
        levels = (parameters.std_warn_level_x, parameters.std_warn_level_y, parameters.std_warn_level_yaw)
        return bool((np.sqrt(summary.variances) <= levels).all())

    def _log_likelihood(self, particles: FloatArray, view: ScanView) -> FloatArray:
        """Return (n,) log likelihoods of a scan at the particles, from the model in the parameters."""
        parameters = self._parameters
        if parameters.laser_model_type == "beam":
            return self._beam_model.log_likelihood(particles, view.ranges)
        points = view.points
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

    def _drawn(
        self, now: Hypothesis, view: ScanView, noise: CloudNoise, searching: float, besides: Pose2 | None
    ) -> Hypothesis:
        """Draw the next generation: copies of present particles, and newcomers if scans fit badly."""
        parameters = self._parameters
        heirs_offset, newcomers_offset = noise.resampling.uniforms(view.tick, 2)
        if searching and len(view.points):
            # Newcomers fill many bins, so KLD sampling would require the maximum number of particles anyway.
            size = min(len(now.particles), parameters.max_particles)
            count = int(searching * size + newcomers_offset)
            heirs = systematic(now.weights, size - count, heirs_offset)
            most = MAX_CANDIDATES if besides is None else CANDIDATES_BESIDES
            newcomers = self._anywhere(count, view, noise, besides, most)
        else:
            heirs = adaptive(
                now.weights,
                bin_particles(now.particles).of_particle,
                heirs_offset,
                parameters.kld_err,
                parameters.kld_z,
                parameters.min_particles,
                parameters.max_particles,
            )
            nearby = parameters.recovers and now.agreement.drifting and len(view.points)
            count = int(NEARBY_SHARE * len(heirs) + newcomers_offset) if nearby else 0
            newcomers = self._nearby(now.mean, count, view, noise)
            # Copies are in the order of their originals, which is random. So omitting the first copies omits a random
            # sample.
            heirs = heirs[count:]
        particles = np.concatenate((self._jittered(now.particles[heirs], view.tick, noise), newcomers))
        weights = read_only(np.full(len(particles), 1.0 / len(particles)))
        return replace(now, particles=read_only(particles), weights=weights)

    def _jittered(
        self, particles: FloatArray, tick: int, noise: CloudNoise, spread: tuple[float, float, float] = JITTER
    ) -> FloatArray:
        """Return the (n, 3) particles with small random errors, so that no two particles are equal."""
        return particles + noise.jitter.normals(tick, 3 * len(particles)).reshape(-1, 3) * spread

    def _anywhere(
        self, count: int, view: ScanView, noise: CloudNoise, besides: Pose2 | None, most: int = MAX_CANDIDATES
    ) -> FloatArray:
        """Return (count, 3) poses from the whole map, drawn in proportion to the scan's (tempered) likelihood there.

        Source: Lenser and Veloso, Sensor resetting localization for poorly modelled mobile robots (2000). Difference:
            amcl draws poses without regard to the scan. Such poses are hardly ever close enough to the truth to
            survive.
        """
        places = min(max(MIN_CANDIDATES, count * CANDIDATES_PER_PARTICLE), most)
        candidates = self._free_space.draw(places, noise.places, view.tick)
        if besides is not None:
            candidates = candidates[elsewhere(candidates, besides.x, besides.y, besides.theta)]
        step = math.ceil(len(view.points) / ROUGH_BEAMS)
        if step == 1:
            return self._fitting(count, candidates, FITTING_SHARE, view, noise)
        rough = self._field.log_likelihood(candidates, np.ascontiguousarray(view.points[::step]))
        last = int((1.0 - ROUGH_SHARE) * len(rough))
        likely = candidates[rough >= np.partition(rough, last)[last]]
        return self._fitting(count, likely, FITTING_SHARE * len(rough) / len(likely), view, noise)

    def _nearby(self, place: Pose2, count: int, view: ScanView, noise: CloudNoise) -> FloatArray:
        """Return (count, 3) poses around a pose, drawn in proportion to the scan's (tempered) likelihood there.

        If the wheels have an error of a fifth, or the map an error of some decimeters, a cloud moves away from the
        truth step by step. Copies of its particles do not return to the truth.
        """
        if count == 0:
            return np.empty((0, 3))
        draws = noise.places.normals(view.tick, 3 * count * CANDIDATES_PER_PARTICLE)
        return self._fitting(count, place.array() + draws.reshape(-1, 3) * NEARBY, FITTING_SHARE, view, noise)

    def _fitting(
        self, count: int, candidates: FloatArray, share: float, view: ScanView, noise: CloudNoise
    ) -> FloatArray:
        """Draw (count, 3) of the candidates in proportion to their likelihoods.

        The likelihoods are tempered so that this share of the candidates stays effective.
        """
        fit = self._field.log_likelihood(candidates, view.points)
        offset = noise.resampling.uniforms(view.tick, 3)[2]
        chosen: FloatArray = candidates[systematic(tempered(fit, share), count, offset)]
        return self._jittered(chosen, view.tick + 1, noise, NEWCOMER_JITTER)
