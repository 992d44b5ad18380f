"""`thbridge drive` from the user's seat."""

import json
from pathlib import Path

import pytest
from click.testing import Result
from typer.testing import CliRunner

from ui.cli import app

OFFICE = Path(__file__).parents[4] / "maps" / "office" / "map.yaml"
CORRIDOR = ("--start", "0", "0", "0")


def drive(*arguments: str) -> Result:
    return CliRunner().invoke(app, ["drive", "--map", str(OFFICE), *arguments])


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
