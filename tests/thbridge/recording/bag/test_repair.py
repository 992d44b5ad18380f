import errno
import signal
import subprocess
import sys
from io import BytesIO
from pathlib import Path
from random import Random
from typing import IO, Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from rosbags.rosbag1 import Writer
from rosbags.rosbag1.reader import RecordType
from rosbags.typesys import Stores, get_typestore

from tests.support.programs.commands import invoke
from tests.support.slow import slow
from thbridge.files.errors import BadFile
from thbridge.files.ros.definitions import Definitions
from thbridge.recording.bag.options import Compression
from thbridge.recording.bag.reading.reader import info, messages
from thbridge.recording.bag.reading.scan import ChunkRecord, ConnectionRecord, MessageRecord, UnreadableSpan, scan
from thbridge.recording.bag.repair import reindex
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.recording.recordings import active_of
from thbridge.ros.messages.types import plain_definition
from thbridge.ros.publisher import RosMessage, Topic

PLAIN = Definitions(())
TOPICS = [Topic("/chatter", "std_msgs/String"), Topic("/news", "std_msgs/String", latched=True)]
TICK_NS = 20_000_000


def said(count: int) -> list[RosMessage]:
    texts = (f"message {number}".encode() * 20 for number in range(count))
    return [
        RosMessage(TOPICS[number % 2], 1_000_000_000 + number * TICK_NS, len(text).to_bytes(4, "little") + text)
        for number, text in enumerate(texts)
    ]


def bag(path: Path, count: int = 300) -> bytes:
    with BagWriter(path, PLAIN) as writer:
        for message in said(count):
            writer.write(message)
    return path.read_bytes()


def read(path: Path) -> list[tuple[str, int, bytes]]:
    return [(message.topic, message.stamp_ns, message.data) for message in messages(path)]


def expected(count: int) -> list[tuple[str, int, bytes]]:
    return [(message.topic.name, message.stamp_ns, message.data) for message in said(count)]


def test_a_bag_with_no_index_is_recovered_whole_and_kept_beside(tmp_path: Path) -> None:
    whole = bag(tmp_path / "a.bag")
    index = int.from_bytes(whole[whole.index(b"index_pos=") + 10 :][:8], "little")
    cut = whole[:index]
    (tmp_path / "a.bag").write_bytes(cut)
    repaired = reindex(tmp_path / "a.bag")
    assert (repaired.path, repaired.backup) == (tmp_path / "a.bag", tmp_path / "a.orig.bag")
    assert (repaired.messages, repaired.lost_bytes) == (300, 0)
    assert repaired.end_ns == said(300)[-1].stamp_ns
    assert repaired.backup.read_bytes() == cut
    assert read(repaired.path) == expected(300)


def test_a_recording_that_was_killed_gets_its_name(tmp_path: Path) -> None:
    whole = bag(tmp_path / "a.bag")
    (tmp_path / "a.bag").unlink()
    (tmp_path / "a.bag.active").write_bytes(whole[:30_000])
    repaired = reindex(tmp_path / "a.bag.active")
    assert repaired.path == tmp_path / "a.bag"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.bag", "a.orig.bag"]
    assert info(repaired.path).messages == repaired.messages > 50


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=40, deadline=None)
@given(st.data(), st.booleans())
def test_wherever_it_is_cut_the_messages_before_are_recovered(
    tmp_path: Path, data: st.DataObject, is_checked: bool
) -> None:
    path = tmp_path / "a.bag"
    for file in tmp_path.iterdir():
        file.unlink()
    whole = bag(path, 120)
    keep = data.draw(st.integers(4117, len(whole)))
    path.write_bytes(whole[:keep] if is_checked else unchecked(whole[:keep]))
    complete, safe = (
        sum(whole.index(message.data) + len(message.data) <= end for message in said(120))
        for end in (keep, keep - 4096)
    )
    found = read(reindex(path).path)
    assert found == expected(len(found))
    # In a chunk with checksums, the messages of a block that is cut off cannot be checked.
    assert safe <= len(found) <= complete if is_checked else len(found) == complete


