"""Recordings in rosbag2's formats are replayed as strictly as bags: all bytes of the recording are compared."""

import dataclasses
from pathlib import Path

import pytest

from tests.support.hunts.recorded_hunts import STUDY, assert_equal_replay, record, replay_again
from tests.support.programs.commands import output_of, refusal_of
from thbridge.recording.bag.options import Compression
from thbridge.recording.bag.reading.reader import RawMessage, info, messages
from thbridge.recording.bag.repair import reindex
from thbridge.recording.bag.writing.bag_file import BagFile
from thbridge.recording.bag.writing.formats import MCAP_FILE
from thbridge.recording.recordings import active_of, parts_of, unfinished_of
from thbridge.ros import names
from thbridge.ros.messages import types
from thbridge.ros2.recorded_types import recorded_type
from thbridge.study.overrides import StudyChange

TICKS = 250


@pytest.fixture(scope="module", params=["hunt.mcap", "hunt"])
def hunt(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("ros2") / request.param
    record(path, STUDY, TICKS / 50)
    return path


def copied(hunt: Path, to: Path, changed: dict[int, RawMessage | None]) -> Path:
    """Copy a recording, with other messages at some places; return its path."""
    target, connections = BagFile(to, Compression.NONE, MCAP_FILE), {}
    for number, message in enumerate(messages(hunt, unchanged=True)):
        item = changed.get(number, message)
        if item is None:
            continue
        if item.topic not in connections:
            theirs = recorded_type(item.msgtype, types.plain_definition(item.msgtype).text)
            connections[item.topic] = target.connect(
                item.topic, theirs.name, theirs.hash, theirs.definition, None, latching=False
            )
        target.write(connections[item.topic], item.stamp_ns, item.data)
    target.close()
    return to


def test_every_message_is_the_same(hunt: Path) -> None:
    assert_equal_replay(hunt, TICKS)


def test_a_study_with_parts_and_zstd_is_replayed(tmp_path: Path) -> None:
    recording = dataclasses.replace(STUDY.recording, compression=Compression.ZSTD, split_duration=2.0)
    record(tmp_path / "run", dataclasses.replace(STUDY, recording=recording), TICKS / 50)
    assert len(parts_of(tmp_path / "run")) == 3
    assert_equal_replay(tmp_path / "run", TICKS)


def test_one_changed_byte_of_any_kind_is_found(hunt: Path, tmp_path: Path) -> None:
    """In a number, in a text, in the padding between fields, and in the header of CDR."""
    said = list(messages(hunt, unchanged=True))
    scan = next(number for number, message in enumerate(said) if message.topic == "/robot1/scan")
    goal = next(number for number, message in enumerate(said) if message.topic == names.ROSOUT)
    odometry = next(number for number, message in enumerate(said) if message.topic == "/robot1/odom")
    padding = 54  # After the frame of the child, numbers begin at the next multiple of 8.
    assert said[odometry].data[32:60] == b"robot1/base_footprint" + bytes(7)
    for number, place in ((scan, -8), (goal, said[goal].data.index(b"goal ")), (odometry, padding), (odometry, 3)):
        data = bytearray(said[number].data)
        data[place] ^= 1
        to = tmp_path / f"{number}-{place}.mcap"
        found = replay_again(copied(hunt, to, {number: said[number]._replace(data=bytes(data))})).difference
        assert found is not None and found.topic == said[number].topic, place
        assert found.number == number


def test_a_missing_message_is_found(hunt: Path, tmp_path: Path) -> None:
    found = replay_again(copied(hunt, tmp_path / "a.mcap", {1500: None})).difference
    assert found is not None and found.number == 1500


def test_fields_that_differ_are_named(hunt: Path) -> None:
    found = replay_again(hunt, StudyChange("seed", "8")).difference
    assert found is not None and found.fields


def test_one_that_was_cut_off_is_the_same_up_to_its_end(hunt: Path, tmp_path: Path) -> None:
    (part,) = parts_of(hunt)
    whole = part.read_bytes()
    for share in (0.5, 0.9):
        cut = tmp_path / f"cut{share}.mcap.active"
        cut.write_bytes(whole[: int(share * len(whole))])
        done = replay_again(reindex(cut).path)
        assert done.difference is None and done.messages > 10


def test_a_replay_records_the_same_bytes(hunt: Path, tmp_path: Path) -> None:
    replay_again(hunt, to=tmp_path / "again.mcap")
    (part,) = parts_of(hunt)
    assert (tmp_path / "again.mcap").read_bytes() == part.read_bytes()


def test_commands_read_it(hunt: Path, tmp_path: Path) -> None:
    bag = tmp_path / "hunt.bag"
    record(bag, STUDY, TICKS / 50)
    assert info(hunt).messages == info(bag).messages
    assert "/robot2/scan" in output_of("bag", "info", hunt)
    output_of("report", hunt, "--to", tmp_path / "report.html")
    output_of("bag", "export", hunt, "--to", tmp_path / "tables")
    output_of("replay", hunt)


def test_names_and_compressions_are_checked_before_a_game_starts(tmp_path: Path) -> None:
    for name, sentence in (
        ("hunt.txt", "is not the name of a recording. Write a file name that ends in .bag or .mcap"),
        ("hunt.mcap", "cannot have `recording.compression: bz2`"),
        ("hunt", "cannot have `recording.compression: bz2`"),
    ):
        study = tmp_path / "study.yaml"
        study.write_text("recording: {compression: bz2}\n")
        assert sentence in refusal_of("play", study, "--headless", "--bag", tmp_path / name)
        assert sorted(path.name for path in tmp_path.iterdir()) == ["study.yaml"]
    assert unfinished_of(tmp_path / "hunt.mcap") is None and not active_of(tmp_path / "hunt").exists()
