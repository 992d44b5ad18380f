"""Refinement of a matched pose by the surfaces that its beams meet, and its uncertainty.

A field of distances to the nearest surface pulls points deep inside a thin wall to the wall's far side. So the error of
a match grows with the noise of the laser. Here each beam is cast through the map, and its point is compared with the
surface that the beam meets: point-to-line matching (Censi 2008). It converges only from nearby, so it is the last step
of a match.
"""

import math

import numpy as np

from sim.common.grid import GridFrame
from sim.common.raycast import FreeSquares, cast_beams
from sim.numerics import elementary
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.numerics.matrices import damped_solution, solution
from sim.robot.localization.bilinear import interpolate

_STEPS = 3
"""Number of Gauss-Newton steps. Each step casts the beams again."""
_BEFORE = 0.01
"""Distance in front of a surface where its normal is measured, meters. On the surface itself the field has a crease."""
_FLATTEST = 0.3
"""Minimum slope of the field that shows the direction of a surface, meters per meter. At an inner corner it is less."""
_LEAST_DEVIATION = 0.002
"""Minimum standard deviation of points, meters."""
_MOST_LEVERAGE = 0.9
"""Maximum leverage of a point. If a point determines the pose almost alone, its residual does not show its error."""
_NEAR_A_SURFACE = 0.25
"""A point counts as being on a surface of the map if its weight is above this."""
_SAME_WALL = (0.95, 0.1)
"""Limits for neighboring points of one wall: minimum cosine between normals, maximum distance of planes, meters."""


@njit(cache=True)
def _weight(distance: float, width: float) -> float:
    """Return Geman and McClure's weight."""
    u = (distance / width) ** 2
    return 1.0 / (1.0 + u) ** 2


