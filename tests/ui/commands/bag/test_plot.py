"""`thbridge bag plot` as people and programs call it."""

from pathlib import Path

import pytest
from typer.testing import Result

from tests.support.bags.foreign_bags import Robot, write, write_map
from tests.support.programs.commands import invoke


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("plot")
    write(folder / "a.bag", Robot(), seconds=1.0)
    write_map(folder)
    return folder


def run(folder: Path, *options: str) -> Result:
    return invoke("bag", "plot", folder / "a.bag", *options)


def test_a_foreign_bag_on_a_map_of_its_own(folder: Path, tmp_path: Path) -> None:
    to = tmp_path / "paths.svg"
    options = ("--map", str(folder / "map.yaml"), "--width", "one", "--progress", "json")
    done = run(folder, "--what", "paths", "--to", str(to), *options)
    assert done.exit_code == 0, done.output
    assert '"task": "messages"' in done.stderr
    assert to.read_bytes().startswith(b"<?xml")
    assert "odometry from /odom" in done.stderr


def test_what_the_bag_lacks_is_told_and_nothing_written(folder: Path, tmp_path: Path) -> None:
    done = run(folder, "--what", "error", "--to", str(tmp_path / "error.pdf"))
    assert done.exit_code == 1
    assert "no robot whose true and estimated paths" in done.stderr
    assert not (tmp_path / "error.pdf").exists()


def test_trajectories_that_are_named(folder: Path, tmp_path: Path) -> None:
    to = tmp_path / "error.png"
    done = run(folder, "--what", "error", "--to", str(to), "--truth", "/odom", "--estimate", "/odom")
    assert done.exit_code == 0, done.output
    assert "truth from /odom, as requested" in done.stderr


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--truth", "/scan"], "--truth: /scan: the topic is of type sensor_msgs/LaserScan. Name one of /odom."),
        (["--estimate", "/none"], "--estimate: /none: the bag has no such topic. Name one of /odom."),
    ],
)
def test_topics_that_hold_no_trajectory(folder: Path, tmp_path: Path, options: list[str], message: str) -> None:
    done = run(folder, "--what", "error", "--to", str(tmp_path / "error.png"), *options)
    assert done.exit_code == 2
    assert message in " ".join(done.stderr.split())


def test_no_figure_but_these_three(folder: Path, tmp_path: Path) -> None:
    done = run(folder, "--what", "paths", "--to", str(tmp_path / "paths.jpg"))
    assert done.exit_code == 2
    assert "ends in .png, .svg or .pdf" in done.stderr


def test_a_place_that_cannot_be_written(folder: Path) -> None:
    done = run(folder, "--what", "paths", "--to", "/nowhere/at/all.png")
    assert done.exit_code == 2
    assert "--to" in done.stderr
