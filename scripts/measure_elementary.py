"""Compare the elementary functions with mpmath and libm: greatest errors, and cost per call.

Run this script from the project's folder: `.venv/bin/python scripts/measure_elementary.py [--count N]`. Arguments are
random; a third of them comes from each range in the table. Errors are in units in the last place of the exact result.
Costs are nanoseconds per call in a compiled loop, next to the cost of the libm function with the same name.
"""

import argparse
import math
import random
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from typing import TypeAlias

import mpmath
import numpy as np

from sim.numerics import elementary
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit

Draw: TypeAlias = Callable[[random.Random], float]
Elementary: TypeAlias = Callable[[*tuple[float, ...]], float]


def wide(low: float, high: float) -> Draw:
    """Return a distribution of positive and negative numbers with magnitudes between these powers of ten."""
    return lambda draw: draw.choice((-1.0, 1.0)) * 10.0 ** draw.uniform(low, high)


def between(low: float, high: float) -> Draw:
    """Return a uniform distribution."""
    return lambda draw: draw.uniform(low, high)


RANGES: dict[str, tuple[tuple[str, Draw], ...]] = {
    "sin": (("-7 to 7", between(-7, 7)), ("1e-9 to 1e5", wide(-9, 5)), ("1e5 to 1e308", wide(5, 308))),
    "cos": (("-7 to 7", between(-7, 7)), ("1e-9 to 1e5", wide(-9, 5)), ("1e5 to 1e308", wide(5, 308))),
    "atan2": (("-7 to 7", between(-7, 7)), ("1e-12 to 10", wide(-12, 1)), ("1e-300 to 1e300", wide(-300, 300))),
    "exp": (("-708 to 709", between(-708, 709)), ("-7 to 7", between(-7, 7)), ("1e-12 to 10", wide(-12, 1))),
    "log": (
        ("1e-307 to 1e308", lambda draw: abs(wide(-307, 308)(draw))),
        ("0.5 to 2", between(0.5, 2)),
        ("within 1e-14 to 0.1 of 1", lambda draw: 1.0 + wide(-14, -1)(draw)),
    ),
    "hypot": (("-7 to 7", between(-7, 7)), ("1e-12 to 10", wide(-12, 1)), ("1e-300 to 1e300", wide(-300, 300))),
}
PAIRS = ("atan2", "hypot")
CHUNK = 20_000


def worst(name: str, part: int, seed: int, count: int) -> float:
    """Return the greatest error of a function over some arguments in one of its ranges."""
    draw, one = random.Random(f"{name} {part} {seed}"), RANGES[name][part][1]
    function = getattr(elementary, name)
    reference = mpmath.hypot if name == "hypot" else getattr(mpmath, name)
    greatest = 0.0
    # The sine of a large number loses as many bits as the number has before the binary point.
    with mpmath.workprec(1200 if name in ("sin", "cos") and part == 2 else 120):
        for _ in range(count):
            arguments = [one(draw) for _ in range(2 if name in PAIRS else 1)]
            truth = reference(*arguments)
            greatest = max(greatest, float(abs(function(*arguments) - truth)) / math.ulp(float(truth)))
    return greatest


def cost(function: Elementary, name: str) -> float:
    """Return the nanoseconds per call: the least value of seven rounds, each with a million arguments."""
    if name in PAIRS:

        @njit(cache=False)
        def total(values: FloatArray) -> float:
            result = 0.0
            for i in range(values.size):
                result += function(values[i], values[values.size - 1 - i])
            return result
    else:

        @njit(cache=False)
        def total(values: FloatArray) -> float:
            result = 0.0
            for i in range(values.size):
                result += function(values[i])
            return result

    values = np.random.default_rng(1).uniform(0.01, 7.0, 1_000_000)
    total(values)
    rounds = []
    for _ in range(7):
        began = time.process_time()
        total(values)
        rounds.append(time.process_time() - began)
    return min(rounds) / values.size * 1e9


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=10_000_000, help="total number of arguments")
    parts = sum(map(len, RANGES.values()))
    chunks = max(1, parser.parse_args().count // parts // CHUNK)
    print(f"{chunks * CHUNK * parts:,} arguments")
    with ProcessPoolExecutor() as pool:
        for name, ranges in RANGES.items():
            own, libm = cost(getattr(elementary, name), name), cost(getattr(math, name), name)
            print(f"{name:6s} {own:5.1f} ns per call, libm {libm:5.1f} ns")
            for part, (where, _) in enumerate(ranges):
                found = pool.map(worst, *zip(*((name, part, seed, CHUNK) for seed in range(chunks)), strict=True))
                print(f"       {where:25s} {max(found):.5f}", flush=True)


if __name__ == "__main__":
    main()
