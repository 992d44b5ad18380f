"""Any message of a recording without reading those before it.

Opening reads what the end of each file says of its chunks. What is in a chunk is looked up when somebody wants to know,
and forgotten when much else was looked up since; so neither time nor memory grows with messages that nobody looks at.
"""

import os
from bisect import bisect_right
from collections import OrderedDict
from collections.abc import Callable, Collection, Generator, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path
from typing import BinaryIO, NamedTuple

import numpy as np
from numpy.typing import NDArray
from rosbags.rosbag1 import ReaderError
from rosbags.rosbag1.reader import Header, RecordType, decompressors, normalize, read_bytes, read_uint32

from thbridge.adapters.bag_reader import MAGIC, VERSION, RawMessage, check_is_bag
from thbridge.adapters.bag_records import Compression
from thbridge.adapters.errors import BadFile
from thbridge.adapters.recordings import ACTIVE, active_of, parts_of

STEP = 64
"""Chunks after which opening a bag pauses: some milliseconds."""
CHUNKS_KEPT = 2048
"""Chunks whose index is remembered."""
BYTES_KEPT = 32 * 1024 * 1024
"""Bytes of unpacked chunks that are remembered."""
WHOLE = 1024 * 1024
"""Bytes of chunks that are read whole though they are not packed: of larger ones, some messages are wanted."""

_CONNECTION = b"\x09\x00\x00\x00conn="
"""The field of an index record's head that says whose it is, up to its 4 bytes."""
_STUMBLES = (ReaderError, ValueError, LookupError, EOFError, OSError, MemoryError, RuntimeError)
"""What rosbags' parser and its decompressors answer damage with."""


@dataclass(frozen=True, slots=True)
class Publisher:
    """One publisher of one topic in one file.

    Attributes:
        file: number of the file among the recording's parts.
        number: what the file calls it.
        topic: its name.
        msgtype: for example "nav_msgs/Odometry".
        md5: of the type.
    """

    file: int
    number: int
    topic: str
    msgtype: str
    md5: str


class Place(NamedTuple):
    """Where a message is; places are ordered by time, those of one time as they were recorded.

    Attributes:
        stamp_ns: when it was recorded.
        file: number of the file.
        position: of its chunk in the file.
        offset: of its record in the unpacked chunk.
        chunk: number of the chunk in the index.
        publisher: who said it.
    """

    stamp_ns: int
    file: int
    position: int
    offset: int
    chunk: int
    publisher: Publisher


@dataclass(frozen=True, slots=True, eq=False)
class _Chunk:
    """What a file's end says of a chunk; `counts` are messages by number of publisher."""

    file: int
    position: int
    start_ns: int
    end_ns: int
    counts: Mapping[int, int]


@dataclass(frozen=True, slots=True, eq=False)
class _Packed:
    """Where a chunk's records lie in its file, how many bytes, and what unpacks them; None: they are not packed."""

    position: int
    size: int
    unpack: Callable[[bytes], bytes] | None


@dataclass(frozen=True, slots=True, eq=False)
class _Where:
    """The chunks that hold messages of one topic: numbers, first stamps, and last stamps in each or any before it."""

    chunks: list[int]
    starts: list[int]
    reach: list[int]

    @classmethod
    def of(cls, chunks: list[int], all_chunks: list[_Chunk]) -> "_Where":
        ends = accumulate((all_chunks[chunk].end_ns for chunk in chunks), max)
        return cls(chunks, [all_chunks[chunk].start_ns for chunk in chunks], list(ends))


@dataclass(frozen=True, slots=True, eq=False)
class _Entries:
    """Messages of one publisher in one chunk: (n,) stamps, rising, and (n,) offsets in the unpacked chunk."""

    publisher: Publisher
    stamps_ns: NDArray[np.int64]
    offsets: NDArray[np.int64]

    @classmethod
    def of(cls, publisher: Publisher, data: bytes) -> "_Entries":
        """From the data of an index record."""
        table = np.frombuffer(data, dtype="<u4").reshape(-1, 3).astype(np.int64)
        stamps, offsets = table[:, 0] * 1_000_000_000 + table[:, 1], table[:, 2]
        if (np.diff(stamps) <= 0).any():
            order = np.lexsort((offsets, stamps))
            stamps, offsets = stamps[order], offsets[order]
        return cls(publisher, stamps, offsets)


