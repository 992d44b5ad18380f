import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import chi2, norm

from sim.robot.localization.resampling import adaptive, sample_limit, systematic, tempered

offsets = st.floats(0, 1, exclude_max=True)
weights_of_some = st.lists(st.floats(0, 1), min_size=1, max_size=50).filter(lambda w: sum(w) > 1e-6)


def effective(weights):
    return weights.sum() ** 2 / (weights @ weights)


@given(st.lists(st.floats(-500, 0), min_size=20, max_size=60))
def test_tempering_leaves_a_share_effective_and_the_order_as_it_is(logs):
    logs = np.array(logs)
    likelihoods = tempered(logs, 0.1)
    assert likelihoods.max() == pytest.approx(1.0)
    assert effective(likelihoods) >= 0.1 * len(logs) * (1 - 1e-9)
    assert (np.diff(likelihoods[np.argsort(logs, kind="stable")]) >= 0).all()


def test_what_leaves_enough_effective_is_not_tempered():
    logs = np.array([-1.0, -1.5, -2.0, -3.0])
    assert tempered(logs, 0.1) == pytest.approx(np.exp(logs + 1.0))


def test_sample_limit_is_foxs_approximation_of_a_chi_square_quantile():
    z = norm.ppf(0.99)
    for bins in (5, 20, 100, 500):
        exact = chi2.ppf(0.99, bins - 1) / (2 * 0.05)
        assert sample_limit(bins, 0.05, z, 1, 10**9) == pytest.approx(exact, rel=0.01)


def test_sample_limit_values_of_the_formula():
    # Worked out by hand: k = 2, epsilon 0.05, z = 0.99 and k = 51, epsilon 0.01, z = 3 (pf.c).
    assert sample_limit(2, 0.05, 0.99, 1, 10**6) == 20
    assert sample_limit(51, 0.01, 3.0, 1, 10**6) == 4273


def test_sample_limit_keeps_its_bounds():
    assert sample_limit(1, 0.05, 0.99, 100, 1000) == 100
    assert sample_limit(2, 0.05, 0.99, 100, 1000) == 100
    assert sample_limit(5000, 0.05, 0.99, 100, 1000) == 1000
    assert sample_limit(2, 0.0, 0.99, 100, 1000) == 1000


@given(weights_of_some, st.integers(1, 200), offsets)
def test_systematic_draws_each_particle_its_share_rounded(weights, count, offset):
    weights = np.array(weights)
    drawn = np.bincount(systematic(weights, count, offset), minlength=len(weights))
    share = count * weights / weights.sum()
    assert drawn.sum() == count
    assert (drawn >= np.floor(share - 1e-6)).all()
    assert (drawn <= np.ceil(share + 1e-6)).all()
    assert (drawn[weights == 0] == 0).all()


def test_systematic_is_unbiased():
    weights = np.array([0.05, 0.0, 0.61, 0.34])
    offsets = (np.arange(1000) + 0.5) / 1000
    drawn = sum(np.bincount(systematic(weights, 3, offset), minlength=4) for offset in offsets)
    assert drawn / 1000 == pytest.approx(3 * weights, abs=0.01)


def test_a_cloud_in_one_bin_needs_the_least():
    assert len(adaptive(np.full(50, 0.02), np.zeros(50, dtype=np.int64), 0.5, 0.05, 0.99, 100, 1000)) == 100


@given(st.integers(1, 60), offsets)
def test_the_draw_is_as_large_as_its_own_bins_ask_for(bins, offset):
    of_particle = np.arange(300) % bins
    drawn = adaptive(np.full(300, 1 / 300), of_particle, offset, 0.05, 0.99, 10, 500)
    needed = sample_limit(len(set(of_particle[drawn].tolist())), 0.05, 0.99, 10, 500)
    assert needed <= len(drawn) <= 500


def test_bins_without_weight_do_not_count():
    weights = np.zeros(100)
    weights[0] = 1.0
    assert len(adaptive(weights, np.arange(100), 0.5, 0.05, 0.99, 10, 500)) == 10
