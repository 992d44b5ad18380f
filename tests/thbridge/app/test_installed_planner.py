"""Global planners of labs plan where built-in ones do; their paths are checked, and their faults reported."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.grid import OCCUPIED, OccupancyGrid
from sim.inputs import SendGoal
from sim.parameters import ParameterRejection, RobotParameters, WorldParameters, live_parameters, reconfigured
from sim.robot.global_planning.path import PlanRefusal
from sim.robot.navigator.goals import Goal
from sim.snapshot import TeamSnapshot
from sim.team import Team
from tests.support.programs.installed_plugins import install_plugins
from thbridge.app.compose.installed_parts import installed_parts
from thbridge.app.compose.setting import read_setting
from thbridge.app.trials.planner_check import try_planner
from thbridge.files.errors import BadFile
from thbridge.files.ros.parameters import parse_ros_files
from thbridge.mavlink.role.parameters import VehicleParameter
from thbridge.ros.diagnostics import RobotDiagnostics
from thbridge.ros.messages.records import LogLevel
from thbridge.ros.topics import Planners
from thbridge.study.study_file import Study

SOURCE = """
import numpy as np


class Detour:
    def __init__(self, parameters, seed):
        pass

    def plan(self, costs, frame, start, goal):
        return self.between([[start.x, start.y]], [[goal.x, goal.y]], costs)

    def between(self, first, last, costs):
        return first + [[1.5, 1.0]] + last


class Straight(Detour):
    def between(self, first, last, costs):
        return first + last


class Nan(Detour):
    def between(self, first, last, costs):
        return np.vstack([first, [[np.nan, 0.0]], last])


class Flat(Detour):
    def between(self, first, last, costs):
        return np.arange(4.0)


class Short(Detour):
    def between(self, first, last, costs):
        return first + [[1.0, 0.0]]


class Writes(Detour):
    def between(self, first, last, costs):
        costs[:] = 0


class Nothing(Detour):
    def between(self, first, last, costs):
        return None


def no_parameters():
    return None
"""
NAMES = {f"lab/{name.lower()}": name for name in ("Detour", "Straight", "Nan", "Flat", "Short", "Writes", "Nothing")}


@pytest.fixture(autouse=True)
def a_lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    names = NAMES | {"lab/odd": "no_parameters"}
    install_plugins(tmp_path, monkeypatch, "lab_of_paths", {"thbridge.global_planners": names}, SOURCE)


def software(name: str) -> RobotParameters:
    standard = RobotParameters()
    move_base = replace(standard.move_base, base_global_planner=name)
    return replace(standard, localization="truth", move_base=move_base)


def team(name: str) -> Team:
    """A robot in a hall with a pillar between it and its goal."""
    cells = np.zeros((80, 160), np.int8)
    cells[38:42, 68:72] = OCCUPIED
    grid = OccupancyGrid(cells, 0.05, Pose2(-2.0, -2.0, 0.0))
    robot = software(name)
    return Team(grid, WorldParameters(), [robot], [Pose2(0.0, 0.0, 0.0)], 7, 100.0, parts=installed_parts([robot]))


def run(name: str, ticks: int) -> Iterator[TeamSnapshot]:
    robots, inputs = team(name), [SendGoal(0, Goal(0, Pose2(3.0, 0.0, 0.0)))]
    for _ in range(ticks):
        yield robots.step(inputs)
        inputs = []


def test_a_planner_of_a_lab_plans_for_its_robot_and_on_request() -> None:
    *_, last = run("lab/detour", 5)
    plan = last.robots[0].navigation.plan
    assert np.hypot(*(plan[:, :2] - (1.5, 1.0)).T).min() < 0.1
    asked = team("lab/detour").make_plan(0, None, Pose2(3.0, 0.0, 0.0), 0.0)
    assert not isinstance(asked, PlanRefusal) and asked[:, :2].tolist() == [[0.0, 0.0], [1.5, 1.0], [3.0, 0.0]]


@pytest.mark.parametrize(
    ("name", "fault"),
    [
        ("straight", "its path leads through an obstacle at (1.20, 0.00)"),
        ("nan", "its path is not an (m, 2) or (m, 3) array of finite numbers"),
        ("flat", "its path is not an (m, 2) or (m, 3) array of finite numbers"),
        ("short", "its path ends 2.00 m from the goal"),
        ("writes", "ValueError: assignment destination is read-only (lab_of_paths.py, line 38)"),
    ],
)
def test_a_path_that_cannot_be_driven_is_not_taken_and_reported(
    name: str, fault: str, caplog: pytest.LogCaptureFixture
) -> None:
    diagnostics, told = RobotDiagnostics(0), []
    for snapshot in run(f"lab/{name}", 5):
        lines = diagnostics.log_lines(snapshot, snapshot.robots[0], ())
        told += [line.text for line in lines if line.level is LogLevel.ERROR]
    sentence = f"the global planner lab/{name} failed: {fault}"
    assert told == caplog.messages == [sentence]
    refused = team(f"lab/{name}").make_plan(0, None, Pose2(3.0, 0.0, 0.0), 0.0)
    assert refused == PlanRefusal("no_way", sentence)


def test_no_path_is_an_answer() -> None:
    refused = team("lab/nothing").make_plan(0, None, Pose2(3.0, 0.0, 0.0), 0.0)
    assert isinstance(refused, PlanRefusal) and refused.code == "no_way"
    assert not any(snapshot.robots[0].navigation.fault for snapshot in run("lab/nothing", 5))


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("lab/detuor", "no global planner lab/detuor is installed. The nearest name is lab/detour"),
        ("lab/odd", "lab/odd: package lab-of-paths 1.0: making the object failed: TypeError"),
    ],
)
def test_a_study_with_a_planner_that_cannot_plan_is_refused(name: str, told: str) -> None:
    with pytest.raises(BadFile, match=told):
        read_setting(Study(robot=software(name)), Path())


def test_a_file_of_ros_and_topics_have_its_name(tmp_path: Path) -> None:
    path = tmp_path / "move_base.yaml"
    path.write_text("base_global_planner: lab/detour\n")
    read = parse_ros_files([Path(f"move_base:{path}")]).over(RobotParameters()).value
    assert read.move_base.base_global_planner == "lab/detour"
    assert Planners.of(read).base_global_planner == "detour"
    assert Planners.of(software("wide-clearance")).base_global_planner == "wide_clearance"


def test_a_robot_that_runs_keeps_it_or_takes_a_built_in_one() -> None:
    path, own = "move_base.base_global_planner", software("lab/detour")
    assert reconfigured(own, path, "lab/detour") == own
    assert reconfigured(own, path, "navfn/NavfnROS") == software("navfn/NavfnROS")
    assert isinstance(reconfigured(own, path, "lab/straight"), ParameterRejection)
    declared = next(each for each in live_parameters() if each.path == path)
    assert VehicleParameter("GLOBAL_PLAN", declared).to_number("lab/detour") == -1.0


def test_a_trial_finds_what_is_wrong_with_a_planner() -> None:
    assert "the planner finds no path where navfn finds a path" in try_planner("lab/nothing", 0, 60.0).faults
    assert any("leads through an obstacle" in problem for problem in try_planner("lab/straight", 0, 60.0).faults)