class BagIndex:
    """A recording that was opened by `open_index`; for one thread.

    All methods that look for messages or read them raise BadFile where the file is damaged, or gone.

    Attributes:
        path: as it was named.
        start_ns: stamp of the first message; 0 when there is none.
        end_ns: stamp of the last one.
    """

    def __init__(
        self,
        path: Path,
        parts: tuple[Path, ...],
        files: list[BinaryIO],
        publishers: list[Publisher],
        chunks: list[_Chunk],
    ) -> None:
        self.path = path
        self._parts, self._files = parts, files
        self._publishers = {(each.file, each.number): each for each in publishers}
        self._of_topic: dict[str, set[tuple[int, int]]] = {}
        for each in publishers:
            self._of_topic.setdefault(each.topic, set()).add((each.file, each.number))
        self._chunks = sorted(chunks, key=lambda chunk: (chunk.start_ns, chunk.file, chunk.position))
        self.start_ns = self._chunks[0].start_ns if chunks else 0
        self.end_ns = max((chunk.end_ns for chunk in chunks), default=0)
        self._where: dict[str, _Where] = {}
        self._speaking: dict[tuple[int, int], list[int]] = {}
        for index, chunk in enumerate(self._chunks):
            for number in chunk.counts:
                self._speaking.setdefault((chunk.file, number), []).append(index)
        self._inner: OrderedDict[int, dict[int, bytes | _Entries]] = OrderedDict()
        self._packed: dict[int, _Packed] = {}
        self._unpacked: OrderedDict[int, bytes] = OrderedDict()
        self._bytes = 0

    @property
    def publishers(self) -> tuple[Publisher, ...]:
        """All of them, in the order of the files."""
        return tuple(self._publishers.values())

    @property
    def chunks(self) -> int:
        """How many chunks there are."""
        return len(self._chunks)

    def close(self) -> None:
        """Close the files."""
        for file in self._files:
            file.close()

    def last(self, topic: str, at_ns: int) -> Place | None:
        """Where the last message of a topic up to a time is, that time included."""
        best: Place | None = None
        where = self._whereabouts(topic)
        for turn in range(bisect_right(where.starts, at_ns) - 1, -1, -1):
            if best is not None and where.reach[turn] < best.stamp_ns:
                break
            index = where.chunks[turn]
            for entries in self._entries_of(index, topic):
                row = int(np.searchsorted(entries.stamps_ns, at_ns, side="right")) - 1
                if row >= 0:
                    found = self._place(index, entries, row)
                    best = found if best is None else max(best, found)
        return best

    def next(self, topic: str, after_ns: int) -> Place | None:
        """Where the first message of a topic later than a time is."""
        best: Place | None = None
        where = self._whereabouts(topic)
        for turn in range(bisect_right(where.reach, after_ns), len(where.chunks)):
            if best is not None and where.starts[turn] > best.stamp_ns:
                break
            index = where.chunks[turn]
            for entries in self._entries_of(index, topic):
                row = int(np.searchsorted(entries.stamps_ns, after_ns, side="right"))
                if row < len(entries.stamps_ns):
                    found = self._place(index, entries, row)
                    best = found if best is None else min(best, found)
        return best

    def chunks_back(self, topic: str, at_ns: int, until_ns: int) -> Iterator[int]:
        """The chunks that may hold messages of a topic from a time back until another, both included; last first."""
        where = self._whereabouts(topic)
        for turn in range(bisect_right(where.starts, at_ns) - 1, -1, -1):
            if where.reach[turn] < until_ns:
                return
            yield where.chunks[turn]

    def places(self, topic: str, chunk: int) -> list[Place]:
        """Where in a chunk the messages of a topic are, in order of time."""
        return sorted(place for entries in self._entries_of(chunk, topic) for place in self._places(chunk, entries))

    def walk(self, topics: Collection[str]) -> Iterator[list[Place]]:
        """Where all messages of these topics are, in order of time; a list for each chunk, so that one can pause."""
        wanted = frozenset[tuple[int, int]]().union(*(self._of_topic.get(topic, set()) for topic in topics))
        pending: list[Place] = []
        for index, chunk in enumerate(self._chunks):
            numbers = [number for number in chunk.counts if (chunk.file, number) in wanted]
            if numbers:
                for entries in self._entries(index, numbers):
                    pending.extend(self._places(index, entries))
            # What begins later cannot come before what is earlier than that.
            horizon = self._chunks[index + 1].start_ns if index + 1 < len(self._chunks) else None
            pending.sort()
            ready = pending if horizon is None else [place for place in pending if place.stamp_ns < horizon]
            pending = pending[len(ready) :]
            yield ready

    def read(self, place: Place) -> RawMessage:
        """The message at a place."""
        publisher = place.publisher
        packed = self._packed_at(place.chunk)
        if packed.unpack is None and packed.size > WHOLE:
            body = self._read_alone(place, packed)
        else:
            data = self._data(place.chunk, packed)
            try:
                start = _after_length(data, place.offset)  # behind the record's head
                body = data[start + 4 : _after_length(data, start)]
            except ValueError as error:
                raise _damaged(self._parts[place.file]) from error
        return RawMessage(publisher.topic, publisher.msgtype, publisher.md5, place.stamp_ns, body)

    def _read_alone(self, place: Place, packed: _Packed) -> bytes:
        """A message without the pictures, say, that share its chunk."""
        file = self._files[place.file]
        with _damage_told(self._parts[place.file]):
            file.seek(packed.position + place.offset)
            file.seek(read_uint32(file), os.SEEK_CUR)
            return read_bytes(file, read_uint32(file))

    def _packed_at(self, index: int) -> _Packed:
        known = self._packed.get(index)
        if known is None:
            chunk = self._chunks[index]
            file = self._files[chunk.file]
            with _damage_told(self._parts[chunk.file]):
                file.seek(chunk.position)
                compression = Header.read(file, RecordType.CHUNK).get_string("compression")
                unpack = None if compression == Compression.NONE else decompressors[compression]
                size = read_uint32(file)
                known = self._packed[index] = _Packed(file.tell(), size, unpack)
        return known

    def _place(self, index: int, entries: _Entries, row: int) -> Place:
        chunk = self._chunks[index]
        stamp_ns, offset = int(entries.stamps_ns[row]), int(entries.offsets[row])
        return Place(stamp_ns, chunk.file, chunk.position, offset, index, entries.publisher)

    def _places(self, index: int, entries: _Entries) -> Iterator[Place]:
        chunk, publisher = self._chunks[index], entries.publisher
        for stamp_ns, offset in zip(entries.stamps_ns.tolist(), entries.offsets.tolist(), strict=True):
            yield Place(stamp_ns, chunk.file, chunk.position, offset, index, publisher)

    def _whereabouts(self, topic: str) -> _Where:
        known = self._where.get(topic)
        if known is None:
            speaking = (self._speaking.get(who, ()) for who in self._of_topic.get(topic, ()))
            chunks = sorted(set[int]().union(*speaking))
            known = self._where[topic] = _Where.of(chunks, self._chunks)
        return known

    def _entries_of(self, index: int, topic: str) -> list[_Entries]:
        file = self._chunks[index].file
        return self._entries(index, (number for said_in, number in self._of_topic[topic] if said_in == file))

    def _entries(self, index: int, numbers: Iterable[int]) -> list[_Entries]:
        """What these publishers of its file say in a chunk."""
        inner, file = self._inside(index), self._chunks[index].file
        found = []
        for number in numbers:
            entries = inner.get(number)
            if isinstance(entries, bytes):
                with _damage_told(self._parts[file]):
                    entries = inner[number] = _Entries.of(self._publishers[file, number], entries)
            if entries is not None:
                found.append(entries)
        return found

    def _inside(self, index: int) -> dict[int, bytes | _Entries]:
        """The index of a chunk by number of publisher; taken apart when somebody looks."""
        known = self._inner.get(index)
        if known is None:
            with _damage_told(self._parts[self._chunks[index].file]):
                known = self._read_inside(index)
            self._inner[index] = known
            if len(self._inner) > CHUNKS_KEPT:
                self._inner.popitem(last=False)
        else:
            self._inner.move_to_end(index)
        return known

    def _read_inside(self, index: int) -> dict[int, bytes | _Entries]:
        chunk = self._chunks[index]
        file = self._files[chunk.file]
        packed = self._packed_at(index)
        file.seek(packed.position + packed.size)
        found: dict[int, bytes | _Entries] = {}
        for _ in chunk.counts:
            # rosbags' own way to read a head takes longer than all else that is done here.
            head = read_bytes(file, read_uint32(file))
            at = head.index(_CONNECTION) + len(_CONNECTION)
            number = int.from_bytes(head[at : at + 4], "little")
            found[number] = read_bytes(file, read_uint32(file))
        if found.keys() != chunk.counts.keys():
            raise ValueError("a chunk's index is not what the file's end says")
        return found

    def _data(self, index: int, packed: _Packed) -> bytes:
        """The records of a chunk, unpacked."""
        known = self._unpacked.get(index)
        if known is not None:
            self._unpacked.move_to_end(index)
            return known
        chunk = self._chunks[index]
        file = self._files[chunk.file]
        with _damage_told(self._parts[chunk.file]):
            file.seek(packed.position)
            known = read_bytes(file, packed.size)
            known = known if packed.unpack is None else packed.unpack(known)
        self._unpacked[index] = known
        self._bytes += len(known)
        while self._bytes > BYTES_KEPT and len(self._unpacked) > 1:
            self._bytes -= len(self._unpacked.popitem(last=False)[1])
        return known


