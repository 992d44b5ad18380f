"""Pace of a loop of ticks: rate in wall time, pauses, and single steps."""

import asyncio
import logging
import time
from collections.abc import Callable
from contextlib import suppress

from sim.common.observations import TICK

_log = logging.getLogger(__name__)

_BREATH = 25
"""If ticks run as fast as possible, other tasks of the event loop run after this number of ticks."""

_LAG = 1.0
"""Largest delay in seconds that later, faster ticks compensate. A larger delay becomes a permanent lag."""

_LOOK = 0.1
"""Seconds between two calls of `pause_abandoned` during a pause."""


class Pacer:
    """Timer of ticks. If the machine is too slow for the rate, simulated time lags; ticks are never skipped.

    The pace can be changed while the loop runs. All calls must be on the thread of the event loop.

    Args:
        rate: simulated seconds per second; 0 means as fast as possible.
        clock: monotonic clock, seconds.
        pause_abandoned: function that returns True to end a pause, because no client needs the pause. It is called ten
            times per second during a pause. If None, pauses last until `resume`.
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
        """Simulated seconds per second; 0 means as fast as possible."""
        return self._rate

    @property
    def paused(self) -> bool:
        """True during a pause, which lasts until `resume` or `step`."""
        return self._paused

    @property
    def lag(self) -> float:
        """Total delay of the ticks relative to the rate, including permanent lag, in seconds."""
        return self._given_up + self.delay

    @property
    def delay(self) -> float:
        """Part of the lag that later, faster ticks can compensate, in seconds."""
        return 0.0 if self._due is None else max(self._clock() - self._due - self.period, 0.0)

    @property
    def period(self) -> float:
        """Seconds from one tick to the next at this rate; 0 if there is no rate."""
        return TICK / self._rate if self._rate > 0.0 else 0.0

    def set_rate(self, rate: float) -> None:
        """Change the rate; 0 means as fast as possible. A pause continues."""
        self._rate = rate
        self._due = None

    def restart(self) -> None:
        """Begin again without a delay, in a program that continues the session of another one."""
        self._due = None
        self._given_up = 0.0

    def pause(self) -> None:
        """Pause: run no more ticks, not even the remaining ticks of an earlier `step`."""
        self._paused = True
        self._steps = 0

    def resume(self) -> None:
        """End a pause."""
        self._paused = False
        self._changed.set()

    def step(self, ticks: int) -> None:
        """Run a number of ticks at the rate, then pause."""
        self._paused = True
        self._steps += ticks
        self._changed.set()

    async def wait(self) -> None:
        """Wait until the next tick is due."""
        await self._keep_time()
        while self._paused:
            if self._steps:
                self._steps -= 1
                return
            self._due = None  # The duration of a pause does not count as delay.
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
        # Each due time follows from the previous due time, so that delays of single ticks do not accumulate.
        self._due = now if self._due is None else self._due + self.period
        if now - self._due > _LAG:
            if not self._lagging:
                _log.warning("this machine is too slow for the requested rate: simulated time lags behind")
            self._lagging = True
            self._given_up += now - self._due
            self._due = now
        await asyncio.sleep(max(self._due - now, 0.0))
