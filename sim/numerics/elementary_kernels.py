"""Kernels of `sim.numerics.elementary_arrays`."""

from sim.numerics import elementary
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit


@njit(cache=True)
def to_cos(values: FloatArray) -> None:
    """Replace (n,) angles in radians with their cosines."""
    for i in range(values.size):
        values[i] = elementary.cos(values[i])


@njit(cache=True)
def to_sin(values: FloatArray) -> None:
    """Replace (n,) angles in radians with their sines."""
    for i in range(values.size):
        values[i] = elementary.sin(values[i])


@njit(cache=True)
def to_exp(values: FloatArray) -> None:
    """Replace (n,) exponents with the powers of e."""
    for i in range(values.size):
        values[i] = elementary.exp(values[i])


@njit(cache=True)
def to_log(values: FloatArray) -> None:
    """Replace (n,) numbers with their natural logarithms."""
    for i in range(values.size):
        values[i] = elementary.log(values[i])


@njit(cache=True)
def to_atan2(y: FloatArray, x: FloatArray) -> None:
    """Replace the (n,) y coordinates of vectors with the vectors' angles, radians."""
    for i in range(y.size):
        y[i] = elementary.atan2(y[i], x[i])


@njit(cache=True)
def to_hypot(x: FloatArray, y: FloatArray) -> None:
    """Replace the (n,) x coordinates of vectors with the vectors' lengths."""
    for i in range(x.size):
        x[i] = elementary.hypot(x[i], y[i])
