"""Watch client: receives a session's messages over TCP, sends requests, and reconnects after every loss."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NoReturn, TypeAlias

from thbridge.files.errors import reason_of
from thbridge.protocols.watching import BagStreamReader, BrokenStream, SessionMessage, key_line, parse_status
from thbridge.sockets.text.client import Backoff, ConnectionLost, LossReason

_SEGMENT = 256 * 1024
_WAITING = 20_000
"""Most queued messages; beyond that nothing is read, and the watch server drops some in the end."""
_NAP = 0.02
_TIMEOUT = 10.0
"""Seconds without a byte until the connection counts as broken; the server sends its status every second."""


@dataclass(frozen=True, slots=True)
class WatchConnected:
    """Connection to the session; its latched messages come next."""


WatchEvent: TypeAlias = WatchConnected | SessionMessage | ConnectionLost


class WatchClient:
    """Receives a session's messages, with reconnections until `run` is cancelled.

    `run` needs an event loop, for example that of a thread of its own; everything else may be called from any thread.

    Args:
        host: host of the watch server.
        port: port of the watch server.
        key: key of the watch server; None for none.
        backoff: delays between two attempts.
    """

    def __init__(self, host: str, port: int, key: str | None = None, backoff: Backoff | None = None) -> None:
        self._host = host
        self._port = port
        self._key = key
        self._backoff = backoff or Backoff(timeout=_TIMEOUT)
        self._events: deque[WatchEvent] = deque()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._writer: asyncio.StreamWriter | None = None  # while the session is heard
        self._reason: LossReason | None = None

    async def run(self) -> NoReturn:
        """Keep connected for ever."""
        self._loop = asyncio.get_running_loop()
        delays = self._delays()
        while True:
            loss = await self._converse()
            if self._reason is None:
                delays = self._delays()
            if loss.reason is not self._reason:
                self._reason = loss.reason
                self._events.append(loss)
            await asyncio.sleep(next(delays))

    def take(self) -> list[WatchEvent]:
        """Take the events that have come, oldest first, without waiting."""
        events: list[WatchEvent] = []
        while self._events:
            events.append(self._events.popleft())
        return events

    def send(self, line: bytes) -> bool:
        """Send a line, such as `app.session.watching.request_line` makes; return False when not connected."""
        loop, writer = self._loop, self._writer
        if loop is None or writer is None or loop.is_closed():
            return False
        loop.call_soon_threadsafe(writer.write, line)
        return True

    def _delays(self) -> Iterator[float]:
        delay = self._backoff.initial
        while True:
            yield delay
            delay = min(2.0 * delay, self._backoff.maximum)

    async def _converse(self) -> ConnectionLost:
        """Connect once and receive until the connection ends, for any reason."""
        try:
            async with asyncio.timeout(self._backoff.timeout):
                reader, writer = await asyncio.open_connection(self._host, self._port, limit=_SEGMENT)
        except (OSError, UnicodeError, OverflowError) as error:
            told = reason_of(error) if isinstance(error, OSError) else str(error)
            return ConnectionLost(LossReason.UNREACHABLE, f"{self._host}:{self._port}: {told}")
        try:
            if self._key is not None:
                writer.write(key_line(self._key))
            return await self._listen(reader, writer)
        except OSError as error:
            return ConnectionLost(LossReason.BROKEN, str(error))
        finally:
            self._writer = None
            writer.close()

    async def _listen(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> ConnectionLost:
        stream = BagStreamReader()
        refused = ""
        while True:
            while len(self._events) > _WAITING:
                await asyncio.sleep(_NAP)
            try:
                async with asyncio.timeout(self._backoff.timeout):
                    data = await reader.read(_SEGMENT)
            except TimeoutError:
                return ConnectionLost(LossReason.BROKEN, f"nothing was heard for {self._backoff.timeout:g} s")
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
                    # An admitted watcher first gets a latched message; a rejected one gets only a refusal.
                    self._writer = writer
                    self._reason = None
                    self._events.append(WatchConnected())
                if self._writer is not None:
                    self._events.append(message)
