"""Random access to the messages of a recording by topic and time.

Opening reads only the chunk info records at the end of each file. The index of a chunk is read when it is needed, and
kept in a limited cache. So unused messages cost neither time nor memory.
"""

from bisect import bisect_right
from collections import OrderedDict
from collections.abc import Collection, Generator, Iterable, Iterator
from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path
from typing import BinaryIO, NamedTuple

import numpy as np
from numpy.typing import NDArray

from thbridge.recording.bag.damage import check_is_bag, damage_as_bad_file
from thbridge.recording.bag.reading.chunk_reader import ChunkInfo, ChunkReader, entries_in
from thbridge.recording.bag.reading.file_end import FileEnd, read_end
from thbridge.recording.bag.reading.reader import RawMessage
from thbridge.recording.bag.ros2 import as_ros1
from thbridge.recording.recordings import parts_of
from thbridge.ros.messages.identification import identified

CHUNKS_KEPT = 2048
"""Number of chunks whose index is cached."""


@dataclass(frozen=True, slots=True)
class IndexedConnection:
    """One connection in one file: a publisher of a topic.

    Attributes:
        file: index of the file among the recording's parts.
        number: number of the connection in the file.
        topic: name of the topic.
        msgtype: for example "nav_msgs/Odometry".
        md5: md5 sum of the type.
        definition: definition of the type and of the types in it.
    """

    file: int
    number: int
    topic: str
    msgtype: str
    md5: str
    definition: str


class MessageLocation(NamedTuple):
    """Location of a message. Locations are ordered by time, and by the order of recording if times are equal.

    Attributes:
        stamp_ns: stamp of recording.
        file: index of the file.
        position: offset of the message's chunk in the file.
        offset: offset of the message's record in the unpacked chunk.
        chunk: index of the chunk in `BagIndex`.
        publisher: connection of the message.
    """

    stamp_ns: int
    file: int
    position: int
    offset: int
    chunk: int
    publisher: IndexedConnection


@dataclass(frozen=True, slots=True, eq=False)
class _TopicChunks:
    """The chunks with messages of one topic: indices, first stamps, and running maximum of the last stamps."""

    chunks: list[int]
    starts: list[int]
    reach: list[int]

    @classmethod
    def of(cls, chunks: list[int], all_chunks: list[ChunkInfo]) -> "_TopicChunks":
        ends = accumulate((all_chunks[chunk].end_ns for chunk in chunks), max)
        return cls(chunks, [all_chunks[chunk].start_ns for chunk in chunks], list(ends))


@dataclass(frozen=True, slots=True, eq=False)
class _Entries:
    """Messages of one connection in one chunk: (n,) stamps, ascending, and (n,) offsets in the unpacked chunk."""

    publisher: IndexedConnection
    stamps_ns: NDArray[np.int64]
    offsets: NDArray[np.int64]

    @classmethod
    def of(cls, publisher: IndexedConnection, data: bytes) -> "_Entries":
        """Return the entries in the data of an index data record."""
        stamps, offsets = entries_in(data)
        if (np.diff(stamps) <= 0).any():
            order = np.lexsort((offsets, stamps))
            stamps, offsets = stamps[order], offsets[order]
        return cls(publisher, stamps, offsets)


