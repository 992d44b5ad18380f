"""Calls of programs of others that may take long in wall time, or for ever."""

import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Generic, TypeVar

T = TypeVar("T")


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


class Stopwatch:
    """Measures the wall time of calls.

    Attributes:
        seconds: of all calls so far.
    """

    def __init__(self) -> None:
        self.seconds = 0.0

    def measure(self, asked: Callable[[], T]) -> T:
        """Return what a call returns, or raise what it raises."""
        began = time.perf_counter()
        try:
            return asked()
        finally:
            self.seconds += time.perf_counter() - began


class ImpatientCaller(Generic[T]):
    """Calls that are waited for so long and no longer; after one that takes longer no other is begun.

    Args:
        seconds: of wall time that a call may take.
    """

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self._late = ""

    def call(self, asked: Callable[[], T]) -> T:
        """Return what a call returns, or raise what it raises; TimeoutError when it takes too long."""
        found: list[T] = []
        raised: list[BaseException] = []

        def ask() -> None:
            try:
                found.append(asked())
            except BaseException as error:
                # It is raised again in the thread that waits.
                raised.append(error)

        if not self._late:
            thread = threading.Thread(target=ask, daemon=True)
            thread.start()
            thread.join(self._seconds)
            if not found and not raised:
                place = traceback.extract_stack(sys._current_frames().get(thread.ident or 0))[-1]
                at = f"{Path(place.filename).name}, line {place.lineno}"
                self._late = f"no answer in {self._seconds:g} s; it is at {at}"
        if self._late:
            raise TimeoutError(self._late)
        if raised:
            raise raised[0]
        return found[0]
