"""What a map of a hectare costs: processor time of ticks, the longest of them, memory, time until the first tick.

An office of 2000 x 2000 cells; four robots drive from one end to the other, each to another corner.
"""

import time
import tracemalloc
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim.common.grid import FREE, OCCUPIED
from sim.common.observations import TICKS_PER_SECOND
from sim.inputs import SendGoal
from sim.robot.navigator.goals import Goal
from sim.team import Team
from tests.bench.budget import Budgets
from tests.support.maps.large_office import large_office
from tests.support.robots.robots_under_way import best_ticks
from thbridge.app.compose.robots import rehearse
from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.study.study_file import Study

pytestmark = pytest.mark.bench

ROBOTS, SECONDS, RUNS = 4, 30, 2
CORNERS = (63, 0, 56, 7)
LONGEST = 0.040
"""Seconds that no tick may take; a tick of simulated time has 0.020, and the next ones make up for a longer one."""


def team_in_the_office(setting: StudySetting, *, another: bool = False) -> Team:
    """Four robots far from each other; in another office, nothing is ready yet."""
    office = large_office()
    cells = office.grid.cells.copy()
    cells[2, 2] = OCCUPIED if another else FREE
    starts = [office.starts[19 * robot % len(office.starts)] for robot in range(ROBOTS)]
    return Team(replace(office.grid, cells=cells), setting.study.world, [setting.study.robot] * ROBOTS, starts, 1, 1e9)


@pytest.fixture(scope="module")
def rehearsed() -> StudySetting:
    setting = read_setting(replace(Study(), map="warehouse12", robots=ROBOTS), Path())
    rehearse(setting)
    return setting


def test_ticks(rehearsed: StudySetting, budgets: Budgets) -> None:
    goals = [Goal(robot, large_office().rooms[room].goal) for robot, room in enumerate(CORNERS)]
    made, runs = [], []
    for _ in range(RUNS):
        began = time.process_time()
        team = team_in_the_office(rehearsed)
        made.append(time.process_time() - began)
        spent = []
        for tick in range(SECONDS * TICKS_PER_SECOND):
            began = time.process_time()
            team.step([SendGoal(robot, goal) for robot, goal in enumerate(goals)] if tick == 0 else [])
            spent.append(time.process_time() - began)
        runs.append(np.array(spent))
    ticks = best_ticks(runs)
    print(
        f"\nmade in {max(made):.2f} s; {1e3 * ticks.sum() / SECONDS / ROBOTS:.1f} ms a robot and simulated s; "
        f"ticks: median {1e3 * np.median(ticks):.1f} ms, the longest {1e3 * ticks.max():.1f} ms"
    )
    budgets.time("large map: four robots made ready", max(made))
    budgets.time("large map: 30 s of four robots", ticks.sum())
    assert ticks.max() < LONGEST


def test_memory(rehearsed: StudySetting) -> None:
    tracemalloc.start()
    before = tracemalloc.get_traced_memory()[0]
    team = team_in_the_office(rehearsed, another=True)
    goals = [Goal(robot, large_office().rooms[room].goal) for robot, room in enumerate(CORNERS)]
    for tick in range(2 * TICKS_PER_SECOND):
        team.step([SendGoal(robot, goal) for robot, goal in enumerate(goals)] if tick == 0 else [])
    held = (tracemalloc.get_traced_memory()[0] - before) / 1e6
    tracemalloc.stop()
    print(f"\n{held:.0f} MB for the map and {ROBOTS} robots, room in queues that is never used included")
    assert held < 210.0
