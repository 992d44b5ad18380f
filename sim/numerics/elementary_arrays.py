"""The functions of `sim.numerics.elementary` for arrays of any shape, including single numbers.

Programs that simulate robots load the compiler, so they use kernels. Programs that read recordings do not load it,
because its import takes half a second and 130 MB. They use numpy, which gives the same bits.
"""

import sys
from functools import cache
from types import ModuleType

import numpy as np
from numpy.typing import ArrayLike

from sim.numerics import elementary_vectors
from sim.numerics.float_array import FloatArray


def _copy(values: ArrayLike) -> FloatArray:
    """Return a contiguous copy, because kernels overwrite it and accept no other layout."""
    return np.array(values, dtype=np.float64, order="C")


@cache
def _kernels() -> ModuleType:
    from sim.numerics import elementary_kernels  # noqa: PLC0415

    return elementary_kernels


def _operations() -> ModuleType:
    """Return the module that overwrites arrays: kernels if the compiler is loaded, else numpy's version."""
    return _kernels() if "sim.numerics.kernels" in sys.modules else elementary_vectors


def cos(angles: ArrayLike) -> FloatArray:
    """Return the cosines of angles in radians."""
    values = _copy(angles)
    _operations().to_cos(values.reshape(-1))
    return values


def sin(angles: ArrayLike) -> FloatArray:
    """Return the sines of angles in radians."""
    values = _copy(angles)
    _operations().to_sin(values.reshape(-1))
    return values


def exp(exponents: ArrayLike) -> FloatArray:
    """Return the powers of e."""
    values = _copy(exponents)
    _kernels().to_exp(values.reshape(-1))
    return values


def log(numbers: ArrayLike) -> FloatArray:
    """Return the natural logarithms."""
    values = _copy(numbers)
    _kernels().to_log(values.reshape(-1))
    return values


def atan2(y: ArrayLike, x: ArrayLike) -> FloatArray:
    """Return the angles of vectors (x, y) in [-pi, pi], radians. Both arrays have the same shape."""
    values, others = _copy(y), _copy(x)
    _operations().to_atan2(values.reshape(-1), others.reshape(-1))
    return values


def hypot(x: ArrayLike, y: ArrayLike) -> FloatArray:
    """Return the lengths of vectors (x, y). Both arrays have the same shape."""
    values, others = _copy(x), _copy(y)
    _operations().to_hypot(values.reshape(-1), others.reshape(-1))
    return values


def interp(x: ArrayLike, known: FloatArray, values: FloatArray) -> FloatArray:
    """Interpolate linearly between (n,) increasing points. Outside them, use the first or last value, as numpy does.

    numpy's own function is not used, because on some processors the compiler may contract its product and sum into one
    instruction.
    """
    wanted = np.clip(x, known[0], known[-1])
    left = np.clip(np.searchsorted(known, wanted, side="right") - 1, 0, max(len(known) - 2, 0))
    right = np.minimum(left + 1, len(known) - 1)
    width = known[right] - known[left]
    slope = (values[right] - values[left]) / np.where(width > 0.0, width, 1.0)
    between: FloatArray = values[left] + slope * (wanted - known[left])
    return np.where(wanted >= known[-1], values[-1], between)
