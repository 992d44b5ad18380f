"""Formats of recordings: ROS 1's bag format, and MCAP as rosbag2 writes it."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from thbridge.recording.bag import mcap_records
from thbridge.recording.bag.options import Compression
from thbridge.recording.bag.records import (
    MAGIC,
    BagConnection,
    bag_header,
    chunk_info_record,
    chunk_pieces,
    connection_record,
    index_record,
)
from thbridge.recording.bag.writing.chunks import Chunk
from thbridge.recording.bag.writing.message_layouts import MCAP, ROS1, RecordLayout


@dataclass(frozen=True, slots=True)
class ChunkOfFile:
    """A chunk as it is written to a file.

    Attributes:
        data: the chunk, with the records of connections that are new to the file.
        info: its record in the index at the end of the file.
        index_bytes: bytes that the index needs for it.
    """

    data: bytes
    info: bytes
    index_bytes: int


class BagFormat(Protocol):
    """Format of a recording.

    Attributes:
        layout: layout of message records.
        beginning: first bytes of a file that is being written.
        tail: bytes that are written after the last chunk of a file without an index.
        first_number: smallest number of a connection.
    """

    layout: RecordLayout
    beginning: bytes
    tail: bytes
    first_number: int

    def packed(
        self, position: int, chunk: Chunk, known: Collection[BagConnection], compression: Compression
    ) -> ChunkOfFile:
        """Return a chunk for a position of the file, given the connections that the file has so far."""

    def end(
        self,
        position: int,
        counts: Mapping[BagConnection, int],
        infos: Sequence[bytes],
        times: tuple[int, int] | None,
    ) -> bytes:
        """Return the index and everything after it.

        Args:
            position: offset of the index in the file.
            counts: number of messages of each connection.
            infos: records of the chunks.
            times: first and last stamp, nanoseconds; None if there are no messages.
        """

    def final_beginning(self, position: int, connections: int, chunks: int) -> bytes:
        """Return the first bytes of a complete file, from the position of its index and two numbers in it."""


class Ros1BagFormat:
    """ROS 1's bag format 2.0. Each chunk begins with the records of its new connections."""

    layout = ROS1
    beginning = MAGIC + bag_header(0, 0, 0)
    tail = b""
    first_number = 0

    def packed(
        self, position: int, chunk: Chunk, known: Collection[BagConnection], compression: Compression
    ) -> ChunkOfFile:
        """Return a chunk with its index data records; without them, ROS's `reindex` rejects a file's last chunk."""
        head = b"".join(connection_record(connection) for connection in chunk.entries if connection not in known)
        index = (index_record(connection, chunk.moved_entries(connection, len(head))) for connection in chunk.entries)
        info = chunk_info_record(position, chunk.start_ns, chunk.end_ns, chunk.counts)
        data = b"".join((*chunk_pieces(head + chunk.data, compression), *index))
        return ChunkOfFile(data, info, len(head) + len(info))

    def end(
        self,
        position: int,
        counts: Mapping[BagConnection, int],
        infos: Sequence[bytes],
        times: tuple[int, int] | None,
    ) -> bytes:
        """Return the records of connections and chunks."""
        # Connections are sorted, because readers use the order of connections for messages with equal stamps. The order
        # must be the same in all parts.
        known = sorted(counts, key=lambda connection: connection.number)
        return b"".join((*map(connection_record, known), *infos))

    def final_beginning(self, position: int, connections: int, chunks: int) -> bytes:
        """Return the first record, with the position of the index."""
        return MAGIC + bag_header(position, connections, chunks)


class McapFormat:
    """MCAP with the profile `ros2`. Each chunk begins with the records of its new connections."""

    layout = MCAP
    beginning = mcap_records.header()
    tail = mcap_records.TAIL
    first_number = 1

    def packed(
        self, position: int, chunk: Chunk, known: Collection[BagConnection], compression: Compression
    ) -> ChunkOfFile:
        """Return a chunk with its message indexes."""
        new = [connection for connection in chunk.entries if connection not in known]
        head = mcap_records.connection_records(new, known) if new else b""
        entries = {connection.number: chunk.moved_entries(connection, len(head)) for connection in chunk.entries}
        times = chunk.start_ns, chunk.end_ns
        packed = mcap_records.packed_chunk(position, head + chunk.data, times, entries, compression)
        # The statistics have 10 bytes for each connection.
        index_bytes = len(head) + len(packed.index) + 10 * len(new) + (0 if known else mcap_records.END_BYTES)
        return ChunkOfFile(packed.data, packed.index, index_bytes)

    def end(
        self,
        position: int,
        counts: Mapping[BagConnection, int],
        infos: Sequence[bytes],
        times: tuple[int, int] | None,
    ) -> bytes:
        """Return the end of the data, the summary, and the footer."""
        return mcap_records.end(position, tuple(counts), infos, counts, times or (0, 0))

    def final_beginning(self, position: int, connections: int, chunks: int) -> bytes:
        """Return the header, which does not depend on the index."""
        return self.beginning


ROS1_BAG: BagFormat = Ros1BagFormat()
MCAP_FILE: BagFormat = McapFormat()
