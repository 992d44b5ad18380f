"""Angles in files: radians, or with a unit; what looks like degrees is told."""

import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.parameters import RobotParameters
from thbridge.files.errors import BadFile
from thbridge.files.yaml.angles import radians_of
from thbridge.files.yaml.load import load_text
from thbridge.study.study_file import Study

PATH = Path("study.yaml")


@pytest.mark.parametrize(
    ("text", "radians"),
    [
        ("90deg", math.pi / 2),
        ("-45 deg", -math.pi / 4),
        ("180°", math.pi),
        ("deg(90)", math.pi / 2),
        ("rad(pi/2)", math.pi / 2),
        ("rad(2*pi/3)", 2 * math.pi / 3),
        ("1.5rad", 1.5),
        ("90", None),
        ("90degrees", None),
        ("rad(x)", None),
        ("rad(1/0)", None),
        ("e.deg", None),
    ],
)
def test_units_of_angles(text: str, radians: float | None) -> None:
    assert radians_of(text) == (None if radians is None else pytest.approx(radians))


@given(st.floats(-1000, 1000))
def test_degrees_and_radians_tell_the_same_angle(degrees: float) -> None:
    assert radians_of(f"{degrees!r}deg") == pytest.approx(math.radians(degrees))
    assert radians_of(f"rad({math.radians(degrees)!r})") == pytest.approx(math.radians(degrees))


def test_a_pose_in_degrees_is_read_in_radians() -> None:
    loaded = load_text(PATH, "things: [{name: a, shape: crate, at: [1, 2, 90deg]}]\n", Study)
    assert loaded.value.things[0].at == (1.0, 2.0, pytest.approx(math.pi / 2))
    assert loaded.doubts == ()


@pytest.mark.parametrize(
    ("text", "key", "told"),
    [
        ("things: [{name: a, shape: crate, at: [100, 200, 90]}]", "things[0].at[2]", "is read as 2.035 rad (116.6 deg"),
        ("mishaps: [{what: carried, time: 1, robot: 1, to: [9, 9, -90]}]", "mishaps[0].to[2]", "is read as -2.035"),
        ("robot: {amcl: {initial_pose_a: 90}}", "robot.amcl.initial_pose_a", "Write 90deg if degrees are meant"),
        ("robot: {ekf: {update_min_a: 3}}", "robot.ekf.update_min_a", "3 rad is 171.9 degrees"),
    ],
)
def test_what_looks_like_degrees_is_told_and_counts_as_radians(text: str, key: str, told: str) -> None:
    loaded = load_text(PATH, text, Study)
    (doubt,) = loaded.doubts
    assert (doubt.key, doubt.line) == (key, 1)
    assert told in str(doubt)
    assert loaded.notices == (str(doubt),)


@pytest.mark.parametrize("planner", ["TrajectoryPlannerROS", "DWAPlannerROS"])
def test_degrees_beyond_the_range_of_a_parameter_are_refused_and_those_with_a_unit_are_not(planner: str) -> None:
    section = "robot: {%s: {yaw_goal_tolerance: %s}}"
    with pytest.raises(BadFile, match=rf"{planner}\.yaw_goal_tolerance: 10 is out of range"):
        load_text(PATH, section % (planner, "10"), Study)
    loaded = load_text(PATH, section % (planner, "10deg"), Study)
    assert getattr(loaded.value.robot, planner).yaw_goal_tolerance == pytest.approx(math.radians(10.0))


@pytest.mark.parametrize("angle", ["3.14", "1.5708", "-3.0", "2", "6.28"])
def test_angles_that_people_write_in_radians_raise_no_doubt(angle: str) -> None:
    assert load_text(PATH, f"amcl: {{initial_pose_a: {angle}}}", RobotParameters).doubts == ()


def test_an_angle_is_no_length() -> None:
    with pytest.raises(BadFile, match=r"at\[0\]: '90deg' is not a number"):
        load_text(PATH, "things: [{name: a, shape: crate, at: [90deg, 2, 1]}]\n", Study)


@pytest.mark.parametrize("key", ["TrajectoryPlannerROS: {max_vel_theta: 15}", "DWAPlannerROS: {max_vel_theta: 15}"])
def test_a_rate_that_looks_like_degrees_is_told_and_counts_as_radians(key: str) -> None:
    loaded = load_text(PATH, key, RobotParameters)
    (doubt,) = loaded.doubts
    assert "15 rad/s is 2.4 turns per second. Write 0.2618 if degrees per second are meant" in str(doubt)


@pytest.mark.parametrize("rate", ["1", "2.84", "4.0", "6.28"])
def test_rates_of_robots_raise_no_doubt(rate: str) -> None:
    assert load_text(PATH, f"DWAPlannerROS: {{max_vel_theta: {rate}}}", RobotParameters).doubts == ()
