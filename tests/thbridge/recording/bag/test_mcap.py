"""Recordings in rosbag2's formats, judged by rosbags, the MCAP project's readers, and the bag of the same session."""

import io
import random
from contextlib import redirect_stdout
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import NonSeekingReader, make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.convert.converter import generate_message_converter
from rosbags.highlevel import AnyReader
from rosbags.interfaces import QosDurability, QosReliability
from rosbags.rosbag2 import CompressionMode, Reader, StoragePlugin
from rosbags.typesys import Stores, get_typestore
from ruamel.yaml import YAML

from tests.support.bags import ros2_bags
from tests.support.bags.drawn_team import MOUNT, SCAN_PERIOD, SESSION, arena, records, snapshots
from tests.support.bags.inline_queue import InlineQueue
from thbridge.app.session.broadcast import Broadcast
from thbridge.files.errors import BadFile
from thbridge.recording.bag.options import MCAP_COMPRESSIONS, Compression, SplitLimits
from thbridge.recording.bag.reading import reader
from thbridge.recording.bag.repair import reindex
from thbridge.recording.bag.writing.writer import WHOLE, BagWriter, ForeignTopic
from thbridge.recording.recordings import make_room, parts_of, reserve
from thbridge.ros.messages import types
from thbridge.ros.messages.foreign_types import register
from thbridge.ros.publisher import TeamPublisher
from thbridge.ros.topics import RosMessage, Topic
from thbridge.ros2.recorded_types import recorded_type

LATCHED = {"/thbridge/session", "/tf_static", "/map", "/map_metadata"}


def record(
    path: Path, ticks: int = 150, compression: Compression = Compression.LZ4, splits: SplitLimits = WHOLE
) -> Path:
    with BagWriter(path, compression=compression, splitting=splits) as writer:
        recorder = Broadcast(TeamPublisher(2, MOUNT, SCAN_PERIOD), SESSION, arena(), [writer])
        for snapshot in snapshots(2, ticks):
            recorder.record(snapshot, records(snapshot.tick))
    return path


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("recorded")


@pytest.fixture(scope="module")
def bag(folder: Path) -> Path:
    return record(folder / "a.bag")


@pytest.fixture(scope="module")
def mcap(folder: Path) -> Path:
    return record(folder / "a.mcap")


def stored(path: Path) -> list[tuple[str, int, bytes]]:
    """Return the messages of a file in its own order, as the MCAP project reads them."""
    with path.open("rb") as file:
        found = make_reader(file).iter_messages(log_time_order=False)
        return [(channel.topic, message.log_time, message.data) for _, channel, message in found]


@cache
def converter(msgtype: str, target: str):  # type: ignore[no-untyped-def]
    ours, theirs = types.typestore(), get_typestore(Stores.ROS2_JAZZY)
    register(theirs, {name: own for name, own in ours.fielddefs.items() if name not in theirs.fielddefs})
    with redirect_stdout(io.StringIO()):
        return generate_message_converter(ours, theirs, msgtype, target, {}, src_is2=False, dst_is2=True)


def test_messages_are_those_of_the_bag_in_its_order(bag: Path, mcap: Path) -> None:
    ours = []
    for publisher, stamp, data in reader.recorded(bag):
        name = publisher.msgtype.replace("/", "/msg/")
        if publisher.topic == "/rosout":
            cdr = recorded_type(publisher.msgtype, publisher.definition).from_ros1(data)
        else:
            cdr = bytes(converter(name, name)(data))
        ours.append((publisher.topic, stamp, cdr))
    assert ours == stored(mcap)
    assert len(ours) > 1000


@pytest.mark.parametrize("compression", MCAP_COMPRESSIONS)
def test_the_mcap_projects_reader_of_ros_2_decodes_every_message(tmp_path: Path, compression: Compression) -> None:
    path = record(tmp_path / "a.mcap", 60, compression)
    with path.open("rb") as file:
        judge = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        assert judge.get_header().profile == "ros2"
        summary = judge.get_summary()
        assert summary is not None and summary.statistics is not None
        packed = {chunk.compression for chunk in summary.chunk_indexes}
        assert packed == {"" if compression is Compression.NONE else compression}
        decoded = list(judge.iter_decoded_messages(log_time_order=False))
        assert len(decoded) == summary.statistics.message_count > 400
        sequences: dict[str, list[int]] = {}
        for _, channel, message, _ in decoded:
            sequences.setdefault(channel.topic, []).append(message.sequence)
        assert all(numbers == list(range(len(numbers))) for numbers in sequences.values())
        file.seek(0)
        assert len(list(NonSeekingReader(file, validate_crcs=True).iter_messages())) == len(decoded)


