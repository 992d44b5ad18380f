"""`thbridge bag export` as people and programs call it."""

import json
from pathlib import Path

import pytest
from typer.testing import Result

from tests.support.bags.foreign_bags import Robot, write
from tests.support.programs.commands import invoke


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("export") / "a.bag"
    write(path, Robot(), seconds=1.0)
    return path


def run(bag: Path, to: Path, *options: str) -> Result:
    return invoke("bag", "export", bag, "--to", to, *options)


def test_json(bag: Path, tmp_path: Path) -> None:
    done = run(bag, tmp_path / "out", "--format", "both", "--topics", "/sc*, /scan", "--json")
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout) == {"folder": str(tmp_path / "out"), "rows": {"scan": 11}, "notices": []}
    made = {path.name for path in (tmp_path / "out").iterdir()}
    assert made == {"scan.csv", "scan.parquet", "dictionary.csv", "session.json", "README.md"}


def test_a_topic_that_is_not_there(bag: Path, tmp_path: Path) -> None:
    done = run(bag, tmp_path / "out", "--topics", "/camera")
    assert done.exit_code == 2
    assert f"there is no topic /camera. No topic has a similar name; `thbridge bag info {bag}`" in done.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("option", ["--topics", "--tables"])
def test_a_name_that_is_nearly_right_is_answered_by_the_right_one(bag: Path, tmp_path: Path, option: str) -> None:
    done = run(bag, tmp_path / "out", option, "odm")
    assert done.exit_code == 2
    assert "Similar names are " in done.stderr
    assert "odom" in done.stderr


def test_tables_are_chosen_by_their_names(bag: Path, tmp_path: Path) -> None:
    done = run(bag, tmp_path / "out", "--tables", "poses,odom", "--tables", "scan", "--json")
    assert done.exit_code == 0, done.output
    assert set(json.loads(done.stdout)["rows"]) <= {"poses", "odom", "scan"}
    assert {"odom.parquet", "scan.parquet"} <= {path.name for path in (tmp_path / "out").iterdir()}


def test_a_folder_that_cannot_be_made(bag: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    done = run(bag, tmp_path / "file")
    assert done.exit_code == 2
    assert "--to" in done.stderr
