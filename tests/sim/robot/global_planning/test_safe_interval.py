import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import distance_transform_edt

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import STANDSTILL, Neighbour
from sim.robot.global_planning.itinerary import densified, itineraries_of, keeps_separation, timed_itinerary
from sim.robot.global_planning.safe_interval import _distances, make_roadmap, refuge, route

SQUARE = np.array([[0.25, 0.25], [-0.25, 0.25], [-0.25, -0.25], [0.25, -0.25]])
NEAR = 0.9


def chart_of(picture):
    """A map drawn with one letter a square meter, the last line at y = 0."""
    cells = np.array([[100 if letter == "#" else 0 for letter in row] for row in picture[::-1]], np.int8)
    grid = OccupancyGrid(np.kron(cells, np.ones((20, 20), np.int8)), 0.05, Pose2(0.0, 0.0, 0.0))
    return make_roadmap(grid, distance_transform_edt(grid.cells == 0) * 0.05, 0.4)


CORRIDOR = chart_of(["##############", "#######.######", "#............#", "##############"])


def told(robot, itinerary):
    return Neighbour(robot, Pose2(*itinerary.points[0], 0.0), STANDSTILL, SQUARE, itinerary.points, itinerary.times)


def standing(robot, x, y):
    return Neighbour(robot, Pose2(x, y, 0.0), STANDSTILL, SQUARE, np.empty((0, 2)), np.empty(0))


def between(start, goal, others):
    return route(CORRIDOR, CORRIDOR.free, np.array(start), np.array(goal), 10.0, itineraries_of(others), NEAR)


def test_alone_it_goes_straight():
    way = between((1.5, 1.5), (12.5, 1.5), [])
    assert np.hypot(*np.diff(way.points, axis=0).T).sum() == pytest.approx(11.0, abs=0.5)
    assert way.times[0] == 10.0
    assert way.unhindered_from == -np.inf


def test_it_lets_an_oncoming_robot_pass_where_there_is_room():
    oncoming = timed_itinerary(np.column_stack([np.linspace(12.5, 1.5, 111), np.full(111, 1.5)]), 10.0)
    way = densified(between((1.5, 1.5), (12.5, 1.5), [standing(0, 0.5, 9.0)]))
    assert not keeps_separation(way.points, way.times, itineraries_of([told(1, oncoming)]), NEAR)
    way = between((6.0, 1.5), (12.0, 1.5), [told(1, oncoming)])
    assert way is not None
    way = densified(way)
    assert keeps_separation(way.points, way.times, itineraries_of([told(1, oncoming)]), NEAR - 0.15)
    # The bay above the corridor's middle is the only place to wait.
    assert way.points[:, 1].max() > 2.0
    # From the bay on it drives as if it were alone: after the oncoming one has passed.
    off = np.flatnonzero(way.points[:, 1] > 2.0)[-1]
    passes = 10.0 + (12.5 - way.points[off, 0]) / 0.5
    assert way.times[off] + 1.0 >= way.unhindered_from >= passes - 1.0
    on = way.times >= way.unhindered_from
    assert np.hypot(*np.diff(way.points[on], axis=0).T).sum() / 0.5 <= way.times[-1] - way.unhindered_from + 0.1


def test_there_is_no_way_past_a_robot_that_stands_in_a_corridor():
    assert between((1.5, 1.5), (12.5, 1.5), [standing(1, 9.0, 1.5)]) is None


def test_a_refuge_is_off_the_wanted_path():
    wish = np.column_stack([np.linspace(1.5, 12.5, 111), np.full(111, 1.5)])
    away = refuge(
        CORRIDOR, CORRIDOR.free, np.array([5.5, 1.5]), wish, 0.0, itineraries_of([standing(0, 1.5, 1.5)]), NEAR
    )
    assert away is not None
    assert np.hypot(*(wish - away.points[-1]).T).min() >= NEAR
    assert (
        refuge(CORRIDOR, CORRIDOR.free, np.array([5.5, 1.5]), wish, 0.0, itineraries_of([standing(0, 6.7, 1.5)]), NEAR)
        is None
    )


def swept(free, targets, side):
    """Distances by sweeps over all cells until nothing changes."""
    rows, cols = free.shape
    field = np.where(targets & free, 0.0, np.inf)
    cells = [(r, c) for r in range(rows) for c in range(cols)]
    changed = True
    while changed:
        changed = False
        for r, c in cells:
            around = [(r + dr, c + dc) for dr in (-1, 0, 1) for dc in (-1, 0, 1) if (dr, dc) != (0, 0)]
            near = [(i, j) for i, j in around if 0 <= i < rows and 0 <= j < cols and free[i, j]]
            step = {(i, j): side if i == r or j == c else math.sqrt(2.0) * side for i, j in near}
            best = min([field[r, c], *(field[cell] + step[cell] for cell in near)])
            if free[r, c] and best < field[r, c] - 1e-9:
                field[r, c] = best
                changed = True
        cells.reverse()
    return field


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=30, deadline=None)
def test_distances_to_go_are_those_of_sweeps_over_all_cells(seed):
    random = np.random.default_rng(seed)
    free = random.random((14, 17)) < random.uniform(0.4, 1.0)
    targets = random.random(free.shape) < 0.02
    assert np.array_equal(_distances(free, targets, 0.2), swept(free, targets, 0.2))
