"""Elementary functions that give the same bits on every machine: sin, cos, atan2, exp, log, hypot.

The functions of libm and numpy are accurate, but their last bit differs between machines. They have several
implementations. The processor's features and the library's version decide which of them runs. A robot's noise,
particles and plans depend on such bits. With libm or numpy, a session could be repeated only on the same kind of
machine.

The functions here use only sums, products, quotients and square roots of doubles, in the written order. IEEE 754
defines each of them exactly. Python does not contract or reorder them, and neither does numba without `fastmath`. A
function looks up its value at a nearby point of a table, as a sum of two doubles, and adds a short series. It also adds
the rounding errors of the leading products and sums. So results are almost correctly rounded: the error is at most
0.502 units in the last place. The smallest possible bound is 0.5.

The functions are plain Python, for code that needs single numbers. Kernels compile the same functions, and
`sim.numerics.elementary_arrays` has versions for arrays. Helper functions without branches also accept arrays, because
numpy computes the same sums and products for each element.

Sources: Muller, Elementary Functions, 3rd ed. (2016), chapters 6 (tables: Tang, Gal) and 11 (range reduction: Cody and
Waite, Payne and Hanek); Dekker, A floating-point technique for extending the available precision (1971), for the errors
of sums and products; Borges, An improved algorithm for hypot(a, b) (2019).
"""

import math
from typing import TypeVar

import numpy as np

from sim.numerics.elementary_tables import (
    ARCTANGENTS,
    EXPONENT_STEP,
    EXPONENTIALS,
    FULL_TURN,
    LOG_2,
    LOGARITHMS,
    LOGARITHMS_FROM,
    RIGHT_ANGLE,
    STRAIGHT_ANGLE,
    TURN_STEP,
    TURN_WORDS,
    TURNS,
)
from sim.numerics.float_array import FloatArray

Real = TypeVar("Real", float, FloatArray)
"""A number or an array. Calculations with arrays are elementwise."""

_STEP_1, _STEP_2, _STEP_3, _STEP_4 = TURN_STEP
_TURN_1, _TURN_2 = FULL_TURN
_EXPONENT_1, _EXPONENT_2, _EXPONENT_3 = EXPONENT_STEP
_LOG_2_1, _LOG_2_2 = LOG_2
_RIGHT_1, _RIGHT_2 = RIGHT_ANGLE
_STRAIGHT_1, _STRAIGHT_2 = STRAIGHT_ANGLE

_STEPS_PER_RADIAN = 64.0 / math.pi
_STEPS_PER_EXPONENT = 128.0 / (_LOG_2_1 + _LOG_2_2)
FARTHEST = 2.0**20 / _STEPS_PER_RADIAN
"""Cody and Waite's reduction is exact for angles below this, radians."""

_ROUNDING = 1.5 * 2.0**52
"""Number for rounding: adding and then subtracting it rounds to an integer, half to even."""

_SPLITTER = 2.0**27 + 1.0
"""Dekker's factor, which splits a double into two halves of 26 bits."""


def leading(x: Real) -> Real:
    """Return the leading 26 bits of a number. The rest also has at most 26 bits, so products of the parts are exact."""
    scaled = _SPLITTER * x
    return scaled - (scaled - x)


def two_sum(a: Real, b: Real) -> tuple[Real, Real]:
    """Return the sum of two numbers and its rounding error."""
    total = a + b
    of_b = total - a
    return total, (a - (total - of_b)) + (b - of_b)


def fast_two_sum(a: Real, b: Real) -> tuple[Real, Real]:
    """Return the sum of two numbers and its rounding error. The first must have the larger magnitude, or be 0."""
    total = a + b
    return total, b - (total - a)


def two_product(a: Real, b: Real) -> tuple[Real, Real]:
    """Return the product of two numbers and its rounding error."""
    a1, b1 = leading(a), leading(b)
    a2, b2 = a - a1, b - b1
    product = a * b
    return product, ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2


def _scaled(x: float, exponent: int) -> float:
    """Return a number times a power of two. On overflow the result is infinite, while ldexp raises an error."""
    return math.ldexp(x, exponent - 1) * 2.0 if exponent > 0 else math.ldexp(x, exponent)


def _reduced(x: float) -> tuple[int, float, float]:
    """Return an angle as a number of steps of pi / 64 and the rest, radians, in two parts."""
    if abs(x) >= FARTHEST:
        return _reduced_far(x)
    steps, rest, error = reduced_near(x)
    return int(steps), rest, error


