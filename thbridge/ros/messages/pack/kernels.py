"""Kernels for fields of many messages at once."""

from sim.numerics import elementary
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit


@njit(cache=True)
def turn_headings(rows: FloatArray) -> None:
    """Replace the heading in column 6 of (n, m) rows by its quaternion, with z in column 5 and w in column 6."""
    for i in range(rows.shape[0]):
        w, z = elementary.cos_sin(rows[i, 6] / 2)
        rows[i, 5] = z
        rows[i, 6] = w
