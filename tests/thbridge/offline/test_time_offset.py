"""The offset between the clocks of odometry and scans."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.numerics.float_array import FloatArray
from thbridge.offline.time_offset import LONGEST_OFFSET, time_offset

ODOMETRY = np.arange(0.0, 40.0, 0.02)
SCANS = np.arange(0.013, 40.0, 0.1)


def heading(seconds: FloatArray, seed: int) -> FloatArray:
    """A drive with turns of all kinds, in radians that are not wrapped."""
    noise = np.random.default_rng(seed)
    waves = zip(noise.uniform(0.2, 0.6, 5), noise.uniform(0.1, 0.8, 5), noise.uniform(0.0, 6.0, 5), strict=True)
    return np.sum([size * np.sin(2.0 * math.pi * rate * seconds + phase) for size, rate, phase in waves], axis=0)


def wrapped(angles: FloatArray) -> FloatArray:
    return (angles + math.pi) % (2.0 * math.pi) - math.pi


@given(
    seed=st.integers(0, 10_000),
    lead=st.floats(-0.4, 0.4),
    turns=st.floats(0.5, 2.0),
    noise=st.floats(0.0, 0.02),
)
def test_the_offset_is_found_within_its_deviation(seed: int, lead: float, turns: float, noise: float) -> None:
    errors = np.random.default_rng(seed).normal(0.0, noise, len(SCANS))
    seen = wrapped(heading(SCANS, seed) + errors)
    told = wrapped(turns * heading(ODOMETRY + lead, seed) + 2.0)
    found = time_offset(ODOMETRY, told, SCANS, seen)
    assert found is not None
    assert found.seconds == pytest.approx(lead, abs=0.003 + 5.0 * found.deviation)
    assert found.turns == pytest.approx(turns, rel=0.1)
    assert found.deviation < 0.05


@given(seed=st.integers(0, 10_000), lead=st.floats(-0.2, 0.2), later=st.floats(-0.2, 0.2))
def test_odometry_stamped_later_leads_by_less(seed: int, lead: float, later: float) -> None:
    seen, told = heading(SCANS, seed), heading(ODOMETRY + lead, seed)
    before, after = time_offset(ODOMETRY, told, SCANS, seen), time_offset(ODOMETRY + later, told, SCANS, seen)
    assert before is not None
    assert after is not None
    assert after.seconds == pytest.approx(before.seconds - later, abs=0.003)


def test_scans_without_a_heading_are_left_out() -> None:
    seen = heading(SCANS, 1)
    seen[::3] = math.nan
    found = time_offset(ODOMETRY, heading(ODOMETRY + 0.15, 1), SCANS, seen)
    assert found is not None
    assert found.seconds == pytest.approx(0.15, abs=0.003)


@pytest.mark.parametrize(
    "told",
    [np.zeros(len(ODOMETRY)), heading(ODOMETRY, 2), heading(ODOMETRY + 2.0 * LONGEST_OFFSET, 1)],
    ids=["no turns", "another drive", "too far off"],
)
def test_no_offset_is_found_where_the_turns_do_not_agree(told: FloatArray) -> None:
    assert time_offset(ODOMETRY, told, SCANS, heading(SCANS, 1)) is None


def test_no_offset_is_found_by_few_scans() -> None:
    few = SCANS[100:130]
    assert time_offset(ODOMETRY, heading(ODOMETRY, 1), few, heading(few, 1)) is None