def reduced_near(x: Real) -> tuple[Real, Real, Real]:
    """Do the same as `_reduced` for angles below `FARTHEST`."""
    steps = (x * _STEPS_PER_RADIAN + _ROUNDING) - _ROUNDING
    # The products with the first three parts of the step are exact, so the differences lose nothing (Cody and Waite).
    rest, error = two_sum(x - steps * _STEP_1, -steps * _STEP_2)
    rest, more = two_sum(rest, -steps * _STEP_3)
    rest, error = fast_two_sum(rest, more + error - steps * _STEP_4)
    return steps, rest, error


def _reduced_far(x: float) -> tuple[int, float, float]:
    """Do the same as `_reduced` for any finite angle, using the fractional part of the angle times 1 / (2 pi).

    Numbers are split into digits of 24 bits. Digits before the point are whole turns and are omitted. Sums of four
    products of digits are exact.
    """
    mantissa, exponent = math.frexp(abs(x))
    first = (exponent - 53) // 24
    ahead = math.ldexp(mantissa, exponent - 24 * first)  # times 2**(24 * first); an integer below 2**77
    digits = np.empty(4)
    for j in range(3, -1, -1):
        digit = float(math.floor(ahead * 2.0 ** (-24 * j)))
        digits[j], ahead = digit, ahead - digit * 2.0 ** (24 * j)
    turn = np.empty(6)
    carry = 0.0
    for k in range(5, -1, -1):
        word = carry
        for j in range(4):
            i = k + j + first
            if 0 <= i < len(TURN_WORDS):
                word += digits[j] * TURN_WORDS[i]
        carry = float(math.floor(word * 2.0**-24))
        turn[k] = word - carry * 2.0**24
    w1, w2, w3, w4, w5, w6 = (
        float(turn[0]),
        float(turn[1]),
        float(turn[2]),
        float(turn[3]),
        float(turn[4]),
        float(turn[5]),
    )
    steps = math.floor(w1 * 2.0**-17 + 0.5)
    part, error = two_sum(((w1 - steps * 2.0**17) * 2.0**24 + w2) * 2.0**-48, (w3 * 2.0**24 + w4) * 2.0**-96)
    error += (w5 * 2.0**24 + w6) * 2.0**-144
    rest, lost = two_product(part, _TURN_1)
    rest, error = fast_two_sum(rest, lost + (part * _TURN_2 + error * _TURN_1))
    return (steps, rest, error) if x > 0.0 else (-steps, -rest, -error)


def turned(cos_1: Real, cos_2: Real, sin_1: Real, sin_2: Real, rest: Real, error: Real) -> Real:
    """Return sin(a + r) from sine and cosine of a in two parts each (26 bits first) and a small r in two parts."""
    square = rest * rest
    # bent is sin(r) - r, and short is cos(r) - 1. Small terms are added first, because this loses the fewest bits.
    bent = error + rest * square * (-1.0 / 6.0 + square * (1.0 / 120.0 + square * (-1.0 / 5040.0 + square / 362880.0)))
    short = square * (-0.5 + square * (1.0 / 24.0 + square * (-1.0 / 720.0 + square / 40320.0))) - rest * error
    rest_1 = leading(rest)
    total, lost = fast_two_sum(sin_1, cos_1 * rest_1)
    return total + (
        lost + (sin_2 + (cos_1 * (rest - rest_1) + (cos_2 * rest + ((cos_1 + cos_2) * bent + (sin_1 + sin_2) * short))))
    )


# Each function first converts its argument to a double. Otherwise numba would compute in single precision for a
# float32, and plain code would be slow with numpy's numbers.


def sin(x: float) -> float:
    """Return the sine of an angle in radians, or nan if it is not finite."""
    x = float(1.0 * x)
    if abs(x) < 2.0**-27:
        # Here sin(x) rounds to x.
        return x
    if not math.isfinite(x):
        return math.nan
    steps, rest, error = _reduced(x)
    i = steps & 127
    return turned(float(TURNS[i, 0]), float(TURNS[i, 1]), float(TURNS[i, 2]), float(TURNS[i, 3]), rest, error)


def cos(x: float) -> float:
    """Return the cosine of an angle in radians, or nan if it is not finite."""
    x = float(1.0 * x)
    if not math.isfinite(x):
        return math.nan
    steps, rest, error = _reduced(x)
    i = steps & 127
    # cos(x) = sin(x + pi / 2), so the columns of sine and cosine change roles, and the sine's sign changes.
    return turned(-float(TURNS[i, 2]), -float(TURNS[i, 3]), float(TURNS[i, 0]), float(TURNS[i, 1]), rest, error)


