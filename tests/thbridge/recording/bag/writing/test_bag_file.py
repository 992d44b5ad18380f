import io
from pathlib import Path

import lz4.frame
import pytest
import rosbag
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from rosbags.rosbag1.reader import Header, RecordType

from thbridge.recording.bag.options import ROS1_COMPRESSIONS, Compression
from thbridge.recording.bag.reading.reader import messages
from thbridge.recording.bag.records import chunk_record
from thbridge.recording.bag.writing.bag_file import BagFile
from thbridge.ros.messages.types import plain_definition

STRING = plain_definition("std_msgs/String")
SAID = st.lists(st.tuples(st.integers(0, 2), st.integers(0, 5 * 10**9), st.binary(max_size=300)), max_size=60)


def written(path: Path, said: list[tuple[int, int, bytes]], compression: Compression) -> None:
    bag = BagFile(path, compression)
    callers = [("/a", "/one", None), ("/a", "/two", False), ("/b", None, True)]
    connections = [
        bag.connect(topic, "std_msgs/String", STRING.md5, STRING.text, caller, latching)
        for topic, caller, latching in callers
    ]
    for connection, stamp_ns, data in said:
        bag.write(connections[connection], stamp_ns, data)
    bag.close()


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=40, deadline=None)
@given(SAID, st.sampled_from(ROS1_COMPRESSIONS))
def test_what_is_written_is_read_whatever_the_order_of_stamps(
    tmp_path: Path, said: list[tuple[int, int, bytes]], compression: Compression
) -> None:
    path = tmp_path / "a.bag"
    path.unlink(missing_ok=True)
    written(path, said, compression)
    expected = sorted(("/b" if connection == 2 else "/a", stamp, data) for connection, stamp, data in said)
    ours = [(message.topic, message.stamp_ns, message.data) for message in messages(path)]
    assert sorted(ours) == expected
    assert [stamp for _, stamp, _ in ours] == sorted(stamp for _, stamp, _ in ours)
    with rosbag.Bag(str(path)) as reader:
        theirs = [(topic, stamp.to_nsec(), raw[1]) for topic, raw, stamp in reader.read_messages(raw=True)]
    assert sorted(theirs) == expected


def test_publishers_and_what_they_latch_are_told_as_ros_tells_them(tmp_path: Path) -> None:
    written(tmp_path / "a.bag", [(0, 1, b""), (1, 2, b""), (2, 3, b"")], Compression.NONE)
    with rosbag.Bag(str(tmp_path / "a.bag")) as reader:
        headers = [connection.header for connection in reader._get_connections()]
    told = [(header["topic"], header.get("callerid"), header.get("latching")) for header in headers]
    assert told == [(b"/a", b"/one", None), (b"/a", b"/two", b"0"), (b"/b", None, b"1")]


@pytest.mark.parametrize("size", [0, 1, 1000, 300_000])
def test_lz4_frames_are_of_the_kind_that_roslz4_reads(size: int) -> None:
    source = io.BytesIO(chunk_record(bytes(range(256)) * (size // 256 + 1), Compression.LZ4))
    assert Header.read(source, RecordType.CHUNK).get_string("compression") == "lz4"
    told = lz4.frame.get_frame_info(source.read()[4:])
    assert (told["block_linked"], told["content_checksum"], told["block_checksum"]) == (False, True, False)
    assert told["content_size"] == 0
