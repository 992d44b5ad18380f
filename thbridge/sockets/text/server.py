"""Text server's sockets: carries out the router's decisions over TCP.

Everything runs on the thread of one event loop, the router included. A session that runs programs inside this process
steps them on the same loop, and wraps the router, so it sees all input.
"""

from __future__ import annotations

import asyncio
import logging
import time
from asyncio import BufferedProtocol, Transport
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from typing import Protocol

from thbridge.protocols.text.router import (
    ClientJoined,
    ClientLeft,
    CloseConnection,
    ConnectionId,
    Forwarded,
    LineSkipped,
    RouterLimits,
    RouterOutput,
    SendToClient,
    TurnedAway,
)
from thbridge.sockets.addresses import DEBIAN_HOST, LOCALHOST, TEXT_SERVER_PORT, ListeningAddress
from thbridge.sockets.admission import OWN_MACHINE, Admission
from thbridge.sockets.errors import CannotListen
from thbridge.sockets.http_refusal import begins_http
from thbridge.sockets.listening import ServerDoor
from thbridge.sockets.warn_once import WarnOnce

_log = logging.getLogger(__name__)

_SEGMENT = 16 * 1024
"""Bytes handled at a time, so that a client that floods the server leaves time for the others."""

_LINGER = 1.0
"""Seconds that a client has to read its last line before the connection is cut off."""

_MOST_LINGERING = 64
"""Connections that may be read their last line at a time."""

_CHECK_INTERVAL = 1.0
"""Seconds between two checks for idle clients."""


class RouterInterface(Protocol):
    """Decisions for a server: a `MessageRouter`, which describes the methods, or a wrapper of one."""

    def make_room(self, now: float) -> Sequence[RouterOutput]:
        """Make room for a connection, where the server is full."""

    def connect(self, now: float) -> ConnectionId | TurnedAway:
        """Accept a connection."""

    def receive_data(self, connection: ConnectionId, data: bytes, now: float) -> Sequence[RouterOutput]:
        """Handle received bytes."""

    def admits(self, connection: ConnectionId) -> bool:
        """Return True when a connection may say another line before the next `TextServer.perform`."""

    def eof(self, connection: ConnectionId) -> Sequence[RouterOutput]:
        """Remove a connection that has ended."""

    def report_backlog(self, connection: ConnectionId, size: int) -> Sequence[RouterOutput]:
        """Note the bytes that wait for a connection."""

    def advance(self, now: float) -> Sequence[RouterOutput]:
        """Ping idle connections."""

    def stop(self) -> Sequence[RouterOutput]:
        """Close all connections."""


def _ignore(forwarded: Forwarded) -> None:
    """Do nothing."""


class TextServer:
    """TCP server of one router.

    Args:
        router: makes the decisions; it may have local endpoints without a socket.
        tap: called with every message passed on, delivered or not, in order. It must not raise.
        clock: returns seconds; must not run backwards.
        admission: of clients by their addresses.
    """

    def __init__(
        self,
        router: RouterInterface,
        tap: Callable[[Forwarded], None] = _ignore,
        clock: Callable[[], float] = time.monotonic,
        admission: Admission = OWN_MACHINE,
    ) -> None:
        self._admission = admission
        self._router = router
        self._tap = tap
        self._clock = clock
        self._transports: dict[ConnectionId, Transport] = {}
        self._open: set[Transport] = set()
        self._held: dict[ConnectionId, _Connection] = {}
        self.complaints = WarnOnce(_log)
        """What clients do wrong."""
        self._all_closed = asyncio.Event()
        # Those turned away linger beside the router's.
        self._door = ServerDoor(RouterLimits().clients + _MOST_LINGERING)
        self._named: set[ConnectionId] = set()
        self._watch: asyncio.Task[None] | None = None

    async def start(self, host: str = LOCALHOST, port: int = TEXT_SERVER_PORT) -> ListeningAddress | CannotListen:
        """Begin to serve; port 0 takes any that is free.

        Whoever asks for `LOCALHOST` gets `DEBIAN_HOST`, too, where the machine has it and nobody else serves there.
        """
        if not 0 <= port <= 65535:
            return CannotListen(host, port, "a port is a number from 0 to 65535")
        try:
            address = await self._door.listen(lambda: _Connection(self), host, port)
        except (OSError, UnicodeError) as error:
            return CannotListen.because(error, host, port)
        self._watch = asyncio.get_running_loop().create_task(self._check_idle())
        if host == LOCALHOST:
            try:
                await self._door.listen(lambda: _Connection(self), DEBIAN_HOST, address.port)
            except OSError as error:
                _log.info("programs that expect the server at %s do not find it: %s", DEBIAN_HOST, error)
        return address

    async def stop(self) -> None:
        """Send the shutdown line to every client, wait a moment for them to close, and close the port."""
        if self._watch is None:
            return
        self._door.close()
        self._watch.cancel()
        self._perform(self._router.stop())
        while self._open:
            self._all_closed.clear()
            await self._all_closed.wait()
        await self._door.wait_closed()

    def perform(self, outputs: Iterable[RouterOutput]) -> None:
        """Carry out outputs of the router, and hear on whoever has said too much before."""
        self._perform(outputs)
        held, self._held = self._held, {}
        for connection in held.values():
            connection.go_on()

    def hold(self, connection: ConnectionId, held: _Connection) -> None:
        """Hear no more of a connection until the next `perform`."""
        self._held[connection] = held

    def admits(self, connection: ConnectionId) -> bool:
        """Return True when a connection may say another line now."""
        return self._router.admits(connection)

    def _perform(self, outputs: Iterable[RouterOutput]) -> None:
        """Carry out outputs of the router, and those that follow from them."""
        waiting = deque(outputs)
        while waiting:
            output = waiting.popleft()
            match output:
                case SendToClient(connection, data):
                    transport = self._transports.get(connection)
                    if transport is not None:
                        transport.write(data)
                        waiting += self._router.report_backlog(connection, transport.get_write_buffer_size())
                case CloseConnection(connection, reason):
                    _log.info("client %d is closed: %s", connection, reason.value)
                    transport = self._transports.pop(connection, None)
                    if transport is not None:
                        _close(transport, reason.flush)
                case LineSkipped(connection, length):
                    self.complaints.warn(f"client {connection} sent a line that is too long; skipped")
                    _log.info("client %d sent a line of %d bytes", connection, length)
                case ClientJoined(connection, name):
                    _log.info("client %d is %s", connection, name)
                    self._named.add(connection)
                case ClientLeft(connection, name):
                    _log.info("client %d is %s no more", connection, name)
                    self._named.discard(connection)
                case Forwarded():
                    self._tap(output)

    def connected(self, transport: Transport) -> ConnectionId | None:
        """Accept a new connection, or turn it away; cut off one whose machine is not admitted."""
        stranger = self._admission.refused(transport)
        if stranger is not None:
            self.complaints.warn(f"{stranger} is in none of the networks of open_to, and is cut off")
            transport.abort()
            return None
        if len(self._open) >= self._door.most:
            # Descriptors are short: the oldest who has not said a name goes, as if it had ended by itself.
            self.complaints.warn(f"more than {self._door.most} connections are more than there are descriptors for")
            nameless = next((each for each in self._transports if each not in self._named), None)
            if nameless is None:
                transport.abort()
                return None
            self._transports[nameless].abort()
            self.ended(nameless)
        self._open.add(transport)
        now = self._clock()
        self._perform(self._router.make_room(now))
        connection = self._router.connect(now)
        if isinstance(connection, TurnedAway):
            self.complaints.warn("a client is turned away: the server is full")
            transport.write(connection.farewell)
            # Of those turned away few may linger: file descriptors are needed for what is recorded.
            _close(transport, flush=len(self._open) - len(self._transports) <= _MOST_LINGERING)
            return None
        self._transports[connection] = transport
        return connection

    def received(self, connection: ConnectionId, data: bytes) -> None:
        """Handle received bytes of a connection."""
        self._perform(self._router.receive_data(connection, data, self._clock()))

    def ended(self, connection: ConnectionId) -> None:
        """Handle the end of a client's bytes."""
        self._perform(self._router.eof(connection))
        self._transports.pop(connection, None)

    def lost(self, transport: Transport) -> None:
        """Remove a connection that is closed on both sides."""
        self._open.discard(transport)
        self._all_closed.set()

    async def _check_idle(self) -> None:
        while True:
            await asyncio.sleep(_CHECK_INTERVAL)
            self._perform(self._router.advance(self._clock()))