def cos_sin(x: float) -> tuple[float, float]:
    """Return the cosine and sine of an angle in radians, with the same bits as separate calls, but faster."""
    x = float(1.0 * x)
    if not math.isfinite(x):
        return math.nan, math.nan
    steps, rest, error = _reduced(x)
    i = steps & 127
    cos_1, cos_2, sin_1, sin_2 = float(TURNS[i, 0]), float(TURNS[i, 1]), float(TURNS[i, 2]), float(TURNS[i, 3])
    cosine = turned(-sin_1, -sin_2, cos_1, cos_2, rest, error)
    return cosine, x if abs(x) < 2.0**-27 else turned(cos_1, cos_2, sin_1, sin_2, rest, error)


def exp(x: float) -> float:
    """Return e to the power of x: infinite above the largest double, 0 below the smallest."""
    x = float(1.0 * x)
    if not -746.0 < x < 710.0:
        if math.isnan(x):
            return x
        return math.inf if x > 0.0 else 0.0
    steps = (x * _STEPS_PER_EXPONENT + _ROUNDING) - _ROUNDING
    rest, error = two_sum(x - steps * _EXPONENT_1, -steps * _EXPONENT_2)
    error -= steps * _EXPONENT_3
    n = int(steps)
    i = n & 127
    value_1, value_2 = float(EXPONENTIALS[i, 0]), float(EXPONENTIALS[i, 1])
    # bent is exp(r) - 1 - r, as a series. The linear term is added exactly below.
    bent = error + rest * rest * (
        0.5 + rest * (1.0 / 6.0 + rest * (1.0 / 24.0 + rest * (1.0 / 120.0 + rest * (1.0 / 720.0))))
    )
    rest_1 = leading(rest)
    total, lost = fast_two_sum(value_1, value_1 * rest_1)
    lost += value_2 + (value_1 * (rest - rest_1) + (value_2 * rest + (value_1 + value_2) * bent))
    return _scaled(total + lost, n >> 7)


def log(x: float) -> float:
    """Return the natural logarithm: minus infinity for 0, nan for negative numbers."""
    x = float(1.0 * x)
    if not 0.0 < x < math.inf:
        if x == 0.0:
            return -math.inf
        return x if x > 0.0 else math.nan
    mantissa, exponent = math.frexp(x)
    if mantissa < 0.7071067811865476:
        # With a mantissa around 1, the exponent is 0 for numbers near 1. So nothing cancels in their small logarithms.
        mantissa, exponent = 2.0 * mantissa, exponent - 1
    i = int(128.0 * mantissa + 0.5) - LOGARITHMS_FROM
    reciprocal, value_1, value_2 = float(LOGARITHMS[i, 0]), float(LOGARITHMS[i, 1]), float(LOGARITHMS[i, 2])
    mantissa_1 = leading(mantissa)
    # The reciprocal has at most ten bits, so both products are exact.
    rest, error = two_sum(reciprocal * mantissa_1 - 1.0, reciprocal * (mantissa - mantissa_1))
    rest_1 = leading(rest)
    tail = 1.0 / 7.0 + rest * (-1.0 / 8.0 + rest * (1.0 / 9.0 + rest * (-1.0 / 10.0)))
    bent = (
        rest * rest * rest * (1.0 / 3.0 + rest * (-1.0 / 4.0 + rest * (1.0 / 5.0 + rest * (-1.0 / 6.0 + rest * tail))))
    )
    total, lost = two_sum(exponent * _LOG_2_1 + value_1, rest)
    total, more = two_sum(total, -0.5 * rest_1 * rest_1)
    lost += more + (exponent * _LOG_2_2 + value_2)
    return total + (lost + (bent + (error - error * rest - 0.5 * (rest - rest_1) * (rest_1 + rest))))


