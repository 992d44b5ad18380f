import hashlib
import math
import random
import struct

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.numerics import elementary, elementary_arrays, elementary_vectors
from sim.numerics.kernels import njit

COUNT = 4000
BOUND = 0.502
"""Units in the last place; half a unit is what a correctly rounded function has."""

numbers = st.floats(allow_nan=True, allow_infinity=True)


def wide(draw, low, high):
    """A number of either sign whose magnitude is spread over powers of ten."""
    return draw.choice((-1.0, 1.0)) * 10.0 ** draw.uniform(low, high)


ARGUMENTS = {
    "sin": (lambda d: d.uniform(-7, 7), lambda d: wide(d, -12, 5), lambda d: wide(d, 4, 308)),
    "cos": (lambda d: d.uniform(-7, 7), lambda d: wide(d, -12, 5), lambda d: wide(d, 4, 308)),
    "exp": (lambda d: d.uniform(-708, 709.7), lambda d: wide(d, -12, 1)),
    "log": (lambda d: 10.0 ** d.uniform(-308, 308), lambda d: d.uniform(0.5, 2.0), lambda d: 1.0 + wide(d, -14, -1)),
    "atan2": (lambda d: d.uniform(-7, 7), lambda d: wide(d, -12, 1), lambda d: wide(d, -300, 300)),
    "hypot": (lambda d: d.uniform(-7, 7), lambda d: wide(d, -12, 1), lambda d: wide(d, -300, 300)),
}
TWO = ("atan2", "hypot")


def exact(name, arguments):
    if name == "hypot":
        x, y = map(mpmath.mpf, arguments)
        return mpmath.sqrt(x * x + y * y)
    return getattr(mpmath, name)(*map(mpmath.mpf, arguments))


def error(name, arguments):
    """Error of a function, in units in the last place of the exact result."""
    truth = exact(name, arguments)
    return float(abs(mpmath.mpf(getattr(elementary, name)(*arguments)) - truth) / math.ulp(float(truth)))


@pytest.mark.parametrize(("name", "part"), [(name, part) for name in ARGUMENTS for part in range(len(ARGUMENTS[name]))])
def test_results_are_as_good_as_correctly_rounded(name, part):
    draw, one = random.Random(part), ARGUMENTS[name][part]
    # Sines of great numbers: as many bits as these have before the point are lost.
    with mpmath.workprec(1300 if name in ("sin", "cos") and part == 2 else 120):
        worst = max(error(name, [one(draw) for _ in range(1 + (name in TWO))]) for _ in range(COUNT))
    assert worst <= BOUND


@pytest.mark.parametrize("number", [5319372648326541 * 2.0**416, 6381956970095103 * 2.0**797, math.pi, 11.0, 355.0])
def test_angles_that_come_close_to_a_right_angle_keep_all_digits(number):
    """The double nearest to a multiple of pi / 2 is the first one (Muller, section 11.3.2); its cosine is 5e-19."""
    with mpmath.workprec(1300):
        assert max(error("sin", (number,)), error("cos", (number,))) <= BOUND


SPECIAL = (0.0, -0.0, math.inf, -math.inf, math.nan, 1.0, -1.0, 5e-324, -5e-324, 1.7976931348623157e308, 1e-300, -1e300)


def same(one, other):
    return struct.pack("<d", one) == struct.pack("<d", other) or (math.isnan(one) and math.isnan(other))


@pytest.mark.parametrize("y", SPECIAL)
@pytest.mark.parametrize("x", SPECIAL)
def test_zeros_infinities_and_nan_are_those_of_the_standard(x, y):
    assert same(elementary.atan2(y, x), math.atan2(y, x))
    assert same(elementary.hypot(x, y), math.hypot(x, y))


def test_poles_and_ends_of_one_argument():
    assert [elementary.exp(x) for x in (-math.inf, -800.0, 0.0, -0.0, 710.0, math.inf)] == [
        0,
        0,
        1,
        1,
        math.inf,
        math.inf,
    ]
    assert elementary.exp(709.782712893384) == math.exp(709.782712893384)
    assert elementary.exp(-745.0) == 5e-324
    assert [elementary.log(x) for x in (0.0, -0.0, 1.0, math.inf)] == [-math.inf, -math.inf, 0, math.inf]
    assert elementary.log(5e-324) == math.log(5e-324)
    for function in (elementary.sin, elementary.cos, elementary.exp, elementary.log):
        assert math.isnan(function(math.nan))
    assert all(math.isnan(function(x)) for function in (elementary.sin, elementary.cos) for x in (math.inf, -math.inf))
    assert math.isnan(elementary.log(-1.0))
    assert same(elementary.sin(-0.0), -0.0)


