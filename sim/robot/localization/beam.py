"""The beam model: likelihood of a scan along its beams, and share of a scan that the map explains from a pose."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import GridFrame, OccupancyGrid
from sim.common.raycast import FreeSquares, Raycaster, cast_beams
from sim.numerics import elementary, elementary_arrays
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.parameters import AmclParameters
from sim.robot.localization.likelihood_field import Beams

_TOLERANCE = 0.3
"""Maximum difference between an explained reading and the map's wall, meters. It allows for errors of pose and map."""

_CUT_SHORT = 0.1
"""Weight of a reading that an unmapped thing may have cut short. A reading that went through a wall has weight 1."""

_TURNS = (-0.02, 0.0, 0.02)
"""Tolerated errors of the heading, radians.

They change the range of a beam that grazes a wall. Each of these ranges counts as correct.
"""


@njit(cache=True)
def _sums(
    expected: FloatArray,
    ranges: FloatArray,
    range_max: float,
    z_hit: float,
    z_short: float,
    z_max: float,
    z_rand: float,
    sigma_hit: float,
    lambda_short: float,
) -> FloatArray:
    """Return (n,) sums of the log probabilities of m readings, for (n, m) expected ranges."""
    out = np.zeros(expected.shape[0])
    for j in range(ranges.size):
        # Beams are in the outer loop and poses in the inner loop. So terms that depend only on the reading are computed
        # once per beam.
        measured = ranges[j]
        if math.isnan(measured):
            continue
        short = z_short * lambda_short * elementary.exp(-lambda_short * measured)
        random = z_max if measured >= range_max else z_rand / range_max
        for i in range(expected.shape[0]):
            error = measured - min(expected[i, j], range_max)
            p = z_hit * elementary.exp(-error * error / (2.0 * sigma_hit * sigma_hit)) + random
            if error < 0.0:
                p += short
            out[i] += elementary.log(max(p, 1e-300))
    return out


class MapAgreement(NamedTuple):
    """Agreement of a scan with the map, from one pose.

    Attributes:
        share: share of the readings that the map explains, 0 to 1.
        cut_short: share of the readings that end in front of the map's surface, 0 to 1.
    """

    share: float
    cut_short: float


@njit(cache=True)
def _agreement(
    squares: FreeSquares, frame: GridFrame, directions: FloatArray, range_max: float,
    laser_x: float, laser_y: float, x: float, y: float, theta: float, ranges: FloatArray,
) -> tuple[float, float]:  # fmt: skip
    """Return share and cut_short of `MapAgreement`, or NaN if no beam met anything. See `BeamModel.agreement`.

    Args:
        squares: see `Raycaster`, also for `frame`.
        directions: see `Beams`, also for `range_max`.
        laser_x: x of the laser in the base frame. y is `laser_y`.
        x: pose of the base in the map, with `y` and `theta`.
        ranges: (m,) readings, meters.
    """
    poses = np.empty((len(_TURNS), 3))
    for i in range(len(_TURNS)):
        turned = theta + _TURNS[i]
        c, s = elementary.cos_sin(turned)
        poses[i, 0] = x + (c * laser_x - s * laser_y)
        poses[i, 1] = y + (s * laser_x + c * laser_y)
        poses[i, 2] = turned
    expected = np.empty((len(_TURNS), ranges.size))
    cast_beams(squares, frame, poses, directions, range_max, expected)
    met, short, through = 0, 0, 0
    for j in range(ranges.size):
        if not ranges[j] < range_max:
            continue
        met += 1
        nearest, farthest = range_max, 0.0
        for i in range(len(_TURNS)):
            nearest, farthest = min(nearest, expected[i, j]), max(farthest, min(expected[i, j], range_max))
        if ranges[j] < nearest - _TOLERANCE:
            short += 1
        if ranges[j] > farthest + _TOLERANCE:
            through += 1
    if met == 0:
        return math.nan, math.nan
    hits = met - short - through
    return hits / (hits + _CUT_SHORT * short + through), short / met


@dataclass(frozen=True, slots=True, eq=False)
class BeamModel:
    """Likelihood of readings, by the distance along each beam to the map's first wall.

    Attributes:
        raycaster: raycaster on the map.
        beams: the beams that are used.
        parameters: the mixture: laser_z_*, laser_sigma_hit, laser_lambda_short.
    """

    raycaster: Raycaster
    beams: Beams
    parameters: AmclParameters

    @classmethod
    def of(cls, grid: OccupancyGrid, beams: Beams, parameters: AmclParameters) -> "BeamModel":
        """Return the model for a map."""
        return cls(Raycaster.of(grid), beams, parameters)

    def expected(self, particles: FloatArray) -> FloatArray:
        """Return the (n, m) expected ranges at (n, 3) base poses in the map, meters, or inf beyond `range_max`."""
        laser = self.beams.mount.laser_in_base
        c, s = elementary_arrays.cos(particles[:, 2]), elementary_arrays.sin(particles[:, 2])
        poses = particles.copy()
        poses[:, 0] += c * laser.x - s * laser.y
        poses[:, 1] += s * laser.x + c * laser.y
        out = np.empty((len(particles), len(self.beams.indices)))
        # The directions of the beams are in the base frame.
        cast_beams(
            self.raycaster.squares, self.raycaster.frame, poses, self.beams.directions, self.beams.range_max, out
        )
        return out

    def log_likelihood(self, particles: FloatArray, ranges: FloatArray) -> FloatArray:
        """Return (n,) log likelihoods of (m,) ranges (see `Beams.ranges`) from (n, 3) base poses in the map.

        Source: Probabilistic Robotics, table 6.1, with amcl's factors (the density of good readings is not normalized)
            and exact ranges. Differences from the source: amcl adds cubes instead of logarithms. Here a beam that
            saw nothing is possible, and has the maximum range as its reading. Readings that are too short are ignored.
        """
        p = self.parameters
        return _sums(
            self.expected(particles),
            ranges,
            self.beams.range_max,
            p.laser_z_hit,
            p.laser_z_short,
            p.laser_z_max,
            p.laser_z_rand,
            p.laser_sigma_hit,
            p.laser_lambda_short,
        )

    def agreement(self, base_in_map: Pose2, ranges: FloatArray) -> MapAgreement | None:
        """Compare (m,) ranges with the map from one pose. Return None if no beam met anything.

        A reading is explained if it ends where the map has a wall. A reading that was cut short has only a tenth of the
        weight of a reading that went through a wall, because other robots shorten readings but nothing lengthens them.
        """
        beams, place = self.beams, base_in_map
        laser, raycaster = beams.mount.laser_in_base, self.raycaster
        share, cut_short = _agreement(
            raycaster.squares,
            raycaster.frame,
            beams.directions,
            beams.range_max,
            laser.x,
            laser.y,
            place.x,
            place.y,
            place.theta,
            ranges,
        )
        return None if math.isnan(share) else MapAgreement(share, cut_short)