def atan2(y: float, x: float) -> float:
    """Return the angle of the vector (x, y) in [-pi, pi], radians. Signed zeros have the same effect as in C."""
    x, y = float(1.0 * x), float(1.0 * y)
    if math.isnan(x) or math.isnan(y):
        return math.nan
    greater, less = abs(x), abs(y)
    steep = less > greater
    if steep:
        greater, less = less, greater
    if greater == 0.0:
        return math.copysign(0.0 if math.copysign(1.0, x) > 0.0 else math.pi, y)
    if greater == math.inf:
        less = 1.0 if less == math.inf else 0.0
        greater = 1.0
    ratio = less / greater
    if ratio < 2.0**-35:
        # For such a small ratio, the arctangent and the quotient differ by far less than the last place.
        angle, error = ratio, 0.0
        if ratio > 0.0 and (x < 0.0 or steep):
            angle = max(angle, 2.0**-200)
    else:
        if not 2.0**-400 < greater < 2.0**400:
            # Powers of two change no bits of the quotient, and prevent overflow in the products below.
            scale = math.frexp(greater)[1]
            greater, less = math.ldexp(greater, -scale), math.ldexp(less, -scale)
        i = int(ratio * 64.0 + 0.5)
        angle, error = arctangent(less, greater, i / 64.0, float(ARCTANGENTS[i, 0]), float(ARCTANGENTS[i, 1]))
    if steep:
        base_1, base_2, sign = _RIGHT_1, _RIGHT_2, (-1.0 if x >= 0.0 else 1.0)
    elif x < 0.0 or (x == 0.0 and math.copysign(1.0, x) < 0.0):
        base_1, base_2, sign = _STRAIGHT_1, _STRAIGHT_2, -1.0
    else:
        return math.copysign(angle + error, y)
    total, lost = fast_two_sum(base_1, sign * angle)
    return math.copysign(total + (lost + (base_2 + sign * error)), y)


def arctangent(less: Real, greater: Real, near: Real, value_1: Real, value_2: Real) -> tuple[Real, Real]:
    """Return the arctangent of less / greater in two parts.

    `value_1` and `value_2` are the two parts of the arctangent of `near`, the argument rounded to six bits.
    """
    greater_1, less_1 = leading(greater), leading(less)
    # Compute tan(a - b) from tan(a) and tan(b) as over / under. Products with the six bits of `near` are exact.
    over, over_error = two_sum(less - near * greater_1, -near * (greater - greater_1))
    under, under_error = two_sum(greater, near * less_1)
    under, under_error = fast_two_sum(under, under_error + near * (less - less_1))
    tangent = over / under
    product, product_error = two_product(tangent, under)
    error = ((over - product) - product_error + over_error - tangent * under_error) / under
    square = tangent * tangent
    bent = square * (-1.0 / 3.0 + square * (1.0 / 5.0 + square * (-1.0 / 7.0 + square * (1.0 / 9.0))))
    angle, lost = two_sum(value_1, tangent)
    return angle, lost + (value_2 + (error + tangent * bent))


def hypot(x: float, y: float) -> float:
    """Return the length of the vector (x, y), without overflow or underflow of intermediate results."""
    x, y = float(1.0 * x), float(1.0 * y)
    greater, less = abs(x), abs(y)
    if greater < less:
        greater, less = less, greater
    # This branch is for nearly all arguments. The condition is False for those that are not finite.
    if less > 2.0**-400 and greater < 2.0**400:
        return _length(greater, less)
    if math.isinf(x) or math.isinf(y):
        return math.inf
    if math.isnan(x) or math.isnan(y):
        return math.nan
    if less == 0.0 or less < greater * 2.0**-60:
        return greater
    scale = math.frexp(greater)[1]
    return _scaled(_length(math.ldexp(greater, -scale), math.ldexp(less, -scale)), scale)


def _length(greater: float, less: float) -> float:
    """Return the length of a vector from its larger and its smaller component, if no square overflows or underflows."""
    return mended_length(math.sqrt(greater * greater + less * less), greater, less)


def mended_length(length: Real, greater: Real, less: Real) -> Real:
    """Correct `length`, the rounded root of the sum of two squares, by one Newton step, and return it."""
    length_1, greater_1, less_1 = leading(length), leading(greater), leading(less)
    length_2, greater_2, less_2 = length - length_1, greater - greater_1, less - less_1
    # Excess of the rounded root's square over the sum of squares. Only its last sum is rounded.
    surplus = (
        ((length_1 * length_1 - greater_1 * greater_1) - less_1 * less_1)
        + 2.0 * ((length_1 * length_2 - greater_1 * greater_2) - less_1 * less_2)
        + ((length_2 * length_2 - greater_2 * greater_2) - less_2 * less_2)
    )
    return length - surplus / (2.0 * length)


def wrap_angle(angle: float) -> float:
    """Return the same direction in [-pi, pi). An angle in this range is returned unchanged. Kernels may call this."""
    angle = float(angle)  # converts numbers of numpy arrays to plain numbers
    if -math.pi <= angle < math.pi:
        return angle
    wrapped = (angle + math.pi) % (2.0 * math.pi) - math.pi
    # For a tiny negative number the remainder rounds to the modulus itself.
    return wrapped if wrapped < math.pi else -math.pi
