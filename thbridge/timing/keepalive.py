"""Keeps ground stations from taking robots for dead while their time stands, or runs slower than the clock.

Stations give a robot up some seconds of their own time after its last heartbeat; the robots' only clock is simulated
time. It ends with the session, on whose event loop it is: no fault is outlived.
"""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from typing import Protocol

from sim.common.observations import TICKS_PER_SECOND
from thbridge.timing.pacer import Pacer

_LOOK = 1.0
"""Seconds between two looks."""

_ENOUGH = 4 * TICKS_PER_SECOND // 5
"""Ticks in a second of the clock with which heartbeats come often enough by themselves."""


class SessionWithVehicles(Protocol):
    """A session with vehicles."""

    @property
    def tick(self) -> int:
        """The number of the next tick."""

    def keep_alive(self) -> None:
        """Let vehicles say that they are there."""


class KeepAlive:
    """Looks at a session once a second.

    A session that nobody asks to keep to the clock is left alone, unless it is paused: what it says must not depend on
    how fast the machine is.
    """

    def __init__(self, session: SessionWithVehicles, pacer: Pacer) -> None:
        self._session = session
        self._pacer = pacer
        self._tick = session.tick

    def check(self) -> None:
        """A second has passed."""
        passed, self._tick = self._session.tick - self._tick, self._session.tick
        if passed < _ENOUGH and (self._pacer.paused or self._pacer.rate > 0.0):
            self._session.keep_alive()


@asynccontextmanager
async def kept_alive(session: SessionWithVehicles, pacer: Pacer) -> AsyncIterator[None]:
    """As long as this lasts, a session says every second that it is there."""

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
