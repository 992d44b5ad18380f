"""Jobs that may wait for a disk, done in order by a separate thread, so that the session does not wait."""

import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Protocol

Job = Callable[[], None]


class JobQueue(Protocol):
    """Does jobs one after another. After a job has failed, no further one is done.

    Attributes:
        failure: the error of the job that failed.
        waiting: bytes that the jobs not done yet keep in memory.
    """

    failure: Exception | None
    waiting: int

    def submit(self, job: Job, size: int = 0) -> None:
        """Have a job done, now or later; `size`: bytes that it keeps in memory."""

    def oldest_wait(self) -> float:
        """Seconds that the oldest job not done yet has waited; 0 when there is none."""

    def wait(self, size: int, seconds: float) -> bool:
        """Wait until no more than `size` bytes wait; with 0, until no job waits.

        Returns:
            True when that is so, False when the time is up.
        """

    def end(self) -> None:
        """Take no more jobs, and drop those that wait; the present one is finished."""


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
        self._changed = threading.Condition()
        self._ended = False
        threading.Thread(target=self._run, name=name, daemon=True).start()

    def submit(self, job: Job, size: int = 0) -> None:
        """Have a job done after those that wait."""
        with self._changed:
            if self.failure is None and not self._ended:
                self._jobs.append((self._clock(), size, job))
                self.waiting += size
                self._changed.notify_all()

    def oldest_wait(self) -> float:
        """Seconds that the oldest job not done yet has waited; 0 when there is none."""
        with self._changed:
            return self._clock() - self._jobs[0][0] if self._jobs else 0.0

    def wait(self, size: int, seconds: float) -> bool:
        """Wait until no more than `size` bytes wait, or with 0 no job waits. Return False when the time is up."""
        with self._changed:
            return self._changed.wait_for(lambda: self.waiting <= size and (size > 0 or not self._jobs), seconds)

    def end(self) -> None:
        """Take no more jobs, and drop those that wait; the present one is finished."""
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
            except Exception as error:  # read from `failure` by the owner
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
