"""The pace of a loop of ticks: rate in wall time, pause, single steps."""

import asyncio
import logging
import time
from collections.abc import Callable
from contextlib import suppress

from sim.common.observations import TICK

_log = logging.getLogger(__name__)

_BREATH = 25
"""Number of ticks after which the event loop gets a turn, if ticks run as fast as possible."""

_LAG = 1.0
"""Largest delay in seconds that is made up for by running faster; a larger delay stays as a lag of simulated time."""

_LOOK = 0.1
"""Seconds between two calls of `pause_abandoned` during a pause."""


class Pacer:
    """Timer of ticks. If the machine is too slow for the rate, simulated time lags; ticks are never skipped.

    The pace can be changed while the loop runs, on the thread of its event loop.

    Args:
        rate: simulated seconds per second; 0 runs as fast as possible.
        clock: monotonic clock, seconds.
        pause_abandoned: called ten times a second while paused; returns True to end the pause, because no client needs
            it. If None, pauses last until `resume`.
    """

    def __init__(
        self,
        rate: float,
        clock: Callable[[], float] = time.monotonic,
        pause_abandoned: Callable[[], bool] | None = None,
    ) -> None:
        self._rate = rate
        self._clock = clock
        self._let_go = pause_abandoned
        self._due: float | None = None
        self._ticks = 0
        self._lagging = False
        self._given_up = 0.0
        self._paused = False
        self._steps = 0
        self._changed = asyncio.Event()

    @property
    def rate(self) -> float:
        """Simulated seconds per second; 0 runs as fast as possible."""
        return self._rate

    @property
    def paused(self) -> bool:
        """True during a pause, which lasts until `resume` or `step`."""
        return self._paused

    @property
    def lag(self) -> float:
        """Delay of the ticks relative to the rate, in seconds, including delays that are not made up for."""
        return self._given_up + self.delay

    @property
    def delay(self) -> float:
        """Part of the lag that later ticks may make up for, in seconds."""
        return 0.0 if self._due is None else max(self._clock() - self._due - self.period, 0.0)

    @property
    def period(self) -> float:
        """Seconds from one tick to the next at this rate; 0 without a rate."""
        return TICK / self._rate if self._rate > 0.0 else 0.0

    def set_rate(self, rate: float) -> None:
        """Change the rate; a pause continues. 0 runs as fast as possible."""
        self._rate = rate
        self._due = None

    def pause(self) -> None:
        """Stop ticks, including the remaining ticks of an earlier `step`."""
        self._paused = True
        self._steps = 0

    def resume(self) -> None:
        """End a pause."""
        self._paused = False
        self._changed.set()

    def step(self, ticks: int) -> None:
        """Run some more ticks at the rate, then pause."""
        self._paused = True
        self._steps += ticks
        self._changed.set()

    async def wait(self) -> None:
        """Return when the next tick is due."""
        await self._keep_time()
        while self._paused:
            if self._steps:
                self._steps -= 1
                return
            self._due = None  # The time of a pause does not count as delay.
            self._changed.clear()
            with suppress(TimeoutError):
                await asyncio.wait_for(self._changed.wait(), None if self._let_go is None else _LOOK)
            if self._let_go is not None and self._let_go():
                self._paused = False

    async def _keep_time(self) -> None:
        self._ticks += 1
        if self._rate == 0.0:
            if self._ticks % _BREATH == 0:
                await asyncio.sleep(0)
            return
        now = self._clock()
        # Due times are added up, so that delays of single ticks are made up for and do not accumulate.
        self._due = now if self._due is None else self._due + self.period
        if now - self._due > _LAG:
            if not self._lagging:
                _log.warning("this machine is too slow for the requested rate: simulated time lags behind")
            self._lagging = True
            self._given_up += now - self._due
            self._due = now
        await asyncio.sleep(max(self._due - now, 0.0))
