"""How long a local planner takes for one command, with the samples and weights of ROS's own defaults.

The C++ planners, driving on a map of the same size, take 3.6 ms for 6 x 1 x 20 samples of the dynamic window and 5.8 ms
for 20 x 20 of trajectory rollout, their map grids included.
"""

import time
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from sim.common.distance_fields import distance_field
from sim.common.geometry import Pose2
from sim.common.observations import Twist
from sim.numerics.float_array import FloatArray
from sim.parameters import (
    DwaPlannerParameters,
    NavfnParameters,
    RobotParameters,
    TrajectoryPlannerParameters,
    WorldParameters,
)
from sim.robot.costmap.costmap_2d import Costmap2D
from sim.robot.global_planning.navfn import Navfn
from sim.robot.global_planning.path import Path as Plan
from sim.robot.global_planning.potential_planner import PotentialPlanner
from sim.robot.local_planning.braking import surroundings
from sim.robot.local_planning.planners import local_planner
from tests.bench.budget import Budgets
from thbridge.files.map_files import read_map

pytestmark = pytest.mark.bench

OFFICE = read_map(Path(__file__).parents[3] / "maps" / "office")
REACH = 3.0
"""Meters of path given to the planner."""
ROUNDS = 5


def along(costmap: Costmap2D) -> list[FloatArray]:
    """The stretches of path ahead at places all along the tour of the office."""
    stretches = []
    planner = PotentialPlanner(Navfn(NavfnParameters()))
    places = [OFFICE.starts[0], *(OFFICE.rooms[number - 1].goal for number in (1, 8, 2, 7, 3, 5, 6, 4))]
    for start, goal in pairwise(places):
        plan = planner.plan(costmap.costs, costmap.frame, start, goal)
        assert isinstance(plan, Plan)
        for at in range(0, len(plan.poses) - 40, 40):
            ahead = plan.poses[at:]
            left = np.cumsum(np.hypot(*np.diff(ahead[:, :2], axis=0).T))
            stretches.append(ahead[: 1 + int(np.searchsorted(left, REACH))])
    return stretches


@pytest.mark.parametrize("side", [4.0, 10.0])
@pytest.mark.parametrize(
    ("planner", "cpp"),
    [("dwa_local_planner/DWAPlannerROS", 3.6), ("base_local_planner/TrajectoryPlannerROS", 5.8)],
    ids=["dwa-6x1x20", "rollout-20x20"],
)
def test_a_command(planner: str, cpp: float, side: float, budgets: Budgets, capsys: pytest.CaptureFixture[str]) -> None:
    robot = RobotParameters(TrajectoryPlannerROS=TrajectoryPlannerParameters())
    robot = replace(
        robot,
        DWAPlannerROS=DwaPlannerParameters(vx_samples=6),
        move_base=replace(robot.move_base, base_local_planner=planner),
        local_costmap=replace(robot.local_costmap, width=side, height=side),
    )
    body = np.array(WorldParameters().footprint)
    stretches = along(Costmap2D(robot.global_costmap, body, OFFICE.grid))
    costmap = Costmap2D(robot.local_costmap, body, OFFICE.grid)
    local = local_planner(robot, costmap.footprint, costmap.costs.shape, 0.05)
    clearance = distance_field(OFFICE.grid, 2.0)
    spent = np.full((ROUNDS, len(stretches)), np.inf)
    for turn, at in np.ndindex(spent.shape):
        ahead = stretches[at]
        pose = Pose2(*(float(value) for value in ahead[min(3, len(ahead) - 1)]))
        costmap.update(pose.x, pose.y)
        around = surroundings(clearance, costmap.frame._replace(x=-2.0, y=-7.0), costmap.footprint, pose, [], 2.5, 0.07)
        local.reset()
        begin = time.process_time()
        drive = local.follow(pose, Twist(0.4, 0.0), costmap.costs, costmap.frame, ahead[:, :2], 0.1, around)
        # Turning in place needs no search.
        if drive.command.linear > 0.0:
            spent[turn, at] = (time.process_time() - begin) * 1e3
    taken = spent.min(axis=0)  # of several rounds, the first of which had to compile
    taken = taken[np.isfinite(taken)]
    with capsys.disabled():
        print(
            f"\n{side:g} m x {side:g} m: {np.median(taken):.2f} ms, worst of {len(taken)} {taken.max():.2f};"
            f" the C++ takes {cpp}: {cpp / np.median(taken):.0f} times as fast"
        )
    name = planner.partition("/")[2]
    budgets.time(f"control: a command of {name}, costmap of {side:g} m", 1e-3 * float(np.median(taken)))
