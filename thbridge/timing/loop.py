"""Loop of a program, which runs ticks in wall time until the last tick, Ctrl-C or SIGTERM."""

import asyncio
import gc
import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from thbridge.timing.pacer import Pacer

_TURN = 0.0005
"""Longest time in seconds for which another thread may run without a switch, for example to compress a recording.

Python's default of 5 ms is a quarter of a tick.
"""
_turns_before: list[float] = []
"""Python's switch interval before each running loop began. The first entry is the original interval."""


@dataclass(frozen=True, slots=True)
class LoopResult:
    """Result of a loop.

    Attributes:
        finished: True if the last tick was reached, False if the program was stopped (Ctrl-C, SIGTERM).
        seconds: wall time of the loop.
    """

    finished: bool
    seconds: float


def _pass() -> None:
    """Do nothing."""


async def run_ticks(tick: Callable[[], bool], pacer: Pacer) -> LoopResult:
    """Run ticks until `tick` returns False. After Ctrl-C or SIGTERM, run one more tick.

    This last tick reads and records all pending inputs. After a pause, there can be many pending inputs.

    Args:
        tick: function that runs one tick, and returns True if another tick follows.
        pacer: pacer that waits until the next tick is due.
    """
    started = time.monotonic()
    with stopping(pacer.resume) as stopped, _standing_spared(), _short_turns():
        finished = is_last = False
        while not finished and not is_last:
            is_last = stopped.is_set()
            finished = not tick()
            await pacer.wait()
    return LoopResult(finished, time.monotonic() - started)


@contextmanager
def stopping(on_stop: Callable[[], None] = _pass) -> Iterator[asyncio.Event]:
    """Yield an event. Ctrl-C and SIGTERM set this event and call `on_stop`, but do not end the program at once."""
    loop = asyncio.get_running_loop()
    stopped = asyncio.Event()

    def stop() -> None:
        stopped.set()
        on_stop()

    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    for number in before:
        loop.add_signal_handler(number, stop)
    try:
        yield stopped
    finally:
        for number, handler in before.items():
            loop.remove_signal_handler(number)
            signal.signal(number, handler)


@contextmanager
def _standing_spared() -> Iterator[None]:
    """Exclude the present objects (modules, compiled code) from garbage collection.

    These objects are never freed. During a session, a full garbage collection with them would take the time of several
    ticks.
    """
    gc.freeze()
    try:
        yield
    finally:
        gc.unfreeze()


@contextmanager
def _short_turns() -> Iterator[None]:
    """Shorten the time for which other threads may run without a switch.

    If several loops of a process overlap, the loop that ends last restores the interval from before the first loop.
    """
    _turns_before.append(sys.getswitchinterval())
    sys.setswitchinterval(min(_turns_before[0], _TURN))
    try:
        yield
    finally:
        # Later loops began with the short interval. So the largest entry is the original interval, in whatever order
        # the loops end.
        before = _turns_before.pop()
        if not _turns_before:
            sys.setswitchinterval(before)
        else:
            _turns_before[0] = max(before, *_turns_before)
