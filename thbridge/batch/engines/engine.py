"""The seam between a sweep and whatever carries out its tasks."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

from thbridge.batch.tasks import SweepTask, TaskOutcome


@dataclass(frozen=True, slots=True)
class FinishedTask:
    """A task that was carried out, or whose worker died.

    Attributes:
        task: the task.
        outcome: None when its worker died.
        worker: name of the worker, as `Engine.submit` takes it.
    """

    task: SweepTask
    outcome: TaskOutcome | None
    worker: str


class EngineFailed(Exception):  # noqa: N818 - it is told to people as a sentence
    """The engine cannot go on; `str` of it is the reason as a sentence."""


class Engine(Protocol):
    """Carries out tasks on its workers; a context manager, which ends them."""

    def submit(self, task: SweepTask, avoid: str | None = None) -> None:
        """Take a task; it may also be called while `finished` runs.

        Args:
            task: the task.
            avoid: name of a worker that shall not do it if there is another.
        """

    def finished(self) -> Iterator[FinishedTask]:
        """Yield tasks as they end, until none is left.

        Raises:
            BadFile: a worker cannot write the sweep's folder.
            EngineFailed: there are no workers, or none that can work.
        """

    def __enter__(self) -> "Engine": ...

    def __exit__(self, *ended: object) -> None: ...
