"""Loop of a program, which runs ticks in wall time until the last tick, or a signal: Ctrl-C, SIGTERM or SIGHUP."""

import asyncio
import gc
import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field

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
        finished: True if the last tick was reached, False if a signal stopped the program.
        seconds: wall time of the loop.
    """

    finished: bool
    seconds: float


def _pass() -> None:
    """Do nothing."""


@dataclass(slots=True)
class _Stop:
    """Request to stop, with the functions that it calls."""

    event: asyncio.Event
    task: asyncio.Task[object] | None
    calls: list[Callable[[], None]] = field(default_factory=list)

    def request(self) -> None:
        """Request to stop. A second request also ends what the program waits for before and after its loops."""
        if self.event.is_set() and not self.calls and self.task is not None:
            self.task.cancel()
        self.event.set()
        for call in (*self.calls,):
            call()


_requested: ContextVar[_Stop | None] = ContextVar("requested", default=None)
"""The `stopping` block around the running code; None if there is none."""


async def run_ticks(tick: Callable[[], bool], pacer: Pacer) -> LoopResult:
    """Run ticks until `tick` returns False. After Ctrl-C, SIGTERM or SIGHUP, run one more tick.

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
    """Yield an event. Ctrl-C, SIGTERM and SIGHUP set this event and call `on_stop`, but do not end the program at once.

    A program begins this block before it opens ports and files, and ends it after closing them. So a signal at any time
    ends the program like a signal during its loop. Inner blocks share the event: a loop that begins after the signal
    runs one tick.
    """
    stop = _requested.get()
    if stop is None:
        with _handling() as stop:
            yield from _shared(stop, on_stop)
    else:
        yield from _shared(stop, on_stop)


def _shared(stop: _Stop, on_stop: Callable[[], None]) -> Iterator[asyncio.Event]:
    if on_stop is _pass:
        yield stop.event
        return
    if stop.event.is_set():
        on_stop()
    stop.calls.append(on_stop)
    try:
        yield stop.event
    finally:
        stop.calls.remove(on_stop)


@contextmanager
def _handling() -> Iterator[_Stop]:
    """Handle signals as requests to stop. A SIGHUP that the program ignores (nohup) stays ignored."""
    loop = asyncio.get_running_loop()
    stop = _Stop(asyncio.Event(), asyncio.current_task())
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
    if before[signal.SIGHUP] is signal.SIG_IGN:
        del before[signal.SIGHUP]
    for number in before:
        loop.add_signal_handler(number, stop.request)
    token = _requested.set(stop)
    try:
        yield stop
    finally:
        _requested.reset(token)
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
