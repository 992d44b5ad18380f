"""Localizers of labs work where built-in ones do; where one fails, the robot is lost, and that is reported."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.inputs import GlobalLocalization, SendGoal, SetPoseEstimate
from sim.parameters import RobotParameters, WorldParameters
from sim.robot.navigator.goals import Goal
from sim.snapshot import TeamSnapshot
from sim.team import START_COVARIANCE, Team
from tests.support.programs.installed_plugins import install_plugins
from thbridge.app.compose.installed_parts import installed_parts
from thbridge.app.compose.setting import read_setting
from thbridge.files.errors import BadFile
from thbridge.ros.diagnostics import RobotDiagnostics
from thbridge.ros.messages.records import LogLevel
from thbridge.study.study_file import Study

SOURCE = """
import numpy as np

from sim.common.geometry import Pose2
from sim.robot.localization.estimate import Estimate


class Fixed:
    pose, covariance = Pose2(1.0, 0.5, 0.25), np.eye(3)

    def __init__(self, parameters, grid, mount, seed):
        pass

    def start(self, base_in_map, covariance):
        covariance[:] = 0.0

    def update(self, odometry, imu, scan):
        if scan is not None:
            scan.ranges[:] = 0.0
        return Estimate(odometry.tick, self.pose, self.pose, self.covariance, np.empty((0, 3)), True)

    def globalize(self):
        raise LookupError("nowhere")

    def widen(self, distance, turn):
        pass

    request_update = configure = widen


class Nan(Fixed):
    pose = Pose2(float("nan"), 0.0, 0.0)


class Flat(Fixed):
    covariance = np.eye(2)


class Mute(Fixed):
    def update(self, odometry, imu, scan):
        return None


class Once(Fixed):
    def update(self, odometry, imu, scan):
        if odometry.tick == 3:
            raise RuntimeError("not now")
        return super().update(odometry, imu, scan)


class Bare:
    def __init__(self, parameters, grid, mount, seed):
        pass

    def update(self, odometry, imu, scan):
        return None
"""
NAMES = {name.lower(): name for name in ("Fixed", "Nan", "Flat", "Mute", "Once", "Bare")}


@pytest.fixture(autouse=True)
def a_lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    install_plugins(tmp_path, monkeypatch, "lab_of_places", {"thbridge.localizers": NAMES}, SOURCE)


def run(name: str, ticks: int, inputs=lambda tick: ()) -> Iterator[TeamSnapshot]:
    grid = OccupancyGrid(np.zeros((80, 160), np.int8), 0.05, Pose2(-2.0, -2.0, 0.0))
    robot = replace(RobotParameters(), localization=name)
    parts = installed_parts([robot])
    team = Team(grid, WorldParameters(), [robot], [Pose2(0.0, 0.0, 0.0)], 7, 100.0, parts=parts)
    for tick in range(ticks):
        yield team.step(inputs(tick))


def test_a_localizer_of_a_lab_is_believed_and_changes_nothing_else() -> None:
    start_covariance = START_COVARIANCE.copy()
    *_, last = run("fixed", 12)
    assert last.robots[0].estimate.base_in_map == Pose2(1.0, 0.5, 0.25)
    assert not last.robots[0].estimate.lost and not last.robots[0].estimate.covariance.flags.writeable
    scan = last.robots[0].observations.scan
    assert scan is None or scan.ranges.any()
    assert (start_covariance == START_COVARIANCE).all()


@pytest.mark.parametrize(
    ("name", "fault"),
    [
        ("nan", "its pose is not finite"),
        ("flat", "the covariance is not a (3, 3) array of finite numbers with variances of 0 or more"),
        ("mute", "a NoneType is not an Estimate"),
    ],
)
def test_where_it_fails_the_robot_is_lost_and_that_is_reported(
    name: str, fault: str, caplog: pytest.LogCaptureFixture
) -> None:
    diagnostics, told = RobotDiagnostics(0), []
    sent = [SendGoal(0, Goal(0, Pose2(3.0, 0.0, 0.0)))]
    for snapshot in run(name, 30, lambda tick: sent if tick == 0 else ()):
        estimate = snapshot.robots[0].estimate
        assert estimate.lost and np.isfinite(estimate.base_in_map.array()).all()
        lines = diagnostics.log_lines(snapshot, snapshot.robots[0], ())
        told += [line.text for line in lines if line.level is LogLevel.ERROR]
    assert told == caplog.messages == [f"the localizer {name} failed: {fault}"]


def test_it_is_asked_again_in_the_next_tick() -> None:
    faults = [each.robots[0].estimate.fault for each in run("once", 8)]
    assert [bool(fault) for fault in faults].count(True) == 1
    assert "the localizer once failed: RuntimeError: not now (lab_of_places.py, line 47)" in faults


def test_a_request_that_fails_is_told_with_the_next_estimate() -> None:
    asked = {4: [GlobalLocalization(0)], 6: [SetPoseEstimate(0, Pose2(0.5, 0.0, 0.0), START_COVARIANCE)]}
    faults = [each.robots[0].estimate.fault for each in run("fixed", 9, lambda tick: asked.get(tick, ()))]
    assert [number for number, fault in enumerate(faults) if "LookupError: nowhere" in fault] == [4]


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("fixd", "no localizer fixd is installed. The nearest name is fixed"),
        ("bare", "package lab-of-places 1.0: the result is a Bare, which has no method start. Name a class"),
    ],
)
def test_a_study_with_a_localizer_that_cannot_work_is_refused(name: str, told: str) -> None:
    with pytest.raises(BadFile, match=told):
        read_setting(Study(robot=replace(RobotParameters(), localization=name)), Path())
