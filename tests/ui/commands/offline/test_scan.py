import json
import math

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from tests.support.programs.commands import invoke
from thbridge.files.grid_files import write_grid


@pytest.fixture
def room(tmp_path):
    """4 m by 2 m inside walls of 0.1 m; its inner corner is the map's origin, turned by 90 degrees."""
    cells = np.full((22, 42), 100, dtype=np.int8)
    cells[1:-1, 1:-1] = 0
    write_grid(tmp_path, OccupancyGrid(cells, 0.1, Pose2(0.1, -0.1, math.pi / 2)))
    return tmp_path / "map.yaml"


def scan(*arguments):
    return invoke("scan", *arguments)


def ranges(*arguments):
    done = scan(*arguments, "--json")
    assert done.exit_code == 0, done.stderr
    return json.loads(done.stdout)["ranges"]


def test_ranges_on_a_map_whose_origin_is_turned(room):
    # The room reaches from the map's origin 4 m along +y and 2 m along -x.
    quarters = ("--beams", 4, "--angle-min", 0)
    (row,) = ranges("--map", room, "--pose", -0.5, 1.0, 0.0, *quarters)
    assert row == pytest.approx([0.5, 3.0, 1.5, 1.0])
    (row,) = ranges("--map", room, "--pose", -0.5, 1.0, math.pi / 2, *quarters)
    assert row == pytest.approx([3.0, 1.5, 1.0, 0.5])


def test_the_last_beam_looks_along_angle_max(room):
    (row,) = ranges("--map", room, "--pose", -0.5, 1.0, 0, "--beams", 3, "--angle-min", 0, "--angle-max", math.pi)
    assert row == pytest.approx([0.5, 3.0, 1.5])


def test_nothing_within_range_is_null_and_inf(room):
    few = ("--map", room, "--pose", -0.5, 1.0, 0.0, "--beams", 4, "--angle-min", 0, "--range-max", 2)
    assert ranges(*few) == [[pytest.approx(0.5), None, pytest.approx(1.5), pytest.approx(1.0)]]
    assert scan(*few).stdout == "0.5000 inf 1.5000 1.0000\n"


def test_a_batch_gives_a_list_for_each_pose(room, tmp_path):
    (tmp_path / "poses.csv").write_text("x,y,yaw\n-0.5,1.0,0\n-0.5,1.0,1.5707963267948966\n")
    rows = ranges("--map", room, "--batch", tmp_path / "poses.csv", "--beams", 1, "--angle-min", 0)
    assert rows == [[pytest.approx(0.5)], [pytest.approx(3.0)]]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), "--pose, --batch: exactly one of these options is needed. Write --pose"),
        (("--pose", 0, 0, 0, "--batch", "poses.csv"), "--pose, --batch: exactly one of these options is needed"),
        (("--pose", 0, "nan", 0), "--pose: a value is not a finite number"),
        (("--pose", 0, 0, 0, "--angle-max", "inf"), "--angle-max: a value is not a finite number"),
        (("--batch", "none.csv"), "none.csv: there is no such file"),
    ],
)
def test_bad_input_is_told_in_one_message(room, arguments, message):
    done = scan("--map", room, *arguments)
    assert done.exit_code == 2
    assert message in done.stderr
    assert done.stdout == ""


def test_a_map_that_is_not_there_is_told(tmp_path):
    done = scan("--map", tmp_path / "map.yaml", "--pose", 0, 0, 0)
    assert done.exit_code == 2
    assert "there is no such file" in done.stderr


def test_a_heading_in_degrees(room):
    told = scan("--map", room, "--pose", -0.5, 1.0, "90deg", "--angle-min", "-90deg", "--angle-max", "deg(90)")
    assert told.exit_code == 0
    same = scan(
        "--map", room, "--pose", -0.5, 1.0, "rad(pi/2)", "--angle-min", -math.pi / 2, "--angle-max", math.pi / 2
    )
    assert told.stdout == same.stdout
    assert told.stderr == ""


def test_degrees_without_their_unit_are_told(room):
    told = scan("--map", room, "--pose", -0.5, 1.0, 90)
    assert told.stderr.startswith("--pose: 90 rad is more than a full turn; it is read as 2.035 rad")


def test_a_map_by_its_name_and_by_its_folder(room):
    assert ranges("--map", room.parent, "--pose", -0.5, 1.0, 0) == ranges("--map", room, "--pose", -0.5, 1.0, 0)
    assert len(ranges("--map", "arena8", "--pose", 0, 0, 0, "--beams", 5)[0]) == 5


def test_what_is_odd_in_a_map_is_told(room):
    room.write_text(room.read_text().replace("map.pgm", "/home/x/map.pgm"))
    told = scan("--map", room, "--pose", -0.5, 1.0, 0)
    assert told.exit_code == 0
    assert "file /home/x/map.pgm does not exist, so map.pgm next to map.yaml is used" in told.stderr
