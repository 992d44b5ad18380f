"""A Kalman filter over (x, y, theta): wheels and gyroscope, corrected by scans matched to the map.

`sim.robot.localization.pose_filters` contains the Gaussian, its prediction and its update. This module computes their
input.

Source: Thrun, Burgard, Fox, Probabilistic Robotics (2005), table 7.2, with odometry as control input (section 5.4) and
a matched pose as measurement.
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
from sim.numerics.matrices import inverse, solution
from sim.parameters import RobotParameters
from sim.robot.localization.estimate import Estimate, read_only
from sim.robot.localization.likelihood_field import Beams
from sim.robot.localization.pose_filters import ExtendedPoseFilter, MeasuredMotion, UnscentedPoseFilter, residual
from sim.robot.localization.scan_matching import GOOD, SPACING, ScanMatch, ScanMatcher
from sim.robot.localization.wrong_pose import GaussianEvidence, probability
from sim.robot.localization.wrong_pose_coefficients import GAUSSIANS

PREDICTION_INTERVAL = 5
"""Ticks between predictions that no scan requires. Between them, odometry alone propagates the estimate."""

GATE = 16.27
"""Maximum squared Mahalanobis distance of an accepted match: the 0.999 quantile of chi-square, 3 degrees of freedom."""

_LEAST_INFORMATION = np.diag((1.0, 1.0, 4.0))
"""Information that is added to each match, as for standard deviations of 1 m and 0.5 rad. It keeps the covariance
finite if a corridor does not determine a direction."""

_LEAST_SHARE = 0.4
"""Share of a scan's points that must be on the map's walls. At a wrong pose, a scan hardly ever reaches this share."""

_LEARNING = 0.2
"""Rate at which unexpectedly large or small innovations change the assumed noise of the motion."""

_MIN_NOISE_SCALE, _MAX_NOISE_SCALE = 0.2, 100.0
"""Minimum and maximum factor by which the motion's variances differ from the parameters. The minimum applies if the
wheels' errors in the ticks between two predictions are independent."""

_MEMORY = 0.95
"""Factor by which each new scan reduces the weight of older scans in the estimate of misplaced walls."""

_DOUBTING = 1.5
"""Factor of the covariance after a match that fits, but is too far away to be accepted: pose or match may be wrong."""

_LOST_AFTER = 20
"""Number of consecutive rejected scans until the robot is lost. For a common laser, this takes two seconds."""

_LEVER = 3.0
"""Distance of a typical wall, meters. It converts the uncertainty of the heading to an uncertainty of position."""

_NO_COVARIANCE = read_only(np.zeros((3, 3)))


@dataclass(frozen=True, slots=True, eq=False)
class TrackingState:
    """State of tracking at the last prediction, in addition to the Gaussian.

    Attributes:
        tick: tick of the prediction.
        base_in_odom: odometry pose at that time.
        shared: (3, 3) covariance of the error that all matches nearby have in common. It does not decrease with more
            matches. Read-only.
        matched: odometry pose at the last accepted scan. None before the first.
        motion_noise_scales: factors of the variances of distances and of turns, relative to the parameters.
        walls_off: weighted sums over scans of `ScanMatch.walls_off`. Older scans have less weight.
        refused: number of rejected scans since the last accepted scan.
        poor: number of consecutive scans that fit badly, accepted or not.
        unmatched: share of the points of the last scan that are not on walls.
        matches: number of accepted matches since the pose was set or found.
    """

    tick: int
    base_in_odom: Pose2
    shared: FloatArray
    matched: Pose2 | None = None
    motion_noise_scales: tuple[float, float] = (1.0, 1.0)
    walls_off: tuple[float, float] = (0.0, 0.0)
    refused: int = 0
    poor: int = 0
    unmatched: float = 1.0
    matches: int = 0

    @property
    def lost(self) -> bool:
        """True if the pose is not reliable because scans have not fitted for a long time."""
        return self.refused >= _LOST_AFTER


