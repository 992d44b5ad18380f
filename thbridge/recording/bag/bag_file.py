"""A file of chunks that becomes a ROS 1 bag, safe from kills and full disks."""

import errno
import os
from pathlib import Path

from thbridge.recording.bag.chunks import Chunk, ChunkBuilder
from thbridge.recording.bag.disk_room import reserve_space
from thbridge.recording.bag.records import (
    MAGIC,
    BagConnection,
    Compression,
    bag_header,
    chunk_info_record,
    chunk_record,
    connection_record,
    index_record,
)

NAMELESS = ".new"
"""Ending of a file that does not hold a bag's first record yet."""


class ChunkFile:
    """A bag that grows by whole chunks. A chunk reaches it whole or, with an OSError, not at all.

    Each chunk begins with the records of connections that are new to the file, so there is none that no message uses
    (it would give `rosbag info` a negative duration). Memory grows with the chunks, not the messages.

    Args:
        path: of the file; it may not exist yet.
        compression: of the chunks.

    Attributes:
        path: of the file.
        size: bytes of the chunks so far, with the file's head.

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
        # It gets its name when it is a bag: a kill in between leaves no empty one.
        nameless = path.with_name(path.name + NAMELESS)
        self._file = nameless.open("wb", buffering=0)
        try:
            self._append(MAGIC + bag_header(0, 0, 0))
            nameless.rename(path)
        except OSError:
            self._file.close()
            nameless.unlink(missing_ok=True)
            raise

    def append(self, chunk: Chunk) -> None:
        """Add a chunk. Raises OSError; then the file is as it was, but for what was previewed."""
        head = self._head(chunk)
        info = chunk_info_record(self.size, chunk.start_ns, chunk.end_ns, chunk.counts)
        # Even when the disk is full there is room for the index.
        self._index_bytes += len(head) + len(info)
        try:
            self._append(_records(head, chunk, self._compression))
        except OSError:
            self._index_bytes -= len(head) + len(info)
            raise
        self._known.update(chunk.entries)
        self._infos.append(info)

    def preview(self, chunk: Chunk) -> None:
        """Put down a chunk that is still growing where its longer self will be. Raises OSError, like `append`.

        It is never compressed: what is on the disk stays readable while more of it is written over it.
        """
        self._put(_records(self._head(chunk), chunk, Compression.NONE))

    def sync(self) -> None:
        """Force the file onto the disk. Raises OSError, also when somebody deleted the file."""
        os.fsync(self._file.fileno())
        if os.fstat(self._file.fileno()).st_nlink == 0:
            raise FileNotFoundError("the file was deleted")

    def finish(self) -> None:
        """Write the index, once. Raises OSError; then the file is as it was, and this can be tried again."""
        if self._complete:
            return
        # Readers order messages of one stamp by their connections here; so all parts of a recording are read alike.
        known = sorted(self._known, key=lambda connection: connection.number)
        position, self._index_bytes = self.size, 0
        self._append(b"".join((*map(connection_record, known), *self._infos)))
        try:
            self._write(len(MAGIC), bag_header(position, len(known), len(self._infos)))
        except OSError:
            self.size = position
            raise
        self._complete = True

    def close(self) -> None:
        """Close the file as it is."""
        self._file.close()

    def _head(self, chunk: Chunk) -> bytes:
        """What a chunk has to say of connections before its messages."""
        return b"".join(connection_record(connection) for connection in chunk.entries if connection not in self._known)

    def _append(self, data: bytes) -> None:
        """Write behind all that is kept, and keep it."""
        self._put(data)
        self.size += len(data)
        if self._end > self.size:
            # What was previewed was longer than its compressed self.
            self._cut()
            self._set_aside(0)

    def _put(self, data: bytes) -> None:
        """Write behind all that is kept. Raises OSError; then nothing stays there."""
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
        """Drop what is not kept."""
        self._file.truncate(self.size)
        self._end = self.size

    def _set_aside(self, size: int) -> None:
        """Have room for so many bytes behind all that is kept, and for the index behind them. Raises OSError."""
        if size + self._index_bytes:
            reserve_space(self._file.fileno(), self.size, size + self._index_bytes)


def _records(head: bytes, chunk: Chunk, compression: Compression) -> bytes:
    """A chunk and where its messages are. ROS's `reindex` takes no last chunk that does not say so."""
    index = (index_record(connection, chunk.moved_entries(connection, len(head))) for connection in chunk.entries)
    return b"".join((chunk_record(head + chunk.data, compression), *index))


class BagFile:
    """A bag being written by one thread, message by message; stamps may go back.

    Args:
        path: of the file; it may not exist yet.
        compression: of the chunks.

    Raises:
        OSError: from every method; `close` can be tried again and then leaves out what found no place.
    """

    def __init__(self, path: Path, compression: Compression = Compression.NONE) -> None:
        self._file = ChunkFile(path, compression)
        self._chunks = ChunkBuilder()
        self._connections = 0

    def connect(
        self, topic: str, msgtype: str, md5: str, definition: str, caller: str | None, latching: bool | None
    ) -> BagConnection:
        """Announce a publisher of a topic; see `Connection` for the arguments."""
        self._connections += 1
        return BagConnection(self._connections - 1, topic, msgtype, md5, definition, caller, latching)

    def write(self, connection: BagConnection, stamp_ns: int, data: bytes) -> None:
        """Write a message."""
        if not self._chunks.accepts(stamp_ns):
            self._file.append(self._chunks.take())
        self._chunks.add(connection, stamp_ns, data)

    def close(self) -> None:
        """End the open chunk, write the index and close the file."""
        if self._chunks.size:
            self._file.append(self._chunks.take())
        self._file.finish()
        self._file.sync()
        self._file.close()
