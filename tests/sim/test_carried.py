"""Robots that are carried elsewhere under way and told nothing: they notice, find themselves and arrive."""

import math
from pathlib import Path

import pytest

from sim.common.geometry import Pose2
from sim.inputs import KidnapRobot, SendGoal
from sim.parameters import RobotParameters, WorldParameters
from sim.robot.navigator.goals import Goal, GoalReached
from sim.team import Team
from thbridge.files.map_files import read_map

MAPS = Path(__file__).parents[2] / "maps"
SECOND = 50


def carried(name, seed, goal, elsewhere, heading, limit=150.0):
    """The seconds after which the robot knows that it is lost, and after which its goal ends; how; and collisions."""
    place = read_map(MAPS / name)
    team = Team(place.grid, WorldParameters(), [RobotParameters()], place.starts[:1], seed, 1e9)
    team.step([SendGoal(0, Goal(1, place.rooms[goal].goal))])
    for _ in range(4 * SECOND):
        team.step()
    room = place.rooms[elsewhere].goal
    begun = team.step([KidnapRobot(0, Pose2(room.x, room.y, heading))]).tick
    noticed = math.inf
    while True:
        snapshot = team.step()
        robot, after = snapshot.robots[0], (snapshot.tick - begun) / SECOND
        if robot.estimate.lost:
            noticed = min(noticed, after)
        if robot.navigation.result is not None:
            return noticed, after, robot.navigation.result, int(snapshot.world.collisions[0])
        assert after < limit


@pytest.mark.parametrize(
    ("name", "seed", "goal", "elsewhere", "heading"),
    [("office", 1, 3, 6, 1.0), ("arena8", 2, 7, 2, -2.0)],
)
def test_a_robot_carried_elsewhere_under_way_finds_itself_and_reaches_its_goal(name, seed, goal, elsewhere, heading):
    noticed, _, result, collisions = carried(name, seed, goal, elsewhere, heading)
    assert noticed < 3.0
    assert isinstance(result, GoalReached)
    assert collisions == 0


@pytest.mark.slow
@pytest.mark.parametrize("name", ["office", "arena8"])
def test_so_do_nine_of_ten_whatever_the_rooms(name):
    arrived = 0
    for seed in range(1, 11):
        goal, elsewhere = seed % 8, (3 * seed + 4) % 8
        _, _, result, collisions = carried(name, seed, goal, elsewhere if elsewhere != goal else (goal + 1) % 8, seed)
        assert collisions == 0
        arrived += isinstance(result, GoalReached)
    assert arrived >= 9
