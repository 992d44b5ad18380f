"""Arrays of keyed noise from compiled code. For a single number use `sim.numerics.noise.uniform`."""

import math
from dataclasses import dataclass

import numpy as np

from sim.numerics import elementary, noise
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit, register_formula
from sim.numerics.noise import key, uniform_pair

for formula in (noise.philox, noise.fraction, noise.uniform_pair):
    register_formula(formula)


@njit(cache=True)
def uniforms(key: np.uint64, tick: int, out: FloatArray) -> None:
    """Fill `out`, (n,), with independent uniforms in [0, 1).

    Number i depends only on (key, tick, i), and not on n. Uniforms and normals of the same key and tick are made from
    the same bits, so use a stream for only one of them.
    """
    for i in range(0, out.size, 2):
        first, second = uniform_pair(key, tick, i // 2)
        out[i] = first
        if i + 1 < out.size:
            out[i + 1] = second


@njit(cache=True)
def normals(key: np.uint64, tick: int, out: FloatArray) -> None:
    """Fill `out`, (n,), with independent standard normals. Number i depends only on (key, tick, i).

    Source: Box and Muller, A note on the generation of random normal deviates (1958).
    """
    for i in range(0, out.size, 2):
        first, second = uniform_pair(key, tick, i // 2)
        # 1 - first is in (0, 1], where the logarithm is finite.
        radius = math.sqrt(-2.0 * elementary.log(1.0 - first))
        angle = 2.0 * math.pi * second
        c, s = elementary.cos_sin(angle)
        out[i] = radius * c
        if i + 1 < out.size:
            out[i + 1] = radius * s


@dataclass(frozen=True, slots=True)
class NoiseStream:
    """A named stream of noise as arrays, for code that is not compiled.

    Attributes:
        key: see `key`.
    """

    key: np.uint64

    @classmethod
    def named(cls, seed: int, *names: str) -> "NoiseStream":
        """Return the stream for a seed and a path of names."""
        return cls(key(seed, *names))

    def uniforms(self, tick: int, n: int) -> FloatArray:
        """Return (n,) uniforms in [0, 1)."""
        out = np.empty(n)
        uniforms(self.key, tick, out)
        return out

    def normals(self, tick: int, n: int) -> FloatArray:
        """Return (n,) standard normals."""
        out = np.empty(n)
        normals(self.key, tick, out)
        return out
