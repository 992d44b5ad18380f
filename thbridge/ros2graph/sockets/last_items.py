"""Bounded queues between the event loop and threads, and threads for calls that may wait."""

import logging
import threading
import time
from collections import deque
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
_PROMPT_CLIENTS = 4
"""The same for prompt clients."""
_QUICK_CALLS = 2
"""Number of quick calls in a row after which a client is prompt."""
_QUICK_SECONDS = 1.0
_MOST_KNOWN = 4096
"""Maximum number of clients whose quick calls are counted."""

Job: TypeAlias = Callable[[], None]
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

    It is a daemon: a call that never returns does not block the end of the program.
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


class ClientThreads:
    """Threads for calls that wait for clients. Calls for the same client are made one after the other.

    So a client that does not read delays no other client, as long as there are not too many such clients. Clients whose
    last calls took no time have some threads of their own, because hostile clients may invent any number of names.
    """

    def __init__(self, name: str) -> None:
        self._others = ThreadPoolExecutor(_MOST_CLIENTS, name)
        self._prompt = ThreadPoolExecutor(_PROMPT_CLIENTS, f"{name}, prompt")
        self._quick_calls: dict[bytes, int] = {}
        self._waiting: dict[bytes, deque[tuple[Job, int]]] = {}
        self._bytes = 0
        self._lock = threading.RLock()  # Garbage collection may post a call at any time.

    def post(self, client: bytes, job: Job, size: int) -> bool:
        """Make a call that keeps a number of bytes.

        Return False, and do nothing, if the client is not prompt and too many bytes wait already.
        """
        with self._lock:
            is_prompt = self._quick_calls.get(client, 0) >= _QUICK_CALLS
            if size and not is_prompt and self._bytes + size > MOST_BYTES:
                return False
            self._bytes += size
            jobs = self._waiting.setdefault(client, deque())
            jobs.append((job, size))
            if len(jobs) == 1:
                with suppress(RuntimeError):  # It has ended.
                    (self._prompt if is_prompt else self._others).submit(self._run, client, jobs)
        return True

    def end(self) -> None:
        """Make no further calls."""
        for pool in (self._others, self._prompt):
            pool.shutdown(wait=False, cancel_futures=True)

    def _run(self, client: bytes, jobs: deque[tuple[Job, int]]) -> None:
        while True:
            job, size = jobs[0]
            began = time.monotonic()
            try:
                job()
            except Exception:
                _log.exception("a call failed")
            with self._lock:
                quick_calls = self._quick_calls.pop(client, 0)
                if time.monotonic() < began + _QUICK_SECONDS:
                    self._quick_calls[client] = quick_calls + 1
                    if len(self._quick_calls) > _MOST_KNOWN:
                        del self._quick_calls[next(iter(self._quick_calls))]
                self._bytes -= size
                jobs.popleft()
                if not jobs:
                    del self._waiting[client]
                    return
