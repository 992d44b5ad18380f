import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from sim.common.noise import NoiseStream, key, normals, philox, uniforms

# Random123, tests/kat_vectors, the lines "philox4x32 10": counter, key, result.
KNOWN_ANSWERS = [
    ("00000000 00000000 00000000 00000000", "00000000 00000000", "6627e8d5 e169c58d bc57ac4c 9b00dbd8"),
    ("ffffffff ffffffff ffffffff ffffffff", "ffffffff ffffffff", "408f276d 41c83b0e a20bc7c6 6d5451fd"),
    ("243f6a88 85a308d3 13198a2e 03707344", "a4093822 299f31d0", "d16cfe09 94fdcceb 5001e420 24126ea1"),
]


def words(text: str) -> list[np.uint64]:
    return [np.uint64(int(word, 16)) for word in text.split()]


@pytest.mark.parametrize(("counter", "stream", "result"), KNOWN_ANSWERS)
def test_philox_gives_the_known_answers_of_its_authors(counter: str, stream: str, result: str) -> None:
    assert list(philox(*words(counter), *words(stream))) == words(result)


def test_numbers_of_a_stream_are_the_same_for_ever() -> None:
    # Frozen on purpose: recordings are replayed by drawing the same numbers again.
    assert int(key(7, "robot1", "laser")) == 6293750106573414420
    assert NoiseStream.named(7, "robot1", "laser").uniforms(3, 3).tolist() == [
        0.5974859556477822,
        0.05114489660878385,
        0.5120727368929462,
    ]
    # The logarithm and the cosine may differ in the last bit between machines.
    assert NoiseStream.named(7, "robot1", "laser").normals(3, 3) == pytest.approx(
        [1.2800310866221742, 0.42611148440788404, -1.1671194571027288], rel=1e-13
    )


def test_every_part_of_a_name_makes_another_stream() -> None:
    keys = {
        int(key(seed, *names))
        for seed in (0, 1, -1, 2**70)
        for names in [(), ("a",), ("a", "b"), ("ab",), ("b", "a"), ("", "ab"), ("ab", ""), ("a\x00b",)]
    }
    assert len(keys) == 4 * 8


@given(st.integers(0, 2**64 - 1), st.integers(0, 2**40), st.integers(0, 40), st.integers(0, 40))
@settings(deadline=None)
def test_a_number_does_not_depend_on_how_many_are_drawn(stream: int, tick: int, n: int, more: int) -> None:
    for draw in (uniforms, normals):
        few, many = np.empty(n), np.empty(n + more)
        draw(np.uint64(stream), tick, few)
        draw(np.uint64(stream), tick, many)
        assert np.array_equal(few, many[:n])


def test_neighbouring_ticks_and_keys_share_no_number() -> None:
    drawn = [NoiseStream(np.uint64(k)).uniforms(tick, 50) for k in range(20) for tick in range(20)]
    assert np.unique(np.concatenate(drawn)).size == 20 * 20 * 50


def test_uniforms_are_uniform() -> None:
    sample = NoiseStream.named(1, "u").uniforms(5, 200_000)
    assert sample.min() >= 0.0
    assert sample.max() < 1.0
    assert stats.kstest(sample, "uniform").pvalue > 1e-3


def test_normals_are_normal() -> None:
    sample = NoiseStream.named(1, "n").normals(5, 200_000)
    assert stats.kstest(sample, "norm").pvalue > 1e-3
    # The tails, to which Kolmogorov and Smirnov are blind.
    beyond = np.count_nonzero(np.abs(sample) > 3.5)
    assert stats.binomtest(beyond, sample.size, 2 * stats.norm.sf(3.5)).pvalue > 1e-3


def test_numbers_are_uncorrelated_between_indices_ticks_and_streams() -> None:
    n = 4000
    one, two = NoiseStream.named(1, "robot1"), NoiseStream.named(1, "robot2")
    table = np.array([np.concatenate((one.normals(tick, 8), two.normals(tick, 8))) for tick in range(n)])
    shifted = np.hstack((table[:-1], table[1:]))
    correlation = np.corrcoef(shifted.T) - np.eye(32)
    assert np.abs(correlation).max() < 5 / np.sqrt(n)
