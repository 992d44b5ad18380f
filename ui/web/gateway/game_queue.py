"""Queue of people who wait until a game can start: first come, first served."""

from ui.web.pool.pool import WorkerPool

LONGEST_WAIT = 1800.0
"""Seconds after which a person who waits for a game is asked to come back later."""


class GameQueue:
    """Queue for the games of one pool.

    Args:
        pool: the pool.

    Attributes:
        is_closed: True after the server was asked to end after its games; then no game starts any more.
    """

    def __init__(self, pool: WorkerPool) -> None:
        self.is_closed = False
        self._pool = pool
        self._waiting: list[str] = []

    def enter(self, key: str) -> None:
        """Let the person of a game wait behind all others."""
        self._waiting.append(key)

    def leave(self, key: str) -> None:
        """Stop waiting, because the game starts or the person does not want to wait."""
        self._waiting.remove(key)

    def before(self, key: str) -> int:
        """Return the number of people who wait and have come earlier."""
        return self._waiting.index(key)

    def admits(self, key: str) -> bool:
        """Return True if the game can start now."""
        return not self.is_closed and self._pool.free > self.before(key)

    @property
    def spare(self) -> int:
        """Number of games that can start now in addition to the games of all people who wait in this queue."""
        return 0 if self.is_closed else max(self._pool.free - len(self._waiting), 0)
