"""Planning of itineraries, asked for again and again."""

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import STANDSTILL, Neighbour
from sim.parameters import GlobalPlannerParameters, NavfnParameters, RobotParameters, WorldParameters
from sim.robot.costmap.costmap_2d import Costmap2D
from sim.robot.global_planning.itinerary import itineraries_of
from sim.robot.global_planning.itinerary_planner import BlockedByRobots, ItineraryPlanner, thinned
from sim.robot.global_planning.planners import global_planner
from sim.robot.global_planning.potential_planner import PotentialPlanner

BODY = np.array(WorldParameters().footprint)
HUNT = RobotParameters()
START, GOAL = Pose2(1.0, 1.0, 0.0), Pose2(5.0, 1.0, 0.0)


def corridor():
    cells = np.zeros((40, 120), np.int8)
    cells[[0, 1, -2, -1]] = 100
    cells[:, [0, 1, -2, -1]] = 100
    return OccupancyGrid(cells, 0.05, Pose2(0.0, 0.0, 0.0))


def itinerary_planner_and_path_planner():
    grid = corridor()
    costmap = Costmap2D(HUNT.global_costmap, BODY, grid)
    planner = global_planner("navfn/NavfnROS", NavfnParameters(), GlobalPlannerParameters())
    return ItineraryPlanner(grid, costmap, HUNT.global_costmap.inflation_layer, planner), planner


def barred(itineraries, start, goal):
    """Plan while a robot stands in the middle of the corridor."""
    other = Neighbour(1, Pose2(3.0, 1.0, 0.0), STANDSTILL, BODY, np.empty((0, 2)), np.empty(0))
    itineraries.update_neighbours([other])
    return itineraries.plan(start, goal, 0.0, itineraries_of([other]))


def test_the_wanted_path_is_planned_once_as_long_as_start_goal_and_planner_stay(monkeypatch: pytest.MonkeyPatch):
    itineraries, planner = itinerary_planner_and_path_planner()
    asked = []
    search = PotentialPlanner.search

    def counted(self, costs, *arguments):
        asked.append(costs is not itineraries.costmap.costs)
        return search(self, costs, *arguments)

    monkeypatch.setattr(PotentialPlanner, "search", counted)
    first, again = (barred(itineraries, START, GOAL) for _ in range(2))
    assert isinstance(first, BlockedByRobots)
    assert np.array_equal(first.wanted_path, again.wanted_path)
    assert asked.count(True) == 1
    elsewhere = Pose2(5.0, 0.9, 0.0)
    assert barred(itineraries, START, elsewhere).wanted_path[-1].tolist() == [5.0, 0.9]
    itineraries.configure(HUNT.global_costmap.inflation_layer, planner)
    assert barred(itineraries, START, elsewhere).wanted_path[-1].tolist() == [5.0, 0.9]
    assert asked.count(True) == 3


def test_thinning_keeps_the_ends():
    points = np.column_stack([np.linspace(0, 1, 51), np.zeros(51)])
    kept = thinned(points, 0.099)
    assert kept[0].tolist() == [0, 0]
    assert kept[-1].tolist() == [1, 0]
    assert len(kept) == 11