def open_index(path: Path) -> Generator[float, None, BagIndex]:
    """Open a recording in pieces of some milliseconds, between which it tells which share of the work is done.

    Args:
        path: a bag, or the name of a split recording.

    Returns:
        The index; whoever opened it closes it.

    Raises:
        BadFile: there is no such file, it is not a ROS 1 bag, its writer has not closed it, or it is damaged.
    """
    parts = parts_of(path)
    if parts == (path,) and not path.exists() and active_of(path).exists():
        raise _unfinished(active_of(path))
    files: list[BinaryIO] = []
    publishers: list[Publisher] = []
    chunks: list[_Chunk] = []
    try:
        for number, part in enumerate(parts):
            check_is_bag(part)
            with _damage_told(part):
                files.append(part.open("rb"))
                for share in _read_end(files[-1], number, part, publishers, chunks):
                    yield (number + share) / len(parts)
    except BaseException:
        for file in files:
            file.close()
        raise
    return BagIndex(path, parts, files, publishers, chunks)


def _read_end(
    file: BinaryIO, number: int, part: Path, publishers: list[Publisher], chunks: list[_Chunk]
) -> Iterator[float]:
    """Add what the end of a file says of its publishers and chunks; tells which share is read."""
    file.seek(len(MAGIC) + len(VERSION))
    head = Header.read(file, RecordType.BAGHEADER)
    position, count = head.get_uint64("index_pos"), head.get_uint32("chunk_count")
    if head.get("encryptor"):
        raise BadFile(part, None, None, "the bag is encrypted", "decrypt it with the program that encrypted it")
    if position == 0:
        raise _unfinished(part)
    file.seek(position)
    for _ in range(head.get_uint32("conn_count")):
        outer = Header.read(file, RecordType.CONNECTION)
        inner = Header.read(file)  # the record's data has the form of a head
        publishers.append(
            Publisher(
                number,
                outer.get_uint32("conn"),
                normalize(outer.get_string("topic")),
                inner.get_string("type"),
                inner.get_string("md5sum"),
            )
        )
    for index in range(count):
        info = Header.read(file, RecordType.CHUNK_INFO)
        table = np.frombuffer(read_bytes(file, read_uint32(file)), dtype="<u4").reshape(-1, 2)
        counts = {publisher: messages for publisher, messages in table.tolist() if messages}
        if counts:
            times = info.get_time("start_time"), info.get_time("end_time")
            chunks.append(_Chunk(number, info.get_uint64("chunk_pos"), *times, counts))
        if index % STEP == STEP - 1:
            yield index / count


def _after_length(data: bytes, at: int) -> int:
    """Where what begins with its own length, 4 bytes, ends. Raises ValueError: beyond the data."""
    end = at + 4 + int.from_bytes(data[at : at + 4], "little")
    if end > len(data):
        raise ValueError("a record ends beyond its chunk")
    return end


def _unfinished(path: Path) -> BadFile:
    if path.name.endswith(ACTIVE):
        problem = "the bag is still being written, or its writer was killed"
        remedy = f"wait until its session has ended, or else run `thbridge bag reindex {path}`"
        return BadFile(path, None, None, problem, remedy)
    return BadFile(path, None, None, "the bag was cut off: it has no index", f"run `thbridge bag reindex {path}`")


@contextmanager
def _damage_told(path: Path) -> Iterator[None]:
    try:
        yield
    except _STUMBLES as error:
        raise _damaged(path) from error


def _damaged(path: Path) -> BadFile:
    problem = "the bag was cut off or is damaged"
    return BadFile(path, None, None, problem, f"run `thbridge bag reindex {path}`")
