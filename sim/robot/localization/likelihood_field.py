"""The likelihood field: how well a scan fits the map from a pose, by the distances of its end points to walls."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sim.common.distance_fields import BAND, nearest_cells
from sim.common.grid import OCCUPIED, GridFrame, OccupancyGrid
from sim.common.observations import LaserMount, Scan
from sim.numerics import elementary, elementary_arrays
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit


def facing_distance(grid: OccupancyGrid, max_distance: float) -> NDArray[np.float32]:
    """Return the capped meters from each cell's center to the nearest surface that beams of one quadrant can meet.

    A laser sees the near side of walls. In a field of distances to the nearest wall, as in amcl, it makes no difference
    whether a beam ends in front of a wall or behind it. With thin walls, the estimate of a robot that sees nothing
    behind itself may then be too far ahead by the walls' thickness. In this field the far side of a wall does not
    exist.

    Returns:
        (4, rows, cols) for beams of quadrant 0 (to lower columns and rows), 1 (higher columns and lower rows), 2 (lower
        columns and higher rows), 3 (higher columns and rows).
    """
    levels, level = facing_levels(grid, max_distance)
    return levels[level]


def facing_levels(
    grid: OccupancyGrid, max_distance: float
) -> tuple[NDArray[np.float32], NDArray[np.uint16 | np.uint32]]:
    """Return the (n,) different distances of `facing_distance`, and (4, rows, cols) their index for each cell.

    Only few different distances occur, so indices need at most half the memory.
    """
    occupied = grid.cells == OCCUPIED
    row, col = np.indices(occupied.shape, sparse=True)
    # The surface of a wall is up to half a cell nearer or farther than the center of its outermost cell. So the reach
    # is half a cell more than the maximum distance.
    reach = math.ceil(max_distance / grid.resolution + 0.5)
    squares = np.unique(np.arange(reach + 1)[:, np.newaxis] ** 2 + np.arange(reach + 1) ** 2)  # of integers
    squares = squares[squares <= reach**2]  # of integers
    cells_away = np.abs(np.sqrt(squares)[:, np.newaxis] + 0.5 * np.array([-1, 0, 1]))
    cells_away[0] = 0.5
    capped = np.minimum(cells_away * grid.resolution, max_distance).ravel()
    levels = np.append(capped, max_distance).astype(np.float32)
    number = np.full(reach**2 + 2, len(capped), dtype=np.min_scalar_type(max(len(capped), 256)))  # of integers
    number[squares] = 3 * np.arange(len(squares)) + 1
    level = np.full((4, *occupied.shape), len(capped), dtype=number.dtype)
    for quadrant in range(4):
        col_step = 1 if quadrant & 1 else -1
        row_step = 1 if quadrant & 2 else -1
        # A beam of this quadrant can enter a cell only if one of the two cells before it is free.
        met = occupied & ~(_shifted(occupied, 0, col_step) & _shifted(occupied, row_step, 0))
        if not met.any():
            continue
        near_row, near_col = nearest_cells(met)
        for begin in range(0, grid.rows, BAND):
            band = slice(begin, begin + BAND)
            rows, cols = row[band] - near_row[band], col - near_col[band]
            away = np.minimum(rows**2 + cols**2, reach**2 + 1)  # of integers
            behind = np.sign(rows * row_step + cols * col_step)
            # Cells beyond the reach have the maximum distance.
            level[quadrant, band] = np.where(away <= reach**2, number[away] + behind, len(capped))  # of integers
    return levels, level


def _shifted(mask: NDArray[np.bool_], rows: int, cols: int) -> NDArray[np.bool_]:
    """Shift a mask by rows and columns. New cells at the edge are False."""
    padded = np.pad(mask, 1)
    moved: NDArray[np.bool_] = padded[1 - rows : padded.shape[0] - 1 - rows, 1 - cols : padded.shape[1] - 1 - cols]
    return moved


@lru_cache(maxsize=8)
def _table(
    grid: OccupancyGrid, max_distance: float, z_hit: float, random: float, sigma_hit: float
) -> tuple[NDArray[np.float32], NDArray[np.uint16 | np.uint32]]:
    """Return the (n,) log probabilities of readings by distance, and for each cell their (4, rows, cols) indices.

    The arrays are read-only, because a map never changes and all robots on it with the same laser share them. See
    `facing_levels`.
    """
    levels, level = facing_levels(grid, max_distance)
    values = _log_probability(levels, z_hit, random, sigma_hit).astype(np.float32)
    values.setflags(write=False)
    level.setflags(write=False)
    return values, level


@njit(cache=True)
def _sum_over_points(
    values: NDArray[np.float32],
    level: NDArray[np.uint16 | np.uint32],
    frame: GridFrame,
    outside: float,
    laser: tuple[float, float],
    particles: FloatArray,
    points: FloatArray,
) -> FloatArray:
    """Return (n,) sums of the field's values at (m, 2) points, as seen from each of (n, 3) poses.

    This loop takes most of the filter's time. So it is a single function that computes in cells. It has no branch for
    the quadrant, because processors could not predict it, and no index that might be negative. This makes it four times
    as fast.
    """
    _, rows, cols = level.shape
    levels = level.reshape(-1)
    out = np.empty(particles.shape[0])
    for i in range(particles.shape[0]):
        dx, dy = particles[i, 0] - frame.x, particles[i, 1] - frame.y
        c, s = elementary.cos_sin(particles[i, 2])
        base_col = (frame.cos * dx + frame.sin * dy) / frame.resolution
        base_row = (frame.cos * dy - frame.sin * dx) / frame.resolution
        cos = (c * frame.cos + s * frame.sin) / frame.resolution
        sin = (s * frame.cos - c * frame.sin) / frame.resolution
        laser_right, laser_up = cos * laser[0] - sin * laser[1], sin * laser[0] + cos * laser[1]
        total = 0.0
        for j in range(points.shape[0]):
            right = cos * points[j, 0] - sin * points[j, 1]
            up = sin * points[j, 0] + cos * points[j, 1]
            col, row = base_col + right, base_row + up
            if 0.0 <= col < cols and 0.0 <= row < rows:
                quadrant = np.int64(right > laser_right) + 2 * np.int64(up > laser_up)
                total += values[levels[np.uint32((quadrant * rows + int(row)) * cols + int(col))]]
            else:
                total += outside
        out[i] = total
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
        # Comparisons with NaN are false. So lost beams are excluded, like ranges that are too short or infinite.
        if range_min < distance < range_max:
            out[count, 0] = x + distance * directions[i, 0]
            out[count, 1] = y + distance * directions[i, 1]
            count += 1
    return out[:count]


@dataclass(frozen=True, slots=True, eq=False)
class Beams:
    """The beams of a laser that a filter uses, and their end points.

    Attributes:
        mount: the laser.
        indices: (m,) indices of the beams, evenly spread over the scan, including both outermost beams.
        directions: (m, 2) unit vectors in the base frame.
        range_min: readings up to this range are ignored, meters.
        range_max: readings from this range on are ignored, meters.
    """

    mount: LaserMount
    indices: NDArray[np.int64]
    directions: FloatArray
    range_min: float
    range_max: float

    @classmethod
    def of(cls, mount: LaserMount, max_beams: int, max_range: float, min_range: float = -1.0) -> "Beams":
        """Select at most `max_beams` beams (at least two). A negative limit is replaced by the laser's own limit.

        Difference from ROS: at most the requested number is selected, while amcl's integer step selects up to one more.
        """
        count = max(2, min(max_beams, mount.beams))
        indices = np.arange(count) * (mount.beams - 1) // (count - 1)
        angles = mount.angles()[indices] + mount.laser_in_base.theta
        directions = np.stack((elementary_arrays.cos(angles), elementary_arrays.sin(angles)), axis=1)
        range_max = min(max_range, mount.range_max) if max_range > 0.0 else mount.range_max
        range_min = max(min_range, mount.range_min)
        return cls(mount, indices, directions, range_min, range_max)

    def end_points(self, scan: Scan) -> FloatArray:
        """Return (m, 2) end points of valid readings in the base frame, meters.

        Readings that are NaN, infinite, too short (up to `range_min`) or too long (from `range_max`) are ignored.
        """
        laser = self.mount.laser_in_base
        return _end_points(scan.ranges, self.indices, self.directions, laser.x, laser.y, self.range_min, self.range_max)

    def ranges(self, scan: Scan) -> FloatArray:
        """Return (m,) ranges of all beams, meters: `range_max` if a beam saw nothing, NaN if lost or too short."""
        ranges = scan.ranges[self.indices].astype(np.float64)
        ranges[ranges <= self.range_min] = np.nan
        return np.minimum(ranges, self.range_max)


def _log_probability(
    distance: FloatArray | NDArray[np.float32], z_hit: float, rand_density: float, sigma_hit: float
) -> FloatArray:
    hit = z_hit * elementary_arrays.exp(-(distance * distance) / (2.0 * (sigma_hit * sigma_hit)))
    # Without random readings, the probability in a distant cell may underflow to 0, but its logarithm must stay finite.
    logs: FloatArray = elementary_arrays.log(np.maximum(hit + rand_density, np.finfo(np.float64).tiny))
    return logs


@dataclass(frozen=True, slots=True, eq=False)
class LikelihoodField:
    """Log probability that a beam ends in each cell of the map.

    Attributes:
        values: (n,) log of `z_hit * exp(-d^2 / (2 sigma_hit^2)) + z_rand / range_max`. d is the distance to the nearest
            surface that faces the beam, capped at `max_dist`.
        frame: frame of the table in the map.
        outside: value for points outside the map.
        laser: x and y of the laser in the base frame, meters.
        noise: z_hit, z_rand / range_max and sigma_hit.
    """

    values: NDArray[np.float32]
    level: NDArray[np.uint16 | np.uint32]
    frame: GridFrame
    outside: float
    laser: tuple[float, float]
    noise: tuple[float, float, float]

    @classmethod
    def of(
        cls, grid: OccupancyGrid, beams: Beams, z_hit: float, z_rand: float, sigma_hit: float, max_dist: float
    ) -> "LikelihoodField":
        """Return the field of a map for a mixture of good and random readings.

        Args:
            grid: the map.
            beams: the beams that will be used.
            z_hit: weight of readings that end on something that the map shows.
            z_rand: weight of readings that end anywhere up to the beams' maximum range.
            sigma_hit: standard deviation of good readings, meters.
            max_dist: cap of the distances, and distance of everything outside the map, meters.

        Source: Probabilistic Robotics, table 6.3, without its constant factor (as in amcl).
        Difference from the source: distances are to surfaces that face the beam. In the table and in amcl, they are to
        occupied cells.
        """
        noise = z_hit, z_rand / beams.range_max, sigma_hit
        values, level = _table(grid, max_dist, *noise)
        outside = float(_log_probability(np.array([max_dist]), *noise)[0])
        laser = beams.mount.laser_in_base.x, beams.mount.laser_in_base.y
        return cls(values, level, grid.frame, outside, laser, noise)

    def log_likelihood(self, particles: FloatArray, points: FloatArray) -> FloatArray:
        """Return the log likelihood of a scan from each of several poses.

        Args:
            particles: (n, 3) base poses in the map.
            points: (m, 2) end points of the beams in the base frame, see `Beams.end_points`.

        Returns:
            (n,) sums over the beams, or 0 without points.

        Source: Probabilistic Robotics, table 6.3. Difference from the source: ROS 1 amcl adds cubes, `1 + sum(p^3)`.
        """
        return _sum_over_points(self.values, self.level, self.frame, self.outside, self.laser, particles, points)

    def explained(
        self, particles: FloatArray, points: FloatArray, distance: float, threshold: float, error_threshold: float
    ) -> FloatArray:
        """Return the points of a scan that enough particles explain: amcl's beam skipping.

        Args:
            particles: (n, 3) base poses in the map, all near one pose.
            points: (m, 2) end points of the beams in the base frame.
            distance: a point within this distance of a wall is explained, meters.
            threshold: share of the particles that must explain a point.
            error_threshold: if a larger share of points is not explained, the particles are considered wrong, and all
                points are returned.

        Returns:
            (k, 2), k <= m.
        """
        limit = _log_probability(np.array([distance]), *self.noise)[0]
        seen = [self.log_likelihood(particles, points[j : j + 1]) > limit for j in range(len(points))]
        kept = np.mean(np.array(seen).reshape(len(points), -1), axis=1) > threshold
        if np.count_nonzero(~kept) >= error_threshold * len(points):
            return points
        some: FloatArray = points[kept]
        return some
