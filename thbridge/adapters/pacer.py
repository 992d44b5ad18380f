"""Keeps a loop of ticks to the wall clock."""

import asyncio
import logging
import time
from collections.abc import Callable

_log = logging.getLogger(__name__)

_BREATH = 25
"""Ticks that run on end before sockets get a turn, when there is no clock to keep to."""

_LAG = 1.0
"""Seconds of delay that are made up for by running faster; beyond that the session's time lags for good."""


class Pacer:
    """Waits between ticks; a machine too slow makes simulated time lag, and never skips a tick.

    Args:
        period: seconds of wall time a tick takes; 0 runs as fast as the machine can.
        clock: seconds, never backwards.
    """

    def __init__(self, period: float, clock: Callable[[], float] = time.monotonic) -> None:
        self._period = period
        self._clock = clock
        self._due: float | None = None
        self._ticks = 0
        self._lagging = False

    async def wait(self) -> None:
        """Return when the next tick is due."""
        self._ticks += 1
        if self._period == 0.0:
            if self._ticks % _BREATH == 0:
                await asyncio.sleep(0)
            return
        now = self._clock()
        self._due = now if self._due is None else self._due + self._period
        if now - self._due > _LAG:
            if not self._lagging:
                _log.warning("this machine is too slow for the rate asked for: simulated time lags behind")
            self._lagging = True
            self._due = now
        await asyncio.sleep(max(self._due - now, 0.0))
