from pathlib import Path

import numpy as np
import pytest
from click.testing import Result
from typer.testing import CliRunner

from sim.common.geometry import IDENTITY
from sim.common.grid import FREE, OCCUPIED, OccupancyGrid
from thbridge.files.map_files import write_grid
from ui.cli import app

ROOMS = """\
rooms:
  - number: 1
    name: West
    region: [[0, 0], [3, 4]]
    goal: [1.5, 2, 0]
  - number: 2
    name: East
    region: [[5, 0], [8, 4]]
    goal: [6.5, 2, 1.57]
starts:
  poses: [[4, 1, 0], [4, 2.2, 0]]
"""


def two_rooms() -> OccupancyGrid:
    """8 m x 4 m: a room, a corridor, a room; doors 1 m wide at the bottom of both walls."""
    cells = np.full((40, 80), FREE, dtype=np.int8)
    cells[[0, -1], :] = OCCUPIED
    cells[:, [0, -1]] = OCCUPIED
    cells[11:, [30, 49]] = OCCUPIED
    return OccupancyGrid(cells, 0.1, IDENTITY)


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder that commands run in, with a map `two` without fault and without travel times."""
    monkeypatch.chdir(tmp_path)
    write_grid(tmp_path / "two", two_rooms())
    (tmp_path / "two" / "rooms.yaml").write_text(ROOMS, encoding="utf-8")
    return tmp_path


def maps(*words: object) -> Result:
    return CliRunner().invoke(app, ["maps", *map(str, words)])


def test_a_new_map_is_measured_by_a_study_that_does_not_fit_it_and_then_plays(here: Path) -> None:
    (here / "study.yaml").write_text("robots: 3\nmap: office\ntemplates: ./none\neach:\n  2: {}\n")
    measure = ("measure", "two", "--runs", 1, "--study", "study.yaml", "--out")
    of_another_map = here / "two" / "mapTimes"
    of_another_map.write_text("2\n99 1\n99 99\n")
    elsewhere = maps(*measure, "mapTimes", "--jobs", 1)
    assert "once it is copied to two/mapTimes" in elsewhere.stderr.splitlines()[-1]
    of_another_map.unlink()
    done = maps(*measure, "two/mapTimes", "--jobs", 2)
    assert done.exit_code == 0, done.stderr
    assert done.stderr.splitlines()[-1] == (
        "Wrote two/mapTimes, into the map's folder: games on this map take it from now on. Nothing more is to do."
    )
    assert (here / "mapTimes").read_bytes() == (here / "two" / "mapTimes").read_bytes()
    (here / "play.yaml").write_text("map: ./two\n")
    assert CliRunner().invoke(app, ["study", "check", "play.yaml"]).exit_code == 0


def test_a_view_for_rviz_needs_no_costs(here: Path) -> None:
    done = CliRunner().invoke(app, ["ros", "rviz", "--map", "./two", "--robots", "2"])
    assert done.exit_code == 0, done.stderr
