"""A ROS 1 bag that is written chunk by chunk, so that little is lost if the program is killed or the disk is full."""

import errno
import os
from collections import Counter
from collections.abc import Collection
from pathlib import Path

from thbridge.recording.bag.options import Compression
from thbridge.recording.bag.records import BagConnection
from thbridge.recording.bag.writing.chunks import Chunk, ChunkBuilder
from thbridge.recording.bag.writing.disk_room import reserve_space
from thbridge.recording.bag.writing.formats import ROS1_BAG, BagFormat

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
        form: format of the file.

    Attributes:
        path: path of the file.
        size: bytes of the chunks so far, including the file's first record.
        has_preview: True if a preview follows the chunks; see `preview`.

    Raises:
        OSError: the file cannot be created.
    """

    def __init__(self, path: Path, compression: Compression = Compression.NONE, form: BagFormat = ROS1_BAG) -> None:
        self.path = path
        self.size = 0
        self.has_preview = False
        self._compression = compression
        self._form = form
        self._counts: Counter[BagConnection] = Counter()
        self._times: tuple[int, int] | None = None
        self._infos: list[bytes] = []
        self._index_bytes = 0
        self._end = 0
        self._tail = form.tail
        self._complete = False
        if path.exists():
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(path))
        # The file gets its name only with its first record, so that a killed program never leaves an invalid bag.
        nameless = path.with_name(path.name + NAMELESS)
        nameless.unlink(missing_ok=True)
        self._file = nameless.open("xb", buffering=0)
        try:
            self._append(form.beginning)
            nameless.rename(path)
        except OSError:
            self._file.close()
            nameless.unlink(missing_ok=True)
            raise

    def append(self, chunk: Chunk) -> None:
        """Add a chunk. Raises OSError; then the file is unchanged, except for a preview."""
        packed = self._form.packed(self.size, chunk, self._known(), self._compression)
        # Space for the index is reserved with each chunk, so that the bag can be completed on a full disk.
        self._index_bytes += packed.index_bytes
        try:
            self._append(packed.data)
        except OSError:
            self._index_bytes -= packed.index_bytes
            raise
        self.has_preview = False
        self._counts.update(chunk.counts)
        self._infos.append(packed.info)
        start, end = self._times or (chunk.start_ns, chunk.end_ns)
        self._times = min(start, chunk.start_ns), max(end, chunk.end_ns)

    def preview(self, chunk: Chunk) -> None:
        """Write a chunk that is still growing; the complete chunk will overwrite it. Raises OSError, like `append`.

        A preview is never compressed, so it stays readable while a longer preview is written over it.
        """
        self._put(self._form.packed(self.size, chunk, self._known(), Compression.NONE).data)
        self.has_preview = True

    def sync(self) -> None:
        """Force the file onto the disk (fsync). Raises OSError, for example if the file was deleted."""
        os.fsync(self._file.fileno())
        if os.fstat(self._file.fileno()).st_nlink == 0:
            raise FileNotFoundError("the file was deleted")

    def finish(self) -> None:
        """Write the index, once. Raises OSError; then the file is unchanged, and this may be called again."""
        if self._complete:
            return
        position, self._index_bytes = self.size, 0
        tail, self._tail = self._tail, b""
        try:
            self._append(self._form.end(position, self._counts, self._infos, self._times))
            beginning = self._form.final_beginning(position, len(self._counts), len(self._infos))
            if beginning != self._form.beginning:
                self._write(0, beginning)
        except OSError:
            self.size, self._tail = position, tail
            raise
        self._complete = True

    def rewind(self) -> None:
        """Drop everything after the kept bytes, which another process has written."""
        self._cut()

    def close(self) -> None:
        """Close the file without completing it."""
        self._file.close()

    def _known(self) -> Collection[BagConnection]:
        """Return the connections of the file so far, in the order of their records."""
        return self._counts.keys()

    def _append(self, data: bytes) -> None:
        """Write data after the kept bytes. From then on, these data belong to the kept bytes."""
        self._put(data)
        self.size += len(data)
        if self._end > self.size + len(self._tail):
            # The preview was longer than the compressed chunk.
            self._end = self.size + len(self._tail)
            self._file.truncate(self._end)
            self._set_aside(0)

    def _put(self, data: bytes) -> None:
        """Write after the kept bytes. Raises OSError; then the file ends with the kept bytes."""
        data += self._tail
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


class BagFile:
    """A bag that one thread writes message by message; stamps do not have to be in order.

    Args:
        path: path of the file, which must not exist.
        compression: compression of the chunks.
        form: format of the file.

    Raises:
        OSError: raised by every method. After that, `close` may be called again; it leaves out data that could not be
            written.
    """

    def __init__(self, path: Path, compression: Compression = Compression.NONE, form: BagFormat = ROS1_BAG) -> None:
        self._file = ChunkFile(path, compression, form)
        self._chunks = ChunkBuilder(form.layout)
        self._next = form.first_number

    def connect(
        self, topic: str, msgtype: str, md5: str, definition: str, caller: str | None, latching: bool | None
    ) -> BagConnection:
        """Add a publisher of a topic; see `BagConnection` for the arguments."""
        self._next += 1
        return BagConnection(self._next - 1, topic, msgtype, md5, definition, caller, latching)

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
