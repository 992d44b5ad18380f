"""The loop of a program: ticks kept to the wall clock until one is the last, or somebody stops the program."""

import asyncio
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from sim.observations import TICK
from thbridge.adapters.pacer import Pacer


@dataclass(frozen=True, slots=True)
class Run:
    """How a loop ended.

    Attributes:
        finished: a tick was the last; or else somebody stopped the program (Ctrl-C, SIGTERM).
        seconds: of wall time that it took.
    """

    finished: bool
    seconds: float


def period_of(rate: float) -> float:
    """Seconds of wall time for a tick; 0 for a rate of 0, as fast as it can."""
    return TICK / rate if rate > 0.0 else 0.0


async def run_ticks(tick: Callable[[], bool], period: float) -> Run:
    """Run ticks until one returns False, or until Ctrl-C or SIGTERM, which end the loop between two ticks.

    Args:
        tick: one tick; whether another one is to follow.
        period: seconds of wall time a tick takes; 0 runs as fast as the machine can.
    """
    pacer = Pacer(period)
    started = time.monotonic()
    with stopping() as stopped:
        finished = False
        while not finished and not stopped.is_set():
            finished = not tick()
            await pacer.wait()
    return Run(finished, time.monotonic() - started)


@contextmanager
def stopping() -> Iterator[asyncio.Event]:
    """An event that Ctrl-C and SIGTERM set instead of ending the program where it stands."""
    loop = asyncio.get_running_loop()
    stopped = asyncio.Event()
    signals = (signal.SIGINT, signal.SIGTERM)
    for number in signals:
        loop.add_signal_handler(number, stopped.set)
    try:
        yield stopped
    finally:
        for number in signals:
            loop.remove_signal_handler(number)
