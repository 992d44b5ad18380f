from collections.abc import Generator, Sequence
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.files.errors import BadFile
from thbridge.recording.bag.options import ROS1_COMPRESSIONS, Compression
from thbridge.recording.bag.reading import reader as bag_reader
from thbridge.recording.bag.reading.chunk_reader import WHOLE
from thbridge.recording.bag.reading.index import BagIndex, open_index
from thbridge.recording.bag.reading.reader import RawMessage
from thbridge.recording.bag.reading.scan import MessageRecord, scan
from thbridge.recording.bag.records import BagConnection
from thbridge.recording.bag.writing.bag_file import BagFile, ChunkFile
from thbridge.recording.bag.writing.chunks import ChunkBuilder
from thbridge.ros.messages import types
from thbridge.ros.messages.pack.fields import string

DEFINITION = types.plain_definition(types.STRING)
Spoken = tuple[int, int]
"""Number of the publisher, and when."""


def opened(path: Path) -> BagIndex:
    work: Generator[float, None, BagIndex] = open_index(path)
    while True:
        try:
            share = next(work)
        except StopIteration as done:
            index = done.value
            assert isinstance(index, BagIndex)
            return index
        assert 0.0 <= share <= 1.0


def connections() -> list[BagConnection]:
    """Two topics; the second has two publishers."""
    topics = ("/a", "/b", "/b")
    return [
        BagConnection(number, topic, types.STRING, DEFINITION.md5, DEFINITION.text, f"/node{number}", False)
        for number, topic in enumerate(topics)
    ]


def write(path: Path, chunks: Sequence[Sequence[Spoken]], compression: Compression = Compression.NONE) -> None:
    """A bag of these chunks; each message says its own number."""
    path.unlink(missing_ok=True)
    known, file, number = connections(), ChunkFile(path, compression), 0
    for spoken in chunks:
        gathered = ChunkBuilder()
        for who, stamp in spoken:
            gathered.add(known[who], stamp, string(str(number)))
            number += 1
        if gathered.size:
            file.append(gathered.take())
    file.finish()
    file.close()


def told(message: RawMessage) -> tuple[str, int, bytes]:
    return message.topic, message.stamp_ns, message.data


def in_order_of_time(path: Path) -> list[tuple[str, int, bytes]]:
    """All messages as they stand in the file, sorted; without its index."""
    topics = [connection.topic for connection in connections()]
    records = [record for record in scan(path) if isinstance(record, MessageRecord)]
    in_order = sorted(records, key=lambda record: record.stamp_ns)
    return [(topics[record.number], record.stamp_ns, record.data) for record in in_order]


STAMPS = st.integers(0, 30)
CHUNKS = st.lists(st.lists(st.tuples(st.integers(0, 2), STAMPS), max_size=12), max_size=6)


class TestAnyBag:
    """Chunks overlap, stamps go back, several publishers speak at once: as merged and filtered bags have it."""

    @given(chunks=CHUNKS, at=STAMPS, until=STAMPS)
    def test_it_finds_what_reading_all_of_it_would(
        self, tmp_path_factory: pytest.TempPathFactory, chunks: list[list[Spoken]], at: int, until: int
    ) -> None:
        path = tmp_path_factory.mktemp("any") / "a.bag"
        write(path, chunks)
        index = opened(path)
        read = list(bag_reader.messages(path))
        assert [told(message) for message in read] == in_order_of_time(path)
        assert [told(message) for message in bag_reader.messages(path, ["/b"])] == [
            message for message in in_order_of_time(path) if message[0] == "/b"
        ]
        walked = [index.read(place) for places in index.walk(["/a", "/b"]) for place in places]
        assert [told(message) for message in walked] == [told(message) for message in read]
        for topic in ("/a", "/b"):
            of_topic = [message for message in read if message.topic == topic]
            last, after = index.last(topic, at), index.next(topic, at)
            before = [message for message in of_topic if message.stamp_ns <= at]
            later = [message for message in of_topic if message.stamp_ns > at]
            assert (None if last is None else told(index.read(last))) == (told(before[-1]) if before else None)
            assert (None if after is None else told(index.read(after))) == (told(later[0]) if later else None)
            back = [
                index.read(place)
                for chunk in index.chunks_back(topic, at, until)
                for place in index.locations(topic, chunk)
                if until <= place.stamp_ns <= at
            ]
            expected = [message for message in of_topic if until <= message.stamp_ns <= at]
            assert sorted(map(told, back)) == sorted(map(told, expected))
        index.close()


@pytest.mark.parametrize("compression", ROS1_COMPRESSIONS)
def test_packed_chunks_are_unpacked(tmp_path: Path, compression: Compression) -> None:
    path = tmp_path / "a.bag"
    write(path, [[(0, 1), (1, 2)], [(0, 3)]], compression)
    index = opened(path)
    assert (index.start_ns, index.end_ns) == (1, 3)
    place = index.last("/a", 2)
    assert place is not None
    assert told(index.read(place)) == ("/a", 1, string("0"))


def test_large_chunks_are_not_read_whole_for_one_message(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    picture = "x" * (2 * WHOLE)
    known, file, gathered = connections(), ChunkFile(path), ChunkBuilder()
    for stamp, text in ((1, "before"), (2, picture), (3, "after")):
        gathered.add(known[0], stamp, string(text))
    file.append(gathered.take())
    file.finish()
    file.close()
    index = opened(path)
    said = [index.read(place) for places in index.walk(["/a"]) for place in places]
    assert [message.data for message in said] == [string(text) for text in ("before", picture, "after")]


def test_an_empty_bag_has_nothing_and_no_time(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    BagFile(path).close()
    index = opened(path)
    assert (index.start_ns, index.end_ns, index.publishers, index.chunks) == (0, 0, (), 0)
    assert index.last("/a", 5) is None
    assert list(index.walk(["/a"])) == []


def test_a_bag_that_is_being_written_says_so_and_what_to_do(tmp_path: Path) -> None:
    path = tmp_path / "a.bag.active"
    file = ChunkFile(path)
    file.close()
    for named in (path, tmp_path / "a.bag"):
        with pytest.raises(BadFile, match=r"still being written.*bag reindex .*a\.bag\.active"):
            opened(named)


def test_a_bag_without_index_says_what_to_do(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    ChunkFile(path).close()
    with pytest.raises(BadFile, match=r"index is missing.*thbridge bag reindex"):
        opened(path)


def test_every_cut_is_told_as_damage(tmp_path: Path) -> None:
    whole = tmp_path / "whole.bag"
    write(whole, [[(0, 1), (1, 2)], [(0, 3), (2, 4)]])
    data = whole.read_bytes()
    cut = tmp_path / "cut.bag"
    for length in range(13, len(data), 97):
        cut.write_bytes(data[:length])
        with pytest.raises(BadFile, match="reindex"):
            opened(cut)


def test_damage_within_a_chunk_is_told_when_it_is_read(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    write(path, [[(0, 1), (1, 2)]], Compression.LZ4)
    data = bytearray(path.read_bytes())
    at = data.index(bytes.fromhex("04224d18"))  # the magic number of LZ4
    data[at : at + 4] = b"\x00" * 4
    path.write_bytes(bytes(data))
    index = opened(path)
    place = index.last("/a", 2)
    assert place is not None
    with pytest.raises(BadFile, match="damaged"):
        index.read(place)


def test_places_are_in_order_of_time(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    write(path, [[(0, 5), (0, 1)], [(0, 3), (1, 3)]])
    places = [place for places in opened(path).walk(["/a", "/b"]) for place in places]
    assert all(one < other for one, other in pairwise(places))
