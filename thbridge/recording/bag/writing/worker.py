"""Jobs that may wait for a disk. A separate thread does these jobs in order, so that the session does not wait."""

import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Protocol

Job = Callable[[], None]


class JobQueue(Protocol):
    """Queue of jobs, which are done one after another. After a job has failed, no further job is done.

    Attributes:
        failure: the error of the failed job.
        waiting: bytes in memory for the pending jobs.
    """

    failure: Exception | None
    waiting: int

    def submit(self, job: Job, size: int = 0) -> None:
        """Add a job, which is done now or later; `size` is the number of bytes that the job keeps in memory."""

    def oldest_wait(self) -> float:
        """Return the seconds that the oldest pending job has waited; 0 if there is none."""

    def wait(self, size: int, seconds: float) -> bool:
        """Wait until at most `size` bytes are pending; with 0, until no job is pending.

        Returns:
            True if this was reached; False if `seconds` passed first.
        """

    def end(self) -> None:
        """Accept no more jobs, and drop the waiting jobs; the running job is finished."""

    def restart(self) -> None:
        """Continue in a copy of the process, which was made while no job was waiting."""


class WorkerThread:
    """A queue with its own thread, which ends with the program.

    Args:
        name: name of the thread.
        clock: monotonic clock, seconds.
    """

    def __init__(self, name: str, clock: Callable[[], float] = time.monotonic) -> None:
        self.failure: Exception | None = None
        self.waiting = 0
        self._clock = clock
        self._jobs: deque[tuple[float, int, Job]] = deque()
        self._ended = False
        self._name = name
        self.restart()

    def restart(self) -> None:
        """Start the thread. A copy of the process has no thread, and its lock may belong to the thread of the other."""
        self._changed = threading.Condition()
        threading.Thread(target=self._run, name=self._name, daemon=True).start()

    def submit(self, job: Job, size: int = 0) -> None:
        """Add a job after the waiting jobs."""
        with self._changed:
            if self.failure is None and not self._ended:
                self._jobs.append((self._clock(), size, job))
                self.waiting += size
                self._changed.notify_all()

    def oldest_wait(self) -> float:
        """Return the seconds that the oldest pending job has waited; 0 if there is none."""
        with self._changed:
            return self._clock() - self._jobs[0][0] if self._jobs else 0.0

    def wait(self, size: int, seconds: float) -> bool:
        """Wait until at most `size` bytes are pending (with 0, no jobs); return False after `seconds`."""
        with self._changed:
            return self._changed.wait_for(lambda: self.waiting <= size and (size > 0 or not self._jobs), seconds)

    def end(self) -> None:
        """Accept no more jobs, and drop the waiting jobs; the running job is finished."""
        with self._changed:
            self._ended = True
            self._changed.notify_all()

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._jobs or self._ended)
                if self._ended:
                    self._forget()
                    return
                _, size, job = self._jobs[0]
            try:
                job()
            except Exception as error:  # The owner reads it from `failure`.
                with self._changed:
                    self.failure = error
                    self._forget()
                return
            with self._changed:
                self._jobs.popleft()
                self.waiting -= size
                self._changed.notify_all()

    def _forget(self) -> None:
        self._jobs.clear()
        self.waiting = 0
        self._changed.notify_all()
