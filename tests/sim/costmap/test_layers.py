import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import distance_transform_edt

from sim.costmap.costs import FREE, INSCRIBED, LETHAL, UNKNOWN, Window, cost_at
from sim.costmap.inflation import InflationLayer
from sim.costmap.layered import LayeredCostmap
from sim.costmap.obstacle import ObstacleLayer
from sim.costmap.robots import RobotsLayer
from sim.costmap.static import StaticLayer, static_costs
from sim.geometry import Pose2
from sim.grid import OccupancyGrid
from sim.observations import STANDSTILL, LaserMount, Neighbour, Scan
from sim.parameters import InflationParameters, ObstacleParameters, WorldParameters

STUDY = np.array(WorldParameters().footprint)
INSCRIBED_RADIUS = 0.26
MOUNT = LaserMount(Pose2(0.0, 0.0, 0.0), 0.0, 0.1, 1, 0.05, 8.0)


def grid_of(occupied=(), rows=60, cols=80, unknown=()):
    cells = np.zeros((rows, cols), np.int8)
    for row, col in occupied:
        cells[row, col] = 100
    for row, col in unknown:
        cells[row, col] = -1
    return OccupancyGrid(cells, 0.05, Pose2(-1.0, -1.0, 0.0))


def neighbour(pose, robot=1, times=()):
    return Neighbour(robot, pose, STANDSTILL, STUDY, np.zeros((len(times), 2)), np.array(times, dtype=float))


def scan(reading):
    return Scan(0, MOUNT, np.array([reading], np.float32))


def test_cost_falls_as_costmap_2d_says():
    assert cost_at(0.0, 0.26, 10.0) == LETHAL
    assert cost_at(0.26, 0.26, 10.0) == INSCRIBED
    assert cost_at(0.36, 0.26, 10.0) == int(252 * math.exp(-1.0))


def test_walls_are_lethal_and_unknown_cells_unknown():
    grid = grid_of([(3, 4)], unknown=[(5, 6)])
    costmap = LayeredCostmap(grid, [StaticLayer(grid)])
    costmap.update(0.0, 0.0)
    assert (costmap.costs[3, 4], costmap.costs[5, 6], costmap.costs[0, 0]) == (LETHAL, UNKNOWN, FREE)


@settings(max_examples=30, deadline=None)
@given(st.lists(st.tuples(st.integers(0, 59), st.integers(0, 79)), min_size=1, max_size=60))
def test_inflation_is_the_cost_of_the_exact_distance(occupied):
    grid = grid_of(occupied)
    parameters = InflationParameters()
    costmap = LayeredCostmap(grid, [StaticLayer(grid), InflationLayer(parameters, 0.05, INSCRIBED_RADIUS)])
    costmap.update(0.0, 0.0)
    distances = distance_transform_edt(grid.cells != 100) * 0.05
    for (row, col), cost in np.ndenumerate(costmap.costs):
        distance = distances[row, col]
        expected = cost_at(distance, INSCRIBED_RADIUS, 10.0) if distance <= 0.5 + 1e-9 else 0
        assert cost == expected


def test_a_change_is_written_as_if_all_were_written_anew():
    grid = grid_of([(10, c) for c in range(20, 40)])
    inflation = InflationLayer(InflationParameters(), 0.05, INSCRIBED_RADIUS)
    robots = RobotsLayer(grid, resting_only=False)
    costmap = LayeredCostmap(grid, [StaticLayer(grid), robots, inflation])
    for x in (0.0, 0.7, 1.5):
        robots.see([neighbour(Pose2(x, 0.5, x))])
        costmap.update(0.0, 0.0)
        fresh_robots = RobotsLayer(grid, resting_only=False)
        fresh_robots.see([neighbour(Pose2(x, 0.5, x))])
        fresh = LayeredCostmap(grid, [StaticLayer(grid), fresh_robots, inflation])
        fresh.update(0.0, 0.0)
        assert np.array_equal(costmap.costs, fresh.costs)


def test_nothing_changed_nothing_written():
    grid = grid_of([(10, 10)])
    costmap = LayeredCostmap(grid, [StaticLayer(grid), InflationLayer(InflationParameters(), 0.05, 0.26)])
    assert costmap.update(0.0, 0.0) == Window(0, 0, 60, 80)
    assert costmap.update(0.0, 0.0).empty


def test_a_rolling_window_shows_what_the_whole_map_shows():
    grid = grid_of([(r, 30) for r in range(10, 50)])
    layers = [StaticLayer(grid), InflationLayer(InflationParameters(), 0.05, INSCRIBED_RADIUS)]
    whole = LayeredCostmap(grid, layers)
    whole.update(0.0, 0.0)
    rolling = LayeredCostmap(grid, layers, 40)
    rolling.update(0.6, 0.5)
    row, col = rolling.origin
    # Inflation from beyond the window's rim is not seen, so compare what lies farther inside.
    inside = np.s_[10:-10]
    assert np.array_equal(rolling.costs[inside, inside], whole.costs[row + 10 : row + 30, col + 10 : col + 30])
    assert rolling.frame.x == pytest.approx(-1.0 + col * 0.05)


