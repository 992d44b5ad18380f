"""Calculations with paths over time: correction of odometry, errors, interpolation, pieces, length.

Results are bit-identical on all machines, and so are the tables of a recording.
"""

import math

import numpy as np

from sim.numerics import elementary_arrays
from sim.numerics.float_array import FloatArray

RELOCATED = 0.5
"""Minimum step of the localizer's pose that counts as a jump and not as a correction, meters. No message reports these
jumps."""


def corrected(odometry: FloatArray, recorded: FloatArray, corrections: FloatArray) -> FloatArray:
    """Return (n, 4) time and base in map: each odometry pose with the last correction that was known at its time.

    Odometry poses before the first correction are omitted.

    Args:
        odometry: (o, 4) time, x, y, theta.
        recorded: (o,) times of recording. Corrections have stamps in the future, so only these times show which
            corrections were known.
        corrections: (c, 4) time of recording, x, y, theta of odom in map.
    """
    return _moved(*_with_last(odometry, recorded, corrections))


def relocations(odometry: FloatArray, recorded: FloatArray, corrections: FloatArray) -> FloatArray:
    """Return (k,) times of jumps, at which a new correction moves the pose by more than `RELOCATED`."""
    odometry, correction = _with_last(odometry, recorded, corrections)
    here, stale = _moved(odometry[1:], correction[1:]), _moved(odometry[1:], correction[:-1])
    moved = elementary_arrays.hypot(here[:, 1] - stale[:, 1], here[:, 2] - stale[:, 2])
    times: FloatArray = here[moved > RELOCATED, 0]
    return times


def _with_last(odometry: FloatArray, recorded: FloatArray, corrections: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return odometry poses, and the last correction before each; poses without a correction are omitted."""
    last = np.searchsorted(corrections[:, 0], recorded, side="right") - 1
    return odometry[last >= 0], corrections[last[last >= 0]]


def _moved(odometry: FloatArray, correction: FloatArray) -> FloatArray:
    """Return (n, 4) time, x, y and heading in the map of odometry poses, given a correction for each pose."""
    c, s = elementary_arrays.cos(correction[:, 3]), elementary_arrays.sin(correction[:, 3])
    x = correction[:, 1] + c * odometry[:, 1] - s * odometry[:, 2]
    y = correction[:, 2] + s * odometry[:, 1] + c * odometry[:, 2]
    return np.column_stack((odometry[:, 0], x, y, wrapped(correction[:, 3] + odometry[:, 3])))


def errors(estimate: FloatArray, truth: FloatArray) -> FloatArray:
    """Return (m, 3) time, distance (m) and absolute angle (rad) of estimates from the interpolated truth."""
    if not len(truth):
        return np.empty((0, 3))
    within = estimate[(estimate[:, 0] >= truth[0, 0]) & (estimate[:, 0] <= truth[-1, 0])]
    times = within[:, 0]
    x, y, theta = at_times(truth, times).T
    away = elementary_arrays.hypot(within[:, 1] - x, within[:, 2] - y)
    return np.column_stack((times, away, np.abs(wrapped(within[:, 3] - theta))))


def at_times(path: FloatArray, times: FloatArray) -> FloatArray:
    """Return (n, 3) x, y, theta, interpolated on a path of rows time, x, y, theta; NaN before and after it."""
    if not len(path):
        return np.full((len(times), 3), np.nan)
    columns = (path[:, 1], path[:, 2], np.unwrap(path[:, 3]))
    x, y, theta = (elementary_arrays.interp(times, path[:, 0], column) for column in columns)
    inside = (times >= path[0, 0]) & (times <= path[-1, 0])
    return np.where(inside[:, np.newaxis], np.column_stack((x, y, wrapped(theta))), np.nan)


def wrapped(angles: FloatArray) -> FloatArray:
    """Return angles wrapped to [-pi, pi)."""
    within: FloatArray = (angles + np.pi) % (2.0 * np.pi) - np.pi
    return within


def pieces(path: FloatArray, cuts: FloatArray) -> list[FloatArray]:
    """Return the parts of a path of rows time, x, y, ..., split at the times of jumps."""
    return [piece for piece in np.split(path, np.searchsorted(path[:, 0], cuts)) if len(piece)]


def distance(path: FloatArray, cuts: FloatArray) -> float:
    """Return the total length of the pieces of a path, meters. Its rows are time, x, y, ..."""
    steps = (elementary_arrays.hypot(np.diff(piece[:, 1]), np.diff(piece[:, 2])) for piece in pieces(path, cuts))
    return math.fsum(float(each.sum()) for each in steps)
