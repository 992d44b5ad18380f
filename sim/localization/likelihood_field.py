"""How well a scan fits the map from a place: the likelihood field."""

import math
from dataclasses import dataclass, replace

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim.geometry import FloatArray
from sim.grid import FREE, OCCUPIED, GridFrame, OccupancyGrid, cell_of, distance_field
from sim.observations import LaserMount, Scan

INDEPENDENT_BEAMS = 6
"""Beams that together tell as much as all of them do.

Neighbouring beams end on the same wall and share the map's errors: their likelihoods multiplied would make the filter
far surer than it is right. Measured: with 60 beams counting as 6 the reported covariance covers the true error.

Source: Probabilistic Robotics, section 6.3.4, on weakening the likelihood by an exponent below 1.
"""


def signed_distance(grid: OccupancyGrid, max_distance: float) -> FloatArray:
    """Metres from each cell's centre to the nearest surface of a wall, negative inside walls.

    A laser sees surfaces. A field that is 0 throughout the walls, as amcl's, lets every beam sink into them for free,
    and a robot that sees nothing behind itself then believes to be centimetres farther on than it is.

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
def _sum_over_points(
    table: NDArray[np.float32], frame: GridFrame, outside: float, particles: FloatArray, points: FloatArray
) -> FloatArray:
    """(n,) sums of the table's values at (m, 2) points, as seen from each of (n, 3) poses."""
    rows, cols = table.shape
    out = np.empty(particles.shape[0])
    for i in range(particles.shape[0]):
        # In one piece and in cells: this loop is where the filter's time goes.
        dx, dy = particles[i, 0] - frame.x, particles[i, 1] - frame.y
        c, s = math.cos(particles[i, 2]), math.sin(particles[i, 2])
        along = (frame.cos * dx + frame.sin * dy) / frame.resolution
        across = (frame.cos * dy - frame.sin * dx) / frame.resolution
        cos = (c * frame.cos + s * frame.sin) / frame.resolution
        sin = (s * frame.cos - c * frame.sin) / frame.resolution
        total = 0.0
        for j in range(points.shape[0]):
            col = along + cos * points[j, 0] - sin * points[j, 1]
            row = across + sin * points[j, 0] + cos * points[j, 1]
            if 0.0 <= col < cols and 0.0 <= row < rows:
                total += table[int(row), int(col)]
            else:
                total += outside
        out[i] = total
    return out


@njit(cache=True)
def _shares_above(
    table: NDArray[np.float32], frame: GridFrame, limit: float, particles: FloatArray, points: FloatArray
) -> FloatArray:
    """(m,) of the (n, 3) poses, the share from which each of (m, 2) points falls where the table exceeds a limit."""
    rows, cols = table.shape
    out = np.zeros(points.shape[0])
    for i in range(particles.shape[0]):
        c, s = math.cos(particles[i, 2]), math.sin(particles[i, 2])
        for j in range(points.shape[0]):
            x = particles[i, 0] + c * points[j, 0] - s * points[j, 1]
            y = particles[i, 1] + s * points[j, 0] + c * points[j, 1]
            row, col = cell_of(frame, x, y)
            if 0 <= row < rows and 0 <= col < cols and table[row, col] > limit:
                out[j] += 1.0
    out /= particles.shape[0]
    return out


@njit(cache=True)
def _end_points(
    ranges: NDArray[np.float32],
    beams: NDArray[np.int64],
    directions: FloatArray,
    x: float,
    y: float,
    range_min: float,
    range_max: float,
) -> FloatArray:
    out = np.empty((beams.size, 2))
    count = 0
    for i in range(beams.size):
        distance = ranges[beams[i]]
        # A comparison with NaN is false: lost beams fall through with the too short and the endless ones.
        if range_min < distance < range_max:
            out[count, 0] = x + distance * directions[i, 0]
            out[count, 1] = y + distance * directions[i, 1]
            count += 1
    return out[:count]


