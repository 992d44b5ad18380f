"""A hunt in which much goes wrong: it ends by itself, nobody touches anything, and the bag tells what happened."""

import json

import pytest

from tests.support.bags.rosbags_reader import messages
from tests.support.programs.processes import play_headless
from thbridge.analysis.report.builder import read_report
from thbridge.recording.bag.reading.reader import messages as recorded

pytestmark = pytest.mark.slow

STUDY = """\
robots: 3
seed: 5
robot:
  move_base:
    planner_patience: 1.0
    controller_patience: 4.0
things:
  - {name: closed door, shape: door, at: [7.0, -4.0, 1.5708], size: [2.0, 0.1]}
  - {name: crate, shape: crate, at: [3.0, 1.0, 0.5], appears: 12}
  - {name: visitor, shape: person, path: [[0, 2.0], [6, 2.0]], back_and_forth: true}
mishaps:
  - {robot: 2, what: dies, time: 45}
  - {robot: 3, what: carried, time: 30, to: [0.0, 4.0, 1.0]}
"""
"""Robots are in a hurry to give up what they find no way to."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("hunt")
    (folder / "study.yaml").write_text(STUDY)
    return folder


@pytest.fixture(scope="module")
def told(folder):
    return play_headless(folder, "study.yaml", "--bag", "hunt.bag")


def test_it_ends_by_itself_without_a_touch(told):
    # Robots give the closed room up after about half a minute each time, three times each.
    assert told["sim_seconds"] < 450
    assert told["collisions"] == 0
    assert told["rooms_visited"] >= 6
    assert told["score"] > 0
    assert told["over"] in {"given-up", "all-visited"}


def test_the_journal_says_why_robots_did_not_get_there(told, folder):
    (journal,) = (folder / "hunt.journal").glob("*.jsonl")
    events = [json.loads(line) for line in journal.read_text().splitlines()]
    reasons = {event["reason"] for event in events if event["event"] == "failed"}
    assert "Robot 2 no longer answers." in reasons
    assert "Something that is not on the map blocks the path of robot 1." in reasons
    silent = events.index({"v": 1, "event": "reported", "robot": 1, "condition": "silent"})
    assert not any(event["event"] == "departed" and event["robot"] == 1 for event in events[silent:])


def test_the_bag_is_whole(told, folder):
    report = read_report(recorded(folder / "hunt.bag"))
    assert report.missing == ()
    assert {"appeared", "died", "carried", "reported"} <= {moment.kind for moment in report.timeline}
    assert [thing.name for thing in report.things] == ["closed door", "visitor", "crate"]


def test_the_same_seed_gives_the_same_bag(told, folder):
    play_headless(folder, "study.yaml", "--bag", "again.bag")
    assert messages(folder / "hunt.bag") == messages(folder / "again.bag")
