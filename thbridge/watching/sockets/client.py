"""Watch client, which receives a session's messages over TCP, sends requests, and reconnects when disconnected."""

from __future__ import annotations

import asyncio
from collections import deque
from dataclasses import dataclass
from typing import TypeAlias

from thbridge.credentials import key_line
from thbridge.files.keys.key_file import ClientKey
from thbridge.sockets.reconnecting import Backoff, ConnectionLost, LossReason, ReconnectingClient
from thbridge.watching.wire import BagStreamReader, BrokenStream, SessionMessage, parse_status

_SEGMENT = 256 * 1024
_WAITING = 20_000
"""Maximum number of queued messages; above it, the client stops reading, and the server may drop messages."""
_NAP = 0.02
_TIMEOUT = 10.0
"""The connection counts as broken after this number of seconds without data. The server sends a status every second."""


@dataclass(frozen=True, slots=True)
class WatchConnected:
    """Event: the client is connected to the session. The session's earlier messages follow."""


WatchEvent: TypeAlias = WatchConnected | SessionMessage | ConnectionLost


class WatchClient(ReconnectingClient):
    """Client that receives a session's messages, and reconnects until `run` is cancelled.

    `run` needs an event loop, for example in a separate thread. All other methods may be called from any thread.

    Args:
        host: host of the watch server.
        port: port of the watch server.
        key: key of the watch server; None if no key is needed.
        backoff: delays between two attempts.
    """

    def __init__(self, host: str, port: int, key: ClientKey | None = None, backoff: Backoff | None = None) -> None:
        super().__init__(host, port, backoff or Backoff(timeout=_TIMEOUT), _SEGMENT, key, may_be_plain=True)
        self._events: deque[WatchEvent] = deque()
        self._loop: asyncio.AbstractEventLoop | None = None

    def take(self) -> list[WatchEvent]:
        """Return the queued events, oldest first, without waiting."""
        events: list[WatchEvent] = []
        while self._events:
            events.append(self._events.popleft())
        return events

    def send(self, line: bytes) -> bool:
        """Send a line, for example from `app.session.watch_requests.request_line`; return False if not connected."""
        loop, writer = self._loop, self._writer
        if loop is None or writer is None or loop.is_closed():
            return False
        loop.call_soon_threadsafe(writer.write, line)
        return True

    async def _lost(self, loss: ConnectionLost) -> None:
        self._events.append(loss)

    async def _listen(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> ConnectionLost:
        self._loop = asyncio.get_running_loop()
        if self._key is not None:
            writer.write(key_line(self._key.secret))
        stream = BagStreamReader()
        refused = ""
        while True:
            while len(self._events) > _WAITING:
                await asyncio.sleep(_NAP)
            try:
                async with asyncio.timeout(self._backoff.timeout):
                    data = await reader.read(_SEGMENT)
            except TimeoutError:
                return ConnectionLost(LossReason.BROKEN, f"nothing was received for {self._backoff.timeout:g} s")
            if not data:
                if self._writer is None and refused:
                    return ConnectionLost(LossReason.REFUSED, refused)
                return ConnectionLost(LossReason.BROKEN, "the session closed the connection")
            for message in stream.feed(data):
                if isinstance(message, BrokenStream):
                    return ConnectionLost(LossReason.BROKEN, message.reason)
                status = parse_status(message)
                if status is not None and status.refused is not None:
                    refused = status.refused.reason
                elif self._writer is None:
                    # An admitted watcher first gets earlier messages; a rejected watcher gets only a refusal.
                    self._accepted(writer)
                    self._events.append(WatchConnected())
                if self._writer is not None:
                    self._events.append(message)
