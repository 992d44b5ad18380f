"""Tasks of a batch: work for any process that can access the batch's folder."""

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
        faults: sentences about failed games, and about games that gave another result when repeated.
        cpu_seconds: total processor time.
        left: number of games that a further call has to play. The outcome of the last call counts all games.
    """

    games: int
    failed: int
    faults: tuple[str, ...]
    cpu_seconds: float
    left: int = 0


class BatchTask(Protocol):
    """Work that leaves its result in a file. Tasks are sent to other processes, so they can be pickled."""

    @property
    def urgent(self) -> bool:
        """True for a task that comes before others."""

    def carry_out(self, most: int | None = None) -> TaskOutcome:
        """Carry out the task, unless its result exists; the result is on disk when this returns.

        Args:
            most: number of games after which it may return even if games are left. If None, it plays all games.

        Raises:
            BadFile: the folder cannot be written.
        """


def worker_name() -> str:
    """Return the name of this process, unique among all processes that write to a folder."""
    return f"{socket.gethostname()}:{os.getpid()}"
