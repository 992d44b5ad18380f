import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.numerics.noise_arrays import NoiseStream
from sim.robot.localization.motion import (
    AS_BELIEVED,
    MAX_NOISE_SCALE,
    Alphas,
    DiffIncrement,
    DiffSpread,
    MotionModel,
    NoiseScales,
    diff_increment,
    diff_move,
    diff_spread,
    omni_increment,
    omni_spread,
)

ALPHAS = Alphas(0.1, 0.2, 0.3, 0.4)
coordinate = st.floats(-10, 10)
heading = st.floats(-math.pi, math.pi, exclude_max=True)
poses = st.builds(Pose2, coordinate, coordinate, heading)


@given(poses, poses, poses)
def test_without_noise_a_particle_moves_as_the_odometry_does(before, after, particle):
    moved = diff_move(particle.array()[None, :], diff_increment(before, after), DiffSpread(0, 0, 0), np.zeros(3))[0]
    expected = particle.compose(before.between(after))
    if before.distance(after) < 0.01:
        # A centimeter without a bearing may go any way.
        assert math.hypot(moved[0] - expected.x, moved[1] - expected.y) < 0.021
    else:
        assert moved[:2] == pytest.approx((expected.x, expected.y), abs=1e-9)
    assert math.remainder(moved[2] - expected.theta, 2 * math.pi) == pytest.approx(0, abs=1e-9)


def test_turning_in_place_has_no_bearing():
    assert diff_increment(Pose2(0, 0, 0), Pose2(0.003, -0.004, 1.0)) == pytest.approx((0.0, 0.005, 1.0))


def test_driving_backwards_is_as_noisy_as_driving_forwards():
    here = Pose2(1.0, 2.0, 0.5)
    forwards = diff_increment(here, here.compose(Pose2(0.3, 0.02, 0.1)))
    backwards = diff_increment(here, here.compose(Pose2(-0.3, -0.02, 0.1)))
    assert abs(backwards.rot1) > 3
    for corrected in (False, True):
        assert diff_spread(backwards, ALPHAS, corrected) == pytest.approx(diff_spread(forwards, ALPHAS, corrected))


def test_spread_is_that_of_table_5_6():
    moved = DiffIncrement(0.2, 0.5, -0.1)
    rot1 = 0.1 * 0.2**2 + 0.2 * 0.5**2
    trans = 0.3 * 0.5**2 + 0.4 * (0.2**2 + 0.1**2)
    rot2 = 0.1 * 0.1**2 + 0.2 * 0.5**2
    assert diff_spread(moved, ALPHAS, corrected=False) == pytest.approx((rot1, trans, rot2))
    assert diff_spread(moved, ALPHAS, corrected=True) == pytest.approx(np.sqrt((rot1, trans, rot2)))


def test_particles_scatter_with_the_spread():
    n = 20000
    noise = NoiseStream.named(3, "motion").normals(0, 3 * n)
    moved = diff_move(np.zeros((n, 3)), DiffIncrement(0.0, 1.0, 0.0), DiffSpread(0.02, 0.05, 0.03), noise)
    assert moved[:, 0].mean() == pytest.approx(1.0, abs=0.003)
    assert moved[:, 0].std() == pytest.approx(0.05, rel=0.03)
    assert moved[:, 1].std() == pytest.approx(0.02, rel=0.03)
    assert moved[:, 2].std() == pytest.approx(math.hypot(0.02, 0.03), rel=0.03)


def test_headings_stay_wrapped():
    moved = diff_move(np.array([[0.0, 0.0, 3.0]]), DiffIncrement(0.5, 0.0, 0.5), DiffSpread(0, 0, 0), np.zeros(3))
    assert moved[0, 2] == pytest.approx(4.0 - 2 * math.pi)


@pytest.mark.parametrize("name", ["diff", "diff-corrected", "omni", "omni-corrected"])
@given(poses, poses, poses)
def test_believed_perfect_wheels_are_followed_exactly(name, before, after, particle):
    if before.distance(after) < 0.01:
        after = before
    followed = MotionModel(name, Alphas(0, 0, 0, 0, 0)).move(particle.array()[None], before, after, np.ones(3))[0]
    expected = particle.compose(before.between(after))
    assert followed[:2] == pytest.approx((expected.x, expected.y), abs=1e-9)
    assert math.remainder(followed[2] - expected.theta, 2 * math.pi) == pytest.approx(0, abs=1e-9)


def test_a_slide_spreads_as_amcl_says():
    moved = omni_increment(Pose2(0, 0, 0), Pose2(0.3, 0.4, 0.2))
    alphas = Alphas(0.1, 0.2, 0.3, 0.4, 0.5)
    first = (0.3 * 0.25 + 0.1 * 0.04, 0.5 * 0.25 + 0.1 * 0.04, 0.4 * 0.04 + 0.2 * 0.25)
    assert omni_spread(moved, alphas, corrected=False) == pytest.approx(first)
    variances = (0.3 * 0.25 + 0.4 * 0.04, 0.5 * 0.25 + 0.4 * 0.04, 0.1 * 0.04 + 0.2 * 0.25)
    assert omni_spread(moved, alphas, corrected=True) == pytest.approx(np.sqrt(variances))


@pytest.mark.parametrize("name", ["diff", "omni"])
def test_factors_follow_the_errors_of_the_particles_that_a_scan_confirms(name):
    n = 5000
    model, errors = MotionModel(name, ALPHAS), NoiseStream.named(4, "motion")
    noise, equal = errors.normals(0, 3 * n), np.full(n, 1.0 / n)
    turn, along = noise.reshape(-1, 3)[:, 2], noise.reshape(-1, 3)[:, 1 if name == "diff" else 0]
    far = np.exp(-0.5 * ((np.abs(turn) - 2.5) / 0.2) ** 2)
    learned = model.learned(AS_BELIEVED, 0.2, noise, equal, far / far.sum())
    assert learned.turn > 1.2
    assert learned.drive == pytest.approx(1.0, abs=0.02)
    near = np.exp(-0.5 * (along / 0.1) ** 2)
    assert model.learned(NoiseScales(3.0, 1.0), 0.2, noise, equal, near / near.sum()).drive < 2.97
    assert model.learned(AS_BELIEVED, 0.2, noise, equal, near / near.sum()).drive == 1.0
    assert model.learned(AS_BELIEVED, 0.2, noise, equal, equal) == AS_BELIEVED
    for _ in range(100):
        learned = model.learned(learned, 1.0, noise, equal, far / far.sum())
    assert learned.turn == MAX_NOISE_SCALE


@pytest.mark.parametrize("name", ["diff", "diff-corrected", "omni", "omni-corrected"])
def test_factors_widen_the_cloud(name):
    model, noise = MotionModel(name, ALPHAS), NoiseStream.named(3, "motion").normals(0, 3000)
    here, there = Pose2(0.0, 0.0, 0.0), Pose2(1.0, 0.0, 0.2)
    narrow, wide = (model.move(np.zeros((1000, 3)), here, there, noise, NoiseScales(k, k)) for k in (1.0, 3.0))
    assert (wide.std(axis=0) > 2.5 * narrow.std(axis=0)).all()
