"""Client's side of a TCP connection that is made again after every loss."""

from __future__ import annotations

import asyncio
from abc import ABC, abstractmethod
from dataclasses import dataclass
from enum import Enum
from typing import NoReturn

from thbridge.files.errors import reason_of
from thbridge.protocols.text.client import ServerCloseReason


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


class ReconnectingClient(ABC):
    """Connects to a server, again and again until `run` is cancelled.

    Args:
        host: host of the server.
        port: port of the server.
        backoff: delays between two attempts.
        segment: bytes that are read at a time.
    """

    def __init__(self, host: str, port: int, backoff: Backoff, segment: int) -> None:
        self._host = host
        self._port = port
        self._backoff = backoff
        self._segment = segment
        self._writer: asyncio.StreamWriter | None = None  # while the server has accepted us
        self._reason: LossReason | None = None

    async def run(self) -> NoReturn:
        """Keep connected for ever."""
        delay = self._backoff.initial
        while True:
            loss = await self._converse()
            if self._reason is None:
                delay = self._backoff.initial
            if loss.reason is not self._reason:
                self._reason = loss.reason
                await self._lost(loss)
            await asyncio.sleep(delay)
            delay = min(2.0 * delay, self._backoff.maximum)

    def _accepted(self, writer: asyncio.StreamWriter) -> None:
        """Note that the server has accepted us."""
        self._writer = writer
        self._reason = None

    @abstractmethod
    async def _lost(self, loss: ConnectionLost) -> None:
        """Report a loss for a new reason."""

    @abstractmethod
    async def _listen(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> ConnectionLost:
        """Exchange messages until the connection ends; return the reason."""

    async def _converse(self) -> ConnectionLost:
        """Connect once and exchange messages until the connection ends, for any reason."""
        try:
            async with asyncio.timeout(self._backoff.timeout):
                reader, writer = await asyncio.open_connection(self._host, self._port, limit=self._segment)
        except (OSError, UnicodeError, OverflowError) as error:
            reason = reason_of(error) if isinstance(error, OSError) else str(error)
            return ConnectionLost(LossReason.UNREACHABLE, f"{self._host}:{self._port}: {reason}")
        try:
            return await self._listen(reader, writer)
        except OSError as error:
            return ConnectionLost(LossReason.BROKEN, str(error))
        finally:
            self._writer = None
            writer.close()