def test_beyond_the_map_all_is_unknown():
    grid = grid_of()
    rolling = LayeredCostmap(grid, [StaticLayer(grid)], 40)
    rolling.update(-1.0, -1.0)
    assert (rolling.costs[:20, :] == UNKNOWN).all()
    assert (rolling.costs[20:, 20:] == FREE).all()


def test_a_reading_in_the_open_marks_and_a_longer_one_clears():
    grid = grid_of([(r, 79) for r in range(60)])
    layer = ObstacleLayer(ObstacleParameters(), grid)
    layer.observe(Pose2(0.0, 0.0, 0.0), scan(1.0), np.empty((0, 3)))
    row, col = grid.cell_of(1.0, 0.0)
    assert layer.marks[row, col] == LETHAL
    assert layer.bounds() == Window(row, col, row + 1, col + 1)
    layer.observe(Pose2(0.0, 0.0, 0.0), scan(2.9), np.empty((0, 3)))
    assert not layer.any_marks
    assert layer.bounds() == Window(row, col, row + 1, col + 1)


@pytest.mark.parametrize("reading", [math.nan, math.inf, 1.6, 0.01])
def test_lost_far_and_too_near_readings_do_not_mark(reading):
    layer = ObstacleLayer(ObstacleParameters(), grid_of())
    layer.observe(Pose2(0.0, 0.0, 0.0), scan(reading), np.empty((0, 3)))
    assert not layer.any_marks


def test_readings_that_the_map_or_a_robot_explains_do_not_mark():
    grid = grid_of([(r, 40) for r in range(60)])
    layer = ObstacleLayer(ObstacleParameters(), grid)
    layer.observe(Pose2(0.0, 0.0, 0.0), scan(0.9), np.empty((0, 3)))
    assert not layer.any_marks
    layer.observe(Pose2(0.0, 0.0, 0.0), scan(0.5), np.array([[0.8, 0.0, 0.35]]))
    assert not layer.any_marks
    layer.observe(Pose2(0.0, 0.0, 0.0), scan(0.5), np.empty((0, 3)))
    assert layer.any_marks


def test_clearing_forgets_all():
    layer = ObstacleLayer(ObstacleParameters(), grid_of())
    layer.observe(Pose2(0.0, 0.0, 0.0), scan(1.0), np.empty((0, 3)))
    layer.bounds()
    layer.clear()
    assert not layer.any_marks
    assert not layer.bounds().empty


def test_a_footprint_is_lethal_where_the_robot_is():
    grid = grid_of()
    layer = RobotsLayer(grid, resting_only=False)
    layer.see([neighbour(Pose2(0.5, 0.5, 0.4))])
    costmap = LayeredCostmap(grid, [StaticLayer(grid), layer])
    costmap.update(0.0, 0.0)
    assert costmap.costs[grid.cell_of(0.5, 0.5)] == LETHAL
    # The body without its nose is half a metre square, the nose adds 0.1 x 0.5 / 2.
    assert (costmap.costs == LETHAL).sum() * 0.05**2 == pytest.approx(0.275, abs=0.02)


def test_robots_on_their_way_do_not_bar_plans():
    grid = grid_of()
    layer = RobotsLayer(grid, resting_only=True)
    layer.see([neighbour(Pose2(0.5, 0.5, 0.0))])
    assert not layer.bounds().empty
    layer.see([neighbour(Pose2(0.5, 0.5, 0.0), times=(1.0, 2.0))])
    assert not layer.bounds().empty
    costmap = LayeredCostmap(grid, [StaticLayer(grid), layer])
    costmap.update(0.0, 0.0)
    assert (costmap.costs == FREE).all()


def test_walls_inflated_once_cost_what_they_cost_anew():
    rng = np.random.default_rng(3)
    cells = rng.choice([0, 0, 0, 0, 0, 0, 100, -1], (70, 90)).astype(np.int8)
    cells[20:50, 30:60] = 0
    grid = OccupancyGrid(cells, 0.05, Pose2(0, 0, 0))
    parameters = InflationParameters()
    plain = InflationLayer(parameters, 0.05, INSCRIBED_RADIUS)
    walls = plain.inflated(static_costs(grid))
    done = InflationLayer(parameters, 0.05, INSCRIBED_RADIUS, walls)
    robots = RobotsLayer(grid, resting_only=False)
    robots.see([Neighbour(1, Pose2(2.2, 1.7, 0.4), STANDSTILL, STUDY, np.empty((0, 2)), np.empty(0))])
    anew = LayeredCostmap(grid, [StaticLayer(grid), robots, plain])
    once = LayeredCostmap(grid, [StaticLayer(grid, walls), robots, done])
    anew.update(0.0, 0.0)
    once.update(0.0, 0.0)
    assert np.array_equal(once.costs, anew.costs)
