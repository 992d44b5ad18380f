"""`thbridge suggest --team`."""

import json
from pathlib import Path

import pytest

from tests.support.programs.commands import invoke


def suggest(*arguments: object) -> str:
    done = invoke("suggest", *arguments)
    assert done.exit_code == 0, done.output
    return done.stdout


@pytest.fixture
def study(tmp_path: Path) -> Path:
    path = tmp_path / "study.yaml"
    path.write_text("map: office\nrobots: 3\ngame: {energy: 60}\n")
    return path


def test_a_team_is_told_its_joint_plan_and_what_else_would_cost(study: Path) -> None:
    told = json.loads(suggest("--team", study, "--json"))
    robots = told["robots"]
    assert told["rooms"] == sum(len(robot["tour"]) for robot in robots)
    assert len({room for robot in robots for room in robot["tour"]}) == told["rooms"] > 3
    assert told["cost"] == pytest.approx(sum(robot["cost"] for robot in robots))
    assert told["points_of_a_room"] == 20.0, "of the treasures of 2016"
    for robot in robots:
        worth = {each["next"]: (-each["rooms"], each["cost"]) for each in robot["alternatives"]}
        assert min(worth.values()) >= (-told["rooms"], told["cost"] - 1e-9)
        if robot["tour"]:
            assert worth[robot["tour"][0]] == pytest.approx((-told["rooms"], told["cost"]))
    assert "Next moves: robot 1 to " in suggest("--team", study)


def test_rooms_that_are_left_may_be_named(study: Path) -> None:
    told = json.loads(suggest("--team", study, "--unvisited", "2,5", "--json"))
    assert sorted(room for robot in told["robots"] for room in robot["tour"]) == [2, 5]


@pytest.mark.parametrize("planner", ["joint", "nearest", "greedy", "tour", "auction"])
def test_a_team_may_plan_more_simply_and_is_told_the_best_plan_too(study: Path, planner: str) -> None:
    told = json.loads(suggest("--team", study, "--planner", planner, "--json"))
    assert told["planner"] == planner and told["proven"] == (planner == "joint")
    best, robots = told["best"], told["robots"]
    assert (-told["rooms"], told["cost"]) >= (-best["rooms"], best["cost"])
    assert all(("alternatives" in robot) == told["proven"] for robot in robots)
    shown = suggest("--team", study, "--planner", planner)
    assert ("Best plan: " in shown) == (told["rooms"] != best["rooms"] or told["cost"] != best["cost"])


def test_a_plan_of_too_many_rooms_is_said_not_to_be_proven(study: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    best = json.loads(suggest("--team", study, "--json"))
    monkeypatch.setattr("thbridge.hunt.team_tour.MOST_ROOMS_OF_A_TEAM", 4)
    told = json.loads(suggest("--team", study, "--json"))
    assert not told["proven"] and told["best"] is None
    assert told["rooms"] == best["rooms"] and told["cost"] == pytest.approx(best["cost"])
    assert "too many rooms to prove that this plan is the best" in suggest("--team", study)


def test_one_robot_may_have_any_number_of_rooms_before_it(tmp_path: Path) -> None:
    def asked(rooms: int, *more: str) -> str:
        costs = tmp_path / "mapTimes"
        places = range(rooms + 1)
        rows = (" ".join(str(abs(a - b) or 99) for b in places) for a in places)
        costs.write_text("\n".join([str(len(places)), *rows, ""]))
        return suggest("--costs", costs, "--at", 0, "--unvisited", ",".join(map(str, places[1:])), *more)

    for rooms in (18, 24):
        told = json.loads(asked(rooms, "--json"))
        tour = list(range(1, rooms + 1))
        assert told == {"next": 1, "tour": tour, "cost": rooms, "proven": True, "at_least": rooms}
    assert "The cheapest tour is" in asked(18)


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (("--at", "0"), "--team: the study defines costs and start poses"),
        (("--unvisited", "99"), "--unvisited: '99' is not a room"),
    ],
)
def test_what_does_not_go_together_is_told(study: Path, options: tuple[str, ...], sentence: str) -> None:
    done = invoke("suggest", "--team", study, *options)
    assert done.exit_code == 2
    assert sentence in done.stderr


def test_a_planner_is_for_a_team() -> None:
    done = invoke("suggest", "--costs", "c", "--at", "0", "--unvisited", "1", "--planner", "greedy")
    assert done.exit_code == 2
    assert "--planner: this option applies only to a team" in done.stderr


def test_without_a_team_all_of_one_robot_is_asked_for() -> None:
    done = invoke("suggest", "--at", "0")
    assert done.exit_code == 2
    assert "for one robot, write --costs, --at and --unvisited" in done.stderr
