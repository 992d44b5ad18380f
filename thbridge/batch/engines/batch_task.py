"""Interface of a task of a batch. Any process with access to the batch's folder can run the task."""

import os
import socket
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, slots=True)
class TaskOutcome:
    """Outcome of a task.

    Attributes:
        games: number of games.
        failed: number of games without a result.
        faults: sentences about failed games, and about games with another result in a repetition.
        cpu_seconds: total processor time.
        left: number of games for a further call. The outcome of the last call counts all games.
    """

    games: int
    failed: int
    faults: tuple[str, ...]
    cpu_seconds: float
    left: int = 0


class BatchTask(Protocol):
    """A task that writes its result to a file. Tasks can be pickled, because they are sent to other processes."""

    @property
    def urgent(self) -> bool:
        """True for a task with priority over other tasks."""

    def carry_out(self, most: int | None = None) -> TaskOutcome:
        """Carry out the task, unless its result exists. The result is on the disk when this function returns.

        Args:
            most: number of games after which the function may return. If None, it plays all games.

        Raises:
            BadFile: the folder cannot be written.
        """


def worker_name() -> str:
    """Return the name of this process. It is unique among all processes that write to a folder."""
    return f"{socket.gethostname()}:{os.getpid()}"
