"""A tour of the office, room after room, with all that a robot has: 8 goals, doors of 1.1 m; and single doors."""

import time
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import TICK
from sim.inputs import SendGoal
from sim.parameters import DwaPlannerParameters, RobotParameters, TrajectoryPlannerParameters, WorldParameters
from sim.robot.navigator.goals import Goal, GoalReached
from sim.team import Team
from tests.bench.budget import Budgets
from thbridge.offline.drive import DriveResult, DriveTask, drive

pytestmark = pytest.mark.bench

RUNS = 3
RUNS = 3
ROOMS = (1, 8, 2, 7, 3, 5, 6, 4)
PLANNERS = ("base_local_planner/TrajectoryPlannerROS", "dwa_local_planner/DWAPlannerROS")


@pytest.mark.parametrize("planner", PLANNERS)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_tour(planner, seed, office, budgets: Budgets, capsys):
    robot = RobotParameters()
    robot = replace(robot, move_base=replace(robot.move_base, base_local_planner=planner))
    places = [office.rooms[room - 1].goal for room in ROOMS]
    straight = sum(one.distance(other) for one, other in pairwise([office.starts[0], *places]))
    tours = [
        tour(Team(office.grid, WorldParameters(), [robot], office.starts[:1], seed, 1e9), places) for _ in range(RUNS)
    ]
    one, cpu = tours[0], min(each.cpu for each in tours) / tours[0].seconds
    with capsys.disabled():
        print(
            f"\n{planner.partition('/')[2]}, seed {seed}: {one.reached} of {len(places)} reached "
            f"in {one.seconds:.0f} s, {one.driven:.0f} m driven ({straight:.0f} m as the crow flies), "
            f"{one.collisions} collisions; {100 * cpu:.1f} % of a core"
        )
    assert one.reached == len(places)
    assert one.collisions == 0
    budgets.time(f"tour: a simulated second of {planner.partition('/')[2]}, seed {seed}", cpu)


@dataclass(frozen=True, slots=True)
class Tour:
    """What came of a tour: goals reached, meters driven, simulated seconds, collisions, CPU seconds."""

    reached: int
    driven: float
    seconds: float
    collisions: int
    cpu: float


def tour(team: Team, places: list[Pose2]) -> Tour:
    reached, driven, ticks = 0, 0.0, 0
    before = None
    began = time.process_time()
    for number, place in enumerate(places):
        inputs, result = [SendGoal(0, Goal(number, place))], None
        while result is None:
            snapshot = team.step(inputs)
            inputs, result = [], snapshot.robots[0].navigation.result
            here = snapshot.world.poses[0, :2].copy()
            driven += 0.0 if before is None else float(np.hypot(*(here - before)))
            before, ticks = here, ticks + 1
        reached += isinstance(result, GoalReached)
    collisions = int(snapshot.world.collisions.sum())
    return Tour(reached, driven, ticks * TICK, collisions, time.process_time() - began)


@pytest.mark.parametrize("width", [0.9, 1.1])
@pytest.mark.parametrize("planner", PLANNERS)
@pytest.mark.parametrize("weights", ["ours", "ROS's"])
def test_doors(width, planner, weights, capsys):
    """Through a door in the middle of a hall, from straight before it and from aside."""
    cells = np.full((120, 160), 100, dtype=np.int8)
    cells[2:-2, 2:-2] = 0
    cells[:, 79:81] = 100
    first = round((3.0 - width / 2) / 0.05)
    cells[first : first + round(width / 0.05), 79:81] = 0
    grid = OccupancyGrid(cells, 0.05, Pose2(0.0, 0.0, 0.0))
    robot = RobotParameters()
    robot = replace(robot, move_base=replace(robot.move_base, base_local_planner=planner))
    if weights != "ours":
        robot = replace(robot, TrajectoryPlannerROS=TrajectoryPlannerParameters(), DWAPlannerROS=DwaPlannerParameters())
    outcomes = [
        drive(grid, WorldParameters(), robot, DriveTask(Pose2(2.0, y, 0.0), Pose2(6.0, 4.5, 0.0), True, 150.0), seed)
        for seed in (1, 2, 3)
        for y in (1.5, 3.0)
    ]
    driven = [outcome for outcome in outcomes if isinstance(outcome, DriveResult)]
    reached, collided = sum(one.reached for one in driven), sum(one.collided for one in driven)
    longest, nearest = max(one.seconds for one in driven), min(one.min_clearance for one in driven)
    with capsys.disabled():
        print(
            f"\ndoor of {width} m, {planner.partition('/')[2]}, {weights} weights: {reached} of {len(outcomes)}"
            f" reached, {collided} collided, at most {longest:.0f} s, least clearance {nearest:.2f} m"
        )
    assert reached == len(outcomes)
    assert collided == 0
    assert longest < 20.0
    assert nearest > 0.05
