"""Interface between a batch and the workers that carry out its tasks."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from thbridge.batch.engines.batch_task import BatchTask, TaskOutcome

TaskT = TypeVar("TaskT", bound=BatchTask)


@dataclass(frozen=True, slots=True)
class FinishedTask(Generic[TaskT]):
    """A task that was carried out, or that lost its worker.

    Attributes:
        task: the task.
        outcome: outcome of the task, or None if its worker died.
        worker: name of the worker, for `Engine.submit`.
        cause: sentence on why workers were lost in the meantime, or None if none was lost or the reason is unknown.
    """

    task: TaskT
    outcome: TaskOutcome | None
    worker: str
    cause: str | None = None


class EngineFailed(Exception):  # noqa: N818 - people read it as a sentence
    """Failure after which an engine cannot continue; `str()` gives the reason as a sentence."""


class Engine(Protocol[TaskT]):
    """Engine that carries out tasks on its workers. As a context manager, it ends the workers on exit."""

    def submit(self, task: TaskT, avoid: str | None = None) -> None:
        """Accept a task. This may also be called while `finished` runs.

        Args:
            task: the task.
            avoid: name of a worker that should not carry it out if there is another.
        """

    def finished(self) -> Iterator[FinishedTask[TaskT]]:
        """Yield tasks as they end, until none is left.

        Raises:
            BadFile: a worker cannot write the batch's folder.
            EngineFailed: there are no workers that can work.
        """

    def __enter__(self) -> "Engine[TaskT]": ...

    def __exit__(self, *ended: object) -> None: ...
