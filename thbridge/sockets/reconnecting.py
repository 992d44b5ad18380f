"""Client's part of a TCP connection that is restored after every loss."""

from __future__ import annotations

import asyncio
import ssl
from abc import ABC, abstractmethod
from dataclasses import dataclass
from enum import Enum
from typing import NoReturn

from thbridge.files.errors import reason_of
from thbridge.files.keys.key_file import ClientKey
from thbridge.sockets.admission import is_own
from thbridge.sockets.tls import UntrustedServer, check_server, client_context


class LossReason(Enum):
    """Reason why there is no connection to the server."""

    UNREACHABLE = "the server cannot be reached"
    BROKEN = "the connection broke"
    UNTRUSTED = "the server is not the one that the key is for"
    REFUSED = "our name is already held, or the server is full"
    STOPPED = "the server stops"


@dataclass(frozen=True, slots=True)
class ConnectionLost:
    """Loss of the connection. The client keeps trying to reconnect. Each new reason causes one event."""

    reason: LossReason
    detail: str = ""


@dataclass(frozen=True, slots=True)
class Backoff:
    """Delays between attempts to connect, and timeout of a connection, in seconds.

    Attributes:
        initial: delay before the first reconnection. It doubles at each further reconnection.
        maximum: maximum delay between two attempts.
        timeout: a connection counts as broken after this time without a byte from the server. The server pings
            idle clients every 15 s.
    """

    initial: float = 0.25
    maximum: float = 5.0
    timeout: float = 45.0


class ReconnectingClient(ABC):
    """Client that connects to a server again after every loss, until `run` is cancelled.

    Args:
        host: host of the server.
        port: port of the server.
        backoff: delays between two attempts.
        segment: maximum number of bytes that are read at a time.
        key: key to present to the server. If None, no key is presented. Only servers of this machine accept this.
        may_be_plain: True if a key without a fingerprint may be sent to servers of this machine without encryption.
    """

    def __init__(
        self,
        host: str,
        port: int,
        backoff: Backoff,
        segment: int,
        key: ClientKey | None = None,
        *,
        may_be_plain: bool = False,
    ) -> None:
        self._host = host
        self._port = port
        self._backoff = backoff
        self._segment = segment
        self._key = key
        plain = key is None or (may_be_plain and key.fingerprint is None and is_own(host))
        self._context = None if key is None or plain else client_context(key)
        self._writer: asyncio.StreamWriter | None = None  # None while the server has not accepted us.
        self._reason: LossReason | None = None

    async def run(self) -> NoReturn:
        """Stay connected until cancelled."""
        delay = self._backoff.initial
        while True:
            loss = await self._converse()
            if self._reason is None:
                # The server had accepted us, so this loss is new. Start with the shortest delay again.
                delay = self._backoff.initial
            if loss.reason is not self._reason:
                self._reason = loss.reason
                await self._lost(loss)
            await asyncio.sleep(delay)
            delay = min(2.0 * delay, self._backoff.maximum)

    def _accepted(self, writer: asyncio.StreamWriter) -> None:
        """Record that the server has accepted us."""
        self._writer = writer
        self._reason = None

    @abstractmethod
    async def _lost(self, loss: ConnectionLost) -> None:
        """Report a loss for a new reason."""

    @abstractmethod
    async def _listen(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> ConnectionLost:
        """Exchange messages until the connection ends. Return the reason."""

    async def _converse(self) -> ConnectionLost:
        """Connect once, exchange messages until the connection ends, and return the reason for the end."""
        try:
            async with asyncio.timeout(self._backoff.timeout):
                reader, writer = await asyncio.open_connection(
                    self._host, self._port, limit=self._segment, ssl=self._context
                )
        # This is a subclass of SSLError, so it must be caught first.
        except ssl.SSLCertVerificationError as error:
            return ConnectionLost(LossReason.UNTRUSTED, f"{self._host}:{self._port}: {error.verify_message}")
        except ssl.SSLError as error:
            return ConnectionLost(LossReason.UNTRUSTED, f"{self._host}:{self._port} does not use TLS ({error.reason})")
        # An invalid host name raises UnicodeError, and an invalid port OverflowError.
        except (OSError, UnicodeError, OverflowError) as error:
            reason = reason_of(error) if isinstance(error, OSError) else str(error)
            return ConnectionLost(LossReason.UNREACHABLE, f"{self._host}:{self._port}: {reason}")
        try:
            if self._key is not None and self._context is not None:
                # The server must be checked before the key is sent, because a false server could use the key.
                check_server(writer.transport, self._key)
            return await self._listen(reader, writer)
        except UntrustedServer as error:
            return ConnectionLost(LossReason.UNTRUSTED, f"{self._host}:{self._port}: {error}")
        except OSError as error:
            return ConnectionLost(LossReason.BROKEN, str(error))
        finally:
            self._writer = None
            writer.close()