@dataclass(frozen=True, slots=True, eq=False)
class Beams:
    """The beams of a laser that are weighed, and where their ends lie.

    Attributes:
        mount: the laser.
        indices: (m,) which beams, evenly spread over the scan, both outermost among them.
        directions: (m, 2) unit vectors in the base frame.
        range_min: metres; readings at or below it say nothing.
        range_max: metres; readings at or beyond it say nothing.
    """

    mount: LaserMount
    indices: NDArray[np.int64]
    directions: FloatArray
    range_min: float
    range_max: float

    @classmethod
    def of(cls, mount: LaserMount, max_beams: int, max_range: float, min_range: float = -1.0) -> "Beams":
        """At most `max_beams` beams (at least two); a negative `max_range` or `min_range` leaves the laser its own.

        Differs: takes exactly as many as asked, where amcl's whole-numbered step takes up to one more.
        """
        count = max(2, min(max_beams, mount.beams))
        indices = np.arange(count) * (mount.beams - 1) // (count - 1)
        angles = mount.angles()[indices] + mount.laser_in_base.theta
        directions = np.stack((np.cos(angles), np.sin(angles)), axis=1)
        range_max = min(max_range, mount.range_max) if max_range > 0.0 else mount.range_max
        range_min = max(min_range, mount.range_min)
        return cls(mount, indices, directions, range_min, range_max)

    def end_points(self, scan: Scan) -> FloatArray:
        """(m, 2) points of the base frame where the readings that mean something ended; metres.

        NaN, infinite, too short (at most `range_min`) and too long (`range_max` and more) readings are left out.
        """
        laser = self.mount.laser_in_base
        points: FloatArray = _end_points(
            scan.ranges, self.indices, self.directions, laser.x, laser.y, self.range_min, self.range_max
        )
        return points

    def ranges(self, scan: Scan) -> FloatArray:
        """(m,) metres along every beam; `range_max` where it saw nothing, NaN where it is lost or too short."""
        ranges = scan.ranges[self.indices].astype(np.float64)
        ranges[ranges <= self.range_min] = np.nan
        return np.minimum(ranges, self.range_max)


def _log_probability(distance: FloatArray, z_hit: float, rand_density: float, sigma_hit: float) -> FloatArray:
    hit = z_hit * np.exp(-(distance**2) / (2.0 * sigma_hit**2))
    # Without random readings a far cell's probability underflows; its logarithm must stay finite.
    logs: FloatArray = np.log(np.maximum(hit + rand_density, np.finfo(np.float64).tiny))
    return logs


@dataclass(frozen=True, slots=True, eq=False)
class LikelihoodField:
    """How likely a beam is to end in each cell of the map.

    Attributes:
        table: (rows, cols) float32, log of `z_hit * exp(-d^2 / (2 sigma_hit^2)) + z_rand / range_max`, d being the
            distance to the nearest surface of a wall, capped at `max_dist`.
        frame: where the table lies.
        outside: what the table would say beyond the map's edge.
        exponent: what each beam's logarithm counts.
        noise: z_hit, z_rand / range_max and sigma_hit.
    """

    table: NDArray[np.float32]
    frame: GridFrame
    outside: float
    exponent: float
    noise: tuple[float, float, float]

    @classmethod
    def of(
        cls, grid: OccupancyGrid, beams: Beams, z_hit: float, z_rand: float, sigma_hit: float, max_dist: float
    ) -> "LikelihoodField":
        """The field of a map under a mixture of good and random readings.

        Args:
            grid: the map.
            beams: the beams that will be weighed.
            z_hit: weight of readings that end on what the map shows.
            z_rand: weight of readings that end anywhere up to the beams' greatest range.
            sigma_hit: standard deviation of the good readings, metres.
            max_dist: distances are capped here, metres; also the distance of everything outside the map.

        Source: Probabilistic Robotics, table 6.3, without its constant factor (as amcl).
        Differs: measures to surfaces (see `signed_distance`), where table and amcl measure to occupied cells.
        """
        noise = z_hit, z_rand / beams.range_max, sigma_hit
        table = _log_probability(signed_distance(grid, max_dist), *noise).astype(np.float32)
        table.setflags(write=False)
        outside = float(_log_probability(np.array([max_dist]), *noise)[0])
        return cls(table, grid.frame, outside, min(1.0, INDEPENDENT_BEAMS / beams.indices.size), noise)

    def log_likelihood(self, particles: FloatArray, points: FloatArray) -> FloatArray:
        """Log likelihood of a scan from each of several places.

        Args:
            particles: (n, 3) base poses in the map.
            points: (m, 2) end points of the beams in the base frame, see `Beams.end_points`.

        Returns:
            (n,) weakened sums over the beams; 0 where no beam says anything.

        Source: Probabilistic Robotics, table 6.3, weakened as section 6.3.4 has it. Differs: ROS 1 amcl adds cubes,
            `1 + sum(p^3)`; measured, that leaves the heading half as sure.
        """
        sums: FloatArray = _sum_over_points(self.table, self.frame, self.outside, particles, points)
        sums *= self.exponent
        return sums

    def explained(
        self, particles: FloatArray, points: FloatArray, distance: float, threshold: float, error_threshold: float
    ) -> FloatArray:
        """The points of a scan that enough particles can explain: amcl's beam skipping.

        Args:
            particles: (n, 3) base poses in the map that agree on where the robot is.
            points: (m, 2) end points of the beams in the base frame.
            distance: a point this near a wall is explained, metres.
            threshold: share of the particles that must explain it.
            error_threshold: share of unexplained points from which on the particles are to blame: all points stay.

        Returns:
            (k, 2), k <= m.
        """
        limit = _log_probability(np.array([distance]), *self.noise)[0]
        kept = _shares_above(self.table, self.frame, float(limit), particles, points) > threshold
        if np.count_nonzero(~kept) >= error_threshold * len(points):
            return points
        some: FloatArray = points[kept]
        return some
