import dataclasses

import numpy as np
import pytest

from sim.parameters import AmclParameters, LaserParameters, OdometryNoise, WorldParameters
from thbridge.offline.noise import PATHS, belief_spread, covered, odometry_spread, room_scan

QUIET = OdometryNoise(0.0, 0.0, 0.0, 0.0)


def test_perfect_wheels_report_the_course_itself() -> None:
    for course, end in (("straight", (10.0, 0.0)), ("square", (0.0, 0.0))):
        fan = odometry_spread(QUIET, course, 1.0, 1.5)  # type: ignore[arg-type]
        assert fan.driven[-1] == pytest.approx(end, abs=1e-9)
        assert np.abs(fan.paths[:, -1] - end).max() < 1e-9
        assert fan.along < 1e-9


def test_the_spread_is_that_of_the_model() -> None:
    fan = odometry_spread(OdometryNoise(0.0, 0.0, 0.02, 0.0), "straight", 1.0, 1.5)
    # 500 ticks of 2 cm, each with a standard deviation of sqrt(0.02) of its way; 95 % within 2.448 deviations.
    assert fan.along == pytest.approx(2.448 * np.sqrt(0.02 * 500) * 0.02, rel=0.15)
    assert fan.paths.shape[0] == PATHS


def test_scales_carry_the_fan_away() -> None:
    fan = odometry_spread(dataclasses.replace(QUIET, linear_scale=1.1), "straight", 1.0, 1.5)
    assert fan.centre == pytest.approx((11.0, 0.0), abs=1e-9)


def test_more_doubt_spreads_particles_farther() -> None:
    doubts = [AmclParameters(odom_alpha2=alpha) for alpha in (0.05, 0.2, 0.8)]
    spreads = [
        belief_spread(amcl, "straight", 1.0, 1.5).across + belief_spread(amcl, "straight", 1.0, 1.5).along
        for amcl in doubts
    ]
    assert spreads == sorted(spreads)
    assert spreads[0] < 0.8 * spreads[-1]


def test_a_belief_of_the_truth_covers_it_and_a_narrow_one_does_not() -> None:
    wheels = odometry_spread(OdometryNoise(), "straight", 1.0, 1.5)
    assert covered(wheels, wheels) > 0.9
    tight = AmclParameters(odom_alpha1=0.0, odom_alpha2=1e-4, odom_alpha3=0.0, odom_alpha4=0.0)
    assert covered(wheels, belief_spread(tight, "straight", 1.0, 1.5)) < 0.2


def test_a_sweep_without_noise_is_the_true_one_and_noise_moves_it() -> None:
    quiet = dataclasses.replace(WorldParameters(), laser=LaserParameters(range_noise=0.0, dropout=0.0))
    scan = room_scan(quiet)
    assert scan.lost == 0
    assert np.abs(scan.true - scan.seen).max() < 1e-6
    noisy = room_scan(dataclasses.replace(quiet, laser=LaserParameters(range_noise=0.1, dropout=0.5)))
    assert noisy.lost > 0.3 * noisy.beams
    assert np.array_equal(noisy.true, scan.true)


def test_true_beams_end_at_the_walls_drawn() -> None:
    scan = room_scan(dataclasses.replace(WorldParameters(), laser=LaserParameters(range_noise=0.0, dropout=0.0)))
    starts, spans = scan.walls[:, 0], scan.walls[:, 1] - scan.walls[:, 0]
    inside = scan.true[scan.true[:, 0] < 5.9]
    shares = np.clip(
        np.einsum("nwi,wi->nw", inside[:, None] - starts, spans) / np.einsum("wi,wi->w", spans, spans), 0, 1
    )
    distances = np.linalg.norm(inside[:, None] - (starts + shares[..., None] * spans), axis=2).min(axis=1)
    assert distances.max() < 0.02


def test_a_body_larger_than_the_room_is_no_trouble() -> None:
    large = dataclasses.replace(WorldParameters(), footprint=((9.0, 9.0), (-9.0, 9.0), (-9.0, -9.0), (9.0, -9.0)))
    assert room_scan(large).beams == large.laser.beams
