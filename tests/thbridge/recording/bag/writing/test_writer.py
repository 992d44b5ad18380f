import errno
import os
import shutil
import threading
import time
import tracemalloc
from collections.abc import Callable, Iterator
from itertools import count, pairwise
from pathlib import Path

import pytest
from rosbags.rosbag1 import Reader
from rosbags.rosbag1.reader import decompressors

from tests.support.bags.drawn_team import MOUNT, SCAN_PERIOD, SESSION, arena, records, snapshots
from tests.support.bags.inline_queue import InlineQueue
from thbridge.app.session.broadcast import Broadcast
from thbridge.files.ros.definitions import Definitions
from thbridge.recording.bag.options import MCAP_COMPRESSIONS, ROS1_COMPRESSIONS, Compression, SplitLimits
from thbridge.recording.bag.reading.reader import info, messages
from thbridge.recording.bag.repair import reindex
from thbridge.recording.bag.writing import bag_file, disk
from thbridge.recording.bag.writing import chunks as bag_chunks
from thbridge.recording.bag.writing.bag_file import BagFile, ChunkFile
from thbridge.recording.bag.writing.chunks import Chunk
from thbridge.recording.bag.writing.disk import BagNotWritten
from thbridge.recording.bag.writing.worker import JobQueue, WorkerThread
from thbridge.recording.bag.writing.writer import WHOLE, BagWriter
from thbridge.recording.recordings import (
    MCAP,
    active_of,
    finished_of,
    is_folder,
    make_room,
    part_of,
    parts_of,
    unfinished_of,
)
from thbridge.ros.publisher import RosMessage, TeamPublisher, Topic

CHATTER = Topic("/chatter", "std_msgs/String")
PLAIN = Definitions(())
KINDS = ["a.bag", "a.mcap", "a"]
"""Names of recordings: a bag, an MCAP file, and a folder of rosbag2."""
FORMS = [
    *(("a.bag", each) for each in ROS1_COMPRESSIONS),
    *(("a.mcap", each) for each in MCAP_COMPRESSIONS),
    ("a", Compression.LZ4),
]


def text(tick: int, size: int = 100) -> RosMessage:
    data = b"x" * size
    return RosMessage(CHATTER, 1_000_000_000 + tick * 20_000_000, len(data).to_bytes(4, "little") + data)


def inline(_: str) -> InlineQueue:
    """No threads: what goes wrong is told at once."""
    return InlineQueue()


def recorded(
    path: Path,
    robots: int,
    ticks: int,
    clock: Callable[[], float] = lambda: 0.0,
    compression: Compression = Compression.NONE,
    splitting: SplitLimits = WHOLE,
) -> list[RosMessage]:
    publisher = TeamPublisher(robots, MOUNT, SCAN_PERIOD)
    writer = BagWriter(path, PLAIN, clock=clock, compression=compression, splitting=splitting)
    with writer:
        recorder = Broadcast(publisher, SESSION, arena(), [writer])
        for snapshot in snapshots(robots, ticks):
            recorder.record(snapshot, records(snapshot.tick))
    twin = TeamPublisher(robots, MOUNT, SCAN_PERIOD)
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
    assert b"topic=/thbridge/session" in path.read_bytes()[4117:4600]


@pytest.mark.parametrize("name", [".bag", ".mcap"])
def test_equal_sessions_give_equal_bytes_however_fast_the_wall_clock_goes(tmp_path: Path, name: str) -> None:
    slow = iter(float(second) for second in range(10_000))
    recorded(tmp_path / f"slow{name}", 2, 120, lambda: next(slow))
    recorded(tmp_path / f"fast{name}", 2, 120)
    assert (tmp_path / f"slow{name}").read_bytes() == (tmp_path / f"fast{name}").read_bytes()


