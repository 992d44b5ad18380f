import errno
import os
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from rosbags.rosbag1 import Reader

from tests.thbridge.ros.drive import MOUNT, SCAN_PERIOD, SESSION, arena, records, snapshots
from thbridge.adapters import bag_file
from thbridge.adapters.bag_reader import info, messages
from thbridge.adapters.bag_writer import BagNotWritten, BagWriter, Recorder
from thbridge.adapters.ros_definitions import Definitions
from thbridge.ros.publisher import Message, Publisher, Topic

CHATTER = Topic("/chatter", "std_msgs/String")
PLAIN = Definitions(())


def text(tick: int, size: int = 100) -> Message:
    data = b"x" * size
    return Message(CHATTER, 1_000_000_000 + tick * 20_000_000, len(data).to_bytes(4, "little") + data)


def recorded(path: Path, robots: int, ticks: int, clock: Callable[[], float] = lambda: 0.0) -> list[Message]:
    publisher = Publisher(robots, MOUNT, SCAN_PERIOD)
    with Recorder(BagWriter(path, PLAIN, clock=clock), publisher, SESSION, arena()) as recorder:
        for snapshot in snapshots(robots, ticks):
            recorder.record(snapshot, records(snapshot.tick))
    twin = Publisher(robots, MOUNT, SCAN_PERIOD)
    said = twin.opening(0, SESSION, arena())
    for snapshot in snapshots(robots, ticks):
        said += twin.tick(snapshot, records(snapshot.tick))
    return said


