"""Queue for services whose answers take milliseconds.

It answers one request at a time. Between two answers, the event loop does other work.
"""

import asyncio
from collections.abc import Callable

from thbridge.rosgraph.sockets.tcpros_server import ServiceAnswer, ServiceHandler


class RequestQueue:
    """Queue of requests of several services."""

    def __init__(self) -> None:
        self._lock = asyncio.Lock()

    def wrap(self, handler: Callable[[bytes], ServiceAnswer]) -> ServiceHandler:
        """Return a handler that waits for its turn and then calls the given handler."""

        async def in_turn(request: bytes) -> ServiceAnswer:
            async with self._lock:
                await asyncio.sleep(0)
            return handler(request)

        return in_turn
