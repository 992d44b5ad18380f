"""Figures of each robot over a run."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.robot.software import RobotOutput
from thbridge.app.compose.robots import build_team
from thbridge.app.compose.setting import read_setting
from thbridge.app.run_statistics import RunStatistics
from thbridge.study.study_file import Study

TICKS = 50


@pytest.fixture(scope="module")
def snapshots():
    team = build_team(read_setting(Study(robots=2), Path()))
    return [team.step() for _ in range(TICKS)]


def believing(snapshot, robot: int, pose: Pose2, lost: bool = False):
    output = snapshot.robots[robot]
    estimate = replace(output.estimate, base_in_map=pose, lost=lost)
    changed = RobotOutput(output.observations, estimate, output.navigation, output.neighbour)
    robots = tuple(changed if index == robot else each for index, each in enumerate(snapshot.robots))
    return replace(snapshot, robots=robots)


def test_errors_are_those_at_scans(snapshots):
    statistics = RunStatistics()
    for tick, snapshot in enumerate(snapshots):
        x, y, theta = snapshot.truth.poses[0]
        away = 0.3 if tick < TICKS // 2 else 0.4
        statistics.add(believing(snapshot, 0, Pose2(x + away, y, theta + 0.1)))
    first, _ = statistics.figures()
    scans = np.array([snapshot.robots[0].observations.scan is not None for snapshot in snapshots])
    early = scans[: TICKS // 2].sum() / scans.sum()
    assert 0 < scans.sum() < TICKS
    assert first.position_rmse == pytest.approx(np.sqrt(early * 0.09 + (1 - early) * 0.16), abs=1e-4)
    assert first.position_max == pytest.approx(0.4, abs=1e-4)
    assert first.heading_max == pytest.approx(np.degrees(0.1), abs=1e-3)


def test_each_time_that_a_robot_is_lost_counts_once(snapshots):
    statistics = RunStatistics()
    for tick, snapshot in enumerate(snapshots):
        believed = snapshot.robots[1].estimate.base_in_map
        statistics.add(believing(snapshot, 1, believed, lost=tick % 10 < 3))
    well, lost = statistics.figures()
    assert (well.times_lost, lost.times_lost, lost.seconds_lost) == (0, 5, 0.3)


def test_a_dead_robot_adds_nothing(snapshots):
    statistics = RunStatistics()
    for snapshot in snapshots:
        statistics.add(replace(snapshot, dead=frozenset({0})))
    dead, alive = statistics.figures()
    assert (dead.position_rmse, alive.position_rmse is None) == (None, False)
