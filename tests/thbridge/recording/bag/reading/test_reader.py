import tracemalloc
from pathlib import Path

import pytest
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_typestore

from tests.support.bags.small_bags import HELLO, write_four_messages
from thbridge.files.errors import BadFile
from thbridge.recording.bag.options import Compression
from thbridge.recording.bag.reading.reader import BagInfo, TopicInfo, info, messages, recorded
from thbridge.recording.bag.writing.bag_file import BagFile


def test_info(tmp_path: Path) -> None:
    path = write_four_messages(tmp_path / "a.bag")
    assert info(path) == BagInfo(
        path,
        path.stat().st_size,
        1_000_000_000,
        3_000_000_000,
        2.0,
        4,
        (TopicInfo("/chatter", "std_msgs/String", 3, False), TopicInfo("/news", "std_msgs/String", 1, True)),
    )


def test_a_bag_of_stock_rosbags_is_read(tmp_path: Path) -> None:
    path = tmp_path / "foreign.bag"
    with Writer(path) as writer:
        connection = writer.add_connection(
            "/chatter", "std_msgs/msg/String", typestore=get_typestore(Stores.ROS1_NOETIC)
        )
        writer.write(connection, 7, HELLO)
    (read,) = messages(path)
    assert (read.topic, read.msgtype, read.stamp_ns, read.data) == ("/chatter", "std_msgs/String", 7, HELLO)


@pytest.mark.parametrize("keep", [4117, 4200, -1, -60])
def test_a_damaged_bag_is_refused_with_the_remedy(tmp_path: Path, keep: int) -> None:
    path = write_four_messages(tmp_path / "a.bag")
    path.write_bytes(path.read_bytes()[:keep])
    with pytest.raises(BadFile, match="thbridge bag reindex"):
        info(path)


def test_a_bag_whose_chunk_is_garbled_is_refused_with_the_remedy(tmp_path: Path) -> None:
    path = write_four_messages(tmp_path / "a.bag")
    data = bytearray(path.read_bytes())
    at = data.index(b"op=\x02")
    data[at : at + 40] = b"\xff" * 40
    path.write_bytes(data)
    with pytest.raises(BadFile, match="thbridge bag reindex"):
        list(messages(path))


@pytest.mark.parametrize("content", [b"", b"hello, I am a text\n", b"\x89PNG\r\n\x1a\n" * 900])
def test_what_is_not_a_bag_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "a.bag"
    path.write_bytes(content)
    with pytest.raises(BadFile, match="not a ROS 1 bag"):
        info(path)


def test_a_bag_of_an_older_format_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    path.write_bytes(b"#ROSBAG V1.2\n" + b"\0" * 5000)
    with pytest.raises(BadFile, match="version"):
        info(path)


def test_no_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadFile, match="no such file"):
        info(tmp_path / "a.bag")
    with pytest.raises(BadFile):
        info(tmp_path)


def test_a_packed_chunk_that_is_garbled_is_refused_with_the_remedy(tmp_path: Path) -> None:
    bag = BagFile(tmp_path / "a.bag", Compression.LZ4)
    line = bag.connect("/chatter", "std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1", "string data\n", None, None)
    for second in range(50):
        bag.write(line, second, HELLO)
    bag.close()
    path = tmp_path / "a.bag"
    data = bytearray(path.read_bytes())
    at = data.index(b"hello")
    data[at] ^= 0xFF
    path.write_bytes(data)
    with pytest.raises(BadFile, match="thbridge bag reindex"):
        list(messages(path))


def peak_of_reading(path: Path, seconds: int) -> int:
    """Bytes held at most while a bag of so many seconds is read."""
    bag = BagFile(path, Compression.LZ4)
    line = bag.connect("/chatter", "std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1", "string data\n", None, None)
    for hundredth in range(100 * seconds):
        bag.write(line, hundredth * 10_000_000, b"\x10\x27\x00\x00" + bytes(10_000))
    bag.close()
    list(messages(path, ["/none"]))  # what is loaded once
    tracemalloc.start()
    assert sum(1 for _ in messages(path)) == 100 * seconds
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return peak


def test_memory_does_not_grow_with_the_bag(tmp_path: Path) -> None:
    short, long = (peak_of_reading(tmp_path / f"{seconds}.bag", seconds) for seconds in (40, 80))
    assert abs(long - short) < 500_000


def test_of_what_is_before_a_time_only_what_holds_is_read(tmp_path: Path) -> None:
    path = write_four_messages(tmp_path / "a.bag")
    read = [(connection.topic, stamp) for connection, stamp, _ in recorded(path, since_ns=10**10)]
    assert read == [("/news", 1_000_000_000)]
