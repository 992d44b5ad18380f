"""Keyed noise: every random number is a pure function of (key, tick, index).

A counter-based generator has no state that would have to be shared or stored. So robot 3 cannot affect the numbers of
robots 1 and 2, and a run can be continued from any recorded tick. Callers name a stream once (`key(seed, "robot1",
"laser")`), and then draw numbers for a tick.

The functions here are plain, for callers that need few numbers. Kernels that draw many numbers call the same functions
(`sim.numerics.noise_arrays`).

Source: Salmon, Moraes, Dror, Shaw, Parallel random numbers: as easy as 1, 2, 3 (SC 2011), Philox4x32 with 10 rounds.
"""

import hashlib

import numpy as np

# The constants of Philox4x32 are unsigned 64-bit words, because in numba a product of unsigned and signed integers is a
# float.
_MULTIPLIER_0 = np.uint64(0xD2511F53)
_MULTIPLIER_1 = np.uint64(0xCD9E8D57)
_WEYL_0 = np.uint64(0x9E3779B9)
_WEYL_1 = np.uint64(0xBB67AE85)
_LOW_WORD = np.uint64(0xFFFFFFFF)
_WORD_BITS = np.uint64(32)


def key(seed: int, *names: str) -> np.uint64:
    """Return the key of a named stream of noise.

    Args:
        seed: the session's seed, any integer.
        names: the path to the stream, e.g. "robot1", "laser". ("ab", "c") and ("a", "bc") are different streams.
    """
    digest = hashlib.blake2b(digest_size=8)
    for part in (str(seed), *names):
        text = part.encode()
        digest.update(len(text).to_bytes(8, "little"))
        digest.update(text)
    return np.uint64(int.from_bytes(digest.digest(), "little"))


def philox(
    c0: np.uint64, c1: np.uint64, c2: np.uint64, c3: np.uint64, k0: np.uint64, k1: np.uint64
) -> tuple[np.uint64, np.uint64, np.uint64, np.uint64]:
    """Return four random words for four counter words and two key words (Philox4x32-10).

    Each has 32 bits in a uint64.
    """
    for _ in range(10):
        product_0 = _MULTIPLIER_0 * c0
        product_1 = _MULTIPLIER_1 * c2
        c0, c1, c2, c3 = (
            (product_1 >> _WORD_BITS) ^ c1 ^ k0,
            product_1 & _LOW_WORD,
            (product_0 >> _WORD_BITS) ^ c3 ^ k1,
            product_0 & _LOW_WORD,
        )
        k0 = (k0 + _WEYL_0) & _LOW_WORD
        k1 = (k1 + _WEYL_1) & _LOW_WORD
    return c0, c1, c2, c3


def fraction(high: np.uint64, low: np.uint64) -> float:
    """Convert two random words to a number in [0, 1) with 53 random bits."""
    return float((high >> np.uint64(5)) * np.uint64(1 << 26) + (low >> np.uint64(6))) * 2.0**-53


def uniform_pair(stream: np.uint64, tick: int, block: int) -> tuple[float, float]:
    """Return two uniforms in [0, 1): numbers 2 * block and 2 * block + 1 of this stream and tick."""
    when = np.uint64(tick)
    where = np.uint64(block)
    w0, w1, w2, w3 = philox(
        when & _LOW_WORD,
        when >> _WORD_BITS,
        where & _LOW_WORD,
        where >> _WORD_BITS,
        stream & _LOW_WORD,
        stream >> _WORD_BITS,
    )
    return fraction(w0, w1), fraction(w2, w3)


def uniform(key: np.uint64, tick: int, index: int) -> float:
    """Return number `index` of this stream and tick, uniform in [0, 1)."""
    return uniform_pair(key, tick, index // 2)[index % 2]


def first_uniforms(key: np.uint64, tick: int, count: int) -> list[float]:
    """Return numbers 0 to `count` - 1 of this stream and tick, the same as from `uniform`."""
    pairs = [uniform_pair(key, tick, block) for block in range((count + 1) // 2)]
    return [number for pair in pairs for number in pair][:count]
