"""Heartbeats to ground stations while simulated time is paused or slow, so that robots do not count as lost.

Heartbeats are due in simulated time, but stations wait only some seconds of wall time for the next one. The task runs
on the session's event loop and ends with the session, so heartbeats never continue after an error of the session.
"""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from typing import Protocol

from sim.common.observations import TICKS_PER_SECOND
from thbridge.timing.pacer import Pacer

_LOOK = 1.0
"""Seconds between two checks."""

_ENOUGH = 4 * TICKS_PER_SECOND // 5
"""Ticks per second of wall time at which heartbeats in simulated time are frequent enough."""


class SessionWithVehicles(Protocol):
    """A session with vehicles."""

    @property
    def tick(self) -> int:
        """Number of the next tick."""

    def keep_alive(self) -> None:
        """Let vehicles send heartbeats."""


class KeepAlive:
    """Check of one session, called once per second.

    A session without a rate sends no extra heartbeats unless it is paused, because its messages must not depend on the
    machine's speed.
    """

    def __init__(self, session: SessionWithVehicles, pacer: Pacer) -> None:
        self._session = session
        self._pacer = pacer
        self._tick = session.tick

    def check(self) -> None:
        """Let the session send heartbeats if too few ticks have passed since the last check."""
        passed, self._tick = self._session.tick - self._tick, self._session.tick
        if passed < _ENOUGH and (self._pacer.paused or self._pacer.rate > 0.0):
            self._session.keep_alive()


@asynccontextmanager
async def kept_alive(session: SessionWithVehicles, pacer: Pacer) -> AsyncIterator[None]:
    """Check a session every second during this block."""

    async def watch() -> None:
        keep_alive = KeepAlive(session, pacer)
        while True:
            await asyncio.sleep(_LOOK)
            keep_alive.check()

    watching = asyncio.create_task(watch())
    try:
        yield
    finally:
        watching.cancel()
        with suppress(asyncio.CancelledError):
            await watching
