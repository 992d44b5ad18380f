"""An extended Kalman filter over (x, y, theta): wheels and gyroscope, corrected by scans matched to the map.

Source: Thrun, Burgard, Fox, Probabilistic Robotics (2005), table 7.2, with odometry for control (section 5.4) and a
matched pose for measurement; the algebra is filterpy's.
"""

import math
from dataclasses import dataclass

import numpy as np

from sim.geometry import FloatArray, Pose2, wrap_angle
from sim.grid import OccupancyGrid
from sim.localization.estimate import Estimate, Start, read_only
from sim.localization.likelihood_field import Beams
from sim.localization.scan_matching import ScanMatcher
from sim.observations import TICK, Imu, LaserMount, Odometry, Scan
from sim.parameters import EkfParameters

PREDICTION_INTERVAL = 5
"""Ticks between predictions where no scan asks for one; in between, odometry alone carries the estimate on."""

GATE = 16.27
"""Greatest squared Mahalanobis distance of a match that is believed: chi-square with 3 degrees of freedom, 0.999."""

_LEAST_INFORMATION = np.diag((1.0, 1.0, 4.0))
"""Keeps a match's covariance finite where a corridor leaves a direction open: one metre, half a radian."""

_MAP_ERROR = np.diag((0.02**2, 0.02**2, 0.005**2))
"""Added to every match's covariance: matches made one after another share walls, clutter, and so their errors."""

_LEVER = 3.0
"""Metres: how far a wall is, typically, when a doubt of heading is to be told as one of place."""


@dataclass(frozen=True, slots=True, eq=False)
class EkfBelief:
    """A Gaussian over poses, as of the last prediction.

    Attributes:
        tick: of that prediction.
        base_in_map: the mean.
        covariance: (3, 3) about it; read-only.
        base_in_odom: the odometry then.
        odom_in_map: the correction that makes the two poses agree.
        matched: the odometry when a scan was last weighed in; None before the first.
    """

    tick: int
    base_in_map: Pose2
    covariance: FloatArray
    base_in_odom: Pose2
    odom_in_map: Pose2
    matched: Pose2 | None


@dataclass(frozen=True, slots=True)
class EkfState:
    """All that the filter remembers between two ticks.

    Attributes:
        belief: where it believes to be.
        turned: radians that the gyroscope has counted since the last prediction.
        asked: whether the next scan is to be matched wherever the robot is.
        lost: whether it was told to forget where it is, and nobody has told it since.
    """

    belief: Start | EkfBelief
    turned: float
    asked: bool
    lost: bool


def _anywhere(grid: OccupancyGrid) -> FloatArray:
    """(3, 3) covariance of a pose that may be anywhere on the map: uniform over its extent and all headings."""
    rows, cols = grid.cells.shape
    spread = (rows**2 + cols**2) * grid.resolution**2 / 12.0
    return np.diag((spread, spread, math.pi**2 / 3.0))


def _direct(_: FloatArray) -> FloatArray:
    """The measurement's Jacobian: a match measures the pose itself."""
    return np.eye(3)


def _itself(mean: FloatArray) -> FloatArray:
    return mean


def _residual(measured: FloatArray, predicted: FloatArray) -> FloatArray:
    difference: FloatArray = measured - predicted
    difference[2] = wrap_angle(difference[2])
    return difference


