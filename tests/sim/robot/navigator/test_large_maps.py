"""Robots on maps over which a wave takes longer than a tick may."""

from dataclasses import replace

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.inputs import SendGoal
from sim.parameters import RobotParameters, WorldParameters
from sim.robot.costmap.costmap_2d import Costmap2D
from sim.robot.global_planning import potential_planner
from sim.robot.global_planning.itinerary import POINT_SPACING
from sim.robot.global_planning.itinerary_planner import thinned
from sim.robot.global_planning.navfn import Navfn
from sim.robot.global_planning.potential_planner import PotentialPlanner
from sim.robot.navigator.goals import Cancelled, Goal, GoalReached, NoPath
from sim.robot.navigator.states import Controlling, Planning
from sim.team import Team
from tests.sim.robot.navigator.ideal_robots import ROOMS, IdealRobots, everybody_arrived
from tests.support.maps.large_office import large_office

OFFICE = large_office()
HUNT = RobotParameters(localization="truth")
FAR = OFFICE.rooms[-1].goal


def team(robots, grid=OFFICE.grid, software=HUNT):
    return Team(grid, WorldParameters(), [software] * robots, OFFICE.starts[:robots], 1, 1e9)


def whole_wave(goal):
    """The points of the path that one wave over the whole office finds at once."""
    costmap = Costmap2D(HUNT.global_costmap, np.array(WorldParameters().footprint), OFFICE.grid)
    path = PotentialPlanner(Navfn(HUNT.NavfnROS)).plan(costmap.costs, costmap.frame, OFFICE.starts[0], goal)
    return thinned(path.poses[:, :2], POINT_SPACING)


def test_a_long_way_is_planned_within_some_ticks_and_is_that_of_a_wave_over_all_of_the_map():
    robots = team(1)
    states = []
    snapshot = robots.step([SendGoal(0, Goal(0, FAR))])
    while snapshot.robots[0].navigation.state != "controlling":
        states.append(snapshot.robots[0].navigation.state)
        snapshot = robots.step()
    assert set(states) == {"planning"}
    assert 5 < len(states) < 30
    path = whole_wave(FAR)
    assert np.hypot(*np.diff(path, axis=0).T).sum() > 120.0
    assert np.array_equal(snapshot.robots[0].navigation.plan[:, :2], path)


def test_robots_that_plan_long_ways_at_once_take_turns_and_do_the_same_twice():
    def plans():
        robots, first = team(3), {}
        for tick in range(100):
            orders = [SendGoal(robot, Goal(0, OFFICE.rooms[60 + robot].goal)) for robot in range(3)]
            snapshot = robots.step(orders if tick == 0 else [])
            for robot, output in enumerate(snapshot.robots):
                if robot not in first and output.navigation.state == "controlling":
                    first[robot] = (tick, output.navigation.plan.tobytes())
        return first, snapshot.truth.poses.tobytes()

    once, again = plans(), plans()
    assert once == again
    ticks = sorted(tick for tick, _ in once[0].values())
    assert len(ticks) == 3
    assert np.diff(ticks).min() > 5


def test_a_room_without_a_door_is_refused_on_a_large_map_too():
    cells = OFFICE.grid.cells.copy()
    col, row = (int(at / OFFICE.grid.resolution) for at in (FAR.x, FAR.y))
    cells[row - 105 : row - 100, col - 105 : col + 105] = 100
    software = replace(HUNT, move_base=replace(HUNT.move_base, max_planning_retries=0))
    robots = team(1, replace(OFFICE.grid, cells=cells), software)
    snapshot = robots.step([SendGoal(0, Goal(0, FAR))])
    while snapshot.robots[0].navigation.result is None:
        assert snapshot.tick < 100
        snapshot = robots.step()
    result = snapshot.robots[0].navigation.result
    assert isinstance(result, NoPath)
    assert result.reason == "no_way"


@pytest.fixture
def small_portions(monkeypatch):
    """Waves over the arena of 2016 take some twenty ticks."""
    monkeypatch.setattr(potential_planner, "PORTION", 4000)


@pytest.mark.usefixtures("small_portions")
def test_a_goal_that_comes_while_another_is_searched_takes_its_place():
    rig = IdealRobots([(0, 0, 0)])
    rig.go(0, *ROOMS[5])
    rig.run(1, lambda rig: rig.tick == 4)
    assert isinstance(rig.navigators[0]._execution.state, Planning)
    rig.go(0, *ROOMS[0])
    rig.run(60, everybody_arrived)
    assert [type(result) for result in rig.results[0]] == [Cancelled, GoalReached]
    assert rig.poses[0].distance(Pose2(*ROOMS[0], 0.0)) < 0.1


@pytest.mark.usefixtures("small_portions")
def test_a_robot_drives_on_while_it_searches_a_better_plan():
    software = RobotParameters()
    software = replace(software, move_base=replace(software.move_base, planner_frequency=1.0))
    rig = IdealRobots([(0, 0, 0)], parameters=software)
    rig.go(0, *ROOMS[5])
    rig.run(5, lambda rig: isinstance(rig.navigators[0]._execution.state, Controlling))
    followers, slowest = [], 1.0
    rig.run(3, lambda rig: rig.twists[0].linear > 0.5)
    begun = rig.tick
    while rig.tick < begun + 150:
        rig.step()
        slowest = min(slowest, rig.twists[0].linear)
        if (follower := rig.navigators[0]._execution.state.follower) not in followers:
            followers.append(follower)
    assert len(followers) > 2
    rig.run(60, everybody_arrived)


@pytest.mark.usefixtures("small_portions")
def test_a_robot_in_the_way_of_a_long_search_is_driven_around_or_asked():
    rig = IdealRobots([(0, -4, 1.57), (0, 6, -1.57)])
    rig.go(0, 0, 6, 1.57)
    rig.go(1, 0, -4, -1.57)
    rig.run(90, everybody_arrived)
