"""The search for a robot all over the map, by one scan."""

import math

import numpy as np
import pytest

from sim.parameters import AmclParameters
from sim.robot.localization import hypothesis
from sim.robot.localization.hypothesis import MIN_CANDIDATES, CloudFilter, CloudNoise
from sim.robot.localization.likelihood_field import LikelihoodField


@pytest.fixture
def search(drive):
    """A filter, a scan in the middle of a drive, the noise of a seed, and where the scan was taken."""
    tour = drive(seconds=60, furnished=True)
    moment = tour.moments[1500]
    clouds = CloudFilter(AmclParameters(max_particles=1000, laser_max_beams=60), tour.grid, tour.mount)
    return clouds, clouds.view(moment.scan, 1500), CloudNoise.named(1, "robot1"), moment.truth


def near(particles, place, reach=0.5, turned=0.3):
    off = np.abs((particles[:, 2] - place.theta + math.pi) % (2 * math.pi) - math.pi)
    return (np.hypot(particles[:, 0] - place.x, particles[:, 1] - place.y) < reach) & (off < turned)


def test_a_search_looks_up_a_third_of_the_beams_and_finds_the_same_places(search, monkeypatch):
    clouds, view, noise, truth = search
    looked_up = []
    weigh = LikelihoodField.log_likelihood

    def counted(field, particles, points):
        looked_up.append(len(particles) * len(points))
        return weigh(field, particles, points)

    monkeypatch.setattr(LikelihoodField, "log_likelihood", counted)
    found = near(clouds.looked_for(view, noise).particles, truth).mean()
    assert sum(looked_up) < 0.4 * MIN_CANDIDATES * len(view.points)
    monkeypatch.setattr(hypothesis, "ROUGH_BEAMS", len(view.points))
    assert found > 0.9 * near(clouds.looked_for(view, noise).particles, truth).mean() > 0.03


def test_besides_a_place_nothing_is_looked_for_there(search):
    clouds, view, noise, truth = search
    besides = clouds.looked_for(view, noise, truth)
    # They are spread by some centimeters after the draw.
    assert near(besides.particles, truth, 0.8, 0.3).sum() == 0
    assert len(besides.particles) == 1000
