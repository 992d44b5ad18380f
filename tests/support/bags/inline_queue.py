"""Job queue without a thread, so that a test knows when a job is done."""

from thbridge.recording.bag.writing.worker import Job


class InlineQueue:
    """Queue that does each job at once, in the thread that submits it."""

    def __init__(self) -> None:
        self.failure: Exception | None = None
        self.waiting = 0

    def submit(self, job: Job, size: int = 0) -> None:
        """Do a job; store its exception in `failure`. After a failure, do nothing."""
        if self.failure is None:
            try:
                job()
            except Exception as error:  # the owner reads it from `failure`
                self.failure = error

    def oldest_wait(self) -> float:
        """Return 0: no job ever waits."""
        return 0.0

    def wait(self, size: int, seconds: float) -> bool:
        """Return True: no job ever waits."""
        return True

    def restart(self) -> None:
        """Do nothing: there is no thread."""

    def end(self) -> None:
        """Do nothing: there is no thread."""
