"""A ROS 1 bag that is written chunk by chunk, so that little is lost if the program is killed or the disk is full."""

import errno
import os
from pathlib import Path

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
from thbridge.recording.bag.writing.chunks import Chunk, ChunkBuilder
from thbridge.recording.bag.writing.disk_room import reserve_space

NAMELESS = ".new"
"""Suffix of a file that does not yet have a bag's first record."""


class ChunkFile:
    """A bag that grows by complete chunks. A chunk is written completely or, with an OSError, not at all.

    Each chunk begins with the records of connections that are new to the file. So each connection has a message. If
    a connection had no messages, `rosbag info` might show a negative duration. Memory grows with the chunks, not with
    the messages.

    Args:
        path: path of the file, which must not exist.
        compression: compression of the chunks.

    Attributes:
        path: path of the file.
        size: bytes of the chunks so far, including the file's first record.

    Raises:
        OSError: the file cannot be created.
    """

    def __init__(self, path: Path, compression: Compression = Compression.NONE) -> None:
        self.path = path
        self.size = 0
        self._compression = compression
        self._known: set[BagConnection] = set()
        self._infos: list[bytes] = []
        self._index_bytes = 0
        self._end = 0
        self._complete = False
        if path.exists():
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(path))
        # The file gets its name only with its first record, so that a killed program never leaves an invalid bag.
        nameless = path.with_name(path.name + NAMELESS)
        nameless.unlink(missing_ok=True)
        self._file = nameless.open("xb", buffering=0)
        try:
            self._append(MAGIC + bag_header(0, 0, 0))
            nameless.rename(path)
        except OSError:
            self._file.close()
            nameless.unlink(missing_ok=True)
            raise

    def append(self, chunk: Chunk) -> None:
        """Add a chunk. Raises OSError; then the file is unchanged, except for a preview."""
        head = self._head(chunk)
        info = chunk_info_record(self.size, chunk.start_ns, chunk.end_ns, chunk.counts)
        # Space for the index is reserved with each chunk, so that the bag can be completed on a full disk.
        self._index_bytes += len(head) + len(info)
        try:
            self._append(_records(head, chunk, self._compression))
        except OSError:
            self._index_bytes -= len(head) + len(info)
            raise
        self._known.update(chunk.entries)
        self._infos.append(info)

    def preview(self, chunk: Chunk) -> None:
        """Write a chunk that is still growing; the complete chunk will overwrite it. Raises OSError, like `append`.

        A preview is never compressed, so it stays readable while a longer preview is written over it.
        """
        self._put(_records(self._head(chunk), chunk, Compression.NONE))

    def sync(self) -> None:
        """Force the file onto the disk (fsync). Raises OSError, for example if the file was deleted."""
        os.fsync(self._file.fileno())
        if os.fstat(self._file.fileno()).st_nlink == 0:
            raise FileNotFoundError("the file was deleted")

    def finish(self) -> None:
        """Write the index, once. Raises OSError; then the file is unchanged, and this may be called again."""
        if self._complete:
            return
        # Connections are sorted, because readers use the order of connections for messages with equal stamps. The order
        # must be the same in all parts.
        known = sorted(self._known, key=lambda connection: connection.number)
        position, self._index_bytes = self.size, 0
        self._append(b"".join((*map(connection_record, known), *self._infos)))
        try:
            self._write(len(MAGIC), bag_header(position, len(known), len(self._infos)))
        except OSError:
            self.size = position
            raise
        self._complete = True

    def rewind(self) -> None:
        """Drop everything after the kept bytes, which another process has written."""
        self._cut()

    def close(self) -> None:
        """Close the file without completing it."""
        self._file.close()

    def _head(self, chunk: Chunk) -> bytes:
        """Return the records of connections that are new to the file."""
        return b"".join(connection_record(connection) for connection in chunk.entries if connection not in self._known)

    def _append(self, data: bytes) -> None:
        """Write data after the kept bytes. From then on, these data belong to the kept bytes."""
        self._put(data)
        self.size += len(data)
        if self._end > self.size:
            # The preview was longer than the compressed chunk.
            self._cut()
            self._set_aside(0)

    def _put(self, data: bytes) -> None:
        """Write after the kept bytes. Raises OSError; then the file ends with the kept bytes."""
        self._set_aside(len(data))
        try:
            self._write(self.size, data)
        except OSError:
            self._cut()
            raise
        self._end = max(self._end, self.size + len(data))

    def _write(self, position: int, data: bytes) -> None:
        self._file.seek(position)
        view = memoryview(data)
        while view:
            view = view[self._file.write(view) :]

    def _cut(self) -> None:
        """Truncate the file to the kept bytes."""
        self._file.truncate(self.size)
        self._end = self.size

    def _set_aside(self, size: int) -> None:
        """Reserve disk space for `size` bytes after the kept bytes, and for the index. Raises OSError."""
        if size + self._index_bytes:
            reserve_space(self._file.fileno(), self.size, size + self._index_bytes)


def _records(head: bytes, chunk: Chunk, compression: Compression) -> bytes:
    """Return a chunk with its index data records; without them, ROS's `reindex` rejects the last chunk of a file."""
    index = (index_record(connection, chunk.moved_entries(connection, len(head))) for connection in chunk.entries)
    return b"".join((*chunk_pieces(head + chunk.data, compression), *index))


class BagFile:
    """A bag that one thread writes message by message; stamps do not have to be in order.

    Args:
        path: path of the file, which must not exist.
        compression: compression of the chunks.

    Raises:
        OSError: raised by every method. After that, `close` may be called again; it leaves out data that could not be
            written.
    """

    def __init__(self, path: Path, compression: Compression = Compression.NONE) -> None:
        self._file = ChunkFile(path, compression)
        self._chunks = ChunkBuilder()
        self._connections = 0

    def connect(
        self, topic: str, msgtype: str, md5: str, definition: str, caller: str | None, latching: bool | None
    ) -> BagConnection:
        """Add a publisher of a topic; see `BagConnection` for the arguments."""
        self._connections += 1
        return BagConnection(self._connections - 1, topic, msgtype, md5, definition, caller, latching)

    def write(self, connection: BagConnection, stamp_ns: int, data: bytes) -> None:
        """Write a message."""
        if not self._chunks.accepts(stamp_ns):
            self._file.append(self._chunks.take())
        self._chunks.add(connection, stamp_ns, data)

    def close(self) -> None:
        """Write the last chunk and the index, and close the file."""
        if self._chunks.size:
            self._file.append(self._chunks.take())
        self._file.finish()
        self._file.sync()
        self._file.close()
