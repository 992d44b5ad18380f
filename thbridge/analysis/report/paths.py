"""Calculations with paths over time: correction of odometry, errors, interpolation, length."""

from array import array

import numpy as np

from sim.common.geometry import FloatArray


def table(series: "array[float]", columns: int) -> FloatArray:
    """(n, columns) table of numbers that are stored row by row; n may be 0."""
    return np.array(series, dtype=np.float64).reshape(-1, columns)


def corrected(odometry: FloatArray, corrections: FloatArray) -> FloatArray:
    """(n, 4) time and base in map: odometry poses, each with the last correction before it; others are left out."""
    last = np.searchsorted(corrections[:, 0], odometry[:, 0], side="right") - 1
    odometry, correction = odometry[last >= 0], corrections[last[last >= 0]]
    c, s = np.cos(correction[:, 3]), np.sin(correction[:, 3])
    x = correction[:, 1] + c * odometry[:, 1] - s * odometry[:, 2]
    y = correction[:, 2] + s * odometry[:, 1] + c * odometry[:, 2]
    return np.column_stack((odometry[:, 0], x, y, wrapped(correction[:, 3] + odometry[:, 3])))


def errors(estimate: FloatArray, truth: FloatArray) -> FloatArray:
    """(m, 3) time, distance (m) and absolute angle (rad) of estimates from the truth, which is interpolated."""
    if not len(truth):
        return np.empty((0, 3))
    within = estimate[(estimate[:, 0] >= truth[0, 0]) & (estimate[:, 0] <= truth[-1, 0])]
    times = within[:, 0]
    x, y, theta = at_times(truth, times).T
    return np.column_stack((times, np.hypot(within[:, 1] - x, within[:, 2] - y), np.abs(wrapped(within[:, 3] - theta))))


def at_times(path: FloatArray, times: FloatArray) -> FloatArray:
    """(n, 3) x, y, theta, interpolated on a path of rows time, x, y, theta; NaN before and after it."""
    if not len(path):
        return np.full((len(times), 3), np.nan)
    columns = (path[:, 1], path[:, 2], np.unwrap(path[:, 3]))
    x, y, theta = (np.interp(times, path[:, 0], column, left=np.nan, right=np.nan) for column in columns)
    return np.column_stack((x, y, wrapped(theta)))


def wrapped(angles: FloatArray) -> FloatArray:
    """Angles wrapped to [-pi, pi)."""
    within: FloatArray = (angles + np.pi) % (2.0 * np.pi) - np.pi
    return within


def distance(path: FloatArray) -> float:
    """Metres along a path of rows time, x, y, ..."""
    return float(np.hypot(np.diff(path[:, 1]), np.diff(path[:, 2])).sum())
