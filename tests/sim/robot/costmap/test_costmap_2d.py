"""A robot's costmap as its parameters make it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import STANDSTILL, LaserMount, Neighbour, Scan
from sim.parameters import (
    GlobalCostmapParameters,
    InflationParameters,
    RobotParameters,
    RobotsParameters,
    StaticParameters,
    WorldParameters,
)
from sim.robot.costmap.costmap_2d import Costmap2D
from sim.robot.costmap.costs import FREE, LETHAL, UNKNOWN
from sim.robot.costmap.obstacle import CostmapObservation

BODY = np.array(WorldParameters().footprint)
HUNT = RobotParameters()
MOUNT = LaserMount(Pose2(0.0, 0.0, 0.0), 0.0, 0.1, 1, 0.05, 8.0)


def grid():
    cells = np.zeros((80, 100), np.int8)
    cells[:, 60] = 100
    cells[:5, :5] = -1
    return OccupancyGrid(cells, 0.05, Pose2(0.0, 0.0, 0.0))


def neighbour(pose):
    return Neighbour(1, pose, STANDSTILL, BODY, np.empty((0, 2)), np.empty(0))


def test_the_footprint_is_the_given_one_or_the_round_one_or_the_bodys():
    corners = ((0.1, 0.1), (-0.1, 0.1), (-0.1, -0.1), (0.1, -0.1))
    given = Costmap2D(GlobalCostmapParameters(footprint=corners, footprint_padding=0.0), BODY, grid())
    assert given.footprint.tolist() == [list(corner) for corner in corners]
    a_round = Costmap2D(GlobalCostmapParameters(robot_radius=0.3, footprint_padding=0.0), BODY, grid())
    assert a_round.footprint.shape == (16, 2)
    assert a_round.circumscribed_radius == pytest.approx(0.3)
    assert a_round.inscribed_radius == pytest.approx(0.3 * math.cos(math.pi / 16))
    assert Costmap2D(GlobalCostmapParameters(robot_radius=None), BODY, grid()).inscribed_radius == pytest.approx(0.26)


def test_a_layer_that_is_not_enabled_makes_no_costs():
    parameters = replace(GlobalCostmapParameters(), static_layer=StaticParameters(enabled=False))
    costmap = Costmap2D(parameters, BODY, grid())
    costmap.update(0.0, 0.0)
    assert (costmap.costs == FREE).all()


@pytest.mark.parametrize(("track", "expected"), [(True, UNKNOWN), (False, FREE)])
def test_unknown_cells_become_free_where_unknown_space_is_not_tracked(track, expected):
    """The obstacle layer's cells then begin as free, and free is more than unknown: so it is in ROS."""
    costmap = Costmap2D(replace(HUNT.global_costmap, track_unknown_space=track), BODY, grid())
    costmap.update(0.0, 0.0)
    assert costmap.costs[0, 0] == expected


def test_the_robots_can_be_thought_away():
    costmap = Costmap2D(HUNT.global_costmap, BODY, grid())
    costmap.update(0.0, 0.0)
    before = costmap.costs.copy()
    costmap.update_neighbours([neighbour(Pose2(1.5, 1.5, 0.3))])
    costmap.update(0.0, 0.0)
    assert not np.array_equal(costmap.costs, before)
    assert np.array_equal(costmap.without_robots(), before)


def test_a_local_costmap_moves_along_and_keeps_what_the_laser_saw():
    costmap = Costmap2D(replace(HUNT.local_costmap, width=3.0, height=2.0), BODY, grid())
    assert costmap.costs.shape == (40, 60)
    costmap.observe(
        CostmapObservation(Pose2(1.0, 2.0, 0.0), Scan(0, MOUNT, np.array([1.0], np.float32)), np.empty((0, 3)))
    )
    for x in (1.0, 1.3):
        costmap.update(x, 2.0)
        frame = costmap.frame
        row, col = int((2.0 - frame.y) / frame.resolution + 1e-9), int((2.0 - frame.x) / frame.resolution + 1e-9)
        assert costmap.costs[row, col] == LETHAL
        assert frame.x == pytest.approx(x - 1.5)


