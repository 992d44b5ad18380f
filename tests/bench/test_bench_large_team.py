"""What teams of up to 250 robots cost: processor time, the longest ticks, memory.

All stand, or all are always under way, in the warehouse, where 250 stand as close as 0.72 m. Nothing is recorded, and
nobody speaks MAVLink.
"""

import gc
import time
import tracemalloc
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim.common.observations import TICKS_PER_SECOND
from sim.team import Team
from tests.bench.halls import free_places
from tests.bench.test_bench_session import Errands, drive
from thbridge.app.compose import read_setting
from thbridge.study.study_file import Study

pytestmark = pytest.mark.bench

WARM_UP, SECONDS = 2, 4


@pytest.mark.parametrize("under_way", [False, True], ids=["standing", "driving"])
@pytest.mark.parametrize("robots", [10, 50, 100, 250])
def test_large_teams(robots: int, under_way: bool) -> None:
    setting = read_setting(replace(Study(), map="warehouse12", robots=2), Path())
    setting.rehearse()
    world, software = setting.study.world, setting.study.robot
    places = free_places(setting.map.grid, 1.0 if robots <= 50 else 0.72)
    team = Team(setting.map.grid, world, [software] * robots, places[:robots], 1, 1000.0)
    errands, snapshot, ticks = Errands(places, robots), None, []
    gc.freeze()
    try:
        for _ in range((WARM_UP + SECONDS) * TICKS_PER_SECOND):
            begun = time.process_time()
            snapshot = team.step(errands.next(snapshot) if under_way else [])
            ticks.append(1e3 * (time.process_time() - begun))
    finally:
        gc.unfreeze()
    spent = np.array(ticks[WARM_UP * TICKS_PER_SECOND :])
    print(
        f"\n{robots} robots, {'driving' if under_way else 'standing'}: {spent.sum() / SECONDS / robots:.1f} ms a robot "
        f"and simulated s; ticks: median {np.median(spent):.1f} ms, 95 % {np.percentile(spent, 95):.1f} ms, "
        f"longest {spent.max():.1f} ms"
    )


def test_memory() -> None:
    setting = read_setting(replace(Study(), map="warehouse12", robots=2), Path())
    setting.rehearse()
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
    print(f"\n{(many - few) / 20 / 1e6:.2f} MB for each robot more, all having planned")
