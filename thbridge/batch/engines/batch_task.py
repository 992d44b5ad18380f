"""Tasks of a batch: work that any process can do which sees the batch's folder."""

import os
import socket
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, slots=True)
class TaskOutcome:
    """Outcome of a task.

    Attributes:
        games: number of games.
        failed: number of those that have no result.
        faults: sentences about these, and about games that were not the same again.
        cpu_seconds: processor time of all of it.
        left: games that are left for a further call, whose outcome then counts all games.
    """

    games: int
    failed: int
    faults: tuple[str, ...]
    cpu_seconds: float
    left: int = 0


class BatchTask(Protocol):
    """Work for a worker, which leaves its result in a file. It is sent to other processes, so it can be pickled."""

    @property
    def urgent(self) -> bool:
        """True for a task that comes before others."""

    def carry_out(self, most: int | None = None) -> TaskOutcome:
        """Do it, unless its result is there; the result is on the disk when this returns.

        Args:
            most: games after which it may return with others left; None: all.

        Raises:
            BadFile: the folder cannot be written.
        """


def worker_name() -> str:
    """Return the name of this process among all that write into a folder."""
    return f"{socket.gethostname()}:{os.getpid()}"
