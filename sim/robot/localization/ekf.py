"""An extended Kalman filter over (x, y, theta): wheels and gyroscope, corrected by scans matched to the map.

Source: Thrun, Burgard, Fox, Probabilistic Robotics (2005), table 7.2, with odometry for control (section 5.4) and a
matched pose for measurement.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import TICK, Imu, LaserMount, Odometry, Scan
from sim.numerics import elementary
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray
from sim.numerics.matrices import inverse, product, solution
from sim.parameters import EkfParameters, RobotParameters
from sim.robot.localization.estimate import Estimate, PosePrior, read_only
from sim.robot.localization.likelihood_field import Beams
from sim.robot.localization.scan_matching import GOOD, SPACING, ScanMatch, ScanMatcher

PREDICTION_INTERVAL = 5
"""Ticks between predictions where no scan asks for one; in between, odometry alone carries the estimate on."""

GATE = 16.27
"""Greatest squared Mahalanobis distance of a match that is believed: chi-square with 3 degrees of freedom, 0.999."""

_LEAST_INFORMATION = np.diag((1.0, 1.0, 4.0))
"""Keeps a match's covariance finite where a corridor leaves a direction open: one metre, half a radian."""

_LEAST_SHARE = 0.4
"""Share of a scan's points that must lie on the map's walls; a scan from elsewhere hardly ever reaches it."""

_LEARNING = 0.2
"""Rate at which innovations that are greater or smaller than they should be change the motion's believed noise."""

_MIN_NOISE_SCALE, _MAX_NOISE_SCALE = 0.2, 100.0
"""Least and greatest factor by which the motion's noise may turn out to differ from what the parameters say. The least
is that of wheels whose errors in each of the ticks between two predictions are independent."""

_MEMORY = 0.95
"""Weight of what older scans told of walls that are not where the map has them, for each scan since."""

_DOUBTING = 1.5
"""Factor on the covariance after a match that fits, but is too far off to be believed: either may be wrong."""

_LOST_AFTER = 20
"""Scans refused one after another until the filter holds itself for lost: two seconds of a common laser."""

_LEVER = 3.0
"""Metres: distance of a typical wall, by which an uncertain heading is converted to an uncertain place."""


@dataclass(frozen=True, slots=True, eq=False)
class GaussianBelief:
    """A Gaussian over poses, as of the last prediction.

    Attributes:
        tick: that of the prediction.
        base_in_map: the mean.
        covariance: (3, 3) about it, but for `shared`; read-only.
        shared: (3, 3) of the error that all matches near by have in common, which no number of them averages out;
            read-only.
        base_in_odom: the odometry then.
        odom_in_map: the correction that makes the two poses agree.
        matched: the odometry when a scan was last weighed in; None before the first.
        motion_noise_scales: factors by which the variances of distances and of turns have turned out to be more than
            the parameters say.
        walls_off: sums over scans of what `ScanMatch.walls_off` says; the older a scan, the less it counts.
        refused: scans that could not be believed since the last one that was.
        poor: scans in a row that fitted badly, believed or not.
    """

    tick: int
    base_in_map: Pose2
    covariance: FloatArray
    shared: FloatArray
    base_in_odom: Pose2
    odom_in_map: Pose2
    matched: Pose2 | None
    motion_noise_scales: tuple[float, float]
    walls_off: tuple[float, float]
    refused: int
    poor: int

    @property
    def lost(self) -> bool:
        """True when scans have not fitted for so long that the pose cannot be relied on."""
        return self.refused >= _LOST_AFTER


def _anywhere(grid: OccupancyGrid) -> FloatArray:
    """(3, 3) covariance of a pose that may be anywhere on the map: uniform over its extent and all headings."""
    rows, cols = grid.cells.shape
    spread = (rows * rows + cols * cols) * (grid.resolution * grid.resolution) / 12.0
    return np.diag((spread, spread, math.pi * math.pi / 3.0))


_NOTHING = read_only(np.zeros((3, 3)))


def _covariance(match: ScanMatch) -> FloatArray:
    """(3, 3) covariance of a match; read-only."""
    covariance = inverse(match.information + _LEAST_INFORMATION)
    return read_only(covariance)


