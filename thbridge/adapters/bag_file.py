"""rosbags' ROS 1 writer, with what ROS 1's own tools want besides, safe from kills and full disks."""

import os
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from struct import Struct

from rosbags.interfaces import Connection
from rosbags.rosbag1 import Writer
from rosbags.rosbag1.reader import RecordType
from rosbags.rosbag1.writer import MAXSIZE, Header, WriteChunk, serialize_uint32

CHUNK_BYTES = 128 * 1024
CHUNK_NS = 1_000_000_000
"""A chunk is closed beyond so many bytes, and when it spans so much time."""

MAGIC = b"#ROSBAG V2.0\n"
HEADER_BYTES = 4096
"""Header and padding of the first record, without its two length words. rosbags counts those in, ROS 1 does not, and
ROS 1's `reindex` overwrites as many bytes as it would have written itself."""

_MESSAGE = Struct("<II3sBI5sII5sIII")
_MESSAGE_HEADER = 38
"""The head of a message record: its fields op, conn and time, each with its length before it, and the data's length."""


class _Disk(BytesIO):
    """The end of a file: bytes gather in memory until `commit` appends all of them or none.

    Unlike a buffered file it can be taken back: when the disk is full, what was appended before stays whole.
    """

    def __init__(self, path: Path) -> None:
        super().__init__()
        self._file = path.open("xb", buffering=0)
        self._committed = 0

    def tell(self) -> int:
        """Where in the file the next byte will be."""
        return self._committed + super().tell()

    def commit(self) -> None:
        """Append what has gathered. Raises OSError; then the file ends where it did."""
        self.put(self._committed, self.getvalue())
        self._committed += super().tell()
        self.discard()

    def discard(self) -> None:
        """Forget what has gathered."""
        self.seek(0)
        self.truncate()

    def put(self, position: int, data: bytes | memoryview) -> None:
        """Write at a place of the file. Raises OSError; then nothing stays behind what was appended before."""
        try:
            self._file.seek(position)
            view = memoryview(data)
            while view:
                view = view[self._file.write(view) :]
        except OSError:
            self._file.truncate(self._committed)
            raise

    def sync(self) -> None:
        """Force the file onto the disk. Raises OSError, also when somebody deleted the file."""
        os.fsync(self._file.fileno())
        if os.fstat(self._file.fileno()).st_nlink == 0:
            raise FileNotFoundError("the file was deleted")

    def close(self) -> None:
        """Close the file; what has gathered and was not appended is lost."""
        self._file.close()
        super().close()


@dataclass(frozen=True, slots=True)
class _ChunkInfo:
    """What the index says of a chunk: its place, first and last stamp, and number of messages by connection."""

    position: int
    start: int
    end: int
    counts: dict[int, int]


class BagFile(Writer):
    """A bag being written. Differs from its parent, which see for `add_connection`:

    The first record is padded as ROS 1 pads it. Chunks end after a second of recorded time too. A chunk reaches the
    file whole or, with an OSError, not at all, so `close` can still write an index for those before it. Connections
    that no kept message uses stay out of the index (they would give `rosbag info` a negative duration). `sync` makes
    the open chunk safe without ending it, so wall time does not change a single byte of the finished file. Memory does
    not grow with the messages written.
    """

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self.chunk_threshold = CHUNK_BYTES
        self._chunk_infos: list[_ChunkInfo] = []

    def open(self) -> None:
        """Create the file. Raises OSError; it may not exist yet."""
        self._disk = _Disk(self.path)
        self.bio = self._disk
        self._disk.write(MAGIC + self._bag_header(0))
        self._disk.commit()

    def write(self, connection: Connection, timestamp: int, data: bytes | memoryview) -> None:
        """Write a message; stamps do not go back. Raises OSError.

        Four times as fast as the parent's, and an interrupt leaves no half of a message behind.
        """
        chunk = self.chunks[-1]
        if chunk.start != MAXSIZE and timestamp - chunk.start >= CHUNK_NS:
            self.write_chunk(chunk)
            chunk = self.chunks[-1]
        stamp = divmod(timestamp, 1_000_000_000)
        head = _MESSAGE.pack(
            _MESSAGE_HEADER, 4, b"op=", RecordType.MSGDATA, 9, b"conn=", connection.id, 13, b"time=", *stamp, len(data)
        )
        chunk.start = min(timestamp, chunk.start)
        chunk.end = max(timestamp, chunk.end)
        place = chunk.data.tell()
        chunk.data.write(b"".join((head, data)))
        chunk.connections[connection.id].append((timestamp, place))
        if chunk.data.tell() > self.chunk_threshold:
            self.write_chunk(chunk)

    def write_chunk(self, chunk: WriteChunk) -> None:
        """End the open chunk. Raises OSError; then its messages are lost and the file is as it was."""
        if not chunk.data.tell():
            return
        self._disk.discard()
        super().write_chunk(chunk)
        # The parent would keep every message's place in memory until the end.
        del self.chunks[:-1]
        self._disk.commit()
        counts = {connection: len(places) for connection, places in chunk.connections.items()}
        self._chunk_infos.append(_ChunkInfo(chunk.pos, chunk.start, chunk.end, counts))

    def sync(self) -> None:
        """Bring everything written onto the disk.

        The open chunk is put down as if it ended here; when it has grown, its longer self takes the same place.

        Raises:
            OSError: the disk is full, or the file was deleted.
        """
        data = self.chunks[-1].data
        if data.tell():
            record = BytesIO()
            header = Header()
            header.set_string("compression", self.compression_format)
            header.set_uint32("size", data.tell())
            header.write(record, RecordType.CHUNK)
            record.write(serialize_uint32(data.tell()))
            record.write(data.getbuffer())
            self._disk.put(self._disk.tell(), record.getbuffer())
        self._disk.sync()

    def close(self) -> None:
        """End the open chunk, write the index and close the file.

        Raises:
            OSError: there is no place for it. The file stays open and is as it was before; calling again writes an
                index without the chunk that found no place.
        """
        self.write_chunk(self.chunks[-1])
        self._disk.discard()
        index_pos = self._disk.tell()
        used = {connection for info in self._chunk_infos for connection in info.counts}
        indexed = [connection for connection in self.connections if connection.id in used]
        for connection in indexed:
            self.write_connection(connection, self._disk)
        for info in self._chunk_infos:
            self._write_chunk_info(info)
        self._disk.commit()
        self._disk.put(len(MAGIC), self._bag_header(index_pos, len(indexed), len(self._chunk_infos)))
        self._disk.sync()
        self.abort()

    def _write_chunk_info(self, info: _ChunkInfo) -> None:
        header = Header()
        header.set_uint32("ver", 1)
        header.set_uint64("chunk_pos", info.position)
        header.set_time("start_time", 0 if info.start == MAXSIZE else info.start)
        header.set_time("end_time", info.end)
        header.set_uint32("count", len(info.counts))
        header.write(self._disk, RecordType.CHUNK_INFO)
        counts = b"".join(serialize_uint32(number) for pair in info.counts.items() for number in pair)
        self._disk.write(serialize_uint32(len(counts)) + counts)

    def _bag_header(self, index_pos: int, connections: int = 0, chunks: int = 0) -> bytes:
        record = BytesIO()
        header = Header()
        header.set_uint64("index_pos", index_pos)
        header.set_uint32("conn_count", connections)
        header.set_uint32("chunk_count", chunks)
        length = header.write(record, RecordType.BAGHEADER) - 4
        padding = HEADER_BYTES - length
        record.write(serialize_uint32(padding) + b" " * padding)
        return record.getvalue()
