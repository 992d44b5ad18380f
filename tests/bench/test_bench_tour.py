"""A tour of the office, room after room without a stop between, with all that a robot has: 8 goals, doors of 1.1 m."""

import time
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from sim.navigator import Arrived, Goal
from sim.observations import TICK
from sim.parameters import RobotParameters, WorldParameters
from sim.team import Go, Team

pytestmark = pytest.mark.bench

ROOMS = (1, 8, 2, 7, 3, 5, 6, 4)
PLANNERS = ("base_local_planner/TrajectoryPlannerROS", "dwa_local_planner/DWAPlannerROS")


@pytest.mark.parametrize("planner", PLANNERS)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_tour(planner, seed, office, capsys):
    robot = RobotParameters()
    robot = replace(robot, move_base=replace(robot.move_base, base_local_planner=planner))
    places = [office.rooms[room - 1].goal for room in ROOMS]
    team = Team(office.grid, WorldParameters(), [robot], office.starts[:1], seed, 1e9)
    reached, driven, ticks = 0, 0.0, 0
    before = np.array((office.starts[0].x, office.starts[0].y))
    began = time.process_time()
    for number, place in enumerate(places):
        inputs, result = [Go(0, Goal(number, place))], None
        while result is None:
            snapshot = team.step(inputs)
            inputs, result = [], snapshot.robots[0].navigation.result
            here = snapshot.world.poses[0, :2].copy()
            driven, before, ticks = driven + float(np.hypot(*(here - before))), here, ticks + 1
        reached += isinstance(result, Arrived)
    straight = sum(one.distance(other) for one, other in pairwise([office.starts[0], *places]))
    cpu = time.process_time() - began
    with capsys.disabled():
        print(
            f"\n{planner.partition('/')[2]}, seed {seed}: {reached} of {len(places)} reached in {ticks * TICK:.0f} s, "
            f"{driven:.0f} m driven ({straight:.0f} m as the crow flies), "
            f"{int(snapshot.world.collisions.sum())} collisions; {100 * cpu / (ticks * TICK):.1f} % of a core"
        )
