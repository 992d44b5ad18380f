"""Recovery behaviors of labs run where built-in ones do; their faults end them, and are reported."""

import pickle
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import TICKS_PER_SECOND
from sim.inputs import SendGoal
from sim.parameters import MoveBaseParameters, RecoveryBehavior, RobotParameters, WorldParameters
from sim.robot.installed_parts import InstalledParts
from sim.robot.navigator.goals import Goal
from sim.snapshot import TeamSnapshot
from sim.team import Team
from tests.support.programs.commands import invoke
from tests.support.programs.installed_plugins import install_plugins
from thbridge.app.compose.installed_parts import installed_parts
from thbridge.app.compose.setting import read_setting
from thbridge.app.trials.plugin_trial import NOT_DETERMINED
from thbridge.app.trials.recovery_check import try_recovery
from thbridge.files.errors import BadFile
from thbridge.files.ros.parameters import parse_ros_files
from thbridge.ros.diagnostics import RobotDiagnostics
from thbridge.ros.messages.records import LogLevel
from thbridge.study.study_file import Study

SOURCE = """
from sim.common.observations import Twist


class Back:
    def __init__(self, seed):
        self.seed = seed

    def command(self, now):
        return None if now.seconds > 1.0 else Twist(-0.2, 0.0)


class Writes(Back):
    def command(self, now):
        now.costs[:] = 0


class Infinite(Back):
    def command(self, now):
        return Twist(float("inf"), 0.0)


class Tuples(Back):
    def command(self, now):
        return (0.1, 0.0)


class Ahead(Back):
    def command(self, now):
        return Twist(0.5, 0.0)


class Fickle(Back):
    made = 0

    def command(self, now):
        Fickle.made += 1
        return None if now.seconds > 0.2 else Twist(1e-4 * Fickle.made, 0.0)


class Hashed(Back):
    def command(self, now):
        return None if now.seconds > 0.2 else Twist(1e-20 * hash("lab"), 0.0)


def no_seed():
    return None
"""
NAMES = {
    "back": "Back",
    "writes": "Writes",
    "infinite": "Infinite",
    "tuples": "Tuples",
    "ahead": "Ahead",
    "fickle": "Fickle",
    "hashed": "Hashed",
    "odd": "no_seed",
}


@pytest.fixture(autouse=True)
def a_lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    install_plugins(tmp_path, monkeypatch, "lab_of_recovery", {"thbridge.recovery_behaviors": NAMES}, SOURCE)


_SOON = {"oscillation_timeout": 0.5, "oscillation_distance": 5.0}
"""Parameters by which a robot that drives recovers after half a second."""


def software(name: str) -> RobotParameters:
    standard = RobotParameters()
    move_base = replace(standard.move_base, recovery_behaviors=(RecoveryBehavior(name),), **_SOON)
    return replace(standard, localization="truth", move_base=move_base)


def run(name: str, seconds: float) -> Iterator[TeamSnapshot]:
    """Run a robot in a hall, until it recovers and on."""
    grid = OccupancyGrid(np.zeros((80, 160), np.int8), 0.05, Pose2(-2.0, -2.0, 0.0))
    robot = software(name)
    # Trips are measured in other processes.
    parts = pickle.loads(pickle.dumps(installed_parts([robot])))
    team = Team(grid, WorldParameters(), [robot], [Pose2(0.0, 0.0, 0.0)], 7, 100.0, (), None, parts)
    inputs = [SendGoal(0, Goal(0, Pose2(5.0, 0.0, 0.0)))]
    for _ in range(round(seconds * TICKS_PER_SECOND)):
        yield team.step(inputs)
        inputs = []


def test_a_behavior_of_a_lab_drives_the_robot() -> None:
    navigations = [each.robots[0].navigation for each in run("back", 2.5)]
    clearing = [each for each in navigations if each.state == "clearing"]
    assert {each.command.linear for each in clearing if each.command.linear} == {-0.2}
    assert len(clearing) >= TICKS_PER_SECOND


@pytest.mark.parametrize(
    ("name", "fault"),
    [
        ("writes", "ValueError: assignment destination is read-only (lab_of_recovery.py, line 15)"),
        ("infinite", "the command (inf, 0.0) is not finite"),
        ("tuples", "a tuple is neither a Twist nor None"),
    ],
)
def test_a_behavior_that_fails_ends_and_is_reported(name: str, fault: str, caplog: pytest.LogCaptureFixture) -> None:
    diagnostics, told = RobotDiagnostics(0), []
    for snapshot in run(name, 2.0):
        told += [
            line for line in diagnostics.log_lines(snapshot, snapshot.robots[0], ()) if line.level is LogLevel.ERROR
        ]
    sentence = f"the recovery behavior {name} failed: {fault}"
    assert {line.text for line in told} == {sentence}
    assert caplog.messages == [sentence]


def test_commands_without_room_to_stop_are_not_carried_out() -> None:
    collisions = [each.truth.collisions[0] for each in run("ahead", 12.0)]
    assert collisions[-1] == 0


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("bakc", r"no recovery behavior bakc is installed. The nearest name is back"),
        ("odd", r"odd: package lab-of-recovery 1.0: making the object failed: TypeError"),
    ],
)
def test_a_study_with_a_behavior_that_cannot_run_is_refused(name: str, told: str) -> None:
    with pytest.raises(BadFile, match=told):
        read_setting(Study(robot=software(name)), Path())
    with pytest.raises(ValueError, match=f"there is no part {name} among the recoveries"):
        InstalledParts().check(software(name))


def test_a_file_of_ros_names_it_by_its_type(tmp_path: Path) -> None:
    path = tmp_path / "move_base.yaml"
    path.write_text("recovery_behaviors: [{name: reverse, type: back}, {name: slow, type: move_slow/MoveSlow}]\n")
    read = parse_ros_files([Path(f"move_base:{path}")]).over(RobotParameters())
    assert read.value.move_base.recovery_behaviors == (RecoveryBehavior("back"),)
    assert any("slow has no effect here" in notice for notice in read.notices)


def test_parameters_without_plugins_load_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("thbridge.files.plugins.entry_points", None)
    assert installed_parts([RobotParameters(move_base=MoveBaseParameters())]).recoveries == {}


@pytest.mark.parametrize(
    ("name", "problem"),
    [
        ("fickle", NOT_DETERMINED),
        pytest.param("ahead", "the behavior has not ended after 30 s", marks=pytest.mark.slow),
        ("tuples", "the recovery behavior tuples failed: a tuple is neither a Twist nor None"),
    ],
)
def test_a_trial_finds_what_is_wrong_with_a_behavior(name: str, problem: str) -> None:
    assert problem in try_recovery(name, 0, 60.0).faults


@pytest.mark.slow
def test_the_command_finds_what_differs_in_another_process() -> None:
    done = invoke("plugins", "check", "--recovery", "hashed")
    assert done.exit_code == 2
    assert "hashed: the plug-in decided differently in another process with the same seed" in done.output


def test_the_command_lists_what_is_installed_and_checks_what_is_named() -> None:
    listed = invoke("plugins", "list")
    assert "recovery behavior back: lab_of_recovery:Back, of the package lab-of-recovery 1.0" in listed.output
    for arguments, told in (([], "plug-in to check is missing"), (["--recovery", "bakc"], "The nearest name is back")):
        done = invoke("plugins", "check", *arguments)
        assert done.exit_code == 2 and told in done.output
