"""`thbridge drive` from the user's seat."""

import json
from pathlib import Path

import pytest
from typer.testing import Result

from tests.support.programs.commands import invoke

OFFICE = Path(__file__).parents[4] / "maps" / "office" / "map.yaml"
CORRIDOR = ("--start", "0", "0", "0")


def drive(*arguments: str) -> Result:
    return invoke("drive", "--map", OFFICE, *arguments)


def outcome_of(*arguments: str) -> dict:
    done = drive(*arguments, "--json")
    assert done.exit_code == 0, (done.output, done.exception)
    assert done.stdout.count("\n") == 1
    return json.loads(done.stdout)


def test_a_drive_is_told_as_one_object() -> None:
    outcome = outcome_of(*CORRIDOR, "--goal", "1.5", "0")
    assert list(outcome) == ["reached", "collided", "seconds", "distance", "min_clearance", "reason"]
    assert (outcome["reached"], outcome["collided"], outcome["reason"]) == (True, False, None)
    assert outcome["distance"] == pytest.approx(1.5, abs=0.15)


def test_a_third_number_is_the_heading_at_the_goal() -> None:
    anyhow = outcome_of(*CORRIDOR, "--goal", "1.5", "0")
    turned = outcome_of("--goal", "1.5", "0", "-2.0", *CORRIDOR)
    assert turned["reached"]
    assert turned["seconds"] > anyhow["seconds"] + 1.0


def test_headings_in_degrees() -> None:
    done = drive("--start", "0", "0", "90deg", "--goal", "0", "0", "deg(90)", "--json")
    assert json.loads(done.stdout)["seconds"] < 1.0, "it has nothing to turn"
    assert " rad is " not in done.stderr
    odd = drive("--start", "0", "0", "90", "--goal", "40", "0", "180")
    assert "--start: 90 rad is more than a full turn; it is read as 2.035 rad" in odd.stderr
    assert "180 rad is more than a full turn; it is read as -2.212 rad" in odd.stderr


def test_people_are_told_in_a_sentence() -> None:
    assert drive(*CORRIDOR, "--goal", "1.5", "0").stdout == "Reached.\n"
    assert drive(*CORRIDOR, "--goal", "40", "0").stdout == "Not reached: the goal is outside the map.\n"


@pytest.mark.parametrize("place", [("4.0", "4.0"), ("4.2", "2.8")])
def test_a_start_or_goal_in_a_wall_is_an_answer(place: tuple[str, str]) -> None:
    assert "wall" in outcome_of("--start", *place, "0", "--goal", "0", "0")["reason"]
    assert "wall" in outcome_of(*CORRIDOR, "--goal", *place)["reason"]


@pytest.mark.parametrize("head", ["robot:\n  ", ""], ids=["a study's", "ROS's"])
def test_the_body_and_the_parameters_may_be_others(tmp_path: Path, head: str) -> None:
    box = "[[0.45, 0.3], [-0.45, 0.3], [-0.45, -0.3], [0.45, -0.3]]"
    slow = tmp_path / "slow.yaml"
    slow.write_text(f"{head}TrajectoryPlannerROS: {{max_vel_x: 0.3}}\n")
    wide = outcome_of(*CORRIDOR, "--goal", "1.5", "0", "--footprint", box, "--params", str(slow))
    assert wide["reached"]
    assert wide["min_clearance"] <= 0.64 + 0.1
    assert wide["seconds"] > 1.4 / 0.3


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("--footprint", "[[1, 1], [2, 2], [1, 2]]"),
        ("--footprint", "round"),
        ("--footprint", "[[0.3, 0], [-0.3, 0]]"),
        ("--params", "no-such.yaml"),
        ("--timeout", "nan"),
        ("--timeout", "0"),
    ],
)
def test_bad_options_are_named(option: str, value: str) -> None:
    done = drive(*CORRIDOR, "--goal", "1.5", "0", option, value)
    assert done.exit_code == 2
    assert value in done.stderr or option in done.stderr


