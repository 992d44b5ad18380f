"""Text client's socket, which keeps one of our own programs connected to a server."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from enum import Enum
from typing import NoReturn, TypeAlias

from thbridge.files.errors import reason_of
from thbridge.protocols.text.client import (
    ClientSession,
    ClosedByServer,
    NameRegistered,
    SendToServer,
    ServerCloseReason,
)
from thbridge.protocols.text.lines import OverlongLine, TextMessage, encode_line

_log = logging.getLogger(__name__)

_EVENTS = 1024
"""Most queued events for the program; beyond that nothing is read, and the server disconnects us in the end."""

_BACKLOG = 1024 * 1024
"""Bytes that may wait to be sent before the connection counts as dead."""

_SEGMENT = 16 * 1024

_LAST_WORDS = 0.1
"""Seconds for the last messages to be sent."""


class LossReason(Enum):
    """Reason why there is no connection to the server."""

    UNREACHABLE = "the server cannot be reached"
    BROKEN = "the connection broke"
    REFUSED = ServerCloseReason.REFUSED.value
    STOPPED = ServerCloseReason.STOPPED.value


@dataclass(frozen=True, slots=True)
class ConnectionLost:
    """Loss of the connection; the client keeps trying. One event for each change of the reason."""

    reason: LossReason
    detail: str = ""


TextClientEvent: TypeAlias = NameRegistered | TextMessage | ConnectionLost


@dataclass(frozen=True, slots=True)
class Backoff:
    """Delays between attempts to connect, and the timeout of a connection, seconds.

    Attributes:
        initial: delay before the first reconnection; doubles at each further one.
        maximum: longest delay between two attempts.
        timeout: time without a byte from the server (which pings idle clients every 15 s) until the connection counts
            as broken.
    """

    initial: float = 0.25
    maximum: float = 5.0
    timeout: float = 45.0


class TextClient:
    """Connects the program called `name` to a server, again and again until `run` is cancelled.

    `NameRegistered` comes at the first connection and after every loss: the moment to introduce oneself anew.

    Args:
        name: name of the program on the server.
        token: one word that marks this run of the program, e.g. some random digits; see `ClientSession`.

    Raises:
        ValueError: name or token is not one word.
    """

    def __init__(self, name: str, token: str, host: str, port: int, backoff: Backoff | None = None) -> None:
        ClientSession(name, token)  # refuses a bad name here, not in the midst of a run
        self._name = name
        self._token = token
        self._host = host
        self._port = port
        self._backoff = backoff or Backoff()
        self._events: asyncio.Queue[TextClientEvent] = asyncio.Queue(_EVENTS)
        self._writer: asyncio.StreamWriter | None = None  # while we are registered
        self._reason: LossReason | None = None

    async def run(self) -> NoReturn:
        """Keep connected for ever."""
        delays = self._delays()
        while True:
            loss = await self._converse()
            if self._reason is None:
                delays = self._delays()
            if loss.reason is not self._reason:
                self._reason = loss.reason
                await self._events.put(loss)
            await asyncio.sleep(next(delays))

    @asynccontextmanager
    async def running(self) -> AsyncIterator[None]:
        """Keep connected inside the `async with`; messages sent inside it are still delivered."""
        running = asyncio.create_task(self.run())
        try:
            yield
            await asyncio.sleep(_LAST_WORDS)
        finally:
            running.cancel()

    def send(self, message: TextMessage) -> bool:
        """Send a message; return False when we are not registered with a server, and the message is lost."""
        if self._writer is None:
            return False
        self._write(self._writer, encode_line(message.line()))
        return True

    async def next_event(self) -> TextClientEvent:
        """Wait for the next event."""
        return await self._events.get()

    def take(self) -> list[TextClientEvent]:
        """Take the events that have come, oldest first, without waiting."""
        return [self._events.get_nowait() for _ in range(self._events.qsize())]

    def _delays(self) -> Iterator[float]:
        delay = self._backoff.initial
        while True:
            yield delay
            delay = min(2.0 * delay, self._backoff.maximum)

    async def _converse(self) -> ConnectionLost:
        """Connect once and exchange messages until the connection ends, for any reason."""
        try:
            async with asyncio.timeout(self._backoff.timeout):
                reader, writer = await asyncio.open_connection(self._host, self._port)
        except (OSError, UnicodeError, OverflowError) as error:
            told = reason_of(error) if isinstance(error, OSError) else str(error)
            return ConnectionLost(LossReason.UNREACHABLE, f"{self._host}:{self._port}: {told}")
        try:
            return await self._listen(reader, writer)
        except OSError as error:
            return ConnectionLost(LossReason.BROKEN, str(error))
        finally:
            self._writer = None
            writer.close()

    async def _listen(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> ConnectionLost:
        session = ClientSession(self._name, self._token)
        self._write(writer, session.hello)
        while True:
            try:
                async with asyncio.timeout(self._backoff.timeout):
                    data = await reader.read(_SEGMENT)
            except TimeoutError:
                return ConnectionLost(LossReason.BROKEN, f"nothing was heard for {self._backoff.timeout} s")
            if not data:
                return ConnectionLost(LossReason.BROKEN, "the server closed the connection")
            for event in session.receive_data(data):
                match event:
                    case SendToServer(line):
                        self._write(writer, line)
                    case NameRegistered():
                        self._writer = writer
                        self._reason = None
                        await self._events.put(event)
                    case TextMessage():
                        await self._events.put(event)
                    case ClosedByServer(reason):
                        return ConnectionLost(LossReason(reason.value))
                    case OverlongLine(length):
                        _log.warning("the server sent a line of %d bytes, which is too long; skipped", length)

    def _write(self, writer: asyncio.StreamWriter, data: bytes) -> None:
        writer.write(data)
        if writer.transport.get_write_buffer_size() > _BACKLOG:
            writer.transport.abort()
