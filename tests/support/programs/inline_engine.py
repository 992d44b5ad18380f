"""Engine that runs tasks in the test's own process."""

from collections import deque
from collections.abc import Callable, Iterator
from typing import Generic, TypeVar

from thbridge.batch.engines.batch_task import BatchTask
from thbridge.batch.engines.engine import FinishedTask

Task = TypeVar("Task", bound=BatchTask)


class InlineEngine(Generic[Task]):
    """Engine that runs tasks in this process.

    It calls `dies` before each task. If this returns True, the worker dies.
    """

    def __init__(self, dies: Callable[[Task], bool] = lambda _task: False) -> None:
        self._dies = dies
        self._waiting: deque[Task] = deque()
        self.carried_out: list[Task] = []

    def submit(self, task: Task, avoid: str | None = None) -> None:
        self._waiting.append(task)

    def finished(self) -> Iterator[FinishedTask[Task]]:
        while self._waiting:
            task = self._waiting.popleft()
            if self._dies(task):
                yield FinishedTask(task, None, "inline")
                continue
            self.carried_out.append(task)
            yield FinishedTask(task, task.carry_out(), "inline")

    def __enter__(self) -> "InlineEngine[Task]":
        return self

    def __exit__(self, *ended: object) -> None: ...