class Ekf:
    """One Gaussian hypothesis, cheap and smooth; it cannot find a robot that was carried away. See `Localizer`.

    Before the first `start` it believes to be at the map's origin.
    """

    def __init__(self, parameters: EkfParameters, grid: OccupancyGrid, mount: LaserMount) -> None:
        """A filter for one robot, on its static map, for the laser whose scans `update` will bring."""
        # Its import takes 0.7 s, which only those who choose this localiser should wait for.
        from filterpy.kalman import ExtendedKalmanFilter  # noqa: PLC0415

        self._parameters = parameters
        self._beams = Beams.of(mount, parameters.laser_max_beams, parameters.laser_max_range)
        self._matcher = ScanMatcher.of(grid)
        self._algebra = ExtendedKalmanFilter(dim_x=3, dim_z=3)
        self._algebra.B = np.eye(3)
        variances = (parameters.initial_cov_xx, parameters.initial_cov_yy, parameters.initial_cov_aa)
        self._belief: Start | EkfBelief = Start(Pose2(0.0, 0.0, 0.0), read_only(np.diag(variances)))
        self._turned = 0.0
        self._asked = False
        self._lost = False
        self._anywhere = read_only(_anywhere(grid))
        self._particles = np.empty((0, 3))

    @property
    def state(self) -> EkfState:
        """Everything the next estimate depends on, besides what `update` will be told."""
        return EkfState(self._belief, self._turned, self._asked, self._lost)

    def restore(self, state: EkfState) -> None:
        """Go on from a state that `state` once gave."""
        self._belief, self._turned, self._asked, self._lost = state.belief, state.turned, state.asked, state.lost

    def start(self, base_in_map: Pose2, covariance: FloatArray) -> None:
        """Begin anew around this pose, at the next tick; the first scan from then on is weighed at once."""
        self._belief, self._turned = Start(base_in_map, read_only(covariance.copy())), 0.0
        self._lost = False

    def globalize(self) -> None:
        """Forget where the robot was: lost, with a covariance as wide as the map, until `start` tells it a pose.

        One Gaussian cannot stand for "anywhere", so it does not search, and weighs no scan in the meantime.
        """
        self._lost = True

    def request_update(self) -> None:
        """Match the next scan even if the robot has not moved."""
        self._asked = True

    def update(self, odometry: Odometry, imu: Imu, scan: Scan | None) -> Estimate:
        """Take in one tick; a scan is matched when the robot has moved enough since the last one that was."""
        belief = self._belief
        if isinstance(belief, Start):
            odom_in_map = belief.base_in_map.compose(odometry.base_in_odom.inverse())
            belief = EkfBelief(
                odometry.tick, belief.base_in_map, belief.covariance, odometry.base_in_odom, odom_in_map, None
            )
        else:
            self._turned += imu.angular_velocity * TICK
            if scan is not None or odometry.tick - belief.tick >= PREDICTION_INTERVAL:
                belief = self._predict(belief, odometry)
                self._turned = 0.0
        updated = False
        if scan is not None and not self._lost and (self._asked or self._due(belief)):
            self._asked = False
            corrected = self._correct(belief, scan)
            if corrected is not None:
                belief, updated = corrected, True
        self._belief = belief
        return Estimate(
            tick=odometry.tick,
            base_in_map=belief.odom_in_map.compose(odometry.base_in_odom),
            odom_in_map=belief.odom_in_map,
            covariance=self._anywhere if self._lost else belief.covariance,
            particles=self._particles,
            updated=updated,
            lost=self._lost,
        )

    def _due(self, belief: EkfBelief) -> bool:
        """Whether the robot moved enough since the last match, by amcl's rule."""
        if belief.matched is None:
            return True
        here, there, limit = belief.base_in_odom, belief.matched, self._parameters.update_min_d
        return (
            abs(here.x - there.x) > limit
            or abs(here.y - there.y) > limit
            or abs(wrap_angle(here.theta - there.theta)) > self._parameters.update_min_a
        )

    def _predict(self, belief: EkfBelief, odometry: Odometry) -> EkfBelief:
        """Carry mean and covariance on by what wheels and gyroscope say of the ticks since the last prediction."""
        parameters, algebra = self._parameters, self._algebra
        moved = belief.base_in_odom.between(odometry.base_in_odom)
        distance = math.hypot(moved.x, moved.y)
        wheels_variance = parameters.odom_alpha1 * moved.theta**2 + parameters.odom_alpha2 * distance**2
        gyro_variance = (odometry.tick - belief.tick) * (parameters.gyro_noise * TICK) ** 2
        # Wheels that stand still are certain of it, and then the gyroscope's noise has no say.
        trust = wheels_variance / (wheels_variance + gyro_variance) if wheels_variance > 0.0 else 0.0
        correction = trust * wrap_angle(self._turned - moved.theta)
        turn_variance = (1.0 - trust) * wheels_variance
        drive_variance = parameters.odom_alpha3 * distance**2 + parameters.odom_alpha4 * moved.theta**2

        here = belief.base_in_map
        # The chord of an arc points half of the turn aside; so does a correction of the turn.
        c, s = math.cos(here.theta + correction / 2.0), math.sin(here.theta + correction / 2.0)
        dx, dy = c * moved.x - s * moved.y, s * moved.x + c * moved.y
        bearing = math.atan2(dy, dx)
        to_noise = np.array(((math.cos(bearing), -dy / 2.0), (math.sin(bearing), dx / 2.0), (0.0, 1.0)))
        algebra.x, algebra.P = here.array(), belief.covariance
        algebra.F = np.array(((1.0, 0.0, -dy), (0.0, 1.0, dx), (0.0, 0.0, 1.0)))
        algebra.Q = to_noise @ np.diag((drive_variance, turn_variance)) @ to_noise.T
        after = np.array((here.x + dx, here.y + dy, here.theta + moved.theta + correction))
        # filterpy predicts F x + B u; the motion is not linear, so u makes up for what F x lacks.
        algebra.predict(u=after - algebra.F @ algebra.x)
        return self._believed(odometry.tick, odometry.base_in_odom, belief.matched)

    def _correct(self, belief: EkfBelief, scan: Scan) -> EkfBelief | None:
        """Weigh in the pose that the scan speaks for; None if it speaks for none, or for one too far off to believe."""
        algebra = self._algebra
        doubt = belief.covariance
        error = 2.0 * math.sqrt(max(doubt[0, 0], doubt[1, 1]) + _LEVER**2 * doubt[2, 2])
        match = self._matcher.match(belief.base_in_map, self._beams.end_points(scan), error)
        if match is None:
            return None
        noise = np.linalg.inv(match.information + _LEAST_INFORMATION) + _MAP_ERROR
        measured = match.base_in_map.array()
        innovation = _residual(measured, belief.base_in_map.array())
        if innovation @ np.linalg.solve(belief.covariance + noise, innovation) > GATE:
            return None
        algebra.x, algebra.P = belief.base_in_map.array(), belief.covariance
        algebra.update(measured, _direct, _itself, R=noise, residual=_residual)
        return self._believed(belief.tick, belief.base_in_odom, belief.base_in_odom)

    def _believed(self, tick: int, base_in_odom: Pose2, matched: Pose2 | None) -> EkfBelief:
        """What the algebra has come to."""
        x, y, theta = (float(value) for value in self._algebra.x)
        base_in_map = Pose2(x, y, wrap_angle(theta))
        covariance: FloatArray = (self._algebra.P + self._algebra.P.T) / 2.0
        odom_in_map = base_in_map.compose(base_in_odom.inverse())
        return EkfBelief(tick, base_in_map, read_only(covariance), base_in_odom, odom_in_map, matched)
