"""The files of a recording that is being written: one file, or several if the recording is split."""

from dataclasses import dataclass
from pathlib import Path

from thbridge.files.disk.synced import sync_folder
from thbridge.recording.bag.options import Compression, SplitLimits
from thbridge.recording.bag.records import BagConnection
from thbridge.recording.bag.writing.bag_file import ChunkFile
from thbridge.recording.bag.writing.chunks import Chunk, ChunkBuilder
from thbridge.recording.bag.writing.formats import ROS1_BAG, BagFormat
from thbridge.recording.bag.writing.worker import JobQueue
from thbridge.recording.recordings import ACTIVE, active_of, is_folder, part_of


@dataclass(frozen=True, slots=True)
class QueuedChunk:
    """A chunk with the latched messages that are needed if a new file begins with it.

    Attributes:
        chunk: the chunk.
        latched: the last message of every latched topic before the chunk.
        period: number of the chunk's period of `SplitLimits.duration_ns`, from 0.
    """

    chunk: Chunk
    latched: tuple[tuple[BagConnection, bytes], ...]
    period: int


class SplitBagWriter:
    """Writer of chunks into one bag, or into several bags one after another, for one thread at a time.

    Each further file begins with the latched messages so far, with the stamp of its first message.

    Args:
        path: path of the bag, from which the names of parts are made.
        compression: compression of the chunks.
        splitting: limits of a file.
        syncing: queue of the jobs that force files onto the disk.
        form: format of the files.

    Raises:
        OSError: the first file cannot be created.
    """

    def __init__(
        self,
        path: Path,
        compression: Compression,
        splitting: SplitLimits,
        syncing: JobQueue,
        form: BagFormat = ROS1_BAG,
    ) -> None:
        self._path = path
        self._form = form
        self._compression = compression
        self._splitting = splitting
        self._syncing = syncing
        self._number = self._period = 0
        self._repeated = 0
        self._full = False
        self._end_ns = 0
        self._open: list[ChunkFile] = []
        self._file = self._begin(0)

    @property
    def unfinished(self) -> Path | None:
        """Path of the first file that does not have its final name yet."""
        return self._open[0].path if self._open else None

    @property
    def last(self) -> Path:
        """Final path of the last bag."""
        return _finished(self._file)

    def append(self, piece: QueuedChunk) -> None:
        """Add a chunk, and sync it if it overwrites a preview. Raises OSError; then all earlier chunks are kept."""
        self._turn_to(piece)
        overwrites = self._file.has_preview
        self._file.append(piece.chunk)
        if overwrites:
            self.sync()  # A power failure before the sync may cost the chunk, also the part that was on the disk.
        own_size = self._file.size - self._repeated
        self._full = self._splitting.size is not None and own_size > self._splitting.size
        self._end_ns = piece.chunk.end_ns

    def preview(self, piece: QueuedChunk) -> None:
        """Force all earlier chunks and a chunk that is still growing onto the disk. Raises OSError."""
        self._turn_to(piece)
        self._file.preview(piece.chunk)
        self.sync()

    def sync(self) -> None:
        """Force everything onto the disk, unless an earlier call is still running."""
        if not self._syncing.oldest_wait():
            self._syncing.submit(self._file.sync)

    def finish(self) -> None:
        """Complete the file; after it is on the disk, it gets its final name. Raises OSError."""
        file = self._file
        file.finish()
        self._syncing.submit(lambda: self._settle(file))

    def salvage(self) -> None:
        """Complete the open files after an error, in this thread. If this raises OSError, it may be called again."""
        for file in tuple(self._open):
            file.finish()
            self._settle(file)

    def rewind(self) -> None:
        """Drop what another process has written into the file."""
        self._file.rewind()

    def abandon(self) -> None:
        """Close all open files without completing them."""
        for file in self._open:
            file.close()

    def _turn_to(self, piece: QueuedChunk) -> None:
        """Begin another file if the chunk does not belong to the present file."""
        # Messages with one stamp stay in one file, so that readers see them in order.
        if not (self._full and piece.chunk.start_ns > self._end_ns) and piece.period == self._period:
            return
        self.finish()
        self._file = self._begin(self._number + 1)
        self._number, self._period, self._full = self._number + 1, piece.period, False
        opening = ChunkBuilder(self._form.layout)
        for connection, data in piece.latched:
            opening.add(connection, piece.chunk.start_ns, data)
        if opening.size:
            self._file.append(opening.take())
        self._repeated = self._file.size

    def _begin(self, number: int) -> ChunkFile:
        path = part_of(self._path, number) if self._splitting.wanted or is_folder(self._path) else self._path
        _refuse_taken(path)
        file = ChunkFile(active_of(path), self._compression, self._form)
        self._open.append(file)
        return file

    def _settle(self, file: ChunkFile) -> None:
        """Give a complete file its final name."""
        file.sync()
        name = _finished(file)
        _refuse_taken(name)
        file.path.replace(name)
        sync_folder(name.parent)
        self._open.remove(file)
        file.close()
        if is_folder(self._path) and not self._open:
            # Imported here, because only this form of recordings needs a reader of MCAP and a writer of YAML.
            from thbridge.recording.bag.rosbag2_metadata import write_metadata  # noqa: PLC0415

            write_metadata(self._path)


def _finished(file: ChunkFile) -> Path:
    return file.path.with_name(file.path.name.removesuffix(ACTIVE))


def _refuse_taken(path: Path) -> None:
    if path.exists():
        raise FileExistsError(f"another program has created {path} in the meantime")