@pytest.mark.parametrize("name", [".bag", ".mcap"])
@pytest.mark.parametrize("splitting", [WHOLE, SplitLimits(duration_ns=700_000_000)])
def test_ticks_are_written_as_their_messages_one_by_one(tmp_path: Path, name: str, splitting: SplitLimits) -> None:
    """Among them a tick of more than a chunk, and a list of more than one stamp."""
    latched = text(0)._replace(topic=CHATTER._replace(name="/latched", latched=True))
    in_ticks = [[latched, text(0)], [text(1, 10_000)] * 300, [text(40), text(41)], [text(90)]]
    with BagWriter(tmp_path / f"ticks{name}", PLAIN, splitting=splitting) as writer:
        for tick, said in enumerate(in_ticks):
            writer.take(tick, said)
    with BagWriter(tmp_path / f"single{name}", PLAIN, splitting=splitting) as writer:
        for said in in_ticks:
            for message in said:
                writer.write(message)
    ticks, single = (parts_of(tmp_path / name) for name in (f"ticks{name}", f"single{name}"))
    assert [part.read_bytes() for part in ticks] == [part.read_bytes() for part in single]
    assert len(list(messages(tmp_path / f"ticks{name}"))) == 305


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


def test_a_chunk_holds_no_more_than_half_a_second_and_chunks_come_in_order(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    with BagWriter(path, PLAIN) as writer:
        for tick in range(0, 500, 7):
            writer.write(text(tick))
    with Reader(path) as reader:
        chunks = list(reader.chunk_infos)
    assert all(chunk.end_time - chunk.start_time <= 500_000_001 for chunk in chunks)
    assert [chunk.start_time for chunk in chunks] == sorted(chunk.start_time for chunk in chunks)
    assert len(chunks) == 18


def test_a_chunk_ends_beyond_its_bound_and_never_within_a_stamp(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    recorded(path, 10, 150)
    with Reader(path) as reader:
        infos = list(reader.chunk_infos)
        assert all(chunk.datasize <= bag_chunks.CHUNK_BYTES + 300_000 for chunk in reader.chunks.values())
    assert len(infos) > 3
    assert all(before.end_time < after.start_time for before, after in pairwise(infos))


def test_a_stamp_of_very_much_is_several_chunks(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    with BagWriter(path, PLAIN) as writer:
        for _ in range(300):
            writer.write(text(0, 10_000))
    with Reader(path) as reader:
        assert all(chunk.datasize <= bag_chunks.MOST_BYTES + 11_000 for chunk in reader.chunks.values())


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize("failure", [RuntimeError, KeyboardInterrupt, SystemExit])
def test_whatever_ends_the_session_leaves_a_complete_bag(
    tmp_path: Path, name: str, failure: type[BaseException]
) -> None:
    path = tmp_path / name
    with pytest.raises(failure), BagWriter(path, PLAIN) as writer:
        writer.write(text(0))
        writer.write(text(1))
        raise failure
    assert info(path).messages == 2


@pytest.mark.parametrize("name", KINDS)
def test_a_bag_without_messages_is_a_bag(tmp_path: Path, name: str) -> None:
    with BagWriter(tmp_path / name, PLAIN):
        pass
    assert info(tmp_path / name).messages == 0


@pytest.mark.parametrize("name", KINDS[:2])
def test_an_existing_bag_is_not_overwritten(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_bytes(b"dear")
    with pytest.raises(BagNotWritten, match="already"):
        BagWriter(path, PLAIN)
    assert path.read_bytes() == b"dear"


@pytest.mark.parametrize("name", ["a.bag.active", "a_0.bag.active", "a.mcap.active", "a_0.mcap.active"])
def test_a_bag_cut_off_is_not_overwritten(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(b"dear")
    with pytest.raises(BagNotWritten, match=f"reindex .*{name}"):
        BagWriter(tmp_path / f"a{Path(Path(name).stem).suffix}", PLAIN)


@pytest.mark.parametrize("name", KINDS[:2])
def test_a_bag_that_appears_meanwhile_is_not_overwritten(tmp_path: Path, name: str) -> None:
    writer = BagWriter(tmp_path / name, PLAIN)
    writer.write(text(0))
    (tmp_path / name).write_bytes(b"dear")
    with pytest.raises(BagNotWritten):
        writer.close()
    assert (tmp_path / name).read_bytes() == b"dear"
    (tmp_path / name).unlink()
    (tmp_path / f"{name}.active").rename(tmp_path / name)
    assert info(tmp_path / name).messages == 1


@pytest.mark.parametrize("name", KINDS)
def test_no_folder_is_a_clear_refusal(tmp_path: Path, name: str) -> None:
    with pytest.raises(BagNotWritten, match="folder"):
        BagWriter(tmp_path / "nowhere" / name, PLAIN)


def test_messages_do_not_go_back_in_time(tmp_path: Path) -> None:
    with BagWriter(tmp_path / "a.bag", PLAIN) as writer:
        writer.write(text(5))
        with pytest.raises(ValueError, match="after"):
            writer.write(text(4))


@pytest.mark.parametrize("name", KINDS)
def test_a_closed_bag_takes_no_more(tmp_path: Path, name: str) -> None:
    writer = BagWriter(tmp_path / name, PLAIN)
    writer.close()
    writer.close()
    with pytest.raises(ValueError, match="closed"):
        writer.write(text(0))


@pytest.fixture
def room(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[int]]:
    """A disk with so many bytes of room; a negative number is a disk without end."""
    left = [-1]
    write = bag_file.ChunkFile._write

    def bounded(self: bag_file.ChunkFile, position: int, data: bytes) -> None:
        end = position + len(data)
        if 0 <= left[0] < end:
            # As a real disk does it: what fits is written, then comes the error.
            write(self, position, data[: max(0, left[0] - position)])
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        write(self, position, data)

    monkeypatch.setattr(bag_file.ChunkFile, "_write", bounded)
    yield left


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize("lane", [inline, WorkerThread])
def test_a_full_disk_is_told_and_all_before_it_is_kept(
    tmp_path: Path, name: str, room: list[int], lane: Callable[[str], JobQueue]
) -> None:
    path = tmp_path / name
    part = part_of(path, 0) if is_folder(path) else path
    writer = BagWriter(path, PLAIN, make_queue=lane)
    for tick in range(200):
        writer.write(text(tick, 1000))
    room[0] = 4117 + 200_000
    with pytest.raises(BagNotWritten, match="no space left") as raised:
        for tick in range(200, 500):
            writer.write(text(tick, 1000))
            writer.sync_if_due()
        writer.close()
    writer.close()
    assert raised.value.path in (part, active_of(path))
    room[0] = -1
    assert info(path).messages == 175  # seven chunks of half a second
    assert "last second" in str(raised.value)


@pytest.mark.parametrize("name", KINDS)
def test_a_disk_too_full_for_an_index_leaves_a_bag_to_reindex(tmp_path: Path, name: str, room: list[int]) -> None:
    path = tmp_path / name
    writer = BagWriter(path, PLAIN, make_queue=inline)
    for tick in range(151):
        writer.write(text(tick, 1000))
    room[0] = active_of(path).stat().st_size + 10
    with pytest.raises(BagNotWritten, match="reindex"):
        writer.close()
    assert not finished_of(path)
    room[0] = -1
    assert reindex(active_of(path)).messages == 150


@pytest.mark.parametrize("name", KINDS)
def test_a_full_disk_at_the_regular_sync_is_told(tmp_path: Path, name: str, room: list[int]) -> None:
    seconds = iter(range(100))
    writer = BagWriter(tmp_path / name, PLAIN, clock=lambda: float(next(seconds)), make_queue=inline)
    writer.write(text(0, 1000))
    writer.sync_if_due()
    room[0] = active_of(tmp_path / name).stat().st_size + 10
    writer.write(text(1, 1000))
    with pytest.raises(BagNotWritten, match="no space left"):
        writer.sync_if_due()


@pytest.mark.parametrize("name", KINDS)
def test_a_folder_that_vanishes_is_told(tmp_path: Path, name: str) -> None:
    folder = tmp_path / "bags"
    folder.mkdir()
    seconds = iter(range(100))
    writer = BagWriter(folder / name, PLAIN, clock=lambda: float(next(seconds)), make_queue=inline)
    writer.write(text(0))
    shutil.rmtree(folder)
    with pytest.raises(BagNotWritten, match="deleted"):
        writer.sync_if_due()
    writer.close()


@pytest.mark.parametrize(("name", "compression"), FORMS)
def test_whichever_write_fails_all_that_was_written_can_be_read(
    tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch, compression: Compression
) -> None:
    write = bag_file.ChunkFile._write
    left = 0

    def failing(self: bag_file.ChunkFile, position: int, data: bytes) -> None:
        nonlocal left
        left -= 1
        if left < 0:
            write(self, position, data[: len(data) // 2])
            raise OSError(errno.EIO, os.strerror(errno.EIO))
        write(self, position, data)

    monkeypatch.setattr(bag_file.ChunkFile, "_write", failing)
    said = [text(tick, 10 + tick) for tick in range(130)]
    twentieths = count()
    kept = 0
    for writes in range(1, 30):
        left = writes
        folder = tmp_path / str(writes)
        folder.mkdir()
        try:
            with BagWriter(
                folder / name,
                PLAIN,
                lambda: next(twentieths) / 20,
                compression,
                make_queue=inline,
            ) as writer:
                for message in said:
                    writer.write(message)
                    writer.sync_if_due()
        except BagNotWritten as failure:
            assert "input/output error" in str(failure)
        else:
            break
        left = 1000
        if failure_left := unfinished_of(folder / name):
            reindex(failure_left)
        read = [message.data for message in messages(folder / name)]
        assert read == [message.data for message in said[: len(read)]]
        assert len(read) >= kept
        kept = len(read)
    assert 5 < writes < 29


@pytest.mark.parametrize("name", KINDS)
def test_the_regular_sync_puts_every_message_on_the_disk(tmp_path: Path, name: str) -> None:
    seconds = iter(range(100))
    writer = BagWriter(tmp_path / name, PLAIN, clock=lambda: float(next(seconds)), make_queue=inline)
    writer.write(text(0))
    writer.sync_if_due()
    size = active_of(tmp_path / name).stat().st_size
    assert size > 300
    writer.write(text(1))
    writer.close()
    assert info(tmp_path / name).messages == 2


@pytest.mark.parametrize("phase", [0.1, 0.3])
@pytest.mark.parametrize("name", KINDS)
def test_all_chunks_that_a_power_failure_may_cost_are_of_the_last_second(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, phase: float
) -> None:
    """From the time at which a chunk is written until the next sync, a power failure may damage it."""
    now, at_risk, oldest = 0.0, list[int](), list[float]()

    def look() -> None:
        oldest.append(now - phase + 1.0 - min(at_risk, default=10**12) / 1e9)

    def risky(write: Callable[[ChunkFile, Chunk], None]) -> Callable[[ChunkFile, Chunk], None]:
        def watched(file: ChunkFile, chunk: Chunk) -> None:
            at_risk.append(chunk.start_ns)
            look()
            write(file, chunk)

        return watched

    def sync(file: ChunkFile) -> None:
        at_risk.clear()

    monkeypatch.setattr(ChunkFile, "append", risky(ChunkFile.append))
    monkeypatch.setattr(ChunkFile, "preview", risky(ChunkFile.preview))
    monkeypatch.setattr(ChunkFile, "sync", sync)
    with BagWriter(tmp_path / name, PLAIN, clock=lambda: now, make_queue=inline) as writer:
        for tick in range(300):
            now = phase + tick * 0.02
            writer.write(text(tick))
            look()
            writer.sync_if_due()
    assert 0.1 < max(oldest) < 0.75


def test_memory_does_not_keep_what_was_written(tmp_path: Path) -> None:
    with BagWriter(tmp_path / "a.bag", PLAIN, make_queue=inline) as writer:
        tracemalloc.start()
        for tick in range(500):
            writer.write(text(tick, 10_000))
        held, _ = tracemalloc.get_traced_memory()
        tracemalloc.stop()
    assert held < 1_000_000


class Stalled(WorkerThread):
    """A disk that answers nothing until it is let go."""

    def __init__(self, name: str, gate: threading.Event, clock: Callable[[], float]) -> None:
        super().__init__(name, clock)
        if name == "bag writer":
            self.submit(lambda: bool(gate.wait(30)) or None)


def test_a_disk_that_is_too_slow_ends_the_recording_with_everything_in_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    gate, now = threading.Event(), [0.0]
    path = tmp_path / "a.bag"
    writer = BagWriter(path, PLAIN, clock=lambda: now[0], make_queue=lambda name: Stalled(name, gate, lambda: now[0]))
    for tick in range(120):
        writer.write(text(tick))
        writer.sync_if_due()
    now[0] = 11.0
    threading.Timer(0.05, gate.set).start()
    with pytest.raises(BagNotWritten, match="too slow: it was 11 s behind"):
        writer.sync_if_due()
    assert info(path).messages == 120


def test_a_disk_that_does_not_answer_leaves_the_file_to_be_mended(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(disk, "CLOSE_SECONDS", 0.05)
    gate = threading.Event()
    writer = BagWriter(tmp_path / "a.bag", PLAIN, make_queue=lambda name: Stalled(name, gate, time.monotonic))
    writer.write(text(0))
    with pytest.raises(BagNotWritten, match=r"has not responded.*reindex"):
        writer.close()
    gate.set()


@pytest.mark.parametrize("compression", [Compression.LZ4, Compression.BZ2])
def test_packed_bags_hold_the_same_in_less_room(tmp_path: Path, compression: Compression) -> None:
    recorded(tmp_path / "plain.bag", 2, 120)
    recorded(tmp_path / "packed.bag", 2, 120, compression=compression)
    assert list(messages(tmp_path / "packed.bag")) == list(messages(tmp_path / "plain.bag"))
    assert (tmp_path / "packed.bag").stat().st_size < 0.6 * (tmp_path / "plain.bag").stat().st_size
    with Reader(tmp_path / "packed.bag") as reader:
        assert {chunk.decompressor for chunk in reader.chunks.values()} == {decompressors[compression]}


SPLITTINGS = [SplitLimits(size=40_000), SplitLimits(duration_ns=700_000_000), SplitLimits(30_000, 1_500_000_000)]


@pytest.mark.parametrize(
    ("name", "compression", "splitting"), [(*form, SPLITTINGS[number % 3]) for number, form in enumerate(FORMS)]
)
def test_parts_read_as_one_are_the_whole(
    tmp_path: Path, name: str, compression: Compression, splitting: SplitLimits
) -> None:
    whole = tmp_path / f"whole{Path(name).suffix}"
    recorded(whole, 2, 100)
    recorded(tmp_path / name, 2, 100, compression=compression, splitting=splitting)
    parts = parts_of(tmp_path / name)
    assert [path.name for path in parts] == [f"a_{number}{Path(name).suffix or MCAP}" for number in range(len(parts))]
    assert not list(tmp_path.rglob("*.active"))
    assert len(parts) > 1
    assert list(messages(tmp_path / name)) == list(messages(whole))
    assert list(messages(tmp_path / name, {"/map", "/tf"})) == list(messages(whole, {"/map", "/tf"}))


@pytest.mark.parametrize("splitting", SPLITTINGS)
def test_each_part_stands_alone(tmp_path: Path, splitting: SplitLimits) -> None:
    said = {message.topic.name: message for message in recorded(tmp_path / "a.bag", 2, 200, splitting=splitting)}
    for part in parts_of(tmp_path / "a.bag"):
        assert b"topic=/thbridge/session" in part.read_bytes()[4117:4600]
        told = info(part)
        first = {m.topic: m for m in reversed(list(messages(part))) if m.stamp_ns == told.start_ns}
        for topic in ("/thbridge/session", "/tf_static", "/map", "/map_metadata"):
            assert first[topic].data == said[topic].data
        assert all(topic.latched == said[topic.name].topic.latched for topic in told.topics)
        if splitting.duration_ns:
            assert told.duration * 1e9 < splitting.duration_ns
        if splitting.size:
            assert told.size < splitting.size + 280_000 + 60_000 + 60_000  # a chunk, the index, what it begins with


def test_parts_smaller_than_what_they_begin_with_still_take_more_than_a_chunk(tmp_path: Path) -> None:
    map_topic = Topic("/map", "std_msgs/String", latched=True)
    with BagWriter(tmp_path / "a.bag", PLAIN, splitting=SplitLimits(size=800_000), make_queue=inline) as writer:
        writer.write(text(0, 1_600_000)._replace(topic=map_topic))
        for tick in range(1, 196):
            writer.write(text(tick, 20_000))
    assert [info(part).messages > 40 for part in parts_of(tmp_path / "a.bag")] == [False, True, True, True, True]


def test_a_new_part_begins_at_multiples_of_the_duration(tmp_path: Path) -> None:
    recorded(tmp_path / "a.bag", 1, 200, splitting=SplitLimits(duration_ns=1_500_000_000))
    starts = [info(part).start_ns for part in parts_of(tmp_path / "a.bag")]
    assert starts == [1_000_000_000, 2_500_000_000, 4_000_000_000]


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize("splitting", SPLITTINGS)
def test_parts_do_not_depend_on_the_wall_clock(tmp_path: Path, name: str, splitting: SplitLimits) -> None:
    slow = iter(float(second) for second in range(10_000))
    for folder, clock in (("slow", lambda: next(slow)), ("fast", lambda: 0.0)):
        (tmp_path / folder).mkdir()
        recorded(tmp_path / folder / name, 2, 120, clock, Compression.LZ4, splitting)
    fast, slowly = (
        sorted(path for path in (tmp_path / folder).rglob("*") if path.is_file()) for folder in ("fast", "slow")
    )
    assert [(path.name, path.read_bytes()) for path in fast] == [(path.name, path.read_bytes()) for path in slowly]


def test_a_folder_that_vanishes_between_parts_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    writer = BagWriter(tmp_path / "a.bag", PLAIN, splitting=SplitLimits(size=1000), make_queue=inline)
    for tick in range(40):
        writer.write(text(tick, 1000))
    (tmp_path / "a_1.bag.active").mkdir()
    with pytest.raises(BagNotWritten, match="file exists"):
        for tick in range(40, 200):
            writer.write(text(tick, 1000))
    assert info(tmp_path / "a_0.bag").messages == 25


def test_an_older_split_recording_is_not_mixed_in(tmp_path: Path) -> None:
    recorded(tmp_path / "a.bag", 1, 100, splitting=SplitLimits(duration_ns=1_000_000_000))
    with pytest.raises(BagNotWritten, match="already"):
        BagWriter(tmp_path / "a.bag", PLAIN)
    assert make_room(tmp_path / "a.bag") == tmp_path / "a-1.bag"
    assert sorted(path.name for path in tmp_path.glob("[!.]*")) == ["a-1_0.bag", "a-1_1.bag"]
    assert info(tmp_path / "a-1.bag").start_ns == 1_000_000_000


def test_no_file_has_a_bags_name_before_it_is_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[tuple[str, bytes]] = []
    rename = Path.rename

    def watched(path: Path, target: Path) -> Path:
        seen.extend((file.name, file.read_bytes()) for file in tmp_path.iterdir())
        return rename(path, target)

    monkeypatch.setattr(Path, "rename", watched)
    BagFile(tmp_path / "a.bag").close()
    (name, content), *_ = seen
    assert name == "a.bag.new"
    assert content.startswith(b"#ROSBAG V2.0\n")
    assert [file.name for file in tmp_path.iterdir()] == ["a.bag"]
