import math

import numpy as np
import pytest

from sim.common.geometry import IDENTITY, Pose2
from sim.common.grid import OccupancyGrid
from sim.robot.localization.likelihood_field import Beams
from sim.robot.localization.scan_matching import ScanMatcher


def test_a_match_finds_back_from_decimetres_off(drive):
    # Seen at every second; the guess is off to all sides in turn.
    tour = drive(seed=1)
    matcher, beams = ScanMatcher.of(tour.grid, tour.mount.laser_in_base), Beams.of(tour.mount, 60, -1.0)
    errors = []
    for i, moment in enumerate(tour.moments[::50]):
        off = Pose2(0.2 * math.cos(i), 0.2 * math.sin(i), 0.1 * (-1) ** i)
        match = matcher.match(moment.truth.compose(off), beams.end_points(moment.scan), 0.5)
        errors.append(moment.truth.distance(match.base_in_map))
    assert np.median(errors) < 0.02
    assert np.mean(np.array(errors) < 0.05) > 0.9


def test_robots_before_the_walls_do_not_pull_a_good_guess(drive):
    tour = drive(seed=1, others=5)
    matcher, beams = ScanMatcher.of(tour.grid, tour.mount.laser_in_base), Beams.of(tour.mount, 60, -1.0)
    errors = [
        moment.truth.distance(matcher.match(moment.truth, beams.end_points(moment.scan), 0.05).base_in_map)
        for moment in tour.moments[::50]
    ]
    assert np.median(errors) < 0.02


def test_a_corridor_leaves_its_direction_open():
    cells = np.zeros((40, 200), dtype=np.int8)
    cells[:2] = cells[-2:] = 100
    grid = OccupancyGrid(cells, 0.05, Pose2(0, -1.0, 0.0))
    xs = np.linspace(-2, 2, 20)
    points = np.concatenate((np.stack((xs, np.full(20, 0.9)), axis=1), np.stack((xs, np.full(20, -0.9)), axis=1)))
    match = ScanMatcher.of(grid, IDENTITY).match(Pose2(5.0, 0.1, 0.05), points, 0.3)
    assert match.base_in_map.x == pytest.approx(5.0, abs=0.02)
    assert match.base_in_map.y == pytest.approx(0.0, abs=0.01)
    assert match.base_in_map.theta == pytest.approx(0.0, abs=0.01)
    assert match.information[0, 0] < 1e-6 * match.information[1, 1]


def test_two_points_fix_no_pose(arena):
    assert ScanMatcher.of(arena, IDENTITY).match(Pose2(0, 0, 0), np.zeros((2, 2)), 0.1) is None


def test_points_off_the_map_say_nothing(arena):
    match = ScanMatcher.of(arena, IDENTITY).match(Pose2(500.0, 0, 0), np.eye(3)[:, :2], 0.1)
    assert match.base_in_map == Pose2(500.0, 0, 0)
    assert not match.information.any()