def seeing(parameters):
    """A costmap that has seen an obstacle before a wall, and heard of a robot."""
    costmap = Costmap2D(parameters, BODY, grid())
    look = CostmapObservation(Pose2(1.0, 2.0, 0.0), Scan(0, MOUNT, np.array([0.8], np.float32)), np.empty((0, 3)))
    costmap.observe(look)
    costmap.update_neighbours([neighbour(Pose2(1.5, 1.2, 0.3))])
    costmap.update(1.0, 2.0)
    return costmap


@pytest.mark.parametrize("standard", [HUNT.global_costmap, HUNT.local_costmap], ids=["global", "local"])
@pytest.mark.parametrize(
    "change",
    [
        {"inflation_layer": InflationParameters(inflation_radius=0.9, cost_scaling_factor=2.0)},
        {"static_layer": StaticParameters(enabled=False)},
        {"footprint_padding": 0.1},
        {"update_frequency": 1.0},
    ],
)
def test_a_costmap_configured_anew_is_as_if_it_had_always_been_so(standard, change):
    costmap, new = seeing(standard), replace(standard, **change)
    costmap.configure(new)
    other = seeing(new)
    assert np.array_equal(costmap.costs, other.costs)
    assert costmap.frame == other.frame
    assert costmap.obstacles.any_marks
    costmap.update(1.2, 2.0)
    other.update(1.2, 2.0)
    assert np.array_equal(costmap.costs, other.costs)


def test_a_layer_switched_off_and_on_again_has_forgotten_nothing():
    costmap = seeing(HUNT.global_costmap)
    before = costmap.costs.copy()
    blind = replace(HUNT.global_costmap, obstacle_layer=replace(HUNT.global_costmap.obstacle_layer, enabled=False))
    costmap.configure(blind)
    assert not np.array_equal(costmap.costs, before)
    costmap.configure(HUNT.global_costmap)
    assert np.array_equal(costmap.costs, before)


@pytest.mark.parametrize("standard", [HUNT.global_costmap, HUNT.local_costmap], ids=["global", "local"])
def test_what_an_update_would_make_of_a_costmap_is_what_it_makes(standard):
    costmap = seeing(standard)
    before, marks = costmap.costs.copy(), costmap.obstacles.marks.copy()
    look = CostmapObservation(Pose2(1.1, 1.8, 0.1), Scan(25, MOUNT, np.array([0.6], np.float32)), np.empty((0, 3)))
    others = [neighbour(Pose2(0.4, 2.9, -1.0))]
    costs, frame = costmap.as_updated(1.1, 1.8, others, look)
    assert np.array_equal(costmap.costs, before)
    assert np.array_equal(costmap.obstacles.marks, marks)
    assert not np.array_equal(costs, before)
    costmap.observe(look)
    costmap.update_neighbours(others)
    costmap.update(1.1, 1.8)
    assert np.array_equal(costmap.costs, costs)
    assert costmap.frame == frame


@pytest.mark.parametrize("path_length", [0.0, 1.5])
@given(st.lists(st.tuples(st.floats(-2, 7), st.floats(-2, 6), st.floats(-3, 3)), max_size=6))
@settings(max_examples=40)
def test_a_local_costmap_is_shown_with_all_robots_that_reach_into_it(path_length, poses):
    layer = RobotsParameters(path_length=path_length)
    costmap = Costmap2D(replace(HUNT.local_costmap, width=2.0, height=2.0, robots_layer=layer), BODY, grid())
    ways = [np.array([(x, y), (x + 1.0, y - 1.0)]) for x, y, _ in poses]
    others = [
        Neighbour(number, Pose2(*pose), STANDSTILL, BODY, way, np.array([0.0, 2.0]))
        for number, (pose, way) in enumerate(zip(poses, ways, strict=True))
    ]
    shown, _ = costmap.as_updated(2.0, 2.0, others)
    costmap.update_neighbours(others)
    costmap.update(2.0, 2.0)
    assert np.array_equal(costmap.costs, shown)


def test_what_the_laser_saw_can_be_thought_away_too():
    costmap, unseeing = seeing(HUNT.global_costmap), Costmap2D(HUNT.global_costmap, BODY, grid())
    unseeing.update(0.0, 0.0)
    assert np.array_equal(costmap.without_observations(), unseeing.costs)
    assert not np.array_equal(costmap.without_robots(), unseeing.costs)
