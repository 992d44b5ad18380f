"""What teams of up to 250 robots cost: processor time, the longest ticks, memory.

All stand, or all are always under way, in the warehouse, where 250 stand as close as 0.72 m. Nothing is recorded, and
nobody speaks MAVLink.
"""

import tracemalloc
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim.common.distance_fields import distance_field
from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import TICKS_PER_SECOND
from sim.numerics.float_array import FloatArray
from sim.team import Team
from tests.bench.budget import Budgets
from tests.support.robots.robots_under_way import best_ticks, drive
from thbridge.app.compose.robots import rehearse
from thbridge.app.compose.setting import read_setting
from thbridge.study.study_file import Study

pytestmark = pytest.mark.bench

WARM_UP, SECONDS = 2, 4
RUNS = 2


def free_places(grid: OccupancyGrid, spacing: float) -> list[Pose2]:
    """Places on a lattice, meters, at which robots may stand and turn, in an order that mixes them."""
    room = distance_field(grid, 2.0)
    places = [
        Pose2(float(x), float(y), 0.0)
        for y in np.arange(grid.origin.y + 0.5, grid.origin.y + grid.rows * grid.resolution, spacing)
        for x in np.arange(grid.origin.x + 0.5, grid.origin.x + grid.cols * grid.resolution, spacing)
        if grid.contains(*grid.cell_of(x, y)) and room[grid.cell_of(x, y)] > 0.45
    ]
    return [places[index] for index in np.random.default_rng(0).permutation(len(places))]


@pytest.mark.parametrize("under_way", [False, True], ids=["standing", "driving"])
@pytest.mark.parametrize("robots", [10, 50, 100, 250])
def test_large_teams(robots: int, under_way: bool, budgets: Budgets) -> None:
    setting = read_setting(replace(Study(), map="warehouse12", robots=2), Path())
    rehearse(setting)
    world, software = setting.study.world, setting.study.robot
    places = free_places(setting.map.grid, 1.0 if robots <= 50 else 0.72)

    def run() -> FloatArray:
        team = Team(setting.map.grid, world, [software] * robots, places[:robots], 1, 1000.0)
        return drive(team, places if under_way else [], WARM_UP + SECONDS)

    spent = 1e3 * best_ticks([run() for _ in range(RUNS)])[WARM_UP * TICKS_PER_SECOND :]
    what = f"{robots} robots, {'driving' if under_way else 'standing'}"
    print(
        f"\n{what}: {spent.sum() / SECONDS / robots:.1f} ms a robot "
        f"and simulated s; ticks: median {np.median(spent):.1f} ms, 95 % {np.percentile(spent, 95):.1f} ms, "
        f"longest {spent.max():.1f} ms"
    )
    budgets.time(f"large team: a simulated second, {what}", 1e-3 * spent.sum() / SECONDS)


def test_memory() -> None:
    setting = read_setting(replace(Study(), map="warehouse12", robots=2), Path())
    rehearse(setting)
    places = free_places(setting.map.grid, 1.0)

    def held(robots: int) -> int:
        before = tracemalloc.get_traced_memory()[0]
        software = [setting.study.robot] * robots
        team = Team(setting.map.grid, setting.study.world, software, places[:robots], 1, 1000.0)
        drive(team, places, 2)
        return tracemalloc.get_traced_memory()[0] - before

    tracemalloc.start()
    few, many = held(2), held(22)
    tracemalloc.stop()
    megabytes = (many - few) / 20 / 1e6
    print(f"\n{megabytes:.2f} MB for each robot more, all having planned")
    assert megabytes < 0.8
