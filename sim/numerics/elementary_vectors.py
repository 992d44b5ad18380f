"""Functions of `sim.numerics.elementary` for arrays in programs without the compiler: the same formulas, by numpy.

numpy applies one operation to all numbers at once and rounds each result as IEEE 754 requires. It does not contract
operations, so the results have the same bits as in plain code. Numbers that need a rare branch of a formula are passed
to plain code.
"""

from collections.abc import Iterator

import numpy as np

from sim.numerics import elementary
from sim.numerics.elementary_tables import ARCTANGENTS, RIGHT_ANGLE, STRAIGHT_ANGLE, TURNS
from sim.numerics.float_array import FloatArray

BLOCK = 4096
"""Number of elements per block. A block with all intermediate results stays in the processor's cache."""
_SMALLEST, _GREATEST = 2.0**-400, 2.0**400


def to_cos(values: FloatArray) -> None:
    """Replace (n,) angles in radians with their cosines."""
    for block in _blocks(values):
        block[:] = _cos(block)


def to_sin(values: FloatArray) -> None:
    """Replace (n,) angles in radians with their sines."""
    for block in _blocks(values):
        block[:] = _sin(block)


def to_atan2(y: FloatArray, x: FloatArray) -> None:
    """Replace the (n,) y coordinates of vectors with the vectors' angles, radians."""
    for block, other in zip(_blocks(y), _blocks(x), strict=True):
        block[:] = _atan2(block, other)


def to_hypot(x: FloatArray, y: FloatArray) -> None:
    """Replace the (n,) x coordinates of vectors with the vectors' lengths."""
    for block, other in zip(_blocks(x), _blocks(y), strict=True):
        block[:] = _hypot(block, other)


def _blocks(values: FloatArray) -> Iterator[FloatArray]:
    return (values[begin : begin + BLOCK] for begin in range(0, values.size, BLOCK))


def _cos(angles: FloatArray) -> FloatArray:
    near = np.abs(angles) < elementary.FARTHEST
    (cos_1, cos_2, sin_1, sin_2), rest, error = _reduced(np.where(near, angles, 0.0))
    found = elementary.turned(-sin_1, -sin_2, cos_1, cos_2, rest, error)
    for place in np.flatnonzero(~near).tolist():
        found[place] = elementary.cos(float(angles[place]))
    return found


def _sin(angles: FloatArray) -> FloatArray:
    near = np.abs(angles) < elementary.FARTHEST
    turn, rest, error = _reduced(np.where(near, angles, 0.0))
    found = np.where(np.abs(angles) < 2.0**-27, angles, elementary.turned(*turn, rest, error))
    for place in np.flatnonzero(~near).tolist():
        found[place] = elementary.sin(float(angles[place]))
    return found


def _reduced(
    angles: FloatArray,
) -> tuple[tuple[FloatArray, FloatArray, FloatArray, FloatArray], FloatArray, FloatArray]:
    """Return the cosines and sines of the nearest table steps, and the rests of the angles, each in two parts."""
    steps, rest, error = elementary.reduced_near(angles)
    cos_1, cos_2, sin_1, sin_2 = TURNS[steps.astype(np.int64) & 127].T
    return (cos_1, cos_2, sin_1, sin_2), rest, error


def _atan2(y: FloatArray, x: FloatArray) -> FloatArray:
    greater, less = np.maximum(np.abs(x), np.abs(y)), np.minimum(np.abs(x), np.abs(y))
    usual = (greater > _SMALLEST) & (greater < _GREATEST)
    greater, less = np.where(usual, greater, 1.0), np.where(usual, less, 0.0)
    steep, back = np.abs(y) > np.abs(x), x < 0.0
    ratio = less / greater
    i = (ratio * 64.0 + 0.5).astype(np.int64)
    angle, error = elementary.arctangent(less, greater, i / 64.0, ARCTANGENTS[i, 0], ARCTANGENTS[i, 1])
    small = ratio < 2.0**-35
    angle, error = np.where(small, ratio, angle), np.where(small, 0.0, error)
    angle = np.where(small & (ratio > 0.0) & (back | steep), np.maximum(angle, 2.0**-200), angle)
    sign = np.where(steep & back, 1.0, -1.0)
    base_1, base_2 = (np.where(steep, *pair) for pair in zip(RIGHT_ANGLE, STRAIGHT_ANGLE, strict=True))
    total, lost = elementary.fast_two_sum(base_1, sign * angle)
    found = np.where(steep | back, total + (lost + (base_2 + sign * error)), angle + error)
    found = np.copysign(found, y)
    for place in np.flatnonzero(~usual).tolist():
        found[place] = elementary.atan2(float(y[place]), float(x[place]))
    return found


def _hypot(x: FloatArray, y: FloatArray) -> FloatArray:
    greater, less = np.maximum(np.abs(x), np.abs(y)), np.minimum(np.abs(x), np.abs(y))
    usual = (less > _SMALLEST) & (greater < _GREATEST)
    of_usual = np.where(usual, greater, 1.0), np.where(usual, less, 1.0)
    found = elementary.mended_length(np.sqrt(of_usual[0] * of_usual[0] + of_usual[1] * of_usual[1]), *of_usual)
    # Zeros are common, because robots stand still or move along an axis.
    found = np.where(less == 0.0, greater, found)
    for place in np.flatnonzero(~(usual | (less == 0.0))).tolist():
        found[place] = elementary.hypot(float(x[place]), float(y[place]))
    return found
