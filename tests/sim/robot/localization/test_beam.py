import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.observations import LaserMount, Scan
from sim.common.raycast import Raycaster
from sim.parameters import AmclParameters
from sim.robot.localization.beam import BeamModel
from sim.robot.localization.likelihood_field import Beams

MOUNT = LaserMount(Pose2(0.2, -0.1, 2.0), 2.0, -0.1, 41, 0.05, 8.0)
HERE = Pose2(3.0, 1.0, 0.7)


@pytest.fixture(scope="module")
def model(arena):
    return BeamModel.of(arena, Beams.of(MOUNT, 41, -1.0), AmclParameters())


@pytest.fixture
def ranges(arena):
    laser = HERE.compose(MOUNT.laser_in_base).array()[None]
    seen = Raycaster.of(arena).ranges(laser, MOUNT.angles(), MOUNT.range_max)[0]
    return Beams.of(MOUNT, 41, -1.0).ranges(Scan(0, MOUNT, seen.astype(np.float32)))


def test_the_true_place_fits_best_however_the_laser_is_mounted(model, ranges):
    away = np.array([[0, 0, 0], [0.3, 0, 0], [0, -0.3, 0], [0, 0, 0.2], [2.0, 1.0, -1.0]])
    fit = model.log_likelihood(HERE.array() + away, ranges)
    assert fit.argmax() == 0


def test_lost_beams_say_nothing(model):
    lost = np.full(41, np.nan)
    assert model.log_likelihood(np.zeros((2, 3)), lost).tolist() == [0.0, 0.0]
    assert model.agreement(HERE, lost) is None


def test_a_place_explains_its_own_scan_and_others_standing_around_hardly_speak_against_it(model, ranges):
    assert model.agreement(HERE, ranges).share == pytest.approx(1.0, abs=0.05)
    assert model.agreement(HERE, ranges).cut_short == pytest.approx(0.0, abs=0.05)
    hidden = ranges.copy()
    hidden[::2] = np.minimum(hidden[::2], 0.4)
    assert 0.85 < model.agreement(HERE, hidden).share < 0.95
    assert model.agreement(HERE, hidden).cut_short == pytest.approx(0.5, abs=0.05)


def test_beams_through_walls_speak_loudest(model, ranges):
    through, short = ranges.copy(), ranges.copy()
    through[::2] = np.minimum(through[::2] + 2.0, 7.9)
    short[::2] *= 0.2
    assert model.agreement(HERE, through).share < model.agreement(HERE, short).share
