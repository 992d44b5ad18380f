import math

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import LaserMount, Scan
from sim.robot.localization.likelihood_field import Beams, LikelihoodField, facing_distance

MOUNT = LaserMount(Pose2(0.2, 0.1, 0.3), -1.0, 0.1, 21, 0.125, 5.0)
ORIGIN = Pose2(-1.0, -2.0, 0.0)


def box(origin: Pose2 = ORIGIN) -> OccupancyGrid:
    cells = np.zeros((40, 60), dtype=np.int8)
    cells[:2] = cells[-2:] = 100
    cells[:, :2] = cells[:, -2:] = 100
    cells[20, 20:30] = -1
    return OccupancyGrid(cells, 0.1, origin)


def field_of(grid: OccupancyGrid, beams: Beams) -> LikelihoodField:
    return LikelihoodField.of(grid, beams, z_hit=0.9, z_rand=0.1, sigma_hit=0.2, max_dist=1.5)


def test_distances_are_those_to_the_side_of_a_wall_that_a_beam_can_meet():
    cells = np.zeros((20, 30), dtype=np.int8)
    cells[:, 10:12] = 100
    lower, higher = facing_distance(OccupancyGrid(cells, 0.1, ORIGIN), 1.5)[:2, 10]
    assert higher[7:14] == pytest.approx((0.25, 0.15, 0.05, 0.05, 0.15, 0.25, 0.35))
    assert lower[8:15] == pytest.approx((0.35, 0.25, 0.15, 0.05, 0.05, 0.15, 0.25))
    assert lower.max() == higher.max() == 1.5


def test_a_beam_through_a_thin_wall_ends_off_the_map_though_near_a_wall():
    cells = np.zeros((60, 60), dtype=np.int8)
    cells[:, 30:32] = 100
    grid = OccupancyGrid(cells, 0.05, Pose2(0, 0, 0))
    mount = LaserMount(Pose2(0, 0, 0), 0.0, 0.1, 2, 0.05, 5.0)
    field = LikelihoodField.of(grid, Beams.of(mount, 2, -1.0), 0.9, 0.1, 0.1, 1.0)
    # A meter from the near side of the wall, and 5 cm behind its far side.
    before, behind = (field.log_likelihood(np.array([[0.5, 1.5, 0.0]]), np.array([[x, 0.0]]))[0] for x in (1.0, 1.15))
    assert before > behind + 1.0


def test_a_map_without_walls_is_far_from_all():
    grid = OccupancyGrid(np.zeros((5, 5), dtype=np.int8), 0.1, Pose2(0, 0, 0))
    assert facing_distance(grid, 1.5) == pytest.approx(1.5)


@pytest.mark.parametrize("origin", [ORIGIN, Pose2(0.5, 0.3, 0.7)])
def test_log_likelihood_is_that_of_table_6_3(origin):
    grid = box(origin)
    beams = Beams.of(MOUNT, 10, -1.0)
    field = field_of(grid, beams)
    distances = facing_distance(grid, 1.5)
    laser = MOUNT.laser_in_base.array()[:2]
    rng = np.random.default_rng(5)
    particles = rng.uniform((-3, -4, -3), (7, 4, 3), (50, 3))
    points = rng.uniform(-2, 2, (10, 2))
    got = field.log_likelihood(particles, points)
    for i, particle in enumerate(particles):
        total = 0.0
        in_grid = Pose2(*particle).theta - origin.theta
        for (x, y), beam in zip(Pose2(*particle).transform(points), points - laser, strict=True):
            row, col = grid.cell_of(x, y)
            right, up = Pose2(0.0, 0.0, in_grid).transform(beam[None])[0] > 0.0
            distance = distances[right + 2 * up, row, col] if grid.contains(row, col) else 1.5
            total += math.log(0.9 * math.exp(-(distance**2) / (2 * 0.2**2)) + 0.1 / 5.0)
        assert got[i] == pytest.approx(total, rel=1e-5)


def test_without_random_readings_the_logarithm_stays_finite():
    field = LikelihoodField.of(box(), Beams.of(MOUNT, 10, -1.0), 1.0, 0.0, 0.001, 2.0)
    assert np.isfinite(field.values).all() and math.isfinite(field.outside)


def test_no_beams_say_nothing():
    field = field_of(box(), Beams.of(MOUNT, 10, -1.0))
    assert field.log_likelihood(np.zeros((3, 3)), np.empty((0, 2))).tolist() == [0, 0, 0]


@pytest.mark.parametrize("wanted", [2, 7, 20, 21])
def test_as_many_beams_as_asked_from_edge_to_edge(wanted):
    indices = Beams.of(MOUNT, wanted, -1.0).indices
    assert len(set(indices.tolist())) == wanted
    assert (indices[0], indices[-1]) == (0, 20)
    assert np.diff(indices).max() - np.diff(indices).min() <= 1


def test_no_more_beams_than_there_are():
    assert len(Beams.of(MOUNT, 500, -1.0).indices) == 21


def test_readings_that_say_nothing_are_skipped():
    ranges = np.full(21, 2.0, dtype=np.float32)
    ranges[:7] = (np.nan, np.inf, -np.inf, 0.125, 0.05, 5.0, 9.0)
    assert len(Beams.of(MOUNT, 21, -1.0).end_points(Scan(0, MOUNT, ranges))) == 14
    assert len(Beams.of(MOUNT, 21, 1.9).end_points(Scan(0, MOUNT, ranges))) == 0


def test_end_points_are_seen_from_the_base():
    scan = Scan(0, MOUNT, np.linspace(1, 3, 21, dtype=np.float32))
    angles = MOUNT.angles()
    in_laser = np.linspace(1, 3, 21)[:, None] * np.stack((np.cos(angles), np.sin(angles)), axis=1)
    expected = MOUNT.laser_in_base.transform(in_laser)
    assert Beams.of(MOUNT, 21, -1.0).end_points(scan) == pytest.approx(expected, abs=1e-6)
