"""The loop of a program: ticks kept to the wall clock until one is the last, or somebody stops the program."""

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
"""Seconds after which another thread, one that packs a recording for example, has to let the ticks go on; Python's own
five milliseconds are a fourth of a tick."""


@dataclass(frozen=True, slots=True)
class LoopResult:
    """How a loop ended.

    Attributes:
        finished: a tick was the last; or else somebody stopped the program (Ctrl-C, SIGTERM).
        seconds: of wall time that it took.
    """

    finished: bool
    seconds: float


def _pass() -> None:
    """Nobody else need be told."""


async def run_ticks(tick: Callable[[], bool], pacer: Pacer) -> LoopResult:
    """Run ticks until one returns False, or until Ctrl-C or SIGTERM, after which one more comes.

    That last one takes in what came since the one before it: in a pause that may be much, and worth a recording.

    Args:
        tick: one tick; whether another one is to follow.
        pacer: says when the next one is due.
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
    """An event that Ctrl-C and SIGTERM set instead of ending the program where it stands; `told` is called then."""
    loop = asyncio.get_running_loop()
    stopped = asyncio.Event()

    def stop() -> None:
        stopped.set()
        on_stop()

    signals = (signal.SIGINT, signal.SIGTERM)
    for number in signals:
        loop.add_signal_handler(number, stop)
    try:
        yield stopped
    finally:
        for number in signals:
            loop.remove_signal_handler(number)


@contextmanager
def _standing_spared() -> Iterator[None]:
    """Keep the garbage collector from what stands already: modules and compiled code, which no tick throws away.

    To walk all of that takes several ticks' time, and the collector would do so in the midst of a session.
    """
    gc.freeze()
    try:
        yield
    finally:
        gc.unfreeze()


@contextmanager
def _short_turns() -> Iterator[None]:
    """Let no other thread keep the interpreter from the ticks for long."""
    usual = sys.getswitchinterval()
    sys.setswitchinterval(min(usual, _TURN))
    try:
        yield
    finally:
        sys.setswitchinterval(usual)
