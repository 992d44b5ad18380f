"""Paths over time: what is believed against what is true."""

import numpy as np

from sim.geometry import FloatArray


def table(rows: list[tuple[float, ...]], columns: int) -> FloatArray:
    """(n, columns) of rows, also when there are none."""
    return np.array(rows, dtype=np.float64).reshape(-1, columns)


def corrected(odometry: FloatArray, corrections: FloatArray) -> FloatArray:
    """(n, 4) base in map: each odometry pose under the last correction up to its time; earlier ones are left out."""
    last = np.searchsorted(corrections[:, 0], odometry[:, 0], side="right") - 1
    odometry, correction = odometry[last >= 0], corrections[last[last >= 0]]
    c, s = np.cos(correction[:, 3]), np.sin(correction[:, 3])
    x = correction[:, 1] + c * odometry[:, 1] - s * odometry[:, 2]
    y = correction[:, 2] + s * odometry[:, 1] + c * odometry[:, 2]
    return np.column_stack((odometry[:, 0], x, y, wrapped(correction[:, 3] + odometry[:, 3])))


def errors(estimate: FloatArray, truth: FloatArray) -> FloatArray:
    """(m, 3) of the estimates within the truth's time, against the truth between its samples."""
    if not len(truth):
        return np.empty((0, 3))
    within = estimate[(estimate[:, 0] >= truth[0, 0]) & (estimate[:, 0] <= truth[-1, 0])]
    times = within[:, 0]
    x, y = np.interp(times, truth[:, 0], truth[:, 1]), np.interp(times, truth[:, 0], truth[:, 2])
    theta = np.interp(times, truth[:, 0], np.unwrap(truth[:, 3]))
    return np.column_stack((times, np.hypot(within[:, 1] - x, within[:, 2] - y), np.abs(wrapped(within[:, 3] - theta))))


def wrapped(angles: FloatArray) -> FloatArray:
    """Angles in [-pi, pi)."""
    within: FloatArray = (angles + np.pi) % (2.0 * np.pi) - np.pi
    return within


def distance(path: FloatArray) -> float:
    """Metres along a path of rows time, x, y, ..."""
    return float(np.hypot(np.diff(path[:, 1]), np.diff(path[:, 2])).sum())
