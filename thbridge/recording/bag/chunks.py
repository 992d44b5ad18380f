"""Chunks of a bag, built in memory from messages."""

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from thbridge.recording.bag.records import U32, BagConnection, message_head, time_bytes

CHUNK_BYTES = 768 * 1024
CHUNK_NS = 1_000_000_000
"""A chunk ends after the stamp with which it becomes larger than this (rosbag's own size: each chunk has an index for
every topic in it), or before it spans more time than this."""

MOST_BYTES = 2 * CHUNK_BYTES
"""Size beyond which a chunk ends even between messages with equal stamps."""

_ENTRY = np.dtype([("time", "V8"), ("offset", "<u4")])


@dataclass(frozen=True, slots=True)
class Chunk:
    """Messages that are written to a bag together.

    Attributes:
        data: the message records.
        start_ns: the oldest stamp.
        end_ns: the newest stamp.
        entries: index entries of the messages, by connection; offsets count from the start of `data`.
        counts: number of messages, by connection.
    """

    data: bytes
    start_ns: int
    end_ns: int
    entries: Mapping[BagConnection, bytes]
    counts: Mapping[BagConnection, int]

    def moved_entries(self, connection: BagConnection, by: int) -> bytes:
        """The index entries of a connection, when `by` bytes are written before `data` in the chunk."""
        entries = np.frombuffer(self.entries[connection], _ENTRY).copy()
        entries["offset"] += by
        return entries.tobytes()


class ChunkBuilder:
    """Collects messages for a chunk.

    Attributes:
        size: bytes of the collected message records.
    """

    def __init__(self) -> None:
        self._heads: dict[BagConnection, bytes] = {}
        self._stamp_ns = -1
        self._time = b""
        self._begin()

    def _begin(self) -> None:
        self.size = 0
        self._pieces: list[bytes] = []
        self._entries: defaultdict[BagConnection, list[bytes]] = defaultdict(list)
        self._start_ns = self._end_ns = 0

    def accepts(self, stamp_ns: int) -> bool:
        """Return True when a message with this stamp still belongs into the chunk."""
        if not self.size:
            return True
        if stamp_ns == self._stamp_ns:
            return self.size <= MOST_BYTES
        return self.size <= CHUNK_BYTES and stamp_ns - self._start_ns < CHUNK_NS

    def add(self, connection: BagConnection, stamp_ns: int, data: bytes) -> None:
        """Add a message."""
        head = self._heads.get(connection)
        if head is None:
            head = self._heads[connection] = message_head(connection)
        if stamp_ns != self._stamp_ns:
            self._stamp_ns, self._time = stamp_ns, time_bytes(stamp_ns)
        if not self.size:
            self._start_ns = self._end_ns = stamp_ns
        elif stamp_ns > self._end_ns:
            self._end_ns = stamp_ns
        elif stamp_ns < self._start_ns:
            self._start_ns = stamp_ns
        self._entries[connection] += (self._time, U32.pack(self.size))
        self._pieces += (head, self._time, U32.pack(len(data)), data)
        self.size += len(head) + len(self._time) + U32.size + len(data)

    def snapshot(self) -> Chunk:
        """The chunk so far, which goes on growing."""
        return Chunk(
            b"".join(self._pieces),
            self._start_ns,
            self._end_ns,
            {connection: b"".join(entries) for connection, entries in self._entries.items()},
            {connection: len(entries) // 2 for connection, entries in self._entries.items()},
        )

    def take(self) -> Chunk:
        """The chunk; the next message begins another one."""
        chunk = self.snapshot()
        self._begin()
        return chunk
