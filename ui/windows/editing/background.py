"""Jobs that run in a separate thread, one job at a time."""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor

from PySide6.QtCore import QObject, Signal, Slot


class BackgroundWorker(QObject):
    """Thread for one kind of job. While a job runs, only the newest waiting job is kept.

    Attributes:
        busy: True while a job runs.
        done: signal with the result of a job, in the window's thread.
    """

    done = Signal(object)
    _ended = Signal(object)

    def __init__(self, parent: QObject, name: str) -> None:
        super().__init__(parent)
        self._pool = ThreadPoolExecutor(1, thread_name_prefix=name)
        self._waiting: Callable[[], object] | None = None
        self.busy = False
        self._ended.connect(self._finish)

    def ask(self, work: Callable[[], object]) -> None:
        """Run this job next; it replaces the waiting job."""
        self._waiting = work
        if not self.busy:
            self._begin()

    def close(self) -> None:
        """Wait for the end of the current job, and drop the waiting job."""
        self._waiting = None
        # The window closes, so it must not receive the result of the current job.
        self._ended.disconnect(self._finish)
        self._pool.shutdown(wait=True, cancel_futures=True)

    def _begin(self) -> None:
        work, self._waiting = self._waiting, None
        if work is not None:
            self.busy = True
            # The callback runs in the worker's thread; the queued signal moves the result to the window's thread.
            self._pool.submit(work).add_done_callback(self._ended.emit)

    @Slot(object)
    def _finish(self, future: "Future[object]") -> None:
        self.busy = False
        self._begin()
        self.done.emit(future.result())
