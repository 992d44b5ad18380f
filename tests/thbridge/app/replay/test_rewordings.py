"""Recordings with texts that have been reworded since are equal when they are replayed."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from rosbags.typesys.msg import normalize_msgtype

from tests.support.hunts.recorded_hunts import record_beginning, replay_again
from thbridge.app.replay.rewordings import in_present_words, reworded
from thbridge.recording.bag.reading.reader import messages
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.roles.shared import failure_reasons as reasons
from thbridge.ros import names
from thbridge.ros.messages import types
from thbridge.ros.messages.types import typestore
from thbridge.ros.publisher import RosMessage, Topic

KEYS = {
    "distance left (m)": "way left (m)",
    "standard deviation of the position (m)": "standard deviation (m)",
    "standard deviation of the heading (degrees)": "of the heading (degrees)",
}


def with_old_keys(data: bytes, changed: str = "") -> bytes:
    """Diagnostics as they were recorded before; `changed` is a value that no session says."""
    store, name = typestore(), normalize_msgtype(types.DIAGNOSTIC_ARRAY)
    message = store.deserialize_ros1(data, name)
    for status in message.status:  # type: ignore[attr-defined]  # rosbags makes its classes as it runs
        for pair in status.values:
            pair.key = KEYS.get(pair.key, pair.key)
            pair.value = changed or pair.value
    return bytes(store.serialize_ros1(message, name))


def older(bag: Path, to: Path, changed: str = "") -> int:
    """Write a recording as an older program would have; how many messages differ from today's."""
    count = 0
    with BagWriter(to) as writer:
        for message in messages(bag):
            data = message.data
            if message.topic == names.DIAGNOSTICS:
                data = with_old_keys(data, changed)
                count += data != message.data
            writer.write(RosMessage(Topic(message.topic, message.msgtype), message.stamp_ns, data))
    return count


@pytest.fixture(scope="module")
def hunt(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    yield record_beginning(tmp_path_factory.mktemp("hunt") / "hunt.bag", robots=2, seconds=6.0)


def test_an_older_recording_is_equal_when_it_is_replayed(hunt: Path, tmp_path: Path) -> None:
    count = older(hunt, tmp_path / "older.bag")
    assert count > 3
    before = (tmp_path / "older.bag").read_bytes()
    done = replay_again(tmp_path / "older.bag")
    assert (done.difference, done.reworded) == (None, count)
    assert done.messages == len(list(messages(hunt))) - 1
    assert (tmp_path / "older.bag").read_bytes() == before


def test_only_what_is_left_after_rewording_is_a_difference(hunt: Path, tmp_path: Path) -> None:
    older(hunt, tmp_path / "other.bag", changed="never said")
    found = replay_again(tmp_path / "other.bag").difference
    assert found is not None and found.topic == names.DIAGNOSTICS
    assert {field.field.rpartition(".")[2] for field in found.fields} == {"value"}


def test_a_text_that_is_still_said_so_stays() -> None:
    store, name = typestore(), normalize_msgtype("std_msgs/String")
    kind = store.types[name]
    was, other = (bytes(store.serialize_ros1(kind(data=text), name)) for text in ("way left (m)", "something else"))
    assert reworded("std_msgs/String", was, was) == was
    assert reworded("std_msgs/String", was, other) != was
    assert reworded("std_msgs/String", other, was) == other
    assert reworded("std_msgs/String", was, b"\1") == was


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("Something that is not on the map blocks the way of robot 2.", "blocked_by_obstacle"),
        ("Other robots stand in the way of robot 2 and do not clear it.", "robots_in_the_way"),
        ("The map has no way there from where robot 2 believes it is.", "no_way"),
        ("Where robot 2 should stand, the map has a wall, or one too near.", "goal_occupied"),
        ("The place where robot 2 should stand is not on the map.", "goal_outside"),
        ("Robot 2 stands within something, or too near to it to set out.", "start_occupied"),
        ("Robot 2 believes that it is where the map has nothing.", "start_outside"),
        ("Robot 2 is stuck and cannot get free.", "stuck"),
        ("Robot 2 does not know where it is.", "lost"),
        ("Robot 2 has given up the way there.", "gave_up"),
        ("Somebody at the robots' controls has called robot 2 off.", "called_off"),
        ("The navigation of robot 2 does not answer.", "unanswered"),
    ],
)
def test_reasons_of_failed_moves_are_reworded(old: str, new: str) -> None:
    today = reasons.failure_sentence(1, new)  # type: ignore[arg-type]  # all of them are reasons
    event = f'{{"event": "failed", "robot": 1, "reason": "{old}", "refund": 2.5}}'
    assert in_present_words(event) == event.replace(old, today)
    assert in_present_words(today) == today


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("Robot 3 does not answer any more.", reasons.unresponsive_sentence(2)),
        ("The map does not know what is where robot 3 should stand.", reasons.unknown_place_sentence(2)),
        (
            "goal robot1-4 is given up: there is no way from here to the goal; the robot stands in a corner",
            "goal robot1-4 was given up: there is no path from here to the goal; the robot stands in a corner",
        ),
        (
            "gave up: other robots stand in the way and do not clear it",
            "gave up: other robots block the path and do not move away",
        ),
        ("goal rviz 1 is given up", "goal rviz 1 was given up"),
        ("goal rviz-2 is given up: it is in another frame", "goal rviz-2 was given up: it is in another frame"),
        ("goal robot1-4 is reached", "goal robot1-4 was reached"),
        ("goal robot1-4 is withdrawn", "goal robot1-4 was preempted"),
        ("goal robot1-4 came too late", "goal robot1-4 was recalled before it started"),
        ("robot1 has run into something, 12 times so far", "robot1 has hit something; collisions so far: 12"),
        (
            "the planner theirs failed: its path is no (m, 2) or (m, 3) array of finite numbers",
            "the planner theirs failed: its path is not an (m, 2) or (m, 3) array of finite numbers",
        ),
        (
            "the recovery behavior x failed: a tuple is no Twist, and not None",
            "the recovery behavior x failed: a tuple is neither a Twist nor None",
        ),
        ("agreement is 1.5, and has to be from 0 to 1, or None", "agreement is 1.5, but must be from 0 to 1, or None"),
        ("a connection is opened by the key desk", "a connection is opened with the key desk"),
        (
            "the connection is given up: 700 bytes wait for it",
            "the connection is closed: its client has not read 700 bytes",
        ),
        ("somebody has been silent for long", "a silent client is pinged or dropped"),
        ("She said: somebody has been silent for long", "She said: somebody has been silent for long"),
    ],
)
def test_log_lines_and_inputs_are_reworded(old: str, new: str) -> None:
    assert in_present_words(old) == new
    assert in_present_words(new) == new
