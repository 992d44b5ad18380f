"""Scan matching: find the pose near a guess at which a scan fits the map best. The Kalman filter uses this pose."""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from sim.common.distance_fields import distance_field
from sim.common.geometry import Pose2
from sim.common.grid import FREE, OCCUPIED, GridFrame, OccupancyGrid
from sim.common.raycast import FreeSquares, free_squares_of
from sim.numerics import elementary, elementary_arrays
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.numerics.matrices import damped_solution
from sim.robot.localization.bilinear import REACH, interpolate
from sim.robot.localization.surface_matching import refined

_FINEST, _COARSEST = 0.15, 0.6
"""Finest and coarsest width of a match, meters. Points at a larger distance from surfaces count as unmapped things."""
_SEARCHED = 0.3
"""Width for comparing poses on the whole map, meters. It is larger because these poses are not exact."""
SPACING, _HEADINGS = 0.4, 16
"""Distance between the first positions of a search, meters, and number of headings at each position."""
_REFINED = 40
"""Number of the best poses that are refined."""
_FEWEST = 20
"""Minimum number of points for a search, and approximate number of points for comparing poses."""
GOOD, _MARGIN = 0.8, 0.1
"""Share of the points that must be on walls at a found pose, and minimum lead of this share over other poses."""
NEAR = 1.5
"""A lost robot is first searched within this distance of its last pose, meters."""
_STEPS = 4
"""Number of Gauss-Newton steps at each width, from coarse to fine."""
_DAMPING = 1e-3
"""The mean of the information matrix's diagonal, times this factor, is added to the diagonal.

It prevents drift along a corridor, where scans do not determine the position.
"""


class ScanMatch(NamedTuple):
    """A pose at which a scan fits the map.

    Attributes:
        base_in_map: the pose.
        information: (3, 3) inverse covariance of the pose if the map is right. Singular along directions that the scan
            does not determine.
        by_walls: (3, 3) covariance of the pose if the positions of the map's walls had a standard deviation of one
            meter.
        walls_off: sum of squared errors of the walls, and its expectation for a standard deviation of one meter.
        share: share of the points on the map's surfaces, 0 to 1.
    """

    base_in_map: Pose2
    information: FloatArray
    by_walls: FloatArray
    walls_off: tuple[float, float]
    share: float


def signed_distance(grid: OccupancyGrid, max_distance: float) -> FloatArray:
    """Return the distance from each cell's center to the nearest surface of a wall, negative inside walls, meters.

    A laser sees surfaces. In a field that is 0 inside walls, beams could end inside walls without a penalty.

    Returns:
        (rows, cols) float64 in [-max_distance, max_distance].
    """
    half = grid.resolution / 2.0
    inverse = replace(grid, cells=np.where(grid.cells == OCCUPIED, FREE, OCCUPIED))
    outside = distance_field(grid, max_distance + half).astype(np.float64) - half
    inside = distance_field(inverse, max_distance + half).astype(np.float64) - half
    distances: FloatArray = np.where(grid.cells == OCCUPIED, -inside, outside)
    return distances


@njit(cache=True)
def _normal_equations(
    field: FloatArray, frame: GridFrame, x: float, y: float, theta: float, points: FloatArray, width: float
) -> tuple[FloatArray, FloatArray, float]:
    """Return the matrix and right side of the Gauss-Newton step, and the mean weight of the points."""
    matrix = np.zeros((3, 3))
    right = np.zeros((3, 1))
    weights = 0.0
    c, s = elementary.cos_sin(theta)
    slopes = np.empty(3)
    for j in range(points.shape[0]):
        px = c * points[j, 0] - s * points[j, 1]
        py = s * points[j, 0] + c * points[j, 1]
        dx, dy = x + px - frame.x, y + py - frame.y
        along = (frame.cos * dx + frame.sin * dy) / frame.resolution
        across = (frame.cos * dy - frame.sin * dx) / frame.resolution
        distance, by_col, by_row = interpolate(field, along, across)
        slopes[0] = (frame.cos * by_col - frame.sin * by_row) / frame.resolution
        slopes[1] = (frame.sin * by_col + frame.cos * by_row) / frame.resolution
        # Derivative by the heading: if the robot turns, a point moves perpendicular to its lever (px, py).
        slopes[2] = slopes[1] * px - slopes[0] * py
        # Geman and McClure's weight: a point far from every wall is on another robot or an unmapped thing, so it must
        # not pull the pose.
        weight = 1.0 / (1.0 + (distance / width) ** 2) ** 2
        weights += weight
        for a in range(3):
            right[a, 0] -= weight * slopes[a] * distance
            for b in range(3):
                matrix[a, b] += weight * slopes[a] * slopes[b]
    return matrix, right, weights / points.shape[0]


@njit(cache=True)
def _match(
    field: FloatArray, frame: GridFrame, x: float, y: float, theta: float, points: FloatArray, width: float
) -> tuple[float, float, float, float]:
    """Return the pose at which the points are on surfaces, and their mean weight there."""
    # Go from coarse to fine: with a wide kernel, distant points pull the pose, and a narrow kernel ignores outliers.
    while True:
        for _ in range(_STEPS):
            matrix, right, _ = _normal_equations(field, frame, x, y, theta, points, width)
            step = damped_solution(matrix, right, _DAMPING)
            x += step[0, 0]
            y += step[1, 0]
            theta += step[2, 0]
        if width <= _FINEST:
            break
        width = max(width / 2.0, _FINEST)
    _, _, share = _normal_equations(field, frame, x, y, theta, points, width)
    return x, y, wrap_angle(theta), share


