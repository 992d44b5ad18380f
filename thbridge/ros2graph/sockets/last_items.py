"""Bounded queues between the event loop and threads, and threads for calls that may wait."""

import logging
import threading
from collections import Counter, deque
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from queue import SimpleQueue
from typing import Generic, TypeAlias, TypeVar

_log = logging.getLogger(__name__)

MOST_BYTES = 64 << 20
"""Maximum number of bytes that wait in a queue."""
_MOST_CLIENTS = 16
"""Maximum number of clients for which calls wait at the same time."""

Job: TypeAlias = Callable[[], object]
_Item = TypeVar("_Item")


class LastItems(Generic[_Item]):
    """Queue that keeps the last items for a consumer on another thread. Any thread may add items.

    At most one call of the consumer is pending. So several queues with the same thread take turns, and a full queue
    does not delay the others.

    Args:
        depth: maximum number of items.
        wake: function that calls its argument on the consumer's thread, after the calls that are already pending.
        consume: consumer of one item.
    """

    def __init__(self, depth: int, wake: Callable[[Job], None], consume: Callable[[_Item], None]) -> None:
        self._depth = max(depth, 1)
        self._wake = wake
        self._consume = consume
        self._items: deque[tuple[_Item, int]] = deque()
        self._bytes = 0
        self._is_awake = False
        self._lock = threading.Lock()
        self.dropped = 0

    def push(self, item: _Item, size: int) -> bool:
        """Add an item with a number of bytes. If the queue is full, drop the oldest items, and return False."""
        with self._lock:
            before = self.dropped
            while self._items and (len(self._items) >= self._depth or self._bytes + size > MOST_BYTES):
                self._bytes -= self._items.popleft()[1]
                self.dropped += 1
            self._items.append((item, size))
            self._bytes += size
            wakes, self._is_awake = not self._is_awake, True
            fits = self.dropped == before
        if wakes:
            self._wake(self._next)
        return fits

    def _next(self) -> None:
        with self._lock:
            item, size = self._items.popleft()
            self._bytes -= size
            remains = self._is_awake = bool(self._items)
        if remains:
            self._wake(self._next)
        self._consume(item)


class CallThread:
    """Thread that makes calls one after the other. Calls that are posted before the start wait for it.

    It is a daemon: a call that never returns does not block the end of the program. Its queue has no lock, so garbage
    collection may post calls.
    """

    def __init__(self, name: str) -> None:
        self._jobs: SimpleQueue[Job | None] = SimpleQueue()
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)

    def start(self) -> None:
        """Begin to make the calls."""
        self._thread.start()

    def post(self, job: Job) -> None:
        """Make a call after the calls that are already posted. This never waits."""
        self._jobs.put(job)

    def end(self, seconds: float) -> bool:
        """Make the posted calls and end. Return False if this takes longer than this number of seconds."""
        self._jobs.put(None)
        self._thread.join(seconds)
        return not self._thread.is_alive()

    def _run(self) -> None:
        while (job := self._jobs.get()) is not None:
            try:
                job()
            except Exception:
                _log.exception("a call failed")


class ClientShares:
    """Amounts that clients use together, up to a total. One client may use a quarter of it, or more for one thing."""

    def __init__(self, total: int) -> None:
        self._total = total
        self._used: Counter[str] = Counter()
        self._lock = threading.Lock()

    def take(self, client: str, amount: int) -> bool:
        """Take an amount for a client. Return False, and take nothing, if this is too much."""
        with self._lock:
            used = self._used[client]
            fits = self._used.total() + amount <= self._total and (not used or used + amount <= self._total // 4)
            if fits:
                self._used[client] += amount
        return fits

    def give_back(self, client: str, amount: int) -> None:
        """Give back an amount that was taken."""
        with self._lock:
            self._used[client] -= amount
            if not self._used[client]:
                del self._used[client]


class ClientThreads:
    """Threads for calls that wait for clients. Calls for the same client are made one after the other.

    So a client that does not read delays no other client, as long as there are not too many such clients.
    """

    def __init__(self, name: str) -> None:
        self._pool = ThreadPoolExecutor(_MOST_CLIENTS, name)
        self._waiting: dict[str, deque[tuple[Job, int]]] = {}
        self._bytes = ClientShares(MOST_BYTES)
        self._lock = threading.Lock()

    def post(self, client: str, job: Job, size: int) -> bool:
        """Make a call that keeps a number of bytes. Return False, and do nothing, if too many bytes wait already.

        Calls that keep no bytes are always made.
        """
        if size and not self._bytes.take(client, size):
            return False
        with self._lock:
            jobs = self._waiting.setdefault(client, deque())
            jobs.append((job, size))
            if len(jobs) == 1:
                with suppress(RuntimeError):  # It has ended.
                    self._pool.submit(self._run, client, jobs)
        return True

    def end(self) -> None:
        """Make no further calls."""
        self._pool.shutdown(wait=False, cancel_futures=True)

    def _run(self, client: str, jobs: deque[tuple[Job, int]]) -> None:
        while True:
            job, size = jobs[0]
            try:
                job()
            except Exception:
                _log.exception("a call failed")
            self._bytes.give_back(client, size)
            with self._lock:
                jobs.popleft()
                if not jobs:
                    del self._waiting[client]
                    return
