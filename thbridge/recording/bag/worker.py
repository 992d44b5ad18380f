"""Jobs that may have to wait for a disk, done in order by a thread of their own, so that nobody else waits."""

import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Protocol

Job = Callable[[], None]


class JobQueue(Protocol):
    """Does jobs one after another. The first that fails is the last that is done.

    Attributes:
        failure: what it failed with.
        waiting: bytes that jobs not done yet hold on to.
    """

    failure: Exception | None
    waiting: int

    def submit(self, job: Job, size: int = 0) -> None:
        """Have a job done, now or later; `size` says how many bytes it holds on to."""

    def oldest_wait(self) -> float:
        """Seconds that the oldest job not done yet has waited; 0 when there is none."""

    def wait(self, size: int, seconds: float) -> bool:
        """Return when no more than so many bytes wait, with 0 when no job does, or when the time is up.

        Returns:
            Whether that is so.
        """

    def end(self) -> None:
        """Take no more jobs; those that wait are not done any more once the one in hand is."""


class InlineQueue:
    """A lane that does each job at once, in the thread that gives it."""

    def __init__(self) -> None:
        self.failure: Exception | None = None
        self.waiting = 0

    def submit(self, job: Job, size: int = 0) -> None:
        """Do a job."""
        if self.failure is None:
            try:
                job()
            except Exception as error:  # whoever gave the job asks for it
                self.failure = error

    def oldest_wait(self) -> float:
        """Nothing ever waits."""
        return 0.0

    def wait(self, size: int, seconds: float) -> bool:
        """Nothing ever waits."""
        return True

    def end(self) -> None:
        """There is nothing to end."""


class WorkerThread:
    """A lane with a thread of its own, which ends with the program.

    Args:
        name: of the thread.
        clock: seconds that never go back.
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
        """Return when no more than so many bytes wait, with 0 when no job does, or when the time is up."""
        with self._changed:
            return self._changed.wait_for(lambda: self.waiting <= size and (size > 0 or not self._jobs), seconds)

    def end(self) -> None:
        """Take no more jobs; those that wait are not done any more once the one in hand is."""
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
            except Exception as error:  # whoever gave the job asks for it
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
