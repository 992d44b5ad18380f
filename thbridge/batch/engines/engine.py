"""Interface between a batch and the workers that run its tasks."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from thbridge.batch.engines.batch_task import BatchTask, TaskOutcome

TaskT = TypeVar("TaskT", bound=BatchTask)


@dataclass(frozen=True, slots=True)
class FinishedTask(Generic[TaskT]):
    """A finished task, or a task whose worker died.

    Attributes:
        task: the task.
        outcome: outcome of the task, or None if the worker died.
        worker: name of the worker, for `Engine.submit`.
        cause: sentence about the reason why workers died meanwhile, or None if no worker died or the reason is unknown.
    """

    task: TaskT
    outcome: TaskOutcome | None
    worker: str
    cause: str | None = None


class EngineFailed(Exception):  # noqa: N818 - people read it as a sentence
    """Failure after which an engine cannot continue. `str()` gives the reason as a sentence."""


class Engine(Protocol[TaskT]):
    """Runner of tasks on several workers. As a context manager, it ends the workers on exit."""

    def submit(self, task: TaskT, avoid: str | None = None) -> None:
        """Accept a task. The caller may call this method while `finished` runs, too.

        Args:
            task: the task.
            avoid: name of a worker that should not run the task if there is another worker.
        """

    def finished(self) -> Iterator[FinishedTask[TaskT]]:
        """Yield each task when it ends, until all tasks have ended.

        Raises:
            BadFile: a worker cannot write the batch's folder.
            EngineFailed: no worker can continue.
        """

    def __enter__(self) -> "Engine[TaskT]": ...

    def __exit__(self, *ended: object) -> None: ...