@njit(cache=True)
def _shares(field: FloatArray, frame: GridFrame, poses: FloatArray, points: FloatArray) -> FloatArray:
    """Return (n,) mean weights of the points, as seen from each pose, for the width that searches use."""
    shares = np.empty(poses.shape[0])
    for i in range(poses.shape[0]):
        c, s = elementary.cos_sin(poses[i, 2])
        total = 0.0
        for j in range(points.shape[0]):
            dx = poses[i, 0] + c * points[j, 0] - s * points[j, 1] - frame.x
            dy = poses[i, 1] + s * points[j, 0] + c * points[j, 1] - frame.y
            along = (frame.cos * dx + frame.sin * dy) / frame.resolution
            across = (frame.cos * dy - frame.sin * dx) / frame.resolution
            distance, _, _ = interpolate(field, along, across)
            total += 1.0 / (1.0 + (distance / _SEARCHED) ** 2) ** 2
        shares[i] = total / points.shape[0]
    return shares


@dataclass(frozen=True, slots=True, eq=False)
class ScanMatcher:
    """Matcher of scans to a map.

    Attributes:
        field: (rows, cols) meters to the nearest surface, negative inside walls. See `signed_distance`.
        frame: frame of the field in the map.
        squares: the map's strides for beams.
        laser: x and y of the laser in the base frame, meters.
        free: (n, 3) poses in free cells. They are dense enough that a match from one of them finds any pose of a robot.
    """

    field: FloatArray
    frame: GridFrame
    squares: FreeSquares
    laser: tuple[float, float]
    free: FloatArray

    @classmethod
    def of(cls, grid: OccupancyGrid, laser_in_base: Pose2) -> "ScanMatcher":
        """Make a matcher for a map and a laser."""
        step = max(1, round(SPACING / grid.resolution))
        cells = np.argwhere(grid.cells[::step, ::step] == FREE) * step
        headings = np.arange(_HEADINGS) * (2.0 * math.pi / _HEADINGS) - math.pi
        places = np.repeat(grid.centres_of(cells), _HEADINGS, axis=0)
        free = np.column_stack((places, np.tile(headings, len(cells))))
        laser = laser_in_base.x, laser_in_base.y
        return cls(signed_distance(grid, REACH), grid.frame, free_squares_of(grid), laser, free)

    def search(self, points: FloatArray, near: Pose2 | None = None) -> ScanMatch | None:
        """Return the only pose that puts the points on the map's walls. If `near` is given, search around it first.

        Returns:
            The match. None if no pose fits, or if another pose fits nearly as well, because places that look the same
            cannot be distinguished.
        """
        if near is not None:
            there = elementary_arrays.hypot(self.free[:, 0] - near.x, self.free[:, 1] - near.y) < NEAR
            found = self._only(points, self.free[there])
            if found is not None:
                return found
        return self._only(points, self.free)

    def _only(self, points: FloatArray, poses: FloatArray) -> ScanMatch | None:
        if len(points) < _FEWEST or len(poses) == 0:
            return None
        shares = _shares(self.field, self.frame, poses, points[:: max(1, len(points) // _FEWEST)])
        # The sort is stable, so that poses with equal shares have the same order on every machine.
        guesses = poses[np.argsort(-shares, kind="stable")[:_REFINED]]
        drawn = [self._drawn(Pose2(x, y, theta), points, _COARSEST) for x, y, theta in guesses.tolist()]
        (here, best), *others = sorted(drawn, key=lambda match: -match[1])
        for there, share in others:
            apart = here.distance(there) > SPACING or abs(wrap_angle(here.theta - there.theta)) > SPACING
            if apart and share > best - _MARGIN:
                return None
        return self.match(here, points, _FINEST) if best >= GOOD else None

    def _drawn(self, guess: Pose2, points: FloatArray, width: float) -> tuple[Pose2, float]:
        """Return the pose near a guess with the most points on the map's walls, and the share of these points."""
        x, y, theta, share = _match(self.field, self.frame, guess.x, guess.y, guess.theta, points, width)
        return Pose2(x, y, theta), share

    def match(self, guess: Pose2, points: FloatArray, error: float) -> ScanMatch | None:
        """Return the pose near `guess` from which the points are on the map's walls.

        Args:
            guess: pose of the base in the map, within some decimeters of the truth.
            points: (m, 2) end points of the beams in the base frame.
            error: maximum displacement of a point by the error of the guess, meters. If it is larger, points on other
                robots also pull the pose more.

        Returns:
            The match. The noise in its information is estimated from the remaining distances. None if there are fewer
            than three points, because they do not determine a pose.

        Source: Kohlbrecher et al., A flexible and scalable SLAM system (2011), section IV: Gauss-Newton on an
            interpolated grid. Differences from the source: this minimizes squared distances to surfaces, with small
            weights for outliers. The last step uses the surfaces that beams meet, see `surface_matching`.
        """
        if len(points) < 3:
            return None
        drawn, share = self._drawn(guess, points, max(_FINEST, min(error, _COARSEST)))
        x, y, theta, information, by_walls, unexplained, degrees = refined(
            self.field,
            self.frame,
            self.squares,
            self.laser,
            (drawn.x, drawn.y, drawn.theta),
            points,
            _FINEST,
            _DAMPING,
        )
        return ScanMatch(Pose2(x, y, theta), information, by_walls, (unexplained, degrees), share)
