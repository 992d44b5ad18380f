"""Heartbeats to ground stations while simulated time is paused or slow, so that stations do not lose the robots.

Heartbeats are due in simulated time, but stations wait only some seconds of wall time for the next heartbeat. The task
runs on the session's event loop. If the session fails, the task also ends, so heartbeats do not continue.
"""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from typing import Protocol

from sim.common.observations import TICKS_PER_SECOND
from thbridge.timing.pacer import Pacer

_LOOK = 1.0
"""Wall time between two checks, seconds."""

_ENOUGH = 4 * TICKS_PER_SECOND // 5
"""Smallest number of ticks per second of wall time at which heartbeats in simulated time are frequent enough."""


class SessionWithVehicles(Protocol):
    """Session with MAVLink vehicles."""

    @property
    def tick(self) -> int:
        """Number of the next tick."""

    def keep_alive(self) -> None:
        """Let vehicles send heartbeats."""


class KeepAlive:
    """Regular check of one session, once per second.

    A session without a rate sends extra heartbeats only while it is paused. At other times, its messages must not
    depend on the speed of the machine.
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
    """Check a session once per second during this block."""

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
