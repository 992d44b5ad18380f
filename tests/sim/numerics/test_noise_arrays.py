import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from sim.numerics.noise import key, uniform
from sim.numerics.noise_arrays import NoiseStream, normals, uniforms


@given(st.integers(0, 2**64 - 1), st.integers(0, 2**40))
def test_arrays_hold_the_very_numbers_that_are_drawn_one_by_one(stream: int, tick: int) -> None:
    drawn = NoiseStream(np.uint64(stream)).uniforms(tick, 5)
    assert drawn.tolist() == [uniform(np.uint64(stream), tick, index) for index in range(5)]


def test_normals_of_a_stream_are_the_same_for_ever() -> None:
    # The logarithm and the cosine may differ in the last bit between machines.
    assert NoiseStream(key(7, "robot1", "laser")).normals(3, 3) == pytest.approx(
        [1.2800310866221742, 0.42611148440788404, -1.1671194571027288], rel=1e-13
    )


@given(st.integers(0, 2**64 - 1), st.integers(0, 2**40), st.integers(0, 40), st.integers(0, 40))
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
