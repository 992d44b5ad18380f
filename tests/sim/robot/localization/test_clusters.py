import math

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.robot.localization.clusters import bin_particles, cluster_bins, summarise


def test_particles_of_one_bin_share_its_number():
    bins = bin_particles(np.array([[0.1, 0.1, 0.01], [0.4, 0.49, 0.17], [0.51, 0.1, 0.01], [-0.1, 0.1, 0.01]]))
    assert bins.of_particle.tolist() == [0, 0, 1, 2]
    assert bins.corners.tolist() == [[0, 0, 0], [1, 0, 0], [-1, 0, 0]]


def test_binning_agrees_with_counting():
    rng = np.random.default_rng(2)
    particles = rng.uniform((-20, -20, -math.pi), (20, 20, math.pi), (2000, 3))
    keys = np.floor(particles / (0.5, 0.5, math.radians(10))).astype(int)
    keys[:, 2] %= 36
    bins = bin_particles(particles)
    assert len(bins.corners) == len({tuple(key) for key in keys})
    assert (bins.corners[bins.of_particle] == keys).all()


def test_bins_that_touch_by_a_corner_are_one_cluster_and_others_are_not():
    corner = bin_particles(np.array([[0.1, 0.1, 0.05], [0.6, 0.6, 0.25]]))
    assert cluster_bins(corner).tolist() == [0, 0]
    apart = bin_particles(np.array([[0.1, 0.1, 0.05], [1.1, 0.1, 0.05]]))
    assert cluster_bins(apart).tolist() == [0, 1]


def test_the_circle_of_headings_is_closed():
    bins = bin_particles(np.array([[0.1, 0.1, math.pi - 0.01], [0.1, 0.1, -math.pi + 0.01]]))
    assert cluster_bins(bins).tolist() == [0, 0]


def test_the_heaviest_cluster_speaks_even_if_it_has_fewer_particles():
    particles = np.array([[0.0, 0.0, 3.1], [0.2, 0.0, -3.1], [5.0, 5.0, 0.0], [5.0, 5.0, 0.0], [5.0, 5.0, 0.0]])
    weights = np.array([0.3, 0.3, 0.1, 0.1, 0.2])
    summary = summarise(particles, weights, bin_particles(particles))
    assert summary.mean.distance(Pose2(0.1, 0.0, 0.0)) < 1e-9
    assert abs(summary.mean.theta) == pytest.approx(math.pi)
    assert summary.weight == pytest.approx(0.6)


def test_covariance_is_the_whole_clouds_about_the_pose():
    rng = np.random.default_rng(3)
    particles = rng.multivariate_normal((1, 2, 0.5), [[0.02, 0.01, 0], [0.01, 0.03, 0.004], [0, 0.004, 0.005]], 500)
    weights = rng.uniform(0, 1, 500)
    summary = summarise(particles, weights, bin_particles(particles))
    away = particles - summary.mean.array()
    expected = np.einsum("i,ij,ik->jk", weights / weights.sum(), away, away)
    assert summary.covariance == pytest.approx(expected, rel=1e-9, abs=1e-12)
