"""Tables and constants of `sim.numerics.elementary`, computed from integers when the program starts.

Numbers are computed in fixed point, as integers in units of 2**-BITS, and then split into doubles, leading bits first.
Leading parts are short, so that their products with other short numbers are exact.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

BITS = 200
"""Number of binary digits after the point."""

_ONE = 1 << BITS


def _arctangent(numerator: int, denominator: int, bits: int = BITS) -> int:
    """Return the arctangent of a small fraction, in fixed point, by its series."""
    power = (numerator << bits) // denominator
    total, sign, odd = 0, 1, 1
    while power:
        total += sign * (power // odd)
        power = power * numerator * numerator // (denominator * denominator)
        sign, odd = -sign, odd + 2
    return total


def _logarithm(numerator: int, denominator: int) -> int:
    """Return the logarithm of a fraction near 1, in fixed point, by the series of the inverse hyperbolic tangent."""
    over, under = numerator - denominator, numerator + denominator
    power = (over << BITS) // under
    total, odd = 0, 1
    while power not in (0, -1):  # shifting a negative number right ends at -1
        total += power // odd
        power = power * over * over // (under * under)
        odd += 2
    return 2 * total


def _exponential(fixed: int) -> int:
    """Return the exponential of a number, both in fixed point, by its series."""
    total = term = _ONE
    step = 1
    while term:
        term = (term * fixed >> BITS) // step
        total += term
        step += 1
    return total


def _cos_sin(angle: int) -> tuple[int, int]:
    """Return the cosine and sine of an angle, all in fixed point, by their series."""
    sums, term, step = [0, 0], _ONE, 0
    while term:
        sums[step % 2] += -term if step % 4 >= 2 else term
        step += 1
        term = (term * angle >> BITS) // step
    return sums[0], sums[1]


def _pi(bits: int) -> int:
    """Return pi in fixed point, by Machin's formula."""
    spare = 20
    return 16 * _arctangent(1, 5, bits + spare) - 4 * _arctangent(1, 239, bits + spare) >> spare


def _parts(fixed: int, *bits: int) -> tuple[float, ...]:
    """Return a fixed-point number as a sum of doubles: leading parts with the given numbers of bits, then the rest."""
    parts = []
    for width in bits:
        spare = max(fixed.bit_length() - width, 0)
        leading = (fixed >> spare) << spare
        parts.append(leading / _ONE)
        fixed -= leading
    return (*parts, fixed / _ONE)


def _on_grid(fixed: int, places: int) -> tuple[float, float]:
    """Return a fixed-point number as two doubles: a multiple of 2**-places, and the rest."""
    spare = BITS - places
    leading = (fixed >> spare) << spare
    return leading / _ONE, (fixed - leading) / _ONE


def _table(rows: Sequence[Sequence[float]]) -> NDArray[np.float64]:
    table = np.array(rows)
    table.setflags(write=False)
    return table


def _turns() -> NDArray[np.float64]:
    rows = []
    cosine, sine = _ONE, 0
    step_cosine, step_sine = _cos_sin(PI_FIXED // 64)
    noise = 40  # Trailing bits that may be wrong after many steps. Without them, 0 and 1 are exact.
    for _ in range(128):
        exact = [((part >> noise - 1) + 1 >> 1) << noise for part in (cosine, sine)]
        rows.append([*_parts(exact[0], 26), *_parts(exact[1], 26)])
        cosine, sine = (
            cosine * step_cosine - sine * step_sine >> BITS,
            sine * step_cosine + cosine * step_sine >> BITS,
        )
    return _table(rows)


def _exponentials() -> NDArray[np.float64]:
    return _table([_parts(_exponential(LOG_2_FIXED * i // 128), 26) for i in range(128)])


def _logarithms() -> NDArray[np.float64]:
    rows = []
    for i in range(LOGARITHMS_FROM, LOGARITHMS_TO):
        reciprocal = round(512 * 128 / i)  # in units of 1 / 512
        rows.append([reciprocal / 512, *_on_grid(-_logarithm(reciprocal, 512), 42)])
    return _table(rows)


def _arctangents() -> NDArray[np.float64]:
    rows: list[tuple[float, ...]] = [(0.0, 0.0)]
    angle = 0
    for i in range(1, 65):
        # arctan(i / 64) - arctan((i - 1) / 64) is one arctangent.
        angle += _arctangent(64, 4096 + i * (i - 1))
        rows.append(_parts(angle, 53))
    return _table(rows)


def _turn_words() -> NDArray[np.float64]:
    count = 52
    bits = 24 * count
    inverse = (1 << 2 * bits + 63) // (_pi(bits + 64))
    words = [float(inverse >> bits - 24 * (i + 1) & (1 << 24) - 1) for i in range(count)]
    digits = np.array(words)
    digits.setflags(write=False)
    return digits


PI_FIXED = _pi(BITS)
LOG_2_FIXED = _logarithm(2, 1)

TURNS = _turns()
"""(128, 4) cosine and sine of i pi / 64, each as its leading 26 bits and the rest."""

TURN_STEP = _parts(PI_FIXED // 64, 33, 33, 33)
"""pi / 64 in four parts. Products of the first three with numbers below 2**20 are exact."""

FULL_TURN = _parts(2 * PI_FIXED, 53)
"""2 pi in two parts."""

TURN_WORDS = _turn_words()
"""(52,) 1 / (2 pi) in digits of 24 bits after the point."""

EXPONENTIALS = _exponentials()
"""(128, 2) 2**(i / 128) as its leading 26 bits and the rest."""

EXPONENT_STEP = _parts(LOG_2_FIXED // 128, 35, 35)
"""log(2) / 128 in three parts. Products of the first two with numbers below 2**18 are exact."""

LOGARITHMS_FROM = 90
LOGARITHMS_TO = 183
LOGARITHMS = _logarithms()
"""(93, 3) for i from LOGARITHMS_FROM: a number c of few bits near 128 / i, and -log(c) in two parts, a multiple of
2**-42 and the rest."""

LOG_2 = _on_grid(LOG_2_FIXED, 42)
"""log(2) in two parts: a multiple of 2**-42, and the rest."""

ARCTANGENTS = _arctangents()
"""(65, 2) arctangent of i / 64 in two parts."""

RIGHT_ANGLE = _parts(PI_FIXED // 2, 53)
"""pi / 2 in two parts."""

STRAIGHT_ANGLE = _parts(PI_FIXED, 53)
"""pi in two parts."""