@given(numbers, numbers)
def test_symmetries_hold_to_the_bit(x, y):
    assert same(elementary.sin(-x), -elementary.sin(x))
    assert same(elementary.cos(-x), elementary.cos(x))
    assert same(elementary.atan2(-y, x), -elementary.atan2(y, x))
    assert same(elementary.hypot(x, y), elementary.hypot(-y, x))
    assert all(map(same, elementary.cos_sin(x), (elementary.cos(x), elementary.sin(x))))


@njit(cache=False)
def compiled(x, y):
    return (
        elementary.cos_sin(x),
        (elementary.cos(x), elementary.sin(x)),
        (elementary.exp(x), elementary.log(x)),
        (elementary.atan2(y, x), elementary.hypot(x, y)),
    )


@given(numbers, numbers)
def test_compiled_functions_give_the_same_bits(x, y):
    for of_kernel, plain in zip(compiled(x, y), compiled.py_func(x, y), strict=True):
        assert all(map(same, of_kernel, plain)), (x, y)


def test_single_precision_is_calculated_with_in_double():
    one = np.float32(0.1)
    assert compiled(one, one)[0] == elementary.cos_sin(float(one))
    assert compiled(one, one)[3][1] == elementary.hypot(float(one), float(one))


@pytest.mark.parametrize("name", [*ARGUMENTS])
def test_arrays_of_any_layout_have_the_same_bits(name):
    draw = random.Random(7)
    values = np.array([abs(draw.uniform(-7, 7)) for _ in range(60)])
    arguments = [values.reshape(6, 10).T[::2], values[::-1].reshape(6, 10).T[::2]][: 1 + (name in TWO)]
    for argument in arguments:
        argument.setflags(write=False)
    found = getattr(elementary_arrays, name)(*arguments)
    wanted = [getattr(elementary, name)(*map(float, one)) for one in zip(*(a.ravel() for a in arguments), strict=True)]
    assert found.shape == arguments[0].shape
    assert found.ravel().tolist() == wanted


@pytest.mark.parametrize("name", ["sin", "cos", "atan2", "hypot"])
def test_without_the_compiler_the_bits_are_the_same(name):
    """Of all kinds of arguments, of special ones in all pairs, and of those that stand still or point along an axis."""
    draw = random.Random(11)
    pairs = [(one(draw), one(draw)) for one in ARGUMENTS[name] for _ in range(elementary_vectors.BLOCK)]
    pairs += [(y, x) for y in SPECIAL for x in SPECIAL]
    pairs += [(draw.choice((-1.0, 0.0, 2.0)), draw.choice((-1.0, -0.0, 2.0))) for _ in range(50)]
    pairs += [(y, y * 2.0 ** draw.randint(-70, 70)) for y, _ in pairs[:500]]
    arguments = [np.array(each) for each in zip(*pairs, strict=True)][: 1 + (name in TWO)]
    wanted = [getattr(elementary, name)(*map(float, one)) for one in zip(*arguments, strict=True)]
    getattr(elementary_vectors, f"to_{name}")(*arguments)
    assert all(map(same, arguments[0].tolist(), wanted))


def test_interpolation_is_numpys():
    draw = np.random.default_rng(3)
    known, values = np.cumsum(draw.uniform(0.1, 1, 20)), draw.uniform(-5, 5, 20)
    wanted = np.concatenate((draw.uniform(-2, 20, 200), known))
    assert elementary_arrays.interp(wanted, known, values) == pytest.approx(np.interp(wanted, known, values), abs=1e-12)
    assert float(elementary_arrays.interp(0.5, np.array([0.0]), np.array([3.0]))) == 3.0
    assert (elementary_arrays.interp(known, known, values) == values).all()


def test_the_bits_are_those_of_every_other_machine():
    """Digest of results, taken once. It may change with the module alone, never with machine, library or compiler."""
    draw, digest = random.Random(2026), hashlib.blake2b(digest_size=8)
    for _ in range(2000):
        x, y = draw.uniform(-40.0, 40.0), draw.uniform(-40.0, 40.0)
        for pair in compiled(x, y):
            digest.update(struct.pack("<2d", *(value + 0.0 if value == value else 0.0 for value in pair)))
    assert digest.hexdigest() == "2306d3dfd0e5c085"