def test_bytes_of_zero_behind_the_end_are_no_harm(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    whole = bag(path)
    path.write_bytes(whole[:20_000] + bytes(8192))
    assert reindex(path).lost_bytes > 8000
    kept = read(path)
    assert len(kept) > 20
    assert kept == expected(len(kept))


def test_a_healthy_bag_comes_back_with_the_same_messages(tmp_path: Path) -> None:
    bag(tmp_path / "a.bag")
    assert reindex(tmp_path / "a.bag").lost_bytes == 0
    assert read(tmp_path / "a.bag") == expected(300)


@pytest.mark.parametrize("compression", [None, Writer.CompressionFormat.BZ2, Writer.CompressionFormat.LZ4])
def test_a_foreign_bag_is_recovered(tmp_path: Path, compression: Writer.CompressionFormat | None) -> None:
    path = tmp_path / "a.bag"
    writer = Writer(path)
    if compression is not None:
        writer.set_compression(compression)
    writer.chunk_threshold = 1000
    store = get_typestore(Stores.ROS1_NOETIC)
    with writer:
        first = writer.add_connection("/chatter", "std_msgs/msg/String", typestore=store)
        second = writer.add_connection("/chatter", "std_msgs/msg/String", typestore=store, callerid="/other")
        for message in said(100):
            writer.write(first if message.topic is TOPICS[0] else second, message.stamp_ns, message.data)
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    repaired = reindex(path)
    assert 20 < repaired.messages < 100
    assert [item[2] for item in read(path)] == [item[2] for item in expected(repaired.messages)]


def chunks(path: Path) -> list[ChunkRecord]:
    return [record for record in scan(path) if isinstance(record, ChunkRecord)]


def data_of(content: bytes, chunk: ChunkRecord) -> int:
    """The place of a chunk's data in its bag."""
    return chunk.position + 8 + int.from_bytes(content[chunk.position :][:4], "little")


def packed_bag(path: Path, compression: Compression) -> tuple[bytes, list[int]]:
    """A bag of several chunks, and the place of the data of each."""
    with BagWriter(path, PLAIN, compression=compression) as writer:
        for message in said(3000):
            writer.write(message)
    content = path.read_bytes()
    places = [data_of(content, chunk) for chunk in chunks(path)]
    assert len(places) > 2
    return content, places


@pytest.mark.parametrize("damaged", [0, 1])
@pytest.mark.parametrize("compression", [Compression.LZ4, Compression.BZ2])
def test_a_chunk_that_cannot_be_unpacked_costs_only_itself(
    tmp_path: Path, compression: Compression, damaged: int
) -> None:
    path = tmp_path / "a.bag"
    whole, places = packed_bag(path, compression)
    chunk = chunks(path)[damaged]
    path.write_bytes(whole[: places[damaged]] + b"broken" + whole[places[damaged] + 6 :])
    in_other_chunks = sum(isinstance(record, MessageRecord) for record in scan(path))
    repaired = reindex(path)
    assert repaired.lost_bytes == chunk.unpacked
    assert repaired.messages == in_other_chunks > 1000
    assert set(read(path)) < set(expected(3000))
    assert read(path)[-1] == expected(3000)[-1]


@pytest.mark.parametrize("compression", [Compression.LZ4, Compression.BZ2])
def test_a_packed_chunk_that_is_cut_off_loses_its_end_alone(tmp_path: Path, compression: Compression) -> None:
    path = tmp_path / "a.bag"
    noise = [Random(number).randbytes(280) for number in range(330)]
    with BagWriter(path, PLAIN, compression=compression) as writer:
        for number, data in enumerate(noise):
            # All within one chunk.
            writer.write(RosMessage(TOPICS[0], 1_000_000_000 + number, data * 4))
    whole = path.read_bytes()
    (chunk,) = chunks(path)
    start = data_of(whole, chunk)
    path.write_bytes(whole[: start + chunk.size - 1000])
    repaired = reindex(path)
    # BZ2 unpacks all of a chunk or nothing.
    assert (repaired.messages > 20) is (compression is Compression.LZ4)
    assert [data for _, _, data in read(path)] == [data * 4 for data in noise[: repaired.messages]]
    assert 1000 < repaired.lost_bytes <= chunk.unpacked


def test_what_is_lost_of_a_chunk_that_is_cut_off_counts_once(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    whole = bag(path)
    chunk = chunks(path)[-1]
    start = data_of(whole, chunk)
    message = said(300)[-10].data
    path.write_bytes(whole[: whole.index(message, start) + len(message) + 30])
    (lost,) = [record for record in scan(path) if isinstance(record, UnreadableSpan)]
    assert 30 <= lost.lost < 4096 + len(message)
    assert "too early" in lost.problem


def test_a_record_of_no_known_kind_does_not_hide_the_others(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    whole, _ = packed_bag(path, Compression.NONE)
    at = whole.index(b"op=", chunks(path)[1].position) + len(b"op=")
    assert whole[at] == RecordType.CHUNK
    path.write_bytes(whole[:at] + b"\x7f" + whole[at + 1 :])
    assert reindex(path).lost_bytes > 5_000
    assert read(path)[-1] == expected(3000)[-1]


def renamed_in(content: bytes, topic: str, name: bytes) -> bytes:
    """The bytes of a bag in which all connection records of a topic have another field in place of one."""
    at, parts = 0, []
    for piece in content.split(b"topic=" + topic.encode())[:-1]:
        start = at + len(piece)
        found = content.index(name + b"=", start)
        parts.append(found)
        at = start + len(b"topic=" + topic.encode())
    data = bytearray(content)
    for found in parts:
        data[found : found + 1] = b"x"
    return unchecked(data)


def unchecked(content: bytes) -> bytes:
    """The bytes of a bag without the checksums of its chunks, as other programs write it."""
    return content.replace(b"crc32=", b"other=")


def two_types(path: Path) -> bytes:
    """A bag of one chunk with two topics, one of a type of ROS's."""
    other = Topic("/other", "std_msgs/Float64")
    with BagWriter(path, PLAIN) as writer:
        for number in range(40):
            writer.write(RosMessage(TOPICS[0], 1_000_000_000 + number * TICK_NS, b"\x02\0\0\0ab"))
            writer.write(RosMessage(other, 1_000_000_000 + number * TICK_NS, bytes(8)))
    return path.read_bytes()


@pytest.mark.parametrize("field", [b"message_definition", b"md5sum"])
def test_a_connection_without_definition_or_sum_gets_that_of_its_type(field: bytes, tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    path.write_bytes(renamed_in(two_types(path), "/other", field))
    repaired = reindex(path)
    assert (repaired.messages, repaired.lost_bytes, repaired.losses) == (80, 0, ())
    plain = plain_definition("std_msgs/Float64")
    connections = {record.topic: record for record in scan(path) if isinstance(record, ConnectionRecord)}
    other = connections["/other"]
    assert (other.md5, other.definition, other.lacks) == (plain.md5, plain.text, ())


def test_a_connection_that_cannot_be_read_costs_its_messages_alone(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    path.write_bytes(renamed_in(two_types(path), "/other", b"type"))
    repaired = reindex(path)
    assert (repaired.messages, {topic for topic, _, _ in read(path)}) == (40, {"/chatter"})
    told = " ".join(repaired.losses)
    assert "the connection of /other lacks its field type" in told
    assert "40 messages of connection 1, 320 bytes: no readable record has its topic and type." in told


def test_two_connections_of_one_number_are_both_kept_and_reported(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    with BagWriter(path, PLAIN) as writer:
        writer.write(RosMessage(TOPICS[0], 1_000_000_000, b"\x02\0\0\0ab"))
    with BagWriter(tmp_path / "b.bag", PLAIN) as writer:
        writer.write(RosMessage(Topic("/other", "std_msgs/Float64"), 2_000_000_000, bytes(8)))
    # As of `cat a.bag b.bag`; the second has no line of its version.
    path.write_bytes(path.read_bytes() + (tmp_path / "b.bag").read_bytes()[len("#ROSBAG V2.0\n") :])
    repaired = reindex(path)
    assert [(topic, data) for topic, _, data in read(path)] == [("/chatter", b"\x02\0\0\0ab"), ("/other", bytes(8))]
    assert (repaired.messages, repaired.lost_bytes) == (2, 0)
    (told,) = repaired.losses
    assert "/chatter (std_msgs/String) and /other (std_msgs/Float64) have the same connection number 0." in told


def test_a_bag_of_which_nothing_can_be_read_is_no_success(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    content = renamed_in(renamed_in(two_types(path), "/other", b"type"), "/chatter", b"type")
    path.write_bytes(content)
    done = invoke("bag", "reindex", path)
    assert done.exit_code == 1
    assert "Recovered 0 messages" in done.output
    assert "the connection of /chatter lacks its field type" in done.output
    assert "40 messages of connection 0" in done.output
    assert (tmp_path / "a.orig.bag").read_bytes() == content


class BadSector(BytesIO):
    """A file of which no disk reads one byte any more."""

    def __init__(self, content: bytes, bad: int) -> None:
        super().__init__(content)
        self.bad = bad

    def read(self, size: int | None = -1) -> bytes:
        if size is not None and self.tell() <= self.bad < self.tell() + size:
            raise OSError(errno.EIO, "Input/output error")
        return super().read(size)


def test_a_sector_that_cannot_be_read_costs_only_its_chunk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.bag"
    whole, _ = packed_bag(path, Compression.NONE)
    bad = chunks(path)[5].position + 1000
    really_open = Path.open

    def open_damaged(at: Path, mode: str = "r", buffering: int = -1) -> IO[Any]:
        return BadSector(whole, bad) if at == path else really_open(at, mode, buffering)

    with monkeypatch.context() as patched:
        patched.setattr(Path, "open", open_damaged)
        assert reindex(path).lost_bytes > 5_000
    assert set(read(path)) < set(expected(3000))
    assert read(path)[-1] == expected(3000)[-1]


def test_files_in_the_way_are_not_overwritten(tmp_path: Path) -> None:
    whole = bag(tmp_path / "a.bag")
    (tmp_path / "a.orig.bag").write_bytes(b"dear")
    with pytest.raises(BadFile, match="would overwrite it"):
        reindex(tmp_path / "a.bag")
    assert (tmp_path / "a.bag").read_bytes() == whole
    (tmp_path / "a.orig.bag").unlink()
    (tmp_path / "a.bag.active").write_bytes(whole)
    with pytest.raises(BadFile, match="would overwrite it"):
        reindex(tmp_path / "a.bag.active")


def test_what_is_not_a_bag_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    path.write_bytes(b"no bag")
    with pytest.raises(BadFile, match="not a ROS 1 bag"):
        reindex(path)


WRITE = """
import sys
import time
from pathlib import Path
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.files.ros.definitions import Definitions
from thbridge.ros.messages.types import plain_definition
from thbridge.ros.publisher import RosMessage, Topic
from ui.cli import app

topic = Topic("/chatter", "std_msgs/String")
writer = BagWriter(Path(sys.argv[1]), Definitions(()))
number = 0
while True:
    text = b"%08d" % number + b"x" * 200
    stamp = 1_000_000_000 + number * 2_000_000
    writer.write(RosMessage(topic, stamp, len(text).to_bytes(4, "little") + text))
    writer.sync_if_due()
    number += 1
    sys.stdout.write(f"{time.monotonic()} {stamp}\\n")
    sys.stdout.flush()
"""
"""Writes 500 messages a simulated second as fast as it can and says after each what it wrote, and when."""


@pytest.mark.parametrize("name", ["a.bag", "a.mcap", *slow("a")])
@pytest.mark.parametrize("kill_after", [3_777, *slow(12_001, 20_250)])
def test_killed_at_any_moment_at_most_the_last_second_is_lost(tmp_path: Path, name: str, kill_after: int) -> None:
    path = tmp_path / name
    process = subprocess.Popen([sys.executable, "-c", WRITE, str(path)], stdout=subprocess.PIPE)
    assert process.stdout is not None
    lines = [line for _, line in zip(range(kill_after), process.stdout, strict=False)]
    process.send_signal(signal.SIGKILL)
    lines += [line for line in process.stdout if line.endswith(b"\n")]  # what it wrote before its end
    process.wait()
    process.stdout.close()
    said = [(float(second), int(stamp)) for second, stamp in (line.split() for line in lines)]
    repaired = reindex(active_of(path))
    assert repaired.end_ns is not None
    kept = next(second for second, stamp in said if stamp == repaired.end_ns)
    assert said[-1][0] - kept <= 1.0
    stamps = [message.stamp_ns for message in messages(path)]
    assert stamps == list(range(1_000_000_000, repaired.end_ns + 1, 2_000_000))
