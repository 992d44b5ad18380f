"""`thbridge plan` from the user's seat."""

import json
import math

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from tests.support.programs.commands import invoke
from thbridge.files.grid_files import write_grid

TURNED = Pose2(3.0, -2.0, 0.7)


@pytest.fixture
def rooms(tmp_path):
    """Two rooms of 3 m by 2 m with a door of 0.8 m in between, and a cupboard; the map's origin is turned."""
    cells = np.zeros((42, 122), dtype=np.int8)
    cells[[0, -1]] = cells[:, [0, 61, -1]] = 100
    cells[5:21, 61] = 0
    cells[30:41, 100:121] = 100
    cells[35:40, 105:115] = 0
    write_grid(tmp_path, OccupancyGrid(cells, 0.05, TURNED))
    return tmp_path / "map.yaml"


def place(x, y):
    """A place of the grid, in the map frame."""
    return TURNED.transform(np.array([[x, y]]))[0].tolist()


def thbridge(*arguments):
    return invoke("plan", *arguments)


def queries(*arguments):
    done = thbridge(*arguments, "--json")
    assert done.exit_code == 0, done.stderr
    return json.loads(done.stdout)["queries"]


def ends(start, goal):
    return "--start", *place(*start), "--goal", *place(*goal)


@pytest.mark.parametrize("planner", ["navfn", "astar"])
def test_a_path_through_the_door_of_a_turned_map(rooms, planner):
    (answer,) = queries("--map", rooms, *ends((1.0, 1.6), (5.0, 1.0)), "--planner", planner)
    assert set(answer) == {"found", "length", "milliseconds", "reason", "code"}
    assert answer["found"] is True
    assert answer["reason"] is None
    by_door = math.hypot(2.08, 0.6) + math.hypot(1.92, 0.3)
    assert by_door < answer["length"] < 1.15 * by_door
    assert answer["milliseconds"] > 0


def test_a_map_by_its_name_its_folder_and_its_file(rooms):
    asked = ends((1.0, 1.6), (5.0, 1.0))
    assert queries("--map", rooms.parent, *asked)[0]["length"] == queries("--map", rooms, *asked)[0]["length"]
    (answer,) = queries("--map", "arena8", "--start", 0, 0, "--goal", 1, 1)
    assert answer["length"] == pytest.approx(math.sqrt(2.0), rel=0.05)


def test_a_batch_as_spreadsheets_write_it(rooms, tmp_path):
    start, goal = place(1.0, 1.0), place(1.5, 1.0)
    numbers = [f"{number:.3f}" for number in (*start, *goal)]
    header = ("start_x", "start_y", "goal_x", "goal_y")
    answers = []
    for mark, point in ((",", "."), (";", ","), ("\t", ".")):
        table = "\r\n".join((mark.join(header), mark.join(number.replace(".", point) for number in numbers), ""))
        (tmp_path / "batch.csv").write_text(table)
        answers += [answer["length"] for answer in queries("--map", rooms, "--batch", tmp_path / "batch.csv")]
    assert answers == [pytest.approx(0.5, rel=0.05)] * 3
    assert len(set(answers)) == 1


def test_a_robot_too_wide_for_the_door_finds_none(rooms):
    (answer,) = queries("--map", rooms, *ends((1.0, 1.0), (4.0, 1.0)), "--radius", 0.45)
    assert answer["found"] is False
    assert answer["length"] is None
    assert answer["code"] == "no_way"
    assert answer["reason"] == "there is no path from here to the goal"


@pytest.mark.parametrize(
    ("start", "goal", "told"),
    [
        ((1.0, 1.0), (5.0, 0.02), "the goal lies in the map's outermost row or column of cells"),
        (
            (0.02, 1.0),
            (2.0, 1.0),
            "there is no path from here to the goal; the robot stands in the map's outermost row",
        ),
    ],
)
def test_the_outermost_cells_of_a_map_are_named(tmp_path, start, goal, told):
    """Planners lead no path there, and nothing in the picture shows it."""
    cells = np.zeros((40, 120), dtype=np.int8)
    cells[:, 3] = 100
    write_grid(tmp_path, OccupancyGrid(cells, 0.05, TURNED))
    (answer,) = queries("--map", tmp_path / "map.yaml", *ends(start, goal))
    assert answer["found"] is False
    assert answer["reason"].startswith(told)


def test_a_batch_is_answered_in_order(rooms, tmp_path):
    asked = [
        ((1.0, 1.0), (5.0, 1.0), None),
        ((1.0, 1.0), (3.07, 1.9), "goal_occupied"),
        ((3.07, 1.9), (1.0, 1.0), "start_occupied"),
        ((1.0, 1.0), (9.0, 1.0), "goal_outside"),
        ((-1.0, 1.0), (1.0, 1.0), "start_outside"),
        ((1.0, 1.0), (1.5, 1.0), None),
    ]
    lines = [",".join(map(str, (*place(*start), *place(*goal)))) for start, goal, _ in asked]
    (tmp_path / "batch.csv").write_text("\n".join(["start_x,start_y,goal_x,goal_y", *lines, ""]))
    answers = queries("--map", rooms, "--batch", tmp_path / "batch.csv", "--radius", 0.2)
    assert [answer["code"] for answer in answers] == [code for _, _, code in asked]
    assert [answer["found"] for answer in answers] == [code is None for _, _, code in asked]
    assert answers[5]["length"] == pytest.approx(0.5, rel=0.05)
    message = thbridge("--map", rooms, "--batch", tmp_path / "batch.csv", "--radius", 0.2).stdout
    assert "found" in message


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), "--start, --goal, --batch: give both --start"),
        (("--start", 0, 0), "--start, --goal, --batch: give both --start"),
        (("--start", 0, 0, "--goal", 1, 1, "--batch", "b.csv"), "--start, --goal, --batch: give both --start"),
        (("--start", 0, "nan", "--goal", 1, 1), "--start: a value is not a finite number"),
        (("--start", 0, 0, "--goal", 1, 1, "--radius", -1), "--radius: -1 is not between"),
        (("--start", 0, 0, "--goal", 1, 1, "--inflation", "nan"), "--inflation: nan is not between"),
        (("--batch", "none.csv"), "none.csv: there is no such file"),
    ],
)
def test_bad_input_is_told_in_one_message(rooms, arguments, message):
    done = thbridge("--map", rooms, *arguments)
    assert done.exit_code == 2
    assert message in done.stderr
    assert done.stdout == ""


def test_a_bad_table_is_told_by_line_and_column(rooms, tmp_path):
    (tmp_path / "batch.csv").write_text("start_x,start_y,goal_x,goal_y\n0,0,1,1\n0,0,one,1\n")
    done = thbridge("--map", rooms, "--batch", tmp_path / "batch.csv")
    assert done.exit_code == 2
    assert "line 3, goal_x: 'one' is not a number" in done.stderr.replace("\n", " ")