def test_what_was_said_is_in_the_bag_in_its_order(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    said = recorded(path, 2, 120)
    read = list(messages(path))
    # Within one stamp a reader may order topics as it likes.
    key = lambda item: (item[0], item[1])  # noqa: E731
    assert sorted(((m.stamp_ns, m.topic, m.data) for m in read), key=key) == sorted(
        ((m.stamp_ns, m.topic.name, m.data) for m in said), key=key
    )
    assert not (tmp_path / "a.bag.active").exists()


def test_the_first_record_is_the_session(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    recorded(path, 1, 1)
    assert b"topic=/thbridge/session" in path.read_bytes()[4117:4300]


def test_equal_sessions_give_equal_bytes_however_fast_the_wall_clock_goes(tmp_path: Path) -> None:
    slow = iter(float(second) for second in range(10_000))
    recorded(tmp_path / "slow.bag", 2, 120, lambda: next(slow))
    recorded(tmp_path / "fast.bag", 2, 120)
    assert (tmp_path / "slow.bag").read_bytes() == (tmp_path / "fast.bag").read_bytes()


def test_the_first_record_is_padded_as_ros_pads_it(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    recorded(path, 1, 1)
    data = path.read_bytes()
    header = int.from_bytes(data[13:17], "little")
    padding = int.from_bytes(data[17 + header : 21 + header], "little")
    assert 4 + header + 4 + padding == 4104
    assert b"op=\x05" in data[13 + 4104 : 13 + 4104 + 16]


def test_latching_is_the_integer_one_and_one_node_publishes(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    recorded(path, 1, 5)
    with Reader(path) as reader:
        said = {c.topic: (c.ext.callerid, c.ext.latching) for c in reader.connections}
    assert said["/map"] == ("/thbridge", 1)
    assert said["/tf"] == ("/thbridge", 0)


def test_a_chunk_holds_no_more_than_a_second_and_chunks_come_in_order(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    with BagWriter(path, PLAIN) as writer:
        for tick in range(0, 500, 7):
            writer.write(text(tick))
    with Reader(path) as reader:
        chunks = list(reader.chunk_infos)
    assert all(chunk.end_time - chunk.start_time <= 1_000_000_001 for chunk in chunks)
    assert [chunk.start_time for chunk in chunks] == sorted(chunk.start_time for chunk in chunks)
    assert len(chunks) == 9


def test_a_chunk_is_not_much_larger_than_its_bound(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    with BagWriter(path, PLAIN) as writer:
        for _ in range(100):
            writer.write(text(0, 10_000))
    with Reader(path) as reader:
        assert all(chunk.datasize <= bag_file.CHUNK_BYTES + 10_100 for chunk in reader.chunks.values())


@pytest.mark.parametrize("failure", [RuntimeError, KeyboardInterrupt, SystemExit])
def test_whatever_ends_the_session_leaves_a_complete_bag(tmp_path: Path, failure: type[BaseException]) -> None:
    path = tmp_path / "a.bag"
    with pytest.raises(failure), BagWriter(path, PLAIN) as writer:
        writer.write(text(0))
        writer.write(text(1))
        raise failure
    assert info(path).messages == 2


def test_a_bag_without_messages_is_a_bag(tmp_path: Path) -> None:
    with BagWriter(tmp_path / "a.bag", PLAIN):
        pass
    assert info(tmp_path / "a.bag").messages == 0


def test_an_existing_bag_is_not_overwritten_unless_told(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    path.write_bytes(b"dear")
    with pytest.raises(BagNotWritten, match="already"):
        BagWriter(path, PLAIN)
    assert path.read_bytes() == b"dear"
    with BagWriter(path, PLAIN, overwrite=True) as writer:
        writer.write(text(0))
        assert path.read_bytes() == b"dear"
    assert info(path).messages == 1


def test_a_bag_cut_off_is_not_overwritten_unless_told(tmp_path: Path) -> None:
    active = tmp_path / "a.bag.active"
    active.write_bytes(b"dear")
    with pytest.raises(BagNotWritten, match="reindex"):
        BagWriter(tmp_path / "a.bag", PLAIN)
    BagWriter(tmp_path / "a.bag", PLAIN, overwrite=True).close()
    assert not active.exists()


def test_a_bag_that_appears_meanwhile_is_not_overwritten(tmp_path: Path) -> None:
    writer = BagWriter(tmp_path / "a.bag", PLAIN)
    writer.write(text(0))
    (tmp_path / "a.bag").write_bytes(b"dear")
    with pytest.raises(BagNotWritten):
        writer.close()
    assert (tmp_path / "a.bag").read_bytes() == b"dear"
    (tmp_path / "a.bag").unlink()
    (tmp_path / "a.bag.active").rename(tmp_path / "a.bag")
    assert info(tmp_path / "a.bag").messages == 1


def test_no_folder_is_a_clear_refusal(tmp_path: Path) -> None:
    with pytest.raises(BagNotWritten, match="folder"):
        BagWriter(tmp_path / "nowhere" / "a.bag", PLAIN)


def test_messages_do_not_go_back_in_time(tmp_path: Path) -> None:
    with BagWriter(tmp_path / "a.bag", PLAIN) as writer:
        writer.write(text(5))
        with pytest.raises(ValueError, match="after"):
            writer.write(text(4))


def test_a_closed_bag_takes_no_more(tmp_path: Path) -> None:
    writer = BagWriter(tmp_path / "a.bag", PLAIN)
    writer.close()
    writer.close()
    with pytest.raises(ValueError, match="closed"):
        writer.write(text(0))


@pytest.fixture
def room(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[int]]:
    """A disk with so many bytes of room; a negative number is a disk without end."""
    left = [-1]
    put = bag_file._Disk.put

    def bounded(self: bag_file._Disk, position: int, data: bytes | memoryview) -> None:
        end = position + len(data)
        if 0 <= left[0] < end:
            # As a real disk does it: what fits is written, then comes the error.
            fits = bytes(data)[: max(0, left[0] - position)]
            put(self, position, fits)
            self._file.truncate(self._committed)
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        put(self, position, data)

    monkeypatch.setattr(bag_file._Disk, "put", bounded)
    yield left


def test_a_full_disk_is_told_and_all_before_it_is_kept(tmp_path: Path, room: list[int]) -> None:
    path = tmp_path / "a.bag"
    writer = BagWriter(path, PLAIN)
    for tick in range(200):
        writer.write(text(tick, 1000))
    room[0] = 4117 + 170_000
    with pytest.raises(BagNotWritten, match="no space left") as raised:
        for tick in range(200, 500):
            writer.write(text(tick, 1000))
    writer.close()
    assert raised.value.path in (path, tmp_path / "a.bag.active")
    room[0] = -1
    assert info(path).messages == 150  # three chunks of a second
    assert "last second" in str(raised.value)


def test_a_disk_too_full_for_an_index_leaves_a_bag_to_reindex(tmp_path: Path, room: list[int]) -> None:
    path = tmp_path / "a.bag"
    writer = BagWriter(path, PLAIN)
    for tick in range(151):
        writer.write(text(tick, 1000))
    room[0] = (tmp_path / "a.bag.active").stat().st_size + 10
    with pytest.raises(BagNotWritten, match="reindex"):
        writer.close()
    assert not path.exists()


def test_a_full_disk_at_the_regular_sync_is_told(tmp_path: Path, room: list[int]) -> None:
    seconds = iter(range(100))
    writer = BagWriter(tmp_path / "a.bag", PLAIN, clock=lambda: float(next(seconds)))
    writer.write(text(0, 1000))
    writer.sync_if_due()
    room[0] = (tmp_path / "a.bag.active").stat().st_size + 10
    writer.write(text(1, 1000))
    with pytest.raises(BagNotWritten, match="no space left"):
        writer.sync_if_due()


def test_a_folder_that_vanishes_is_told(tmp_path: Path) -> None:
    folder = tmp_path / "bags"
    folder.mkdir()
    seconds = iter(range(100))
    writer = BagWriter(folder / "a.bag", PLAIN, clock=lambda: float(next(seconds)))
    writer.write(text(0))
    (folder / "a.bag.active").unlink()
    folder.rmdir()
    with pytest.raises(BagNotWritten, match="deleted"):
        writer.sync_if_due()
    writer.close()


def test_the_regular_sync_puts_every_message_on_the_disk(tmp_path: Path) -> None:
    seconds = iter(range(100))
    writer = BagWriter(tmp_path / "a.bag", PLAIN, clock=lambda: float(next(seconds)))
    writer.write(text(0))
    writer.sync_if_due()
    size = (tmp_path / "a.bag.active").stat().st_size
    assert size > 4117 + 100
    writer.write(text(1))
    writer.close()
    assert info(tmp_path / "a.bag").messages == 2


def test_memory_does_not_keep_what_was_written(tmp_path: Path) -> None:
    with BagWriter(tmp_path / "a.bag", PLAIN) as writer:
        for tick in range(500):
            writer.write(text(tick))
        assert len(writer._file.chunks) == 1