class _Connection(BufferedProtocol):
    """One TCP connection. Bytes that come after its end are read and ignored.

    If they were left unread, closing the socket would reset the connection and could destroy the shutdown line on its
    way.

    asyncio sends each write at once (TCP_NODELAY), which matters: the C++ client of 2016 takes one segment for one
    line, and would overlook a ``%%goto`` that shares one with an ack.
    """

    def __init__(self, server: TextServer) -> None:
        self._server = server
        self._buffer = bytearray(_SEGMENT)
        self._id: ConnectionId | None = None
        self._transport: Transport | None = None
        self._begun = False
        self._waiting = b""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        if isinstance(transport, Transport):
            self._transport = transport
            self._id = self._server.connected(transport)

    def get_buffer(self, sizehint: int) -> bytearray:
        return self._buffer

    def buffer_updated(self, nbytes: int) -> None:
        begun, self._begun = self._begun, True
        if not begun and self._transport is not None and begins_http(bytes(self._buffer[:nbytes])):
            self._server.complaints.warn("a client speaks HTTP, as a page in a browser does, and is cut off")
            self._transport.abort()
            return
        self._hear(self._waiting + self._buffer[:nbytes])

    def go_on(self) -> None:
        """Hear what waits, and what comes."""
        if self._transport is not None and not self._transport.is_closing():
            self._transport.resume_reading()
            self._hear(self._waiting)

    def _hear(self, data: bytes) -> None:
        """Pass on line by line as much as is admitted; the rest waits, here and in the other side's socket."""
        begin, self._waiting = 0, b""
        while begin < len(data) and self._transport is not None and self._id is not None:
            if self._transport.is_closing():
                return
            if not self._server.admits(self._id):
                self._waiting = data[begin:]
                self._transport.pause_reading()
                self._server.hold(self._id, self)
                return
            end = data.find(b"\n", begin) + 1 or len(data)
            self._server.received(self._id, data[begin:end])
            begin = end

    def eof_received(self) -> None:
        if self._id is not None:
            self._server.ended(self._id)
        if self._transport is not None:
            _close(self._transport, flush=True)

    def connection_lost(self, exc: Exception | None) -> None:
        if self._id is not None:
            self._server.ended(self._id)
        if self._transport is not None:
            self._server.lost(self._transport)


def _close(transport: Transport, flush: bool) -> None:
    """Close a connection: at once, or after the other side has had a moment to read what it was sent."""
    if flush:
        try:
            transport.write_eof()
        except OSError:  # the other side is gone already, though asyncio has not heard of it yet
            flush = False
    if flush:
        asyncio.get_running_loop().call_later(_LINGER, transport.abort)
    else:
        transport.abort()