def carried(covariance: FloatArray, jacobian: FloatArray) -> FloatArray:
    """(n, n) covariance of what an (n, m) Jacobian makes of an (m, m) one; exactly symmetric."""
    whole = product(product(jacobian, covariance), np.ascontiguousarray(jacobian.T))
    return (whole + whole.T) / 2.0


def corrected(covariance: FloatArray, noise: FloatArray, innovation: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return (3,) what an innovation changes of the mean, and the (3, 3) covariance afterwards.

    The measurement is the state itself, with noise of a (3, 3) covariance.

    Source: Bucy and Joseph, Filtering for stochastic processes with applications to guidance (1968), for the form of
        the covariance, which stays symmetric and positive whatever is rounded.
    """
    # Both matrices are symmetric, so the transposed gain is the solution of a system.
    gain = np.ascontiguousarray(solution(covariance + noise, covariance).T)
    change = product(gain, innovation[:, np.newaxis])[:, 0]
    return change, carried(covariance, np.eye(3) - gain) + carried(noise, gain)


def _residual(measured: FloatArray, predicted: FloatArray) -> FloatArray:
    difference: FloatArray = measured - predicted
    difference[2] = wrap_angle(difference[2])
    return difference


def _surprise(innovation: FloatArray, expected: FloatArray) -> float:
    """Squared Mahalanobis distance of an innovation, or of some of its elements, by their covariance."""
    return float((innovation * solution(expected, innovation[:, np.newaxis])[:, 0]).sum())


def _learnt(scales: tuple[float, float], innovation: FloatArray, expected: FloatArray) -> tuple[float, float]:
    """The factors on the variances of distances and turns, after one more innovation and its (3, 3) covariance."""
    drive = _surprise(innovation[:2], np.ascontiguousarray(expected[:2, :2])) / 2.0
    turn = innovation[2] * innovation[2] / expected[2, 2]
    lessons = (elementary.exp(_LEARNING * (min(each, GATE / 3.0) - 1.0)) for each in (drive, turn))
    for_drive, for_turn = (
        min(max(scale * lesson, _MIN_NOISE_SCALE), _MAX_NOISE_SCALE)
        for scale, lesson in zip(scales, lessons, strict=True)
    )
    return for_drive, for_turn


class Ekf:
    """One Gaussian hypothesis, cheap and smooth. See `Localizer`.

    Where scans do not fit for some seconds it holds itself for lost, and looks for the one place where they do: near by
    first, then all over the map; it looks as well where they fit badly for long, since another place may fit better. It
    reports itself found only when a scan from another spot agrees. On a map that looks the same from two places it
    stays lost, since one Gaussian cannot hold two hypotheses as particles do.

    Before the first `start` it believes to be at the map's origin.
    """

    def __init__(self, parameters: EkfParameters, grid: OccupancyGrid, mount: LaserMount) -> None:
        """A filter for one robot, on its static map, for the laser whose scans `update` will bring."""
        self._mount = mount
        self._use(parameters)
        self._matcher = ScanMatcher.of(grid, mount.laser_in_base)
        variances = (parameters.initial_cov_xx, parameters.initial_cov_yy, parameters.initial_cov_aa)
        self._belief: PosePrior | GaussianBelief = PosePrior(Pose2(0.0, 0.0, 0.0), read_only(np.diag(variances)))
        self._turned = 0.0  # radians that the gyroscope has counted since the last prediction
        self._requested = False
        self._forgotten = False  # told to forget where it is, and has neither found nor been told it since
        self._anywhere = read_only(_anywhere(grid))
        self._particles = np.empty((0, 3))

    def _use(self, parameters: EkfParameters) -> None:
        self._parameters = parameters
        self._beams = Beams.of(self._mount, parameters.laser_max_beams, parameters.laser_max_range)

    def start(self, base_in_map: Pose2, covariance: FloatArray) -> None:
        """Begin anew around this pose, at the next tick; the first scan from then on is weighed at once."""
        self._belief, self._turned = PosePrior(base_in_map, read_only(covariance.copy())), 0.0
        self._forgotten = False

    def globalize(self) -> None:
        """Forget where the robot was: lost, with a covariance as wide as the map, until it is found or told a pose."""
        self._forgotten = True

    def request_update(self) -> None:
        """Match the next scan even if the robot has not moved."""
        self._requested = True

    def configure(self, parameters: RobotParameters) -> None:
        """Go on with these parameters, believing what it believed."""
        if parameters.ekf != self._parameters:
            self._use(parameters.ekf)

    @property
    def awaits_scan(self) -> bool:
        """False: the gyroscope counts in every tick."""
        return False

    def update(self, odometry: Odometry, imu: Imu, scan: Scan | None) -> Estimate:
        """Take in one tick; a scan is matched when the robot has moved enough since the last one that was."""
        belief = self._belief
        if isinstance(belief, PosePrior):
            odom_in_map = belief.base_in_map.compose(odometry.base_in_odom.inverse())
            belief = GaussianBelief(
                tick=odometry.tick,
                base_in_map=belief.base_in_map,
                covariance=belief.covariance,
                shared=_NOTHING,
                base_in_odom=odometry.base_in_odom,
                odom_in_map=odom_in_map,
                matched=None,
                motion_noise_scales=(1.0, 1.0),
                walls_off=(0.0, 0.0),
                refused=0,
                poor=0,
            )
        else:
            self._turned += imu.angular_velocity * TICK
            if scan is not None or odometry.tick - belief.tick >= PREDICTION_INTERVAL:
                belief = self._predict(belief, odometry)
                self._turned = 0.0
        updated = False
        if scan is not None and self._parameters.vo_used and (self._forgotten or self._requested or self._due(belief)):
            self._requested = False
            if not self._forgotten:
                belief, updated = self._correct(belief, scan)
            if self._forgotten or (belief.lost and belief.refused % _LOST_AFTER == 0) or belief.poor >= _LOST_AFTER:
                belief = self._search(belief, scan)
        self._belief = belief
        return Estimate(
            tick=odometry.tick,
            base_in_map=belief.odom_in_map.compose(odometry.base_in_odom),
            odom_in_map=belief.odom_in_map,
            covariance=self._anywhere if self._forgotten else read_only(belief.covariance + belief.shared),
            particles=self._particles,
            updated=updated,
            lost=self._forgotten or belief.lost,
        )

    def _due(self, belief: GaussianBelief) -> bool:
        """Return True when the robot moved enough since the last match, by amcl's rule."""
        if belief.matched is None:
            return True
        here, there, limit = belief.base_in_odom, belief.matched, self._parameters.update_min_d
        return (
            abs(here.x - there.x) > limit
            or abs(here.y - there.y) > limit
            or abs(wrap_angle(here.theta - there.theta)) > self._parameters.update_min_a
        )

    def _predict(self, belief: GaussianBelief, odometry: Odometry) -> GaussianBelief:
        """Carry mean and covariance on by wheels and gyroscope, over the ticks since the last prediction."""
        parameters = self._parameters
        moved = belief.base_in_odom.between(odometry.base_in_odom)
        distance = elementary.hypot(moved.x, moved.y)
        turn, drive = moved.theta * moved.theta, distance * distance
        wheels_variance = parameters.odom_alpha1 * turn + parameters.odom_alpha2 * drive
        gyro_noise = parameters.gyro_noise * TICK
        gyro_variance = (odometry.tick - belief.tick) * (gyro_noise * gyro_noise)
        # Wheels that stand still are certain of it; then the gyroscope, which is only noise, does not count.
        listening = parameters.imu_used and wheels_variance > 0.0
        trust = wheels_variance / (wheels_variance + gyro_variance) if listening else 0.0
        correction = trust * wrap_angle(self._turned - moved.theta)
        turn_variance = (1.0 - trust) * wheels_variance
        drive_variance = parameters.odom_alpha3 * drive + parameters.odom_alpha4 * turn

        here = belief.base_in_map
        # The chord of an arc points half of the turn aside; so does a correction of the turn.
        c, s = elementary.cos_sin(here.theta + correction / 2.0)
        dx, dy = c * moved.x - s * moved.y, s * moved.x + c * moved.y
        bearing = elementary.atan2(dy, dx)
        ahead, left = elementary.cos_sin(bearing)
        to_noise = np.array(((ahead, -dy / 2.0), (left, dx / 2.0), (0.0, 1.0)))
        motion = np.array(((1.0, 0.0, -dy), (0.0, 1.0, dx), (0.0, 0.0, 1.0)))
        for_drive, for_turn = belief.motion_noise_scales
        covariance = carried(belief.covariance, motion) + carried(
            np.diag((for_drive * drive_variance, for_turn * turn_variance)), to_noise
        )
        mean = Pose2(here.x + dx, here.y + dy, wrap_angle(here.theta + moved.theta + correction))
        return replace(
            belief,
            tick=odometry.tick,
            base_in_map=mean,
            covariance=read_only(covariance),
            base_in_odom=odometry.base_in_odom,
            odom_in_map=mean.compose(odometry.base_in_odom.inverse()),
        )

    def _correct(self, belief: GaussianBelief, scan: Scan) -> tuple[GaussianBelief, bool]:
        """Weigh in the pose at which the scan matches the map, if it can be believed; and return whether it could.

        Innovations that are greater than they should be raise `motion_noise_scales`, factors on the motion's variances;
        smaller ones lower them. A match too far off is not believed. But each such match that fits widens the
        covariance, so that after several alike the next one is believed.

        Source: Mehra, On the identification of variances and adaptive Kalman filtering (1970), for learning the
            motion's noise from innovations; here as a running mean of its logarithm, which cannot become negative.
        """
        points = self._beams.end_points(scan)
        doubt = belief.covariance + belief.shared
        error = 2.0 * math.sqrt(max(doubt[0, 0], doubt[1, 1]) + _LEVER * _LEVER * doubt[2, 2])
        match = self._matcher.match(belief.base_in_map, points, error)
        if match is None:
            return belief, False
        belief = replace(belief, poor=belief.poor + 1 if match.share < GOOD else 0)
        if match.share < _LEAST_SHARE:
            return replace(belief, refused=belief.refused + 1), False
        squares, degrees = (_MEMORY * old + new for old, new in zip(belief.walls_off, match.walls_off, strict=True))
        common = max(0.0, squares / degrees) * match.by_walls if degrees > 0.0 else np.zeros((3, 3))
        own = _covariance(match)
        noise = own + common
        measured = match.base_in_map.array()
        innovation = _residual(measured, belief.base_in_map.array())
        expected = belief.covariance + noise
        surprise = _surprise(innovation, expected)
        scales = _learnt(belief.motion_noise_scales, innovation, expected)
        if surprise > GATE:
            doubting = read_only(_DOUBTING * belief.covariance)
            return replace(belief, covariance=doubting, motion_noise_scales=scales, refused=belief.refused + 1), False
        correction, covariance = corrected(belief.covariance, noise, innovation)
        dx, dy, turn = correction.tolist()
        here = belief.base_in_map
        mean = Pose2(here.x + dx, here.y + dy, wrap_angle(here.theta + turn))
        return (
            replace(
                belief,
                base_in_map=mean,
                covariance=read_only(covariance),
                shared=read_only(common + (1.0 - match.share) * own),
                odom_in_map=mean.compose(belief.base_in_odom.inverse()),
                matched=belief.base_in_odom,
                motion_noise_scales=scales,
                walls_off=(squares, degrees),
                refused=0,
            ),
            True,
        )

    def _search(self, belief: GaussianBelief, scan: Scan) -> GaussianBelief:
        """Begin anew where the scan fits, if that is one place only; lost, until the next match agrees."""
        near = None if self._forgotten else belief.base_in_map
        found = self._matcher.search(self._beams.end_points(scan), near)
        belief = replace(belief, poor=0)
        if found is None:
            return belief
        if near is not None and not belief.lost and near.distance(found.base_in_map) < SPACING:
            return belief
        self._forgotten = False
        return replace(
            belief,
            base_in_map=found.base_in_map,
            covariance=_covariance(found),
            odom_in_map=found.base_in_map.compose(belief.base_in_odom.inverse()),
            matched=belief.base_in_odom,
            motion_noise_scales=(1.0, 1.0),
            refused=_LOST_AFTER,
        )