def _anywhere(grid: OccupancyGrid) -> FloatArray:
    """Return the (3, 3) covariance of a pose anywhere on the map: uniform over the map's extent and all headings."""
    rows, cols = grid.cells.shape
    spread = (rows * rows + cols * cols) * (grid.resolution * grid.resolution) / 12.0
    return np.diag((spread, spread, math.pi * math.pi / 3.0))


def _covariance(match: ScanMatch) -> FloatArray:
    """Return the (3, 3) covariance of a match."""
    return inverse(match.information + _LEAST_INFORMATION)


def _surprise(innovation: FloatArray, expected: FloatArray) -> float:
    """Return the squared Mahalanobis distance of (some elements of) an innovation with this expected covariance."""
    return float((innovation * solution(expected, innovation[:, np.newaxis])[:, 0]).sum())


def _learnt(scales: tuple[float, float], innovation: FloatArray, expected: FloatArray) -> tuple[float, float]:
    """Return updated factors of the variances of distances and turns after an innovation with a (3, 3) covariance."""
    drive = _surprise(innovation[:2], np.ascontiguousarray(expected[:2, :2])) / 2.0
    turn = innovation[2] * innovation[2] / expected[2, 2]
    # The minimum limits the effect of a single outlier. The exponential keeps factors positive.
    lessons = (elementary.exp(_LEARNING * (min(each, GATE / 3.0) - 1.0)) for each in (drive, turn))
    for_drive, for_turn = (
        min(max(scale * lesson, _MIN_NOISE_SCALE), _MAX_NOISE_SCALE)
        for scale, lesson in zip(scales, lessons, strict=True)
    )
    return for_drive, for_turn


