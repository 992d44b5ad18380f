import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.numerics.noise_arrays import NoiseStream
from sim.robot.localization.motion import (
    Alphas,
    DiffIncrement,
    DiffSpread,
    MotionModel,
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
        # A centimetre without a bearing may go any way.
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
