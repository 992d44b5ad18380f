"""The loop of a program: ticks in wall time until one is the last, or until Ctrl-C or SIGTERM."""

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
"""Longest time in seconds for which another thread, for example one that packs a recording, may hold the interpreter;
Python's default of 5 ms is a fourth of a tick."""
_turns_before: list[float] = []
"""The time that each loop under way has found when it began; the first of them is the usual one."""


@dataclass(frozen=True, slots=True)
class LoopResult:
    """The end of a loop.

    Attributes:
        finished: True when a tick was the last, False when the program was stopped (Ctrl-C, SIGTERM).
        seconds: wall time that it took.
    """

    finished: bool
    seconds: float


def _pass() -> None:
    """Do nothing."""


async def run_ticks(tick: Callable[[], bool], pacer: Pacer) -> LoopResult:
    """Run ticks until one returns False, or until Ctrl-C or SIGTERM, after which there is one more.

    The last one reads and records all inputs since the one before it, which may be many after a pause.

    Args:
        tick: runs one tick, and returns True when another one is to follow.
        pacer: waits until the next one is due.
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
    """An event that Ctrl-C and SIGTERM set, instead of ending the program at once; they also call `on_stop`."""
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
    """Exclude the present objects (modules, compiled code) from garbage collection: they are never freed anyway.

    A full collection over them takes several ticks, and would happen in the middle of a session.
    """
    gc.freeze()
    try:
        yield
    finally:
        gc.unfreeze()


@contextmanager
def _short_turns() -> Iterator[None]:
    """Shorten the time for which other threads may hold the interpreter.

    Of loops that overlap in one process the last to end puts back what the first found.
    """
    _turns_before.append(sys.getswitchinterval())
    sys.setswitchinterval(min(_turns_before[0], _TURN))
    try:
        yield
    finally:
        # What a later loop found was short already, so it does not matter whose entry is taken.
        before = _turns_before.pop()
        if not _turns_before:
            sys.setswitchinterval(before)
        else:
            _turns_before[0] = max(before, *_turns_before)
