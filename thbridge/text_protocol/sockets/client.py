"""Socket of the text client. The client keeps one of our own programs connected to a server."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import TypeAlias

from thbridge.credentials import key_line, parse_answer
from thbridge.files.keys.key_file import ClientKey
from thbridge.line_splitter import OverlongLine
from thbridge.sockets.reconnecting import Backoff, ConnectionLost, LossReason, ReconnectingClient
from thbridge.text_protocol.wire.client import (
    ClientSession,
    ClosedByServer,
    NameRegistered,
    SendToServer,
)
from thbridge.text_protocol.wire.lines import TextMessage, encode_line
from thbridge.text_protocol.wire.notice_format import SERVER

_log = logging.getLogger(__name__)

_EVENTS = 1024
"""Maximum number of queued events. At this number the client stops reading, and finally the server disconnects it."""

_BACKLOG = 1024 * 1024
"""Maximum number of bytes that wait to be sent. Above it, the connection counts as dead."""

_SEGMENT = 16 * 1024

_LAST_WORDS = 0.1
"""Seconds that remain for sending the last messages."""


TextClientEvent: TypeAlias = NameRegistered | TextMessage | ConnectionLost


class TextClient(ReconnectingClient):
    """Client that keeps the program `name` connected to a server until `run` is cancelled.

    `NameRegistered` is the first event of every connection. After it, the program must introduce itself to the other
    programs again.

    Args:
        name: name of the program on the server.
        token: one word that identifies this run of the program, e.g. random digits. See `ClientSession`.
        key: key to present to the server over TLS. If None, the server must run on this machine.

    Attributes:
        name: name of the program.
        address: address of the server, `HOST:PORT`.

    Raises:
        ValueError: name or token is not one word.
    """

    def __init__(
        self,
        name: str,
        token: str,
        host: str,
        port: int,
        backoff: Backoff | None = None,
        key: ClientKey | None = None,
    ) -> None:
        ClientSession(name, token)  # Raises for a bad name now instead of in `run`.
        super().__init__(host, port, backoff or Backoff(), _SEGMENT, key)
        self.name = name
        self.address = f"{host}:{port}"
        self._token = token
        self._events: asyncio.Queue[TextClientEvent] = asyncio.Queue(_EVENTS)

    @classmethod
    async def why_refused(
        cls, name: str, host: str, port: int, key: ClientKey | None, timeout: float
    ) -> ConnectionLost | None:
        """Connect once, and return the reason why the program `name` cannot connect; None if it can.

        The name is not registered, and a key for one game is not used. `timeout` is in seconds.
        """
        # A server refuses its own name with a reason only if it would also refuse the name in the token.
        lost = await cls(SERVER, name, host, port, Backoff(timeout=timeout), key)._converse()
        return None if lost.reason is LossReason.REFUSED and not lost.detail else lost

    @asynccontextmanager
    async def running(self) -> AsyncIterator[None]:
        """Stay connected inside the `async with`. At its end, wait a moment until the last messages are delivered."""
        running = asyncio.create_task(self.run())
        try:
            yield
            await asyncio.sleep(_LAST_WORDS)
        finally:
            running.cancel()

    def send(self, message: TextMessage) -> bool:
        """Send a message. Return False if the message is lost because no server has accepted the name."""
        if self._writer is None:
            return False
        self._write(self._writer, encode_line(message.line()))
        return True

    async def next_event(self) -> TextClientEvent:
        """Wait for the next event."""
        return await self._events.get()

    def take(self) -> list[TextClientEvent]:
        """Return the queued events, oldest first, without waiting."""
        return [self._events.get_nowait() for _ in range(self._events.qsize())]

    async def _lost(self, loss: ConnectionLost) -> None:
        await self._events.put(loss)

    async def _listen(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> ConnectionLost:
        # The server expects the key before any line of the protocol.
        if self._key is not None:
            writer.write(key_line(self._key.secret))
            refused = await self._answer(reader)
            if refused is not None:
                return refused
        session = ClientSession(self.name, self._token)
        self._write(writer, session.hello)
        while True:
            try:
                async with asyncio.timeout(self._backoff.timeout):
                    data = await reader.read(_SEGMENT)
            except TimeoutError:
                return ConnectionLost(LossReason.BROKEN, f"nothing was received for {self._backoff.timeout} s")
            if not data:
                return ConnectionLost(LossReason.BROKEN, "the server closed the connection")
            for event in session.receive_data(data):
                match event:
                    case SendToServer(line):
                        self._write(writer, line)
                    case NameRegistered():
                        self._accepted(writer)
                        await self._events.put(event)
                    case TextMessage():
                        await self._events.put(event)
                    case ClosedByServer(reason, detail):
                        return ConnectionLost(LossReason[reason.name], detail)
                    case OverlongLine(length):
                        _log.warning("the server sent a line of %d bytes, which is too long; skipped", length)

    async def _answer(self, reader: asyncio.StreamReader) -> ConnectionLost | None:
        """Wait for the answer to the key. Return the reason why there is no connection, or None."""
        try:
            async with asyncio.timeout(self._backoff.timeout):
                answer = parse_answer(await reader.readline())
        except (TimeoutError, ValueError):
            answer = None
        if answer is None:
            return ConnectionLost(LossReason.BROKEN, "the server did not answer after receiving the key")
        return ConnectionLost(LossReason.REFUSED, answer.refused) if answer.refused else None

    def _write(self, writer: asyncio.StreamWriter, data: bytes) -> None:
        writer.write(data)
        # A server that does not read counts as dead. Otherwise the waiting bytes would fill the memory.
        if writer.transport.get_write_buffer_size() > _BACKLOG:
            writer.transport.abort()
