from pathlib import Path

import pytest

from sim.common.geometry import IDENTITY
from tests.support.bags.bags_with_faults import (
    SCAN_LINE,
    START,
    STATIC_LINE,
    STEP,
    Entry,
    clean,
    scan_message,
    tf,
    write,
)
from tests.support.bags.foreign_bags import transform
from thbridge.analysis.check import judge
from thbridge.analysis.cut import CutRange, cut
from thbridge.files.errors import BadFile
from thbridge.recording.bag.options import ROS1_COMPRESSIONS, Compression
from thbridge.recording.bag.reading.reader import info, recorded
from thbridge.recording.bag.reading.scan import ChunkRecord, ConnectionRecord, scan


@pytest.fixture
def bag(tmp_path: Path) -> Path:
    return write(tmp_path / "a.bag", clean())


def test_a_piece_has_what_lies_between_and_what_was_latched_before(tmp_path: Path, bag: Path) -> None:
    done = cut(bag, CutRange(1.0, 1.5), tmp_path / "b.bag")
    said = [(publisher.topic, stamp, data) for publisher, stamp, data in recorded(done.path)]
    whole = [(publisher.topic, stamp, data) for publisher, stamp, data in recorded(bag)]
    start = START + 10 * STEP
    carried = [(topic, start, data) for topic, _, data in whole if topic in ("/map", "/tf_static")]
    between = [message for message in whole if start <= message[1] <= START + 15 * STEP]
    assert said == carried + between
    assert (done.messages, done.latched, done.start_ns, done.end_ns) == (20, 2, start, START + 15 * STEP)


def test_of_what_was_latched_the_last_is_kept(tmp_path: Path) -> None:
    planted = clean()
    later = tf(transform(START, "base_link", "laser", IDENTITY))
    planted.entries.insert(40, Entry(STATIC_LINE, planted.entries[40].ns, later))
    done = cut(write(tmp_path / "a.bag", planted), CutRange(2.0), tmp_path / "b.bag")
    (kept,) = [data for publisher, _, data in recorded(done.path) if publisher.topic == "/tf_static"]
    assert kept == planted.entries[40].bytes()


def test_publishers_stay_as_they_were(tmp_path: Path, bag: Path) -> None:
    done = cut(bag, CutRange(1.0), tmp_path / "b.bag")
    before = {record.topic: record for record in scan(bag) if isinstance(record, ConnectionRecord)}
    after = {record.topic: record for record in scan(done.path) if isinstance(record, ConnectionRecord)}
    for topic, source in before.items():
        kept = after[topic]
        assert (kept.msgtype, kept.md5, kept.definition, kept.caller, kept.latching) == (
            (source.msgtype, source.md5, source.definition, source.caller, source.latching)
        )


def test_a_piece_is_clean_to_the_judge(tmp_path: Path, bag: Path) -> None:
    done = cut(bag, CutRange(0.5, 2.0), tmp_path / "b.bag")
    assert judge(scan(done.path)).findings == ()


def test_only_some_topics(tmp_path: Path, bag: Path) -> None:
    done = cut(bag, CutRange(topics=("/scan", "/map")), tmp_path / "b.bag")
    assert {topic.name for topic in info(done.path).topics} == {"/scan", "/map"}


@pytest.mark.parametrize("compression", ROS1_COMPRESSIONS)
def test_a_piece_is_packed_as_its_recording(tmp_path: Path, bag: Path, compression: Compression) -> None:
    packed = cut(bag, CutRange(compression=compression), tmp_path / "packed.bag").path
    done = cut(packed, CutRange(0.5), tmp_path / "b.bag")
    assert {record.compression for record in scan(done.path) if isinstance(record, ChunkRecord)} == {compression}


@pytest.mark.parametrize("compression", ROS1_COMPRESSIONS)
def test_compression(tmp_path: Path, bag: Path, compression: Compression) -> None:
    done = cut(bag, CutRange(compression=compression), tmp_path / "b.bag")
    assert {record.compression for record in scan(done.path) if isinstance(record, ChunkRecord)} == {compression}
    assert [data for _, _, data in recorded(done.path)] == [data for _, _, data in recorded(bag)]


def test_what_was_out_of_order_is_sorted(tmp_path: Path) -> None:
    bag = write(tmp_path / "a.bag", clean(), reverse_chunks=True, padded_to=4088)
    done = cut(bag, CutRange(), tmp_path / "b.bag")
    assert judge(scan(done.path)).findings == ()


def test_parts_become_one(tmp_path: Path) -> None:
    planted = clean()
    first, second = clean(), clean()
    first.entries = planted.entries[:50]
    # A part begins with what is latched, so that it can be played by itself.
    second.entries = [
        Entry(entry.line, planted.entries[50].ns, data=entry.bytes()) for entry in planted.entries[:2]
    ] + planted.entries[50:]
    write(tmp_path / "a_0.bag", first)
    write(tmp_path / "a_1.bag", second)
    whole = write(tmp_path / "whole.bag", planted)
    done = cut(tmp_path / "a.bag", CutRange(), tmp_path / "b.bag")
    assert [data for _, _, data in recorded(done.path)] == [data for _, _, data in recorded(whole)]


def test_the_end_before_the_first_message_of_the_rest(tmp_path: Path) -> None:
    planted = clean()
    planted.entries.append(Entry(SCAN_LINE, START + 100 * STEP, scan_message(START + 100 * STEP)))
    bag = write(tmp_path / "a.bag", planted)
    done = cut(bag, CutRange(5.0, 6.0), tmp_path / "b.bag")
    assert (done.messages, done.latched) == (2, 2)


@pytest.mark.parametrize(
    ("piece", "why"),
    [
        (CutRange(2.0, 1.0), "not before"),
        (CutRange(50.0), "after the end"),
        (CutRange(topics=("/nothing",)), "no topic /nothing"),
        (CutRange(5.0, 6.0, ("/odom",)), "after the end"),
    ],
)
def test_refusals(tmp_path: Path, bag: Path, piece: CutRange, why: str) -> None:
    with pytest.raises(BadFile, match=why):
        cut(bag, piece, tmp_path / "b.bag")
    assert not (tmp_path / "b.bag").exists()


def test_nothing_is_overwritten_unasked(tmp_path: Path, bag: Path) -> None:
    out = tmp_path / "b.bag"
    out.write_text("mine")
    with pytest.raises(BadFile, match="--overwrite"):
        cut(bag, CutRange(), out)
    assert out.read_text() == "mine"
    cut(bag, CutRange(), out, overwrite=True)
    assert info(out).messages == 92
    with pytest.raises(BadFile, match="the recording itself"):
        cut(bag, CutRange(), bag, overwrite=True)


def test_a_damaged_bag_leaves_nothing_behind(tmp_path: Path, bag: Path) -> None:
    data = bytearray(bag.read_bytes())
    at = data.rindex(b"op=\x02")
    data[at : at + 40] = b"\xff" * 40
    bag.write_bytes(data)
    with pytest.raises(BadFile, match="reindex"):
        cut(bag, CutRange(), tmp_path / "b.bag")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.bag"]


def test_a_folder_that_is_not_there(tmp_path: Path, bag: Path) -> None:
    with pytest.raises(BadFile, match="cannot be written"):
        cut(bag, CutRange(), tmp_path / "no" / "b.bag")
