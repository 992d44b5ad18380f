"""Chunks of a bag, built in memory from messages."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from thbridge.recording.bag.records import BagConnection
from thbridge.recording.bag.writing.message_layouts import ROS1, TIME, RecordLayout

CHUNK_BYTES = 768 * 1024
CHUNK_NS = 500_000_000
"""Limits of a chunk. When a chunk becomes larger than `CHUNK_BYTES`, it ends after all messages of the present stamp. A
chunk also ends before it spans more time than `CHUNK_NS`. The size is rosbag's default, because each chunk has an index
for every topic in it. A power failure while a complete chunk overwrites its preview can cost the whole chunk, so its
time is half of the second that may be lost."""

MOST_BYTES = 2 * CHUNK_BYTES
"""Maximum size of a chunk. A larger chunk ends even between messages with equal stamps."""


@dataclass(frozen=True, slots=True)
class Chunk:
    """Messages that are written to a bag together.

    Attributes:
        data: the message records.
        start_ns: the oldest stamp.
        end_ns: the newest stamp.
        entries: index entries of the messages, by connection; offsets count from the start of `data`.
        counts: number of messages, by connection.
        entry: type of an index entry, with the field `offset`.
    """

    data: bytes
    start_ns: int
    end_ns: int
    entries: Mapping[BagConnection, bytes]
    counts: Mapping[BagConnection, int]
    entry: np.dtype[np.void]

    def moved_entries(self, connection: BagConnection, by: int) -> bytes:
        """Return the index entries of a connection if `by` bytes are written before `data` in the chunk."""
        if not by:
            return self.entries[connection]
        entries = np.frombuffer(self.entries[connection], self.entry).copy()
        entries["offset"] += by
        return entries.tobytes()


class ChunkBuilder:
    """Collector of messages for a chunk. Their records are built all at once, when the chunk is needed.

    Args:
        layout: layout of the records.

    Attributes:
        size: bytes of the collected messages' records.
    """

    def __init__(self, layout: RecordLayout = ROS1) -> None:
        self._layout = layout
        self._before: Counter[BagConnection] = Counter()
        self._begin()

    def _begin(self) -> None:
        self.size = 0
        self._connections: list[BagConnection] = []
        self._messages: list[bytes] = []
        self._stamps: list[int] = []
        self._repeats: list[int] = []
        """Number of successive messages with each of these stamps."""
        self._start_ns = 0

    def accepts(self, stamp_ns: int) -> bool:
        """Return True if a message with this stamp still belongs to the chunk."""
        if not self.size:
            return True
        if stamp_ns == self._stamps[-1]:
            return self.size <= MOST_BYTES
        return self.size <= CHUNK_BYTES and stamp_ns - self._start_ns < CHUNK_NS

    def add(self, connection: BagConnection, stamp_ns: int, data: bytes) -> None:
        """Add a message."""
        self._add(stamp_ns, (connection,), (data,), len(data) + self._layout.head_bytes)

    def add_all(self, connections: Sequence[BagConnection], stamp_ns: int, messages: Sequence[bytes]) -> bool:
        """Add messages of one stamp if all of them fit. Otherwise add none of them, and return False.

        The chunk must accept the first message.
        """
        size = sum(map(len, messages)) + self._layout.head_bytes * len(messages)
        if self.size + size > MOST_BYTES:
            return False
        self._add(stamp_ns, connections, messages, size)
        return True

    def _add(self, stamp_ns: int, connections: Sequence[BagConnection], messages: Sequence[bytes], size: int) -> None:
        if self._stamps and self._stamps[-1] == stamp_ns:
            self._repeats[-1] += len(messages)
        else:
            self._start_ns = min(self._start_ns, stamp_ns) if self._stamps else stamp_ns
            self._stamps.append(stamp_ns)
            self._repeats.append(len(messages))
        self._connections += connections
        self._messages += messages
        self.size += size

    def snapshot(self) -> Chunk:
        """Return a copy of the chunk, which continues to grow."""
        layout, count = self._layout, len(self._messages)
        numbers = np.fromiter((connection.number for connection in self._connections), np.int64, count)
        sizes = np.fromiter(map(len, self._messages), np.int64, count)
        times = np.repeat(np.frombuffer(b"".join(map(layout.time_bytes, self._stamps)), TIME), self._repeats)
        # Sorted by connection, so that each connection's entries are contiguous.
        order = np.argsort(numbers, kind="stable")
        counts = np.bincount(numbers)
        ends = np.cumsum(counts)
        connections = dict.fromkeys(self._connections)
        sequence = np.zeros(count, np.int64)
        if layout.is_numbered:
            before = np.zeros(len(counts), np.int64)
            for connection in connections:
                before[connection.number] = self._before[connection]
            sequence[order] = np.arange(count) - np.repeat(ends - counts - before, counts)
        records = [b""] * (2 * count)
        records[::2], records[1::2] = layout.heads(numbers, times, sizes, sequence), self._messages
        entries = np.empty(count, layout.entry)
        entries["time"] = times
        entries["offset"] = np.cumsum(sizes + layout.head_bytes) - sizes - layout.head_bytes
        packed = entries[order].tobytes()
        edges = (ends * layout.entry.itemsize).tolist()
        of_number = [packed[begin:end] for begin, end in pairwise((0, *edges))]
        return Chunk(
            b"".join(records),
            self._start_ns,
            max(self._stamps),
            {connection: of_number[connection.number] for connection in connections},
            {connection: int(counts[connection.number]) for connection in connections},
            layout.entry,
        )

    def take(self) -> Chunk:
        """Return the chunk; the next message begins another chunk."""
        chunk = self.snapshot()
        self._before.update(chunk.counts)
        self._begin()
        return chunk
