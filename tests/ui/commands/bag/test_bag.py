"""`thbridge bag` as people and scripts meet it."""

import json
from pathlib import Path

import pytest

from tests.support.bags.bags_with_faults import clean, content, write
from tests.support.programs.commands import invoke


@pytest.fixture
def bag(tmp_path: Path) -> Path:
    return write(tmp_path / "a.bag", clean())


@pytest.fixture
def bad(tmp_path: Path) -> Path:
    planted = clean()
    planted.drop("/tf_static")
    return write(tmp_path / "bad.bag", planted)


def test_check_of_a_clean_bag(bag: Path) -> None:
    done = invoke("bag", "check", bag)
    assert done.exit_code == 0
    assert done.stdout.count("can read the recording\n") == 5


def test_check_does_not_say_that_evo_takes_a_bag_without_a_trajectory(tmp_path: Path) -> None:
    planted = clean()
    planted.entries = planted.of("/scan")
    (tmp_path / "a.bag").write_bytes(content(planted))
    done = invoke("bag", "check", tmp_path / "a.bag")
    assert "evo         finds no trajectory in the recording" in done.stdout
    assert "PlotJuggler can read the recording" in done.stdout


def test_check_says_what_where_and_what_to_do(bad: Path) -> None:
    done = invoke("bag", "check", bad)
    assert done.exit_code == 1
    assert "error for rviz, Foxglove: /scan: no transform connects the frame 'laser' to 'map'" in done.stdout
    assert "(first at 0.000 s; 30 messages)" in done.stdout
    assert "rviz        has problems" in done.stdout


def test_check_for_scripts(bad: Path) -> None:
    done = invoke("bag", "check", bad, "--json")
    assert done.exit_code == 1
    result = json.loads(done.stdout)
    assert result["ok"] is False
    assert result["tools"]["rviz"] == "error"
    assert result["tools"]["evo"] == "ok"
    (finding,) = result["findings"]
    assert (finding["rule"], finding["topic"], finding["messages"]) == ("tf-missing", "/scan", 30)


@pytest.mark.parametrize("what", [b"", b"this is a text\n", b"#ROSBAG V1.2\n", None])
def test_what_is_not_a_bag(tmp_path: Path, what: bytes | None) -> None:
    path = tmp_path / "a.bag"
    if what is not None:
        path.write_bytes(what)
    done = invoke("bag", "check", path)
    assert done.exit_code == 2
    assert str(path) in done.stderr


def test_check_of_a_damaged_bag(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    path.write_bytes(content(clean())[:9000])
    done = invoke("bag", "check", path)
    assert done.exit_code == 1
    assert "thbridge bag reindex" in done.stdout


def test_check_of_a_split_recording_tells_which_part(tmp_path: Path, bag: Path, bad: Path) -> None:
    bag.rename(tmp_path / "hunt_0.bag")
    bad.rename(tmp_path / "hunt_1.bag")
    done = invoke("bag", "check", tmp_path / "hunt.bag", "--json")
    assert done.exit_code == 1
    result = json.loads(done.stdout)
    assert result["messages"] == 92 + 91
    assert [finding["file"] for finding in result["findings"]] == [str(tmp_path / "hunt_1.bag")]


def test_info_names_all_topics_in_full(bag: Path) -> None:
    done = invoke("bag", "info", bag)
    assert done.exit_code == 0
    assert "2.9 s, 92 messages" in done.stdout
    (odometry,) = [line.split() for line in done.stdout.splitlines() if line.startswith("/odom ")]
    assert odometry[:6] == ["/odom", "30", "10.0", "0.0", "2.9", "nav_msgs/Odometry"]


def test_info_for_scripts(bag: Path) -> None:
    result = json.loads(invoke("bag", "info", bag, "--json").stdout)
    assert (result["messages"], result["parts"][0]["messages"], result["session"]) == (92, 92, None)
    assert {topic["name"] for topic in result["topics"]} == {"/map", "/odom", "/scan", "/tf", "/tf_static"}


def test_cut(bag: Path) -> None:
    options = ["--from", "1", "--until", "2", "--topics", "/scan,/map", "--compression", "lz4"]
    done = invoke("bag", "cut", bag, *options)
    assert done.exit_code == 0
    assert "12 messages to" in done.stdout
    result = json.loads(invoke("bag", "info", bag.with_name("a-cut.bag"), "--json").stdout)
    assert (result["messages"], result["compression"]) == (12, "lz4")
    again = invoke("bag", "cut", bag, *options)
    assert again.exit_code == 2
    assert "--overwrite" in again.stderr


def test_cut_refuses_what_is_not_there(bag: Path) -> None:
    done = invoke("bag", "cut", bag, "--topics", "/nothing")
    assert done.exit_code == 2
    assert "the bag has no topic /nothing" in done.stderr


def test_to_mcap(bag: Path) -> None:
    done = invoke("bag", "to-mcap", bag, "--compression", "none", "--json")
    assert json.loads(done.stdout)["messages"] == 92
    assert bag.with_suffix(".mcap").read_bytes().startswith(b"\x89MCAP")


@pytest.mark.parametrize("active", ["a.bag.active", "a_0.bag.active"])
def test_where_only_an_unfinished_file_is_the_way_to_save_it_is_named(bag: Path, active: str) -> None:
    bag.rename(bag.with_name(active))
    for command in (["bag", "info"], ["report"], ["replay"]):
        done = invoke(*command, bag)
        assert done.exit_code == 2
        assert f"thbridge bag reindex {bag.with_name(active)}" in done.stderr
