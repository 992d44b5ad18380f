import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import STANDSTILL, Neighbour
from sim.parameters import InflationParameters, RobotsParameters, StaticParameters, WorldParameters
from sim.robot.costmap.costs import FREE, LETHAL, UNKNOWN, Window
from sim.robot.costmap.inflation import InflationLayer
from sim.robot.costmap.layered import LayeredCostmap
from sim.robot.costmap.robots import RobotsLayer
from sim.robot.costmap.static import StaticLayer, interpretation

STUDY = np.array(WorldParameters().footprint)
STATIC = StaticParameters()
INSCRIBED_RADIUS = 0.26


def grid_of(occupied=(), rows=60, cols=80, unknown=()):
    cells = np.zeros((rows, cols), np.int8)
    for row, col in occupied:
        cells[row, col] = 100
    for row, col in unknown:
        cells[row, col] = -1
    return OccupancyGrid(cells, 0.05, Pose2(-1.0, -1.0, 0.0))


def neighbour(pose, robot=1, path=(), times=()):
    path = np.array(path, dtype=float).reshape(-1, 2)
    return Neighbour(robot, pose, STANDSTILL, STUDY, path, np.array(times, dtype=float))


def inflation(radius=0.5):
    return InflationLayer(InflationParameters(inflation_radius=radius), 0.05, INSCRIBED_RADIUS)


class TestStatic:
    def test_walls_are_lethal_and_unknown_cells_unknown(self):
        grid = grid_of([(3, 4)], unknown=[(5, 6)])
        costmap = LayeredCostmap(grid, [StaticLayer(STATIC, grid)])
        costmap.update()
        assert (costmap.costs[3, 4], costmap.costs[5, 6], costmap.costs[0, 0]) == (LETHAL, UNKNOWN, FREE)

    @given(st.integers(0, 100), st.integers(-128, 255), st.booleans(), st.booleans())
    def test_every_value_of_a_map_has_the_cost_that_static_layer_gives_it(self, lethal, unknown, track, trinary):
        parameters = StaticParameters(
            track_unknown_space=track,
            lethal_cost_threshold=lethal,
            unknown_cost_value=unknown,
            trinary_costmap=trinary,
        )
        costs = interpretation(parameters)
        for value in range(256):
            if value == unknown % 256:
                expected = UNKNOWN if track else FREE
            elif value >= lethal:
                expected = LETHAL
            else:
                expected = FREE if trinary else int(value / lethal * LETHAL)
            assert costs[value] == expected

    def test_with_use_maximum_it_only_raises_costs(self):
        grid = grid_of([(0, 0)], rows=2, cols=2, unknown=[(1, 1)])
        costs = np.array([[7, 8], [UNKNOWN, 9]], np.uint8)
        StaticLayer(StaticParameters(use_maximum=True), grid).write(costs, (0, 0), Window(0, 0, 2, 2))
        assert costs.tolist() == [[LETHAL, 8], [FREE, 9]]

    @pytest.mark.parametrize(("track", "beyond"), [(True, UNKNOWN), (False, FREE)])
    def test_beyond_the_map_all_is_as_the_costmap_begins(self, track, beyond):
        grid = grid_of([(0, 0)])
        rolling = LayeredCostmap(grid, [StaticLayer(STATIC, grid)], (40, 30), track_unknown_space=track)
        rolling.roll(-1.0, -1.0)
        rolling.update()
        assert (rolling.costs[:20, :] == beyond).all()
        assert rolling.costs[20, 15] == LETHAL
        assert (rolling.costs[21:, 16:] == FREE).all()