@njit(cache=True)
def _surfaces(
    field: FloatArray,
    frame: GridFrame,
    squares: FreeSquares,
    laser: tuple[float, float],
    pose: tuple[float, float, float],
    points: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return (m, 3) slopes of the distances, (m,) distances and (m,) offsets, for each point and its beam's surface.

    Distances are negative behind the surface. An offset is the distance of the surface's plane from the base, along the
    surface's normal. All three are 0 for a beam that meets no surface.
    """
    m = points.shape[0]
    slopes, distances, offsets = np.zeros((m, 3)), np.zeros(m), np.zeros(m)
    measured, directions = np.empty(m), np.empty((m, 2))
    for j in range(m):
        ahead, left = points[j, 0] - laser[0], points[j, 1] - laser[1]
        measured[j] = max(elementary.hypot(ahead, left), 1e-9)
        directions[j, 0], directions[j, 1] = ahead / measured[j], left / measured[j]
    c, s = elementary.cos_sin(pose[2])
    sensor = np.array([[pose[0] + c * laser[0] - s * laser[1], pose[1] + s * laser[0] + c * laser[1], pose[2]]])
    ranges = np.empty((1, m))
    cast_beams(squares, frame, sensor, directions, measured.max() + 1.0, ranges)
    for j in range(m):
        if not math.isfinite(ranges[0, j]):
            continue
        along_x = c * directions[j, 0] - s * directions[j, 1]
        along_y = s * directions[j, 0] + c * directions[j, 1]
        # First the position of the surface relative to the base, then its position in cells of the grid.
        px = sensor[0, 0] + ranges[0, j] * along_x - pose[0]
        py = sensor[0, 1] + ranges[0, j] * along_y - pose[1]
        dx = pose[0] + px - _BEFORE * along_x - frame.x
        dy = pose[1] + py - _BEFORE * along_y - frame.y
        _, by_col, by_row = interpolate(
            field,
            (frame.cos * dx + frame.sin * dy) / frame.resolution,
            (frame.cos * dy - frame.sin * dx) / frame.resolution,
        )
        slope = elementary.hypot(by_col, by_row)
        if slope < _FLATTEST * frame.resolution:
            continue
        normal_x = (frame.cos * by_col - frame.sin * by_row) / slope
        normal_y = (frame.sin * by_col + frame.cos * by_row) / slope
        slopes[j, 0], slopes[j, 1], slopes[j, 2] = normal_x, normal_y, normal_y * px - normal_x * py
        distances[j] = (measured[j] - ranges[0, j]) * (normal_x * along_x + normal_y * along_y)
        offsets[j] = normal_x * px + normal_y * py
    return slopes, distances, offsets


@njit(cache=True)
def refined(
    field: FloatArray,
    frame: GridFrame,
    squares: FreeSquares,
    laser: tuple[float, float],
    pose: tuple[float, float, float],
    points: FloatArray,
    width: float,
    damping: float,
) -> tuple[float, float, float, FloatArray, FloatArray, float, float]:
    """Return the pose at which points are on the surfaces that their beams meet.

    Args:
        field: (rows, cols) signed meters to the nearest surface, see `scan_matching.signed_distance`.
        frame: frame of the field in the map.
        squares: the map's strides, see `raycast.free_squares_of`.
        laser: x and y in the base frame, meters.
        pose: x, y, theta of the base in the map, within a few centimeters of the truth.
        points: (m, 2) end points of the beams in the base frame.
        width: distance from a surface above which points begin to count as unmapped things, meters.
        damping: part of the information's mean that is added to its diagonal.

    Returns:
        x, y and theta. Their (3, 3) information, which is the inverse of their covariance if the map is right. The
        results of `_walls`, which show the errors of the map.

    Source: Huber, The behavior of maximum likelihood estimates under nonstandard conditions (1967), for a covariance
        that estimates the points' noise from their residuals, for any distribution; MacKinnon and White (1985), HC3,
        for few points.
    """
    x, y, theta = pose
    for _ in range(_STEPS):
        slopes, distances, _ = _surfaces(field, frame, squares, laser, (x, y, theta), points)
        matrix, right = np.zeros((3, 3)), np.zeros((3, 1))
        for j in range(points.shape[0]):
            weight = _weight(distances[j], width)
            for a in range(3):
                right[a, 0] -= weight * slopes[j, a] * distances[j]
                for b in range(3):
                    matrix[a, b] += weight * slopes[j, a] * slopes[j, b]
        step = damped_solution(matrix, right, damping)
        x += step[0, 0]
        y += step[1, 0]
        theta += step[2, 0]
    slopes, distances, offsets = _surfaces(field, frame, squares, laser, (x, y, theta), points)
    information = _information(slopes, distances, width)
    by_walls, unexplained, degrees = _walls(slopes, distances, offsets, width)
    return x, y, wrap_angle(theta), information, by_walls, unexplained, degrees


@njit(cache=True)
def _information(slopes: FloatArray, distances: FloatArray, width: float) -> FloatArray:
    """Return the (3, 3) information of a pose. See `refined`."""
    m = distances.shape[0]
    hessian, scatter = np.zeros((3, 3)), np.zeros((3, 3))
    curvatures = np.empty(m)
    for j in range(m):
        # Second derivative of Geman and McClure's loss. It is negative for distant points.
        u = (distances[j] / width) ** 2
        curvatures[j] = (1.0 - 3.0 * u) / (1.0 + u) ** 3
        for a in range(3):
            for b in range(3):
                hessian[a, b] += curvatures[j] * slopes[j, a] * slopes[j, b]
    # A small number on the diagonal keeps the solution finite in directions that the scan does not determine.
    regular = hessian.copy()
    for a in range(3):
        regular[a, a] += 1e-3
    spread = solution(regular, np.ascontiguousarray(slopes.T))
    for j in range(m):
        leverage = 0.0
        for a in range(3):
            leverage += curvatures[j] * slopes[j, a] * spread[a, j]
        # HC3 divides a residual by 1 - leverage. Otherwise the residual would be too small, because a point pulls the
        # pose toward itself.
        leverage = min(max(leverage, 0.0), _MOST_LEVERAGE)
        weight = _weight(distances[j], width)
        score = weight * distances[j] / (1.0 - leverage)
        least = weight * _LEAST_DEVIATION
        for a in range(3):
            for b in range(3):
                scatter[a, b] += (score * score + least * least) * slopes[j, a] * slopes[j, b]
    for a in range(3):
        scatter[a, a] += 1e-9
    information = np.zeros((3, 3))
    # Sandwich formula: the information is hessian scatter^-1 hessian.
    half = solution(scatter, hessian)
    for a in range(3):
        for b in range(3):
            for k in range(3):
                information[a, b] += hessian[a, k] * half[k, b]
    return information


@njit(cache=True)
def _walls(
    slopes: FloatArray, distances: FloatArray, offsets: FloatArray, width: float
) -> tuple[FloatArray, float, float]:
    """Estimate from one scan the position errors of the map's walls, and their effect on the pose.

    Neighboring points of a wall share its error. The fitted pose absorbs part of such errors, so only the remaining
    distances show them: the part of a wall's mean distance that the noise of its points does not explain.

    Returns:
        (3, 3) covariance of the pose if the walls' positions had a standard deviation of one meter. The sum of squared
        errors of the walls, in m^2. The expected sum for this standard deviation. The ratio of the last two, over
        many scans, is the variance of the walls' positions.

    Source: Henderson, Estimation of variance and covariance components (1953), method 3, for the variance of a random
        effect (here the walls) from the sums of squares that remain after a fit.
    """
    m = distances.shape[0]
    matrix, pulls, means = np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((3, 3))
    walls, between, within, total = 0, 0.0, 0.0, 0.0
    j = 0
    while j < m:
        weight = _weight(distances[j], width)
        if weight < _NEAR_A_SURFACE or not slopes[j].any():
            j += 1
            continue
        pull, weights, off, square = np.zeros(3), 0.0, 0.0, 0.0
        last = j
        while True:
            weight = _weight(distances[j], width)
            weights += weight
            off += weight * distances[j]
            square += weight * distances[j] * distances[j]
            for a in range(3):
                pull[a] += weight * slopes[j, a]
                for b in range(3):
                    matrix[a, b] += weight * slopes[j, a] * slopes[j, b]
            last = j
            j += 1
            if j == m or _weight(distances[j], width) < _NEAR_A_SURFACE or not slopes[j].any():
                break
            cosine = slopes[j, 0] * slopes[last, 0] + slopes[j, 1] * slopes[last, 1]
            if cosine < _SAME_WALL[0] or abs(offsets[j] - offsets[last]) > _SAME_WALL[1]:
                break
        walls += 1
        total += weights
        between += off * off / weights
        within += square - off * off / weights
        for a in range(3):
            for b in range(3):
                pulls[a, b] += pull[a] * pull[b]
                means[a, b] += pull[a] * pull[b] / weights
    for a in range(3):
        matrix[a, a] += 1e-3
    spread, absorbed = solution(matrix, pulls), solution(matrix, means)
    covariance = solution(matrix, np.ascontiguousarray(spread.T))
    # Between-wall sum of squares minus the part expected from point noise, with the fit's degrees of freedom removed.
    noise = within / max(total - walls, 1.0)
    free = walls - (absorbed[0, 0] + absorbed[1, 1] + absorbed[2, 2])
    degrees = total - (spread[0, 0] + spread[1, 1] + spread[2, 2])
    return covariance, between - noise * free, degrees
