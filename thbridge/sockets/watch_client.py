"""The other side of the watch door: hears a session over TCP and asks for things, come what may."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NoReturn, TypeAlias

from thbridge.files.errors import reason_of
from thbridge.sockets.text_client import Backoff, ConnectionLost, LossReason
from thbridge.wire.watch_protocol import BagStreamReader, BrokenStream, SessionMessage, key_line, status_in

_SEGMENT = 256 * 1024
_WAITING = 20_000
"""Messages that may wait to be taken; after that the session's door has to wait, and drops some in the end."""
_NAP = 0.02
_SILENCE = 10.0
"""Seconds without a word, of a door that says something every second, until the connection counts as broken."""


@dataclass(frozen=True, slots=True)
class WatchConnected:
    """The session can be heard (again), from what is in force on."""


WatchEvent: TypeAlias = WatchConnected | SessionMessage | ConnectionLost


class WatchClient:
    """Hears a session, again and again until `run` is cancelled.

    `run` belongs on an event loop, for example that of a thread of its own; everything else may be called from any
    thread.

    Args:
        host: of the door.
        port: of the door.
        key: that it wants; None: none.
        patience: how to wait between two attempts.
    """

    def __init__(self, host: str, port: int, key: str | None = None, patience: Backoff | None = None) -> None:
        self._host = host
        self._port = port
        self._key = key
        self._patience = patience or Backoff(silence=_SILENCE)
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
        """What has come, oldest first, without waiting."""
        events: list[WatchEvent] = []
        while self._events:
            events.append(self._events.popleft())
        return events

    def send(self, line: bytes) -> bool:
        """Say a line, such as `app.session.watching.request_line` makes; False when nobody hears it just now."""
        loop, writer = self._loop, self._writer
        if loop is None or writer is None or loop.is_closed():
            return False
        loop.call_soon_threadsafe(writer.write, line)
        return True

    def _delays(self) -> Iterator[float]:
        delay = self._patience.first
        while True:
            yield delay
            delay = min(2.0 * delay, self._patience.longest)

    async def _converse(self) -> ConnectionLost:
        """Connect once and listen until the connection ends, for whatever reason."""
        try:
            async with asyncio.timeout(self._patience.silence):
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
                async with asyncio.timeout(self._patience.silence):
                    data = await reader.read(_SEGMENT)
            except TimeoutError:
                return ConnectionLost(LossReason.BROKEN, f"nothing was heard for {self._patience.silence:g} s")
            if not data:
                if self._writer is None and refused:
                    return ConnectionLost(LossReason.REFUSED, refused)
                return ConnectionLost(LossReason.BROKEN, "the session closed the connection")
            for heard in stream.feed(data):
                if isinstance(heard, BrokenStream):
                    return ConnectionLost(LossReason.BROKEN, heard.reason)
                status = status_in(heard)
                if status is not None and status.refused is not None:
                    refused = status.refused.reason
                elif self._writer is None:
                    # The first word is something in force; whoever is turned away hears a refusal alone.
                    self._writer = writer
                    self._reason = None
                    self._events.append(WatchConnected())
                if self._writer is not None:
                    self._events.append(heard)