class BagIndex:
    """A recording that was opened by `open_index`, for use by one thread.

    All methods that find or read messages raise BadFile if the file is damaged or lost.

    Attributes:
        path: the path as given.
        start_ns: stamp of the first message; 0 if there are no messages.
        end_ns: stamp of the last message.
    """

    def __init__(
        self,
        path: Path,
        parts: tuple[Path, ...],
        files: list[BinaryIO],
        publishers: list[IndexedConnection],
        chunks: list[ChunkInfo],
    ) -> None:
        self.path = path
        self._parts, self._reader = parts, ChunkReader(parts, files)
        self._publishers = {(each.file, each.number): each for each in publishers}
        self._of_topic: dict[str, set[tuple[int, int]]] = {}
        for each in publishers:
            self._of_topic.setdefault(each.topic, set()).add((each.file, each.number))
        self._chunks = sorted(chunks, key=lambda chunk: (chunk.start_ns, chunk.file, chunk.position))
        self.start_ns = self._chunks[0].start_ns if chunks else 0
        self.end_ns = max((chunk.end_ns for chunk in chunks), default=0)
        self._topic_chunks: dict[str, _TopicChunks] = {}
        self._chunks_by_connection: dict[tuple[int, int], list[int]] = {}
        for index, chunk in enumerate(self._chunks):
            for number in chunk.counts:
                self._chunks_by_connection.setdefault((chunk.file, number), []).append(index)
        self._inner: OrderedDict[int, dict[int, bytes | _Entries]] = OrderedDict()

    @property
    def publishers(self) -> tuple[IndexedConnection, ...]:
        """All connections, in the order of the files."""
        return tuple(self._publishers.values())

    @property
    def chunks(self) -> int:
        """Number of chunks."""
        return len(self._chunks)

    @property
    def counts(self) -> dict[str, int]:
        """Number of messages of each topic; repeated latched messages of a split recording count in each part."""
        counts = dict.fromkeys(sorted(self._of_topic), 0)
        for chunk in self._chunks:
            for number, count in chunk.counts.items():
                if (publisher := self._publishers.get((chunk.file, number))) is not None:
                    counts[publisher.topic] += count
        return counts

    def close(self) -> None:
        """Close the files."""
        self._reader.close()

    def last(self, topic: str, at_ns: int) -> MessageLocation | None:
        """Return the location of the last message of a topic at or before a time, or None."""
        best: MessageLocation | None = None
        topic_chunks = self._chunks_of(topic)
        # Chunks may overlap in time: a message in an earlier chunk can be later than the best message so far. The
        # search ends when the running maximum of last stamps shows that no earlier chunk can have a later message.
        for turn in range(bisect_right(topic_chunks.starts, at_ns) - 1, -1, -1):
            if best is not None and topic_chunks.reach[turn] < best.stamp_ns:
                break
            index = topic_chunks.chunks[turn]
            for entries in self._entries_of(index, topic):
                row = int(np.searchsorted(entries.stamps_ns, at_ns, side="right")) - 1
                if row >= 0:
                    found = self._location(index, entries, row)
                    best = found if best is None else max(best, found)
        return best

    def next(self, topic: str, after_ns: int) -> MessageLocation | None:
        """Return the location of the first message of a topic after a time, or None."""
        best: MessageLocation | None = None
        topic_chunks = self._chunks_of(topic)
        for turn in range(bisect_right(topic_chunks.reach, after_ns), len(topic_chunks.chunks)):
            if best is not None and topic_chunks.starts[turn] > best.stamp_ns:
                break
            index = topic_chunks.chunks[turn]
            for entries in self._entries_of(index, topic):
                row = int(np.searchsorted(entries.stamps_ns, after_ns, side="right"))
                if row < len(entries.stamps_ns):
                    found = self._location(index, entries, row)
                    best = found if best is None else min(best, found)
        return best

    def chunks_back(self, topic: str, at_ns: int, until_ns: int) -> Iterator[int]:
        """Yield the chunks, last first, that may have a topic's messages from `at_ns` back to `until_ns`, inclusive."""
        topic_chunks = self._chunks_of(topic)
        for turn in range(bisect_right(topic_chunks.starts, at_ns) - 1, -1, -1):
            if topic_chunks.reach[turn] < until_ns:
                return
            yield topic_chunks.chunks[turn]

    def locations(self, topic: str, chunk: int) -> list[MessageLocation]:
        """Return the locations of the messages of a topic in a chunk, in order of time."""
        return sorted(each for entries in self._entries_of(chunk, topic) for each in self._locations(chunk, entries))

    def walk(self, topics: Collection[str]) -> Iterator[list[MessageLocation]]:
        """Yield the locations of all messages of some topics in order of time.

        Each list is for one chunk, so that callers can pause between chunks.
        """
        wanted = frozenset[tuple[int, int]]().union(*(self._of_topic.get(topic, set()) for topic in topics))
        pending: list[MessageLocation] = []
        for index, chunk in enumerate(self._chunks):
            numbers = [number for number in chunk.counts if (chunk.file, number) in wanted]
            if numbers:
                for entries in self._entries(index, numbers):
                    pending.extend(self._locations(index, entries))
            # Chunks are ordered by their first stamps: no message in later chunks is before the start of the next
            # chunk.
            horizon = self._chunks[index + 1].start_ns if index + 1 < len(self._chunks) else None
            pending.sort()
            ready = pending if horizon is None else [location for location in pending if location.stamp_ns < horizon]
            pending = pending[len(ready) :]
            yield ready

    def read(self, location: MessageLocation) -> RawMessage:
        """Return the message at a location."""
        publisher, data = location.publisher, self._reader.message(self._chunks[location.chunk], location.offset)
        return RawMessage(publisher.topic, publisher.msgtype, publisher.md5, location.stamp_ns, data)

    def _location(self, index: int, entries: _Entries, row: int) -> MessageLocation:
        chunk = self._chunks[index]
        stamp_ns, offset = int(entries.stamps_ns[row]), int(entries.offsets[row])
        return MessageLocation(stamp_ns, chunk.file, chunk.position, offset, index, entries.publisher)

    def _locations(self, index: int, entries: _Entries) -> Iterator[MessageLocation]:
        chunk, publisher = self._chunks[index], entries.publisher
        for stamp_ns, offset in zip(entries.stamps_ns.tolist(), entries.offsets.tolist(), strict=True):
            yield MessageLocation(stamp_ns, chunk.file, chunk.position, offset, index, publisher)

    def _chunks_of(self, topic: str) -> _TopicChunks:
        known = self._topic_chunks.get(topic)
        if known is None:
            chunk_lists = (self._chunks_by_connection.get(key, ()) for key in self._of_topic.get(topic, ()))
            chunks = sorted(set[int]().union(*chunk_lists))
            known = self._topic_chunks[topic] = _TopicChunks.of(chunks, self._chunks)
        return known

    def _entries_of(self, index: int, topic: str) -> list[_Entries]:
        file = self._chunks[index].file
        return self._entries(index, (number for part, number in self._of_topic[topic] if part == file))

    def _entries(self, index: int, numbers: Iterable[int]) -> list[_Entries]:
        """Return the messages of some connections in a chunk."""
        inner, file = self._inside(index), self._chunks[index].file
        found = []
        for number in numbers:
            entries = inner.get(number)
            if isinstance(entries, bytes):
                with damage_as_bad_file(self._parts[file]):
                    entries = inner[number] = _Entries.of(self._publishers[file, number], entries)
            if entries is not None:
                found.append(entries)
        return found

    def _inside(self, index: int) -> dict[int, bytes | _Entries]:
        """Return the index of a chunk by connection number; entries are decoded when they are needed."""
        known = self._inner.get(index)
        if known is None:
            known = self._inner[index] = {**self._reader.index_of(self._chunks[index])}
            if len(self._inner) > CHUNKS_KEPT:
                self._inner.popitem(last=False)
        else:
            self._inner.move_to_end(index)
        return known


def open_index(path: Path) -> Generator[float, None, BagIndex]:
    """Open a recording in steps of some milliseconds; after each step yield the share of work done.

    Args:
        path: a bag, or the name of a split recording.

    Returns:
        The index; the caller closes it.

    Raises:
        BadFile: the file does not exist, is not a ROS 1 bag, was not closed by its writer, or is damaged.
    """
    parts = parts_of(path)
    files: list[BinaryIO] = []
    publishers: list[IndexedConnection] = []
    chunks: list[ChunkInfo] = []
    try:
        for number, named in enumerate(parts):
            part = as_ros1(named)
            check_is_bag(part)
            with damage_as_bad_file(part):
                files.append(part.open("rb"))
                end = FileEnd()
                for share in read_end(files[-1], number, part, end):
                    yield (number + share) / len(parts)
            for each in end.connections:
                better = identified(each.msgtype, each.md5, each.definition)
                text = each.definition if better is None else better.definition
                publishers.append(IndexedConnection(number, each.number, each.topic, each.msgtype, each.md5, text))
            chunks += end.chunks
    except BaseException:
        for file in files:
            file.close()
        raise
    return BagIndex(path, parts, files, publishers, chunks)
