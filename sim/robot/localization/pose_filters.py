"""Extended and unscented Kalman filter over (x, y, theta), based on filterpy, with the same bits on every machine.

filterpy multiplies matrices with numpy's `dot`. For arrays of floats, `dot` calls BLAS, and its last bits depend on the
processor. If one factor is an array of Python objects, `dot` multiplies and adds Python floats in a fixed order, and
the product is again an array of objects. So Jacobians and inverses are passed to filterpy as arrays of objects. Each
product in filterpy has such an array as a factor. All other operations in filterpy's filters are elementwise.

Source: Thrun, Burgard, Fox, Probabilistic Robotics (2005), tables 3.3 and 3.4; van der Merwe, Sigma-point Kalman
filters for probabilistic inference (2004), for the scaled sigma points.
"""

import math
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt
from filterpy.kalman import KalmanFilter, MerweScaledSigmaPoints, UnscentedKalmanFilter

from sim.common.geometry import Pose2
from sim.numerics import elementary, matrices
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray
from sim.parameters import UkfParameters
from sim.robot.localization.estimate import read_only

ObjectArray: TypeAlias = npt.NDArray[np.object_]


@dataclass(frozen=True, slots=True)
class MeasuredMotion:
    """Motion of a robot between two predictions, as measured by its wheels and gyroscope.

    Attributes:
        step: pose at the end, relative to the pose at the beginning.
        drive_variance: variance of the distance, m^2.
        turn_variance: variance of the turn, rad^2.
    """

    step: Pose2
    drive_variance: float
    turn_variance: float

    def noise(self, here: Pose2) -> FloatArray:
        """Return the (3, 3) covariance that the motion adds if it starts at `here`.

        An error of the distance is along the chord. The chord deviates from the first heading by half of the turn. So
        an error of the turn rotates the chord by half of this error.
        """
        there = here.compose(self.step)
        dx, dy = there.x - here.x, there.y - here.y
        ahead, left = elementary.cos_sin(here.theta + elementary.atan2(self.step.y, self.step.x))
        drive, turn = np.array((ahead, left, 0.0)), np.array((-dy / 2.0, dx / 2.0, 1.0))
        return self.drive_variance * np.outer(drive, drive) + self.turn_variance * np.outer(turn, turn)


def residual(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return the (3,) difference of two poses, with a heading in [-pi, pi)."""
    difference: FloatArray = one - other
    difference[2] = wrap_angle(difference[2])
    return difference


def _inverse(matrix: FloatArray | ObjectArray) -> ObjectArray:
    return matrices.inverse(matrix.astype(np.float64)).astype(object)


class PoseFilter:
    """A Gaussian over poses in one of filterpy's filters. It starts at the map's origin."""

    def __init__(self, on: KalmanFilter | UnscentedKalmanFilter) -> None:
        self._filter = on
        self._filter.inv = _inverse
        self.reset(Pose2(0.0, 0.0, 0.0), np.eye(3))

    @property
    def mean(self) -> Pose2:
        """Mean of the Gaussian."""
        return Pose2(*self._filter.x.tolist())

    @property
    def covariance(self) -> FloatArray:
        """(3, 3) covariance, exactly symmetric. Read-only."""
        covariance: FloatArray = self._filter.P
        return covariance

    def reset(self, mean: Pose2, covariance: FloatArray | ObjectArray) -> None:
        """Restart from a mean and a (3, 3) covariance."""
        floats = covariance.astype(np.float64)
        self._filter.x, self._filter.P = mean.array(), read_only((floats + floats.T) / 2.0)

    def predict(self, motion: MeasuredMotion) -> None:
        """Move the Gaussian as the robot moved."""
        raise NotImplementedError

    def update(self, measured: Pose2, noise: FloatArray) -> None:
        """Correct the Gaussian by a measured pose with a (3, 3) covariance."""
        raise NotImplementedError

    def _settle(self) -> None:
        """Wrap the heading to [-pi, pi), and convert filterpy's results to symmetric arrays of floats."""
        x, y, theta = map(float, self._filter.x)
        self.reset(Pose2(x, y, wrap_angle(theta)), self._filter.P)


class ExtendedPoseFilter(PoseFilter):
    """Extended Kalman filter: the motion is linearized about the mean."""

    def __init__(self) -> None:
        # filterpy's ExtendedKalmanFilter is not used, because it inverts matrices with LAPACK. With its KalmanFilter,
        # only the motion of the mean has to be computed here.
        super().__init__(KalmanFilter(dim_x=3, dim_z=3))
        self._filter.H = np.eye(3).astype(object)

    def predict(self, motion: MeasuredMotion) -> None:
        """Move the Gaussian as the robot moved."""
        here = self.mean
        there = here.compose(motion.step)
        jacobian = np.array(((1.0, 0.0, here.y - there.y), (0.0, 1.0, there.x - here.x), (0.0, 0.0, 1.0)), dtype=object)
        self._filter.predict(F=jacobian, Q=motion.noise(here))
        self.reset(there, self._filter.P)

    def update(self, measured: Pose2, noise: FloatArray) -> None:
        """Correct the Gaussian by a measured pose with a (3, 3) covariance."""
        # Choose the equivalent heading within half a turn of the mean's heading.
        self._filter.update(self._filter.x + residual(measured.array(), self._filter.x), R=noise)
        self._settle()


class UnscentedPoseFilter(PoseFilter):
    """Unscented Kalman filter.

    It moves several poses around the mean, so the mean of poses on an arc is inside the arc.
    """

    def __init__(self, parameters: UkfParameters) -> None:
        # filterpy squares alpha with libm's pow, which is certain to be exact only for 1. So pass 1, and other values
        # that give the same points and weights.
        squared = parameters.alpha * parameters.alpha
        self._points = MerweScaledSigmaPoints(
            3,
            alpha=1.0,
            beta=parameters.beta + 1.0 - squared,
            kappa=squared * (3.0 + parameters.kappa) - 3.0,
            sqrt_method=lambda covariance: matrices.root(covariance).T,
        )
        super().__init__(
            UnscentedKalmanFilter(
                dim_x=3,
                dim_z=3,
                dt=0.0,  # not used, because motions are passed instead of times
                hx=lambda pose: pose,
                fx=_moved,
                points=self._points,
                x_mean_fn=_mean,
                z_mean_fn=_mean,
                residual_x=residual,
                residual_z=residual,
            )
        )

    def predict(self, motion: MeasuredMotion) -> None:
        """Move the Gaussian as the robot moved."""
        self._filter.Q = motion.noise(self.mean)
        self._filter.predict(step=motion.step)
        self._settle()

    def update(self, measured: Pose2, noise: FloatArray) -> None:
        """Correct the Gaussian by a measured pose with a (3, 3) covariance."""
        # The Gaussian may have been reset since the prediction, so its points must be computed again.
        self._filter.sigmas_f = self._points.sigma_points(self._filter.x, self._filter.P)
        self._filter.update(measured.array(), R=noise)
        self._settle()


def _moved(pose: FloatArray, _: float, step: Pose2) -> FloatArray:
    return Pose2(*pose.tolist()).compose(step).array()


def _mean(poses: FloatArray, weights: FloatArray) -> FloatArray:
    """Return the (3,) weighted mean of (n, 3) poses, computed from their differences to the first pose."""
    first = poses[0]
    differences = np.array([residual(pose, first) for pose in poses])
    mean: FloatArray = first + np.array([math.fsum(each) for each in (weights * differences.T).tolist()])
    return mean
