"""How particles move with the odometry: amcl's differential-drive models."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from sim.geometry import FloatArray, Pose2, wrap_angle

_STANDING = 0.01
"""Metres: two places nearer than this give no trustworthy bearing (amcl)."""


class Increment(NamedTuple):
    """A movement as odometry tells it: turn, drive straight, turn again. Radians, metres, radians."""

    rot1: float
    trans: float
    rot2: float


class Spread(NamedTuple):
    """Standard deviations of the three parts of an increment. Radians, metres, radians."""

    rot1: float
    trans: float
    rot2: float


class Alphas(NamedTuple):
    """Believed odometry noise, as in table 5.6: turn per turn, turn per metre, metre per metre, metre per turn."""

    alpha1: float
    alpha2: float
    alpha3: float
    alpha4: float


def increment(before: Pose2, after: Pose2) -> Increment:
    """The movement between two odometry poses, both in the odom frame.

    Source: Probabilistic Robotics, table 5.6, lines 2 to 4; amcl_odom.cpp for the bearing of a robot that hardly moved.
    """
    dx, dy = after.x - before.x, after.y - before.y
    trans = math.hypot(dx, dy)
    rot1 = wrap_angle(math.atan2(dy, dx) - before.theta) if trans >= _STANDING else 0.0
    return Increment(rot1, trans, wrap_angle(after.theta - before.theta - rot1))


def _turning(angle: float) -> float:
    """How much turning a rotation stands for: driving backwards is half a turn that the wheels never made."""
    return min(abs(angle), abs(wrap_angle(angle - math.pi)))


def spread(moved: Increment, alphas: Alphas, corrected: bool) -> Spread:
    """How far the true movement may be from the measured one.

    Args:
        moved: the measured movement.
        alphas: the believed noise.
        corrected: table 5.6, where sums of squares are variances (amcl: diff-corrected). Otherwise the same sums are
            taken for standard deviations, as amcl's default model diff has always done: a narrower spread over the
            short steps of a tracking filter, which its customary alphas of 0.2 count on.

    Source: Probabilistic Robotics, table 5.6, lines 5 to 7; amcl_odom.cpp.
    """
    turn1, turn2 = _turning(moved.rot1) ** 2, _turning(moved.rot2) ** 2
    drive = moved.trans**2
    rot1 = alphas.alpha1 * turn1 + alphas.alpha2 * drive
    trans = alphas.alpha3 * drive + alphas.alpha4 * (turn1 + turn2)
    rot2 = alphas.alpha1 * turn2 + alphas.alpha2 * drive
    if corrected:
        return Spread(math.sqrt(rot1), math.sqrt(trans), math.sqrt(rot2))
    return Spread(rot1, trans, rot2)


@njit(cache=True)
def _move(particles: FloatArray, moved: Increment, spread: Spread, noise: FloatArray) -> FloatArray:
    out = np.empty_like(particles)
    for i in range(particles.shape[0]):
        rot1 = moved.rot1 - spread.rot1 * noise[3 * i]
        trans = moved.trans - spread.trans * noise[3 * i + 1]
        rot2 = moved.rot2 - spread.rot2 * noise[3 * i + 2]
        heading = particles[i, 2] + rot1
        out[i, 0] = particles[i, 0] + trans * math.cos(heading)
        out[i, 1] = particles[i, 1] + trans * math.sin(heading)
        out[i, 2] = wrap_angle(heading + rot2)
    return out


def move(particles: FloatArray, moved: Increment, spread: Spread, noise: FloatArray) -> FloatArray:
    """Particles after a movement, each with an error of its own.

    Args:
        particles: (n, 3) poses in the map.
        moved: what odometry says.
        spread: how far that may be off.
        noise: (3 n,) standard normals.

    Returns:
        (n, 3) poses in the map.

    Source: Probabilistic Robotics, table 5.6, lines 5 to 11.
    """
    moved_particles: FloatArray = _move(particles, moved, spread, noise)
    return moved_particles