@pytest.mark.parametrize("splits", [WHOLE, SplitLimits(duration_ns=1_000_000_000)])
def test_rosbags_reads_a_folder_and_its_quality_of_service(tmp_path: Path, splits: SplitLimits) -> None:
    path = record(tmp_path / "run", splits=splits)
    with Reader(path) as judge:
        assert judge.message_count == sum(1 for _ in judge.messages())
        durability = {each.topic: each.ext.offered_qos_profiles[0].durability for each in judge.connections}
        assert {topic for topic, kind in durability.items() if kind is QosDurability.TRANSIENT_LOCAL} >= LATCHED
        assert durability["/tf"] is QosDurability.VOLATILE
        assert {each.ext.offered_qos_profiles[0].reliability for each in judge.connections} == {QosReliability.RELIABLE}
        assert judge.start_time == 1_000_000_000
    facts = YAML(typ="safe").load((path / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert facts["version"] == 9 and facts["ros_distro"] == "jazzy"
    assert facts["custom_data"]["study.yaml"] == SESSION.study
    assert [each["path"] for each in facts["files"]] == [part.name for part in parts_of(path)]
    topics = [each["topic_metadata"] for each in facts["topics_with_message_count"]]
    hashes = {each["name"]: each["type_description_hash"] for each in topics}
    assert hashes["/tf"] == get_typestore(Stores.ROS2_JAZZY).hash_rihs01("tf2_msgs/msg/TFMessage")
    with AnyReader([path]) as judge:
        for connection, _, data in judge.messages():
            judge.deserialize(data, connection.msgtype)


def test_a_folder_has_the_bytes_of_the_file(tmp_path: Path, mcap: Path) -> None:
    assert (record(tmp_path / "run") / "run_0.mcap").read_bytes() == mcap.read_bytes()


def test_a_folder_that_was_renamed_is_the_same_recording(tmp_path: Path) -> None:
    path = record(tmp_path / "run", splits=SplitLimits(duration_ns=1_000_000_000))
    before = list(reader.messages(path))
    moved = path.rename(tmp_path / "moved")
    assert list(reader.messages(moved)) == before
    with Reader(moved) as judge:
        assert judge.message_count > len(before), "latched messages are repeated"


def test_parts_in_a_folder_read_as_one_are_the_whole(tmp_path: Path, mcap: Path) -> None:
    path = record(tmp_path / "run", splits=SplitLimits(duration_ns=1_000_000_000))
    assert len(parts_of(path)) == 3
    assert list(reader.messages(path, unchanged=True)) == list(reader.messages(mcap, unchanged=True))


@given(data=st.data(), compression=st.sampled_from(MCAP_COMPRESSIONS))
@settings(max_examples=25)
def test_wherever_it_is_cut_the_messages_before_are_recovered(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject, compression: Compression
) -> None:
    path = tmp_path_factory.mktemp("cut") / "a.mcap"
    whole, content = cut_source(compression)
    cut = data.draw(st.integers(len(content) // 50, len(content)))
    active = path.with_name("a.mcap.active")
    active.write_bytes(content[:cut])
    repaired = reindex(active)
    assert repaired.path == path and repaired.backup.read_bytes() == content[:cut]
    kept = stored(path)
    assert kept == whole[: len(kept)]
    if compression is Compression.NONE:
        # Messages are stored as they are, so that most of a chunk that is cut off is recovered.
        assert sum(len(each) for _, _, each in kept) > 0.7 * cut - 60_000


@cache
def cut_source(compression: Compression) -> tuple[list[tuple[str, int, bytes]], bytes]:
    with TemporaryDirectory() as folder:
        path = record(Path(folder) / "whole.mcap", 100, compression)
        return stored(path), path.read_bytes()


@given(data=st.data(), compression=st.sampled_from(MCAP_COMPRESSIONS))
@settings(max_examples=25)
def test_damaged_bytes_cost_no_more_than_their_chunk(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject, compression: Compression
) -> None:
    path = tmp_path_factory.mktemp("damaged") / "a.mcap"
    whole, content = cut_source(compression)
    place = data.draw(st.integers(100, len(content) - 1))
    damaged = bytearray(content)
    damaged[place : place + 8] = bytes(8)
    path.write_bytes(damaged)
    repaired = reindex(path)
    kept = stored(path)
    assert len(kept) == repaired.messages
    assert set(kept) <= set(whole)


def test_bytes_of_zero_behind_the_end_are_no_harm(tmp_path: Path, mcap: Path) -> None:
    path = tmp_path / "a.mcap.active"
    content = mcap.read_bytes()
    start = content.rindex(b"\x0f\x04\x00\x00\x00\x00\x00\x00\x00")  # the end of the data
    path.write_bytes(content[:start] + bytes(50_000))
    assert reindex(path).messages == len(stored(mcap))


def test_other_programs_read_a_file_that_is_being_written(tmp_path: Path) -> None:
    seconds = iter(range(1000))
    path = tmp_path / "a.mcap"
    writer = BagWriter(path, clock=lambda: float(next(seconds)), make_queue=lambda _: InlineQueue())
    recorder = Broadcast(TeamPublisher(1, MOUNT, SCAN_PERIOD), SESSION, arena(), [writer])
    copy = tmp_path / "copy.mcap"
    for snapshot in snapshots(1, 120):
        recorder.record(snapshot, records(snapshot.tick))
        if snapshot.tick in {3, 50, 90}:
            copy.write_bytes((tmp_path / "a.mcap.active").read_bytes())
            with AnyReader([copy]) as judge:
                count = sum(1 for _ in judge.messages())
            assert count == len(stored(copy)) > 10
            with pytest.raises(BadFile, match="still being written"):
                reader.info(tmp_path / "a.mcap.active")
    writer.close()
    assert stored(path)[:count] == stored(copy)


def test_a_killed_folder_is_repaired_with_its_metadata(tmp_path: Path) -> None:
    path = record(tmp_path / "run", splits=SplitLimits(duration_ns=1_000_000_000))
    before = list(reader.messages(path, unchanged=True))
    metadata = (path / "metadata.yaml").read_bytes()
    last = path / "run_2.mcap"
    last.rename(path / "run_2.mcap.active")
    (path / "metadata.yaml").unlink()
    with pytest.raises(BadFile, match=r"still being written.*reindex .*run"):
        reader.info(path)
    done = reindex(path)
    assert done.path == path and done.lost_bytes == 0
    assert list(reader.messages(path, unchanged=True)) == before
    assert (path / "metadata.yaml").read_bytes() == metadata
    with pytest.raises(BadFile, match="no unfinished"):
        reindex(path)


def test_a_folder_without_metadata_gets_it(tmp_path: Path) -> None:
    path = record(tmp_path / "run")
    metadata = (path / "metadata.yaml").read_bytes()
    (path / "metadata.yaml").unlink()
    reindex(path)
    assert (path / "metadata.yaml").read_bytes() == metadata


def test_files_of_other_recorders_are_not_repaired(tmp_path: Path) -> None:
    folder = ros2_bags.written(tmp_path / "theirs", StoragePlugin.MCAP, CompressionMode.NONE)
    with pytest.raises(BadFile, match=r"thbridge did not record.*mcap recover"):
        reindex(folder / "theirs.mcap")


def test_an_older_folder_is_renamed_and_other_folders_are_left_alone(tmp_path: Path) -> None:
    path = record(tmp_path / "run")
    (tmp_path / "run-1.bag").touch()
    assert make_room(path) == tmp_path / "run-2"
    reserve(path)
    record(path)
    assert len(list(reader.messages(tmp_path / "run-2"))) == len(list(reader.messages(path)))
    mine = tmp_path / "mine"
    mine.mkdir()
    (mine / "thesis.txt").touch()
    with pytest.raises(BadFile, match="something other than a recording"):
        make_room(mine)
    assert (mine / "thesis.txt").exists()


def test_foreign_messages_that_do_not_fit_their_type_are_omitted_once(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    text = types.plain_definition("std_msgs/String")
    source = ForeignTopic("/said", "std_msgs/String", text.md5, text.text, "/talker", latched=False)
    odd = ForeignTopic("/odd", "my_msgs/Odd", "*", "float64 x\nfloat128[] y\n", "/odd_node", latched=False)
    with BagWriter(tmp_path / "a.mcap") as writer:
        writer.write_foreign(source, 10**9, b"\x02\x00\x00\x00ab")
        for number in range(3):
            writer.write_foreign(source, 10**9 + number, b"\x09\x00\x00\x00ab")
            writer.write_foreign(odd, 10**9 + number, bytes(12))
    assert stored(tmp_path / "a.mcap") == [("/said", 10**9, b"\x00\x01\x00\x00\x03\x00\x00\x00ab\x00")]
    assert len(caplog.records) == 2


def test_topics_of_one_name_and_different_definitions_are_both_recorded(tmp_path: Path) -> None:
    one, other = "float64 x\n", "int32 y\n"
    with BagWriter(tmp_path / "a.mcap") as writer:
        writer.write(RosMessage(Topic("/said", "std_msgs/String"), 10**9, b"\x01\x00\x00\x00a"))
        for text, data in ((one, bytes(8)), (other, bytes(4))):
            writer.write_foreign(
                ForeignTopic("/value", "my_msgs/Value", "*", text, "/node", latched=False), 10**9, data
            )
    assert [len(data) for _, _, data in stored(tmp_path / "a.mcap")] == [10, 12, 8]


def test_random_damage_raises_nothing_but_bad_file(tmp_path: Path, mcap: Path) -> None:
    content, chance = mcap.read_bytes(), random.Random(1)
    for number in range(30):
        place = chance.randrange(len(content))
        damaged = bytearray(content)
        damaged[place : place + chance.randrange(1, 20)] = chance.randbytes(chance.randrange(20))
        path = tmp_path / f"{number}.mcap"
        path.write_bytes(damaged)
        try:
            reindex(path)
        except BadFile:
            continue
