"""Calls of programs of others that may take long in wall time."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def told_if_slow(seconds: float, tell: Callable[[], None]) -> Iterator[None]:
    """Call `tell`, in a thread of its own, if this block takes longer than some seconds; the block goes on."""
    timer = threading.Timer(seconds, tell)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
