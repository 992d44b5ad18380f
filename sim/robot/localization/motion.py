"""Motion of particles by odometry: amcl's models of differential and omnidirectional drives."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sim.common.geometry import Pose2
from sim.numerics import elementary
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit

_STANDING = 0.01
"""Minimum distance between two positions with a reliable bearing, meters (amcl)."""


_SYSTEMATIC = 0.1
"""Assumed systematic error of the wheels, as a share of every motion.

amcl's models diff and omni use the sums of alphas as standard deviations: 8 mm for a step of 20 cm. Wheels that report
5 % too much then move the cloud ahead of the truth by 1 cm per step. Scans cannot pull the cloud back this fast.
"""


_MOST_OF_ONE_SCAN = 6.0
"""Maximum ratio of squared errors that is learned from a single scan, see `MotionModel.learned`."""
MAX_NOISE_SCALE = 10.0
"""Maximum factor of the odometry noise."""


class DiffIncrement(NamedTuple):
    """A motion measured by odometry: turn, drive straight, turn again. Radians, meters, radians."""

    rot1: float
    trans: float
    rot2: float


class DiffSpread(NamedTuple):
    """Standard deviations of the three parts of an increment. Radians, meters, radians."""

    rot1: float
    trans: float
    rot2: float


class Alphas(NamedTuple):
    """Assumed odometry noise, as in table 5.6: turn per turn, turn per meter, meter per meter, meter per turn.

    The fifth value is the sideways error, meter per meter.
    """

    alpha1: float
    alpha2: float
    alpha3: float
    alpha4: float
    alpha5: float = 0.0


class NoiseScales(NamedTuple):
    """Factors of the noise of distances and turns, relative to the alphas."""

    drive: float
    turn: float


AS_BELIEVED = NoiseScales(1.0, 1.0)


class OmniIncrement(NamedTuple):
    """A motion of a base that can move sideways: a distance, its direction relative to the heading, and a turn."""

    bearing: float
    trans: float
    rot: float


class OmniSpread(NamedTuple):
    """Standard deviations of a sliding motion along its direction, across it, and of its turn.

    Meters, meters, radians.
    """

    trans: float
    strafe: float
    rot: float


def diff_increment(before: Pose2, after: Pose2) -> DiffIncrement:
    """Return the motion between two odometry poses, both in the odom frame.

    Source: Probabilistic Robotics, table 5.6, lines 2 to 4. amcl_odom.cpp for the first turn of a robot that hardly
        moved.
    """
    dx, dy = after.x - before.x, after.y - before.y
    trans = elementary.hypot(dx, dy)
    rot1 = wrap_angle(elementary.atan2(dy, dx) - before.theta) if trans >= _STANDING else 0.0
    return DiffIncrement(rot1, trans, wrap_angle(after.theta - before.theta - rot1))


def _turning(angle: float) -> float:
    """Return the angle that the robot turned, radians.

    Driving backward looks like half a turn, but the robot does not turn.
    """
    return min(abs(angle), abs(wrap_angle(angle - math.pi)))


def diff_spread(moved: DiffIncrement, alphas: Alphas, corrected: bool) -> DiffSpread:
    """Return the standard deviations of the true motion, given the measured motion.

    Args:
        moved: the measured motion.
        alphas: the assumed noise.
        corrected: True for table 5.6, where sums of squares are variances (amcl: diff-corrected). False for amcl's
            default model diff, which uses the same sums as standard deviations. The spread of diff is narrower for the
            short steps of a tracking filter, and the usual alphas of 0.2 are meant for diff.

    Source: Probabilistic Robotics, table 5.6, lines 5 to 7; amcl_odom.cpp.
    """
    turn1, turn2 = (turning * turning for turning in (_turning(moved.rot1), _turning(moved.rot2)))
    drive = moved.trans * moved.trans
    rot1 = alphas.alpha1 * turn1 + alphas.alpha2 * drive
    trans = alphas.alpha3 * drive + alphas.alpha4 * (turn1 + turn2)
    rot2 = alphas.alpha1 * turn2 + alphas.alpha2 * drive
    if corrected:
        return DiffSpread(math.sqrt(rot1), math.sqrt(trans), math.sqrt(rot2))
    return DiffSpread(rot1, trans, rot2)


@njit(cache=True)
def diff_move(particles: FloatArray, moved: DiffIncrement, spread: DiffSpread, noise: FloatArray) -> FloatArray:
    """Move the particles, each with its own random error.

    Args:
        particles: (n, 3) poses in the map.
        moved: the motion by odometry.
        spread: standard deviations of the motion.
        noise: (3 n,) standard normals.

    Returns:
        (n, 3) poses in the map.

    Source: Probabilistic Robotics, table 5.6, lines 5 to 11.
    """
    out = np.empty_like(particles)
    for i in range(particles.shape[0]):
        # The error is subtracted, as in table 5.6: the true motion is the measured motion minus its error.
        rot1 = moved.rot1 - spread.rot1 * noise[3 * i]
        trans = moved.trans - spread.trans * noise[3 * i + 1]
        rot2 = moved.rot2 - spread.rot2 * noise[3 * i + 2]
        heading = particles[i, 2] + rot1
        c, s = elementary.cos_sin(heading)
        out[i, 0] = particles[i, 0] + trans * c
        out[i, 1] = particles[i, 1] + trans * s
        out[i, 2] = wrap_angle(heading + rot2)
    return out


def omni_increment(before: Pose2, after: Pose2) -> OmniIncrement:
    """Return the motion between two odometry poses in the odom frame, for a base that can move sideways."""
    dx, dy = after.x - before.x, after.y - before.y
    bearing = wrap_angle(elementary.atan2(dy, dx) - before.theta)
    return OmniIncrement(bearing, elementary.hypot(dx, dy), wrap_angle(after.theta - before.theta))


def omni_spread(moved: OmniIncrement, alphas: Alphas, corrected: bool) -> OmniSpread:
    """Return the standard deviations of the true sliding motion from the measured motion.

    Args:
        moved: the measured motion.
        alphas: the assumed noise.
        corrected: True if the sums are variances and the alphas have the same meaning as for a differential drive.
            False if they are standard deviations with alpha1 and alpha4 exchanged, as in amcl's model omni.

    Source: amcl_odom.cpp.
    """
    drive, turn = moved.trans * moved.trans, moved.rot * moved.rot
    if corrected:
        return OmniSpread(
            math.sqrt(alphas.alpha3 * drive + alphas.alpha4 * turn),
            math.sqrt(alphas.alpha5 * drive + alphas.alpha4 * turn),
            math.sqrt(alphas.alpha1 * turn + alphas.alpha2 * drive),
        )
    return OmniSpread(
        alphas.alpha3 * drive + alphas.alpha1 * turn,
        alphas.alpha5 * drive + alphas.alpha1 * turn,
        alphas.alpha4 * turn + alphas.alpha2 * drive,
    )


@njit(cache=True)
def _slide(particles: FloatArray, moved: OmniIncrement, spread: OmniSpread, noise: FloatArray) -> FloatArray:
    out = np.empty_like(particles)
    for i in range(particles.shape[0]):
        along = moved.trans + spread.trans * noise[3 * i]
        across = spread.strafe * noise[3 * i + 1]
        direction = particles[i, 2] + moved.bearing
        c, s = elementary.cos_sin(direction)
        out[i, 0] = particles[i, 0] + along * c + across * s
        out[i, 1] = particles[i, 1] + along * s - across * c
        out[i, 2] = wrap_angle(particles[i, 2] + moved.rot + spread.rot * noise[3 * i + 2])
    return out


@njit(cache=True)
def _square_ratios(noise: FloatArray, before: FloatArray, after: FloatArray) -> FloatArray:
    """Return (3,) ratios of the weighted mean squares of (3 n,) normals: after a scan, divided by before the scan."""
    squares = np.zeros((2, 3))
    for i in range(before.size):
        for k in range(3):
            square = noise[3 * i + k] * noise[3 * i + k]
            squares[0, k] += before[i] * square
            squares[1, k] += after[i] * square
    ratios: FloatArray = squares[1] / squares[0]
    return ratios


@dataclass(frozen=True, slots=True)
class MotionModel:
    """Model that moves particles according to the odometry.

    Attributes:
        name: amcl's `odom_model_type`: diff, diff-corrected, omni or omni-corrected.
        alphas: the assumed noise.
    """

    name: str
    alphas: Alphas

    def move(
        self, particles: FloatArray, before: Pose2, after: Pose2, noise: FloatArray, scales: NoiseScales = AS_BELIEVED
    ) -> FloatArray:
        """Return (n, 3) particles after a motion from one odometry pose to another. `noise` are (3 n,) normals.

        Difference from ROS: the assumed error of distances and turns is at least a tenth of them, see `_SYSTEMATIC`.
        """
        corrected = self.name.endswith("-corrected")
        # Alphas of 0 mean perfect wheels, without a systematic error.
        straight = _SYSTEMATIC if self.alphas.alpha3 > 0.0 else 0.0
        turning = _SYSTEMATIC if self.alphas.alpha1 > 0.0 else 0.0
        if self.name.startswith("diff"):
            moved = diff_increment(before, after)
            doubt = diff_spread(moved, self.alphas, corrected)
            doubt = DiffSpread(
                scales.turn * max(doubt.rot1, turning * _turning(moved.rot1)),
                scales.drive * max(doubt.trans, straight * moved.trans),
                scales.turn * max(doubt.rot2, turning * _turning(moved.rot2)),
            )
            return diff_move(particles, moved, doubt, noise)
        slid = omni_increment(before, after)
        slid_doubt = omni_spread(slid, self.alphas, corrected)
        slid_doubt = slid_doubt._replace(
            trans=scales.drive * max(slid_doubt.trans, straight * slid.trans),
            strafe=scales.drive * slid_doubt.strafe,
            rot=scales.turn * max(slid_doubt.rot, turning * abs(slid.rot)),
        )
        return _slide(particles, slid, slid_doubt, noise)

    def learned(
        self, scales: NoiseScales, rate: float, noise: FloatArray, before: FloatArray, after: FloatArray
    ) -> NoiseScales:
        """Return the factors of the odometry noise after one more scan.

        Particles are moved with random errors of the assumed size. If the true odometry noise has this size, the
        particles that fit a scan have average errors. If it is larger, the particles with the largest errors fit best.
        Their mean square error, divided by the mean square error of all particles, shows how much larger the noise is.
        The factors are never below 1, so the alphas give the minimum noise.

        Args:
            scales: previous factors, with which the particles were moved.
            rate: rate at which the logarithm of a squared factor follows the ratio.
            noise: (3 n,) normals with which the particles were moved.
            before: (n,) weights before the scan.
            after: (n,) weights after the scan.

        Source: Dempster, Laird and Rubin, Maximum likelihood from incomplete data via the EM algorithm (1977), for the
            expected square of a hidden error. Here, a running mean of the square's logarithm is used, as in `ekf`.
        """
        first, second, third = np.minimum(_square_ratios(noise, before, after), _MOST_OF_ONE_SCAN).tolist()
        # A differential drive has errors of turn, distance and turn. An omnidirectional drive has errors along, across
        # and of the turn.
        turns = (first + third) / 2.0 if self.name.startswith("diff") else third
        drives = second if self.name.startswith("diff") else (first + second) / 2.0
        drive, turn = (
            min(max(scale * elementary.exp(0.5 * rate * (ratio - 1.0)), 1.0), MAX_NOISE_SCALE)
            for scale, ratio in zip(scales, (drives, turns), strict=True)
        )
        return NoiseScales(drive, turn)