def grey(folder: Path, name: str, cells: list[str], origin: str = "[0.4, -0.5, 0.0]") -> Path:
    """A map file of 5 cm; `#` is an obstacle, rows from the top."""
    pixels = bytes(0 if cell == "#" else 254 for row in cells for cell in row)
    (folder / f"{name}.pgm").write_bytes(f"P5 {len(cells[0])} {len(cells)} 255\n".encode() + pixels)
    file = folder / f"{name}.yaml"
    file.write_text(
        f"image: {name}.pgm\nresolution: 0.05\norigin: {origin}\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    return file


def test_obstacles_that_the_map_does_not_show(tmp_path: Path) -> None:
    """A box on the way: the robot goes round it, and learns of it by its laser alone."""
    box = grey(tmp_path, "box", ["." * 16] * 8 + ["........####...."] * 4 + ["." * 16] * 8)
    free = outcome_of(*CORRIDOR, "--goal", "2.5", "0")
    outcome = outcome_of(*CORRIDOR, "--goal", "2.5", "0", "--unmapped", str(box))
    assert (outcome["reached"], outcome["collided"]) == (True, False)
    assert outcome["distance"] > free["distance"] + 0.03
    assert outcome["min_clearance"] < free["min_clearance"] - 0.1


def test_a_start_in_an_unmapped_obstacle_is_an_answer(tmp_path: Path) -> None:
    box = grey(tmp_path, "box", ["#" * 10] * 10, "[-0.25, -0.25, 0.0]")
    assert "start is not free" in outcome_of(*CORRIDOR, "--goal", "2.5", "0", "--unmapped", str(box))["reason"]


def test_obstacles_that_walk(tmp_path: Path) -> None:
    file = tmp_path / "people.yaml"
    file.write_text(
        "things:\n"
        "  - {name: visitor, shape: person, path: [[1.2, 0.0], [3.4, 0.0]], speed: 0.2}\n"
        "  - {name: crate, shape: crate, at: [3.0, 0.7, 0.0], appears: 1, vanishes: 5}\n"
    )
    free = outcome_of(*CORRIDOR, "--goal", "2.5", "0")
    outcome = outcome_of(*CORRIDOR, "--goal", "2.5", "0", "--moving", str(file))
    assert (outcome["reached"], outcome["collided"]) == (True, False)
    assert outcome["seconds"] > free["seconds"] + 0.5


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "there are no things"),
        ("things: 3", "a list is needed"),
        ("thing: []", "thing: unknown key. The nearest name is things"),
        ("things: [{name: a}]", "things[0].shape: missing"),
        ("things: [{name: a, shape: ball, at: [0, 0, 0]}]", "things[0].shape: 'ball' is not a valid choice"),
        ("things: [{name: a, shape: person}]", "things[0]: the thing has neither `at` nor `path`"),
        ("things:\n- {name: a, shape: person, path: [[0, 0]]}", "line 2, things[0].path: a path needs two points"),
        ("things: [{name: a, shape: person, path: [[0, 0], [90, 0]]}]", "path[1]: (90, 0) is outside the map"),
        ("things: [{name: a, shape: person, at: [0, 0, 0], vanishes: 0}]", "vanishes: 0 is not later than `appears`"),
        ("things: [{name: a, shape: person, at: [0, 0, .nan]}]", "things[0].at[2]"),
        ("things: [{name: a, shape: person, path: [[0, 0], [1, 0]], speed: -1}]", "speed: -1 is out of range"),
        ("things: [", "people.yaml"),
    ],
)
def test_what_is_wrong_with_obstacles_that_walk_is_named(tmp_path: Path, text: str, told: str) -> None:
    file = tmp_path / "people.yaml"
    file.write_text(text)
    done = drive(*CORRIDOR, "--goal", "1.5", "0", "--moving", str(file))
    assert done.exit_code == 2
    assert str(file) in done.stderr
    assert told in done.stderr


def test_unmapped_obstacles_that_do_not_fit_are_named(tmp_path: Path) -> None:
    for name, cells, origin, told in (
        ("turned", ["#"], "[0, 0, 0.3]", "origin: it is rotated by 0.3 rad"),
        ("empty", ["."], "[0, 0, 0]", "it has no occupied cell"),
        ("far", ["#"], "[80, 0, 0]", "are outside the map"),
    ):
        file = grey(tmp_path, name, cells, origin)
        done = drive(*CORRIDOR, "--goal", "1.5", "0", "--unmapped", str(file))
        assert done.exit_code == 2
        assert str(file) in done.stderr
        assert told in done.stderr
    half = grey(tmp_path, "half", ["#" * 4] * 4, "[-2.1, 0, 0]")
    done = drive(*CORRIDOR, "--goal", "0.5", "0", "--unmapped", str(half), "--timeout", "0.1")
    assert "occupied cells lie outside the map and are ignored" in done.stderr


def test_defaults_of_ros_are_told(tmp_path: Path) -> None:
    file = tmp_path / "amcl.yaml"
    file.write_text("amcl: {min_particles: 200}\n")
    outcome = outcome_of(*CORRIDOR, "--goal", "0.5", "0", "--params", str(file))
    assert {"name": "amcl.max_particles", "value": 5000, "hunts": 1000} in outcome["ros_defaults"]
    assert outcome["notices"] == []
    done = drive(*CORRIDOR, "--goal", "0.5", "0", "--params", str(file))
    assert (
        "amcl: parameters left out, with ROS's defaults (the values of hunts in brackets): max_particles 5000 (1000)"
        in done.stderr.replace("\n", " ")
    )