class TestUpdates:
    def test_changes_are_written_as_if_all_were_written_anew(self):
        grid = grid_of([(10, c) for c in range(20, 40)], rows=120, cols=160, unknown=[(60, c) for c in range(160)])
        robots = RobotsLayer(RobotsParameters(path_length=0.6), grid)
        costmap = LayeredCostmap(grid, [StaticLayer(STATIC, grid), robots, inflation()])
        for x in (0.0, 0.7, 1.5, 1.7):
            seen = [
                neighbour(Pose2(x, 0.5, x)),
                neighbour(Pose2(x + 0.6, 0.9, x), 2, [(x + 0.6, 0.9), (x + 0.9, 1.2), (x + 1.4, 2.2)]),
                neighbour(Pose2(6.0 - x, 4.0, x), 3),
            ]
            robots.update_neighbours(seen)
            costmap.update()
            fresh_robots = RobotsLayer(RobotsParameters(path_length=0.6), grid)
            fresh_robots.update_neighbours(seen)
            fresh = LayeredCostmap(grid, [StaticLayer(STATIC, grid), fresh_robots, inflation()])
            fresh.update()
            assert np.array_equal(costmap.costs, fresh.costs)

    def test_what_lies_far_apart_is_written_apart(self):
        grid = grid_of(rows=400, cols=400)
        robots = RobotsLayer(RobotsParameters(), grid)
        costmap = LayeredCostmap(grid, [StaticLayer(STATIC, grid), robots, inflation()])
        costmap.update()
        robots.update_neighbours([neighbour(Pose2(1.0, 1.0, 0.0), 1), neighbour(Pose2(17.0, 17.0, 0.0), 2)])
        windows = costmap.update()
        assert len(windows) == 2
        assert sum((end - row) * (right - left) for row, left, end, right in windows) < 4000

    def test_nothing_changed_nothing_written(self):
        grid = grid_of([(10, 10)])
        costmap = LayeredCostmap(grid, [StaticLayer(STATIC, grid), inflation()])
        assert costmap.update() == (Window(0, 0, 60, 80),)
        assert costmap.update() == ()

    @settings(max_examples=20, deadline=None)
    @given(st.floats(-1.0, 3.0), st.floats(-1.0, 2.0))
    def test_a_rolling_window_shows_what_the_whole_map_shows(self, x, y):
        grid = grid_of([(r, 30) for r in range(10, 50)])
        layers = [StaticLayer(STATIC, grid), inflation()]
        whole = LayeredCostmap(grid, layers)
        whole.update()
        rolling = LayeredCostmap(grid, layers, (30, 40))
        rolling.roll(x, y)
        rolling.update()
        # Inflation from beyond the window's rim is not seen, so compare what lies farther inside.
        row, col = rolling.origin
        inside = Window(row + 10, col + 10, row + 20, col + 30).clipped(Window(0, 0, 60, 80))
        if not inside.empty:
            assert np.array_equal(inside.of(rolling.costs, rolling.origin), inside.of(whole.costs))
        assert rolling.frame.x == pytest.approx(-1.0 + col * 0.05)
        assert abs(rolling.frame.x + 1.0 - x) <= 0.025 + 1e-9


class TestRobots:
    def test_a_footprint_is_lethal_where_the_robot_is(self):
        grid = grid_of()
        layer = RobotsLayer(RobotsParameters(), grid)
        layer.update_neighbours([neighbour(Pose2(0.5, 0.5, 0.4))])
        costmap = LayeredCostmap(grid, [StaticLayer(STATIC, grid), layer])
        costmap.update()
        assert costmap.costs[grid.cell_of(0.5, 0.5)] == LETHAL
        # The body without its nose is half a meter square, the nose adds 0.1 x 0.5 / 2.
        assert (costmap.costs == LETHAL).sum() * 0.05**2 == pytest.approx(0.275, abs=0.02)

    def test_the_first_part_of_its_path_costs_more_than_free_space_and_bars_nothing(self):
        grid = grid_of()
        layer = RobotsLayer(RobotsParameters(path_length=1.0, path_cost=99), grid)
        layer.update_neighbours(
            [neighbour(Pose2(0.0, 0.0, 0.0), path=[(0.0, 0.0), (0.7, 0.0), (0.7, 1.5)], times=(1.0, 2.0, 3.0))]
        )
        costmap = LayeredCostmap(grid, [StaticLayer(STATIC, grid), layer])
        costmap.update()
        assert costmap.costs[grid.cell_of(0.6, 0.0)] == 99
        assert costmap.costs[grid.cell_of(0.7, 0.2)] == 99
        assert costmap.costs[grid.cell_of(0.7, 0.4)] == FREE

    def test_robots_under_way_need_not_bar_plans(self):
        grid = grid_of()
        layer = RobotsLayer(RobotsParameters(under_way=False), grid)
        layer.update_neighbours([neighbour(Pose2(0.5, 0.5, 0.0))])
        assert layer.bounds()
        layer.update_neighbours([neighbour(Pose2(0.5, 0.5, 0.0), times=(1.0, 2.0))])
        assert layer.bounds()
        costmap = LayeredCostmap(grid, [StaticLayer(STATIC, grid), layer])
        costmap.update()
        assert (costmap.costs == FREE).all()

    def test_what_nobody_asks_for_is_not_heaped_up_and_not_lost(self):
        layer = RobotsLayer(RobotsParameters(), grid_of())
        for step in range(1000):
            layer.update_neighbours([neighbour(Pose2(0.002 * step, 0.5, 0.1 * step))])
        windows = layer.bounds()
        assert len(windows) <= 101
        assert min(window.col for window in windows) <= 14
