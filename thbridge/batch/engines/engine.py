"""The seam between a batch and whatever carries out its tasks."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from thbridge.batch.engines.batch_task import BatchTask, TaskOutcome

TaskT = TypeVar("TaskT", bound=BatchTask)


@dataclass(frozen=True, slots=True)
class FinishedTask(Generic[TaskT]):
    """A task that was carried out, or whose worker died.

    Attributes:
        task: the task.
        outcome: None when its worker died.
        worker: name of the worker, as `Engine.submit` takes it.
        cause: sentence on why workers were lost meanwhile; None where none was, or nobody knows.
    """

    task: TaskT
    outcome: TaskOutcome | None
    worker: str
    cause: str | None = None


class EngineFailed(Exception):  # noqa: N818 - it is told to people as a sentence
    """The engine cannot go on; `str` of it is the reason as a sentence."""


class Engine(Protocol[TaskT]):
    """Carries out tasks on its workers; a context manager, which ends them."""

    def submit(self, task: TaskT, avoid: str | None = None) -> None:
        """Take a task; it may also be called while `finished` runs.

        Args:
            task: the task.
            avoid: name of a worker that shall not do it if there is another.
        """

    def finished(self) -> Iterator[FinishedTask[TaskT]]:
        """Yield tasks as they end, until none is left.

        Raises:
            BadFile: a worker cannot write the batch's folder.
            EngineFailed: there are no workers, or none that can work.
        """

    def __enter__(self) -> "Engine[TaskT]": ...

    def __exit__(self, *ended: object) -> None: ...
