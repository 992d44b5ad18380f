"""Bilinear interpolation in a grid of distances to walls."""

import math

from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit

REACH = 1.0
"""Distance from walls, meters. Beyond it the field is flat, so points there do not pull a pose."""


@njit(cache=True)
def interpolate(field: FloatArray, along: float, across: float) -> tuple[float, float, float]:
    """Return the value at a point (in cells) and its slopes per column and row, from the four cell centers around it.

    Beyond the outermost centers the field is flat, with slope 0.
    """
    left, below = along - 0.5, across - 0.5
    col, row = math.floor(left), math.floor(below)
    if col < 0 or row < 0 or col + 1 >= field.shape[1] or row + 1 >= field.shape[0]:
        return REACH, 0.0, 0.0
    u, v = left - col, below - row
    f00, f01 = field[row, col], field[row, col + 1]
    f10, f11 = field[row + 1, col], field[row + 1, col + 1]
    value = (1.0 - v) * ((1.0 - u) * f00 + u * f01) + v * ((1.0 - u) * f10 + u * f11)
    return value, (1.0 - v) * (f01 - f00) + v * (f11 - f10), (1.0 - u) * (f10 - f00) + u * (f11 - f01)
