"""Messages gather in memory until they fill a chunk of a bag."""

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from thbridge.recording.bag.records import U32, BagConnection, message_head, time_bytes

CHUNK_BYTES = 128 * 1024
CHUNK_NS = 1_000_000_000
"""A chunk ends with the stamp that takes it beyond so many bytes, and when it spans so much time."""

MOST_BYTES = 8 * CHUNK_BYTES
"""Beyond so many bytes it ends even within a stamp."""

_ENTRY = np.dtype([("time", "V8"), ("offset", "<u4")])


@dataclass(frozen=True, slots=True)
class Chunk:
    """Messages that go into a bag together.

    Attributes:
        data: their records.
        start_ns: the oldest stamp.
        end_ns: the newest one.
        entries: by connection, what the index says of its messages; offsets count from the start of `data`.
        counts: by connection, the number of its messages.
    """

    data: bytes
    start_ns: int
    end_ns: int
    entries: Mapping[BagConnection, bytes]
    counts: Mapping[BagConnection, int]

    def moved_entries(self, connection: BagConnection, by: int) -> bytes:
        """What the index says of a connection where `data` has so many bytes before it."""
        entries = np.frombuffer(self.entries[connection], _ENTRY).copy()
        entries["offset"] += by
        return entries.tobytes()


class ChunkBuilder:
    """Gathers messages.

    Attributes:
        size: bytes of the messages that have gathered, with all that a bag says of them.
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
        """Whether a message of this stamp belongs to those that have gathered."""
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
        """What has gathered, and goes on gathering."""
        return Chunk(
            b"".join(self._pieces),
            self._start_ns,
            self._end_ns,
            {connection: b"".join(entries) for connection, entries in self._entries.items()},
            {connection: len(entries) // 2 for connection, entries in self._entries.items()},
        )

    def take(self) -> Chunk:
        """What has gathered; the next message begins another chunk."""
        chunk = self.snapshot()
        self._begin()
        return chunk
