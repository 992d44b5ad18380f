"""A robot's costmap as its parameters make it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from sim.costmap.costmap_2d import Costmap2D
from sim.costmap.costs import FREE, LETHAL, UNKNOWN
from sim.geometry import Pose2
from sim.grid import OccupancyGrid
from sim.observations import STANDSTILL, LaserMount, Neighbour, Scan
from sim.parameters import GlobalCostmapParameters, RobotParameters, StaticParameters, WorldParameters

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
    costmap.see([neighbour(Pose2(1.5, 1.5, 0.3))])
    costmap.update(0.0, 0.0)
    assert not np.array_equal(costmap.costs, before)
    assert np.array_equal(costmap.without_robots(), before)


def test_a_local_costmap_moves_along_and_keeps_what_the_laser_saw():
    costmap = Costmap2D(replace(HUNT.local_costmap, width=3.0, height=2.0), BODY, grid())
    assert costmap.costs.shape == (40, 60)
    costmap.observe(Pose2(1.0, 2.0, 0.0), Scan(0, MOUNT, np.array([1.0], np.float32)), np.empty((0, 3)))
    for x in (1.0, 1.3):
        costmap.update(x, 2.0)
        frame = costmap.frame
        row, col = int((2.0 - frame.y) / frame.resolution + 1e-9), int((2.0 - frame.x) / frame.resolution + 1e-9)
        assert costmap.costs[row, col] == LETHAL
        assert frame.x == pytest.approx(x - 1.5)
