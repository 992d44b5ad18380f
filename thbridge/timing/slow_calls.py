"""Calls of plug-ins, which may take a long time or never return."""

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
    """Call `tell` in a separate thread if this block takes longer than `seconds`; the block is not interrupted."""
    timer = threading.Timer(seconds, tell)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()


class Stopwatch:
    """Stopwatch for the wall time of calls.

    Attributes:
        seconds: total duration of all calls so far.
    """

    def __init__(self) -> None:
        self.seconds = 0.0

    def measure(self, asked: Callable[[], T]) -> T:
        """Call a function and return its result. Exceptions of the function are raised."""
        began = time.perf_counter()
        try:
            return asked()
        finally:
            self.seconds += time.perf_counter() - began


class ImpatientCaller(Generic[T]):
    """Caller with a timeout. After a call has exceeded the timeout, further calls are refused.

    Args:
        seconds: timeout of a call, in wall time.
    """

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self._late = ""

    def call(self, asked: Callable[[], T]) -> T:
        """Call a function and return its result. Exceptions of the function are raised.

        Raises:
            TimeoutError: the call took longer than the timeout, or an earlier call did.
        """
        found: list[T] = []
        raised: list[BaseException] = []

        def ask() -> None:
            try:
                found.append(asked())
            except BaseException as error:
                # The waiting thread raises the exception again.
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
