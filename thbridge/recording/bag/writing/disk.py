"""The disk to which threads write a bag: its delays, and the rescue of a recording when the disk fails."""

from collections.abc import Callable
from pathlib import Path

from thbridge.files.disk.synced import make_folder
from thbridge.files.errors import BadFile
from thbridge.recording.bag.options import Compression, SplitLimits
from thbridge.recording.bag.writing.formats import ROS1_BAG, BagFormat
from thbridge.recording.bag.writing.parts import QueuedChunk, SplitBagWriter
from thbridge.recording.bag.writing.worker import JobQueue
from thbridge.recording.claims import claim, release
from thbridge.recording.recordings import active_of, finished_of, is_folder, part_of

BEHIND_SECONDS = 10.0
"""Maximum delay of the disk, in seconds. If the delay is longer, the recording ends."""

WAITING_BYTES = 2 * 2**20
"""If more bytes than this wait for the disk, the session waits, too. bz2 packs this number of bytes in 0.1 s."""

CLOSE_SECONDS = 60.0
"""Longest wait for the disk at the end of a recording."""

ALMOST_ALL = "the file has everything except the last second"


class BagNotWritten(BadFile):
    """A recording could not begin or continue; the message names the file, and the data in it."""

    def __init__(self, path: Path, problem: str, remedy: str) -> None:
        super().__init__(path, problem, remedy)

    def __reduce__(self) -> tuple[type["BagNotWritten"], tuple[Path, str, str]]:  # type: ignore[override]  # fewer parts
        return (type(self), (self.path, self.problem, self.remedy))


class BagDisk:
    """Files of a bag and the threads that write them.

    Args:
        path: path of the finished bag.
        compression: compression of the bag's chunks.
        splitting: limits after which the recording continues in another file.
        make_queue: factory of the two job queues, given a name for each.
        form: format of the files.

    Raises:
        BagNotWritten: the bag exists already, or the folder cannot be written to.
    """

    def __init__(
        self,
        path: Path,
        compression: Compression,
        splitting: SplitLimits,
        make_queue: Callable[[str], JobQueue],
        form: BagFormat = ROS1_BAG,
    ) -> None:
        self._path = path
        try:
            claim(path)
        except BadFile as taken:
            raise BagNotWritten(path, taken.problem, taken.remedy) from None
        except OSError as error:
            raise BagNotWritten(path, _reason(error), "name a folder that exists and may be written to") from error
        _refuse_taken(path)
        self._syncing = make_queue("bag sync")
        self._writing = make_queue("bag writer")
        try:
            if is_folder(path):
                make_folder(path)
            self._parts = SplitBagWriter(path, compression, splitting, self._syncing, form)
        except OSError as error:
            self.end()
            raise BagNotWritten(path, _reason(error), "name a folder that exists and may be written to") from error

    @property
    def failure(self) -> Exception | None:
        """Error of the thread that failed; None if no thread has failed."""
        return self._writing.failure or self._syncing.failure

    @property
    def behind(self) -> float:
        """Seconds that the oldest pending job has waited."""
        return max(self._writing.oldest_wait(), self._syncing.oldest_wait())

    @property
    def last(self) -> Path:
        """Final path of the last bag."""
        return self._parts.last

    def append(self, piece: QueuedChunk) -> None:
        """Write a chunk."""
        self._writing.submit(lambda: self._parts.append(piece), len(piece.chunk.data))

    def sync(self, growing: QueuedChunk | None) -> None:
        """Force everything onto the disk, including the growing chunk if there is one."""
        self._writing.submit(self._parts.sync if growing is None else lambda: self._parts.preview(growing))

    def keep_up(self) -> None:
        """Wait for the disk if a session runs at full speed. In real time, it does not wait: few bytes are pending."""
        self._writing.wait(WAITING_BYTES, BEHIND_SECONDS)

    @property
    def is_idle(self) -> bool:
        """True if everything is written and synced so far."""
        return self._writing.wait(0, 0.0) and self._syncing.wait(0, 0.0)

    def rewind(self) -> None:
        """Continue in a copy of the process that was made while `is_idle`; drop what the process has written since."""
        self._writing.restart()
        self._syncing.restart()
        self._parts.rewind()

    def finish(self) -> bool:
        """Complete the files; return False if that takes too long."""
        self._writing.submit(self._parts.finish)
        return self._writing.wait(0, CLOSE_SECONDS) and self._syncing.wait(0, CLOSE_SECONDS)

    def saved(self, failure: Exception) -> Exception:
        """Save what can be saved, and return the error to raise."""
        in_time = self._writing.wait(0, CLOSE_SECONDS)
        self.end()
        if not (in_time and self._syncing.wait(0, CLOSE_SECONDS)):
            return self.stuck()
        if not isinstance(failure, OSError):
            self._parts.abandon()
            return failure
        try:
            self._parts.salvage()
        except OSError:
            self._parts.abandon()
            return self._left(_reason(failure), f"{ALMOST_ALL}: free disk space, then")
        return BagNotWritten(
            self._parts.last, _reason(failure), f"{ALMOST_ALL}; free disk space before recording again"
        )

    def stuck(self) -> BagNotWritten:
        """Abandon the threads of a disk that does not respond, and return the error to raise."""
        self.end()
        problem = f"the disk has not responded for {CLOSE_SECONDS:.0f} s"
        return self._left(problem, "the file has all data that reached the disk; when the disk works again,")

    def _left(self, problem: str, remedy: str) -> BagNotWritten:
        """Return the error for a file that could not be completed, with its remedy."""
        active = self._parts.unfinished
        if active is None or not active.exists():
            return BagNotWritten(self._path, problem, "record again, into a folder that no program deletes")
        return BagNotWritten(active, problem, f"{remedy} run `thbridge bag reindex {active}`")

    def end(self) -> None:
        """End the threads, and release the name for other recordings."""
        self._writing.end()
        self._syncing.end()
        release(self._path)


def _refuse_taken(path: Path) -> None:
    """Raise BagNotWritten if there is a recording with this name."""
    finished = finished_of(path)
    active = [file for file in (active_of(path), active_of(part_of(path, 0))) if file.exists()]
    if finished:
        remedy = "choose another name, or move this file to another folder"
        raise BagNotWritten(finished[0], "this file already exists", remedy)
    if active:
        raise BagNotWritten(
            active[0],
            "a recording of this name is being written, or was cut off",
            f"save it with `thbridge bag reindex {active[0]}`, or choose another name",
        )


def _reason(error: OSError) -> str:
    return (error.strerror or str(error)).lower()