class KalmanLocalizer:
    """A fast localizer that represents the pose by a single Gaussian and reports smooth estimates. See `Localizer`.

    If scans do not fit for some seconds, the robot is lost. The localizer then searches for the only pose where they
    fit, first nearby, then on the whole map. It also searches if scans fit badly for a long time, because another pose
    may fit better. The robot is found only when a scan from another place confirms the pose. On a map that looks the
    same from two places, the robot stays lost, because a single Gaussian cannot represent two hypotheses.

    Before the first `start`, it assumes that the robot is at the map's origin.

    Attributes:
        looked: evidence after the last examined scan. None before the first examined scan.
    """

    def __init__(self, software: RobotParameters, grid: OccupancyGrid, mount: LaserMount) -> None:
        """Create a filter for one robot, with its static map and the laser that makes the scans for `update`."""
        self._mount = mount
        self.configure(software)
        self._matcher = ScanMatcher.of(grid, mount.laser_in_base)
        is_unscented = software.localization == "ukf"
        self._filter = UnscentedPoseFilter(software.ukf) if is_unscented else ExtendedPoseFilter()
        variances = (software.ekf.initial_cov_xx, software.ekf.initial_cov_yy, software.ekf.initial_cov_aa)
        self.start(Pose2(0.0, 0.0, 0.0), np.diag(variances))
        self._requested = False
        self._anywhere = read_only(_anywhere(grid))
        self._particles = np.empty((0, 3))

    def start(self, base_in_map: Pose2, covariance: FloatArray) -> None:
        """Restart around this pose at the next tick. The first scan after the restart is used immediately."""
        self._filter.reset(base_in_map, covariance)
        self._state: TrackingState | None = None
        self._odom_in_map = base_in_map  # until the first odometry
        self._turned = 0.0  # rotation by the gyroscope since the last prediction, radians
        self._forgotten = False  # True from `globalize` until the pose is found or set
        self.looked: GaussianEvidence | None = None
        self._p_wrong: float | None = None

    def globalize(self) -> None:
        """Forget the pose: the robot is lost, with a covariance as wide as the map, until its pose is found or set."""
        self._forgotten = True

    def widen(self, distance: float, turn: float) -> None:
        """Increase the uncertainty. See `Localizer`."""
        more = np.diag((distance * distance, distance * distance, turn * turn))
        self._filter.reset(self._filter.mean, self._filter.covariance + more)

    def request_update(self) -> None:
        """Match the next scan even if the robot has not moved."""
        self._requested = True

    def configure(self, parameters: RobotParameters) -> None:
        """Continue with these parameters and the present belief."""
        self._parameters = parameters.ekf
        self._beams = Beams.of(self._mount, parameters.ekf.laser_max_beams, parameters.ekf.laser_max_range)

    @property
    def awaits_scan(self) -> bool:
        """False, because the gyroscope is used in every tick."""
        return False

    def ignores_scans(self, odometry: Odometry) -> bool:
        """Return False; see `awaits_scan`."""
        return False

    def update(self, odometry: Odometry, imu: Imu, scan: Scan | None) -> Estimate:
        """Process one tick. A scan is matched if the robot has moved enough since the last match."""
        state = self._state
        if state is None:
            state = TrackingState(odometry.tick, odometry.base_in_odom, _NO_COVARIANCE)
        else:
            self._turned += imu.angular_velocity * TICK
            if scan is not None or odometry.tick - state.tick >= PREDICTION_INTERVAL:
                self._predict(state, odometry)
                state = replace(state, tick=odometry.tick, base_in_odom=odometry.base_in_odom)
        updated = False
        if scan is not None and self._parameters.vo_used and (self._forgotten or self._requested or self._due(state)):
            self._requested = False
            if not self._forgotten:
                state, updated = self._correct(state, scan)
            if self._forgotten or (state.lost and state.refused % _LOST_AFTER == 0) or state.poor >= _LOST_AFTER:
                state = self._search(state, scan)
            self.looked = self._evidence(state)
            self._p_wrong = probability(GAUSSIANS, self.looked)
        if state is not self._state:
            self._odom_in_map = self._filter.mean.compose(odometry.base_in_odom.inverse())
            self._state = state
        return Estimate(
            tick=odometry.tick,
            base_in_map=self._odom_in_map.compose(odometry.base_in_odom),
            odom_in_map=self._odom_in_map,
            covariance=self._anywhere if self._forgotten else read_only(self._filter.covariance + state.shared),
            particles=self._particles,
            updated=updated,
            lost=self._forgotten or state.lost,
            p_wrong=self._p_wrong,
        )

    def _evidence(self, state: TrackingState) -> GaussianEvidence:
        """After a scan, collect the features that distinguish right poses from wrong poses."""
        return GaussianEvidence.of(
            self._filter.covariance + state.shared,
            state.motion_noise_scales,
            forgotten=self._forgotten,
            lost=state.lost,
            refused=state.refused / _LOST_AFTER,
            poor=state.poor / _LOST_AFTER,
            unmatched=state.unmatched,
            matches=state.matches,
        )

    def _due(self, state: TrackingState) -> bool:
        """Return True if the robot has moved enough since the last match, by amcl's rule."""
        if state.matched is None:
            return True
        here, there, limit = state.base_in_odom, state.matched, self._parameters.update_min_d
        return (
            abs(here.x - there.x) > limit
            or abs(here.y - there.y) > limit
            or abs(wrap_angle(here.theta - there.theta)) > self._parameters.update_min_a
        )

    def _predict(self, state: TrackingState, odometry: Odometry) -> None:
        """Move the Gaussian by wheels and gyroscope, over the ticks since the last prediction."""
        parameters = self._parameters
        moved = state.base_in_odom.between(odometry.base_in_odom)
        distance = elementary.hypot(moved.x, moved.y)
        turn, drive = moved.theta * moved.theta, distance * distance
        wheels_variance = parameters.odom_alpha1 * turn + parameters.odom_alpha2 * drive
        gyro_noise = parameters.gyro_noise * TICK
        gyro_variance = (odometry.tick - state.tick) * (gyro_noise * gyro_noise)
        # Wheels that stand still have no error. In this case the gyroscope is ignored, because it would only add noise.
        listening = parameters.imu_used and wheels_variance > 0.0
        trust = wheels_variance / (wheels_variance + gyro_variance) if listening else 0.0
        correction = trust * wrap_angle(self._turned - moved.theta)
        turn_variance = (1.0 - trust) * wheels_variance
        drive_variance = parameters.odom_alpha3 * drive + parameters.odom_alpha4 * turn

        # The chord of an arc deviates from the first heading by half of the turn. So half of the correction of the turn
        # is applied before the chord, and half after it.
        step = Pose2(0.0, 0.0, correction / 2.0).compose(Pose2(moved.x, moved.y, moved.theta + correction / 2.0))
        for_drive, for_turn = state.motion_noise_scales
        self._filter.predict(MeasuredMotion(step, for_drive * drive_variance, for_turn * turn_variance))
        self._turned = 0.0

    def _correct(self, state: TrackingState, scan: Scan) -> tuple[TrackingState, bool]:
        """Correct the estimate with the pose at which the scan matches the map. Also return whether it was accepted.

        Innovations that are larger than expected increase `motion_noise_scales`, the factors of the motion's variances.
        Smaller innovations decrease them. A match that is too far away is rejected. But if the scan fits there, the
        match increases the covariance. So after several similar matches, the next match is accepted.

        Source: Mehra, On the identification of variances and adaptive Kalman filtering (1970), for learning the
            motion's noise from innovations. Here the running mean is of its logarithm, so that the variance cannot
            become negative.
        """
        points = self._beams.end_points(scan)
        doubt = self._filter.covariance + state.shared
        error = 2.0 * math.sqrt(max(doubt[0, 0], doubt[1, 1]) + _LEVER * _LEVER * doubt[2, 2])
        match = self._matcher.match(self._filter.mean, points, error)
        if match is None:
            return state, False
        poor = state.poor + 1 if match.share < GOOD else 0
        state = replace(state, poor=poor, unmatched=1.0 - match.share)
        if match.share < _LEAST_SHARE:
            return replace(state, refused=state.refused + 1), False
        squares, degrees = (_MEMORY * old + new for old, new in zip(state.walls_off, match.walls_off, strict=True))
        common = max(0.0, squares / degrees) * match.by_walls if degrees > 0.0 else np.zeros((3, 3))
        own = _covariance(match)
        noise = own + common
        innovation = residual(match.base_in_map.array(), self._filter.mean.array())
        expected = self._filter.covariance + noise
        surprise = _surprise(innovation, expected)
        state = replace(state, motion_noise_scales=_learnt(state.motion_noise_scales, innovation, expected))
        if surprise > GATE:
            # Either the estimate or the match is wrong. After several such matches the gate accepts the next match.
            self._filter.reset(self._filter.mean, _DOUBTING * self._filter.covariance)
            return replace(state, refused=state.refused + 1), False
        self._filter.update(match.base_in_map, noise)
        return (
            replace(
                state,
                shared=read_only(common + (1.0 - match.share) * own),
                matched=state.base_in_odom,
                walls_off=(squares, degrees),
                refused=0,
                matches=state.matches + 1,
            ),
            True,
        )

    def _search(self, state: TrackingState, scan: Scan) -> TrackingState:
        """Restart at the only pose where the scan fits, if there is one. Stay lost until the next match agrees."""
        near = None if self._forgotten else self._filter.mean
        found = self._matcher.search(self._beams.end_points(scan), near)
        state = replace(state, poor=0)
        if found is None:
            return state
        # The search has only found the present pose again.
        if near is not None and not state.lost and near.distance(found.base_in_map) < SPACING:
            return state
        self._forgotten = False
        self._filter.reset(found.base_in_map, _covariance(found))
        at, scales = state.base_in_odom, (1.0, 1.0)
        return replace(state, matched=at, motion_noise_scales=scales, refused=_LOST_AFTER, matches=0)
