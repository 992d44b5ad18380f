"""Sockets of the text server. They carry out the router's decisions over TCP.

Everything runs on the thread of one event loop, including the router. So no locks are needed. A session steps
the programs of this process on the same loop. It wraps the router in order to record all input.
"""

from __future__ import annotations

import asyncio
import logging
import socket
import time
from asyncio import BufferedProtocol, Transport
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from typing import Protocol

from thbridge.credentials import LOCAL, PLAIN, Credentials, KeyAnswer, Right, secret_of
from thbridge.sockets.addresses import DEBIAN_HOST, LOCALHOST, TEXT_SERVER_PORT, ListeningAddress
from thbridge.sockets.admission import OWN_MACHINE, Admission, peer_of
from thbridge.sockets.errors import CannotListen
from thbridge.sockets.http_refusal import begins_http
from thbridge.sockets.keys import RingKeys
from thbridge.sockets.listening import ServerDoor, address_of, bind
from thbridge.sockets.tls import is_encrypted
from thbridge.sockets.warn_once import WarnOnce
from thbridge.text_protocol.wire.router import (
    SHUTDOWN_LINE,
    ClientJoined,
    ClientLeft,
    CloseConnection,
    CloseReason,
    ConnectionId,
    Forwarded,
    LineSkipped,
    RouterLimits,
    RouterOutput,
    SendToClient,
    TurnedAway,
    farewell,
    right_of,
)

_log = logging.getLogger(__name__)

_SEGMENT = 16 * 1024
"""Maximum number of bytes that are handled at a time. So a client that floods the server does not block the others."""

_LINGER = 1.0
"""Seconds that a client has to read its last line before the connection is closed."""

_MOST_LINGERING = 64
"""Maximum number of rejected connections that stay open until the client has read its last line."""

_CHECK_INTERVAL = 1.0
"""Seconds between two checks for idle clients and for keys that are no longer valid."""

_KEY_SECONDS = 10.0
"""Seconds that an encrypted connection has to send its key."""

_WRONG_KEY_SECONDS = 1.0
"""Seconds before the server rejects a wrong key, so that a connection cannot try many keys."""

_LONGEST_KEY_LINE = 4096

_MOST_WITHOUT_KEY = 64
"""Maximum number of encrypted connections without a valid key. A further connection replaces the oldest connection."""


class RouterInterface(Protocol):
    """Interface of a server's router: a `MessageRouter`, which documents the methods, or a wrapper of it."""

    def make_room(self, now: float) -> Sequence[RouterOutput]:
        """Close an idle connection if the server is full."""

    def connect(self, now: float, credentials: Credentials = LOCAL) -> ConnectionId | TurnedAway:
        """Accept a connection."""

    def receive_data(self, connection: ConnectionId, data: bytes, now: float) -> Sequence[RouterOutput]:
        """Handle received bytes."""

    def admits(self, connection: ConnectionId) -> bool:
        """Return True if a connection may send another line before the next `TextServer.perform`."""

    def eof(self, connection: ConnectionId) -> Sequence[RouterOutput]:
        """Remove a connection that has ended."""

    def report_backlog(self, connection: ConnectionId, size: int) -> Sequence[RouterOutput]:
        """Record the number of bytes that are queued for a connection."""

    def advance(self, now: float) -> Sequence[RouterOutput]:
        """Ping idle connections."""

    def stop(self) -> Sequence[RouterOutput]:
        """Close all connections."""


class TextServer:
    """TCP server of one router. It accepts plain connections. If there are keys, it also accepts TLS connections.

    Args:
        clock: returns seconds. It must not run backward.
        admission: admission of plain connections, by address.
        keys: keys for the admission of TLS connections from any machine. If None, there are no TLS connections.
    """

    def __init__(
        self,
        clock: Callable[[], float] = time.monotonic,
        admission: Admission = OWN_MACHINE,
        keys: RingKeys | None = None,
    ) -> None:
        self._admission = admission
        self._keys = keys
        self._with_key: dict[ConnectionId, Credentials] = {}
        self._without_key: dict[_Connection, None] = {}
        self._game: str | None = None
        self._over = False
        self._router: RouterInterface
        self._clock = clock
        self._transports: dict[ConnectionId, Transport] = {}
        self._open: set[Transport] = set()
        self._held: dict[ConnectionId, _Connection] = {}
        self.complaints = WarnOnce(_log)
        """Warnings about clients."""
        self._all_closed = asyncio.Event()
        # The sum counts the router's connections, rejected connections, and connections without a key.
        self._door = ServerDoor(RouterLimits().clients + _MOST_LINGERING + _MOST_WITHOUT_KEY)
        self._bound: list[socket.socket] = []
        self._names: dict[ConnectionId, str] = {}
        self._watch: asyncio.Task[None] | None = None

    async def start(
        self, router: RouterInterface, host: str = LOCALHOST, port: int = TEXT_SERVER_PORT
    ) -> ListeningAddress | CannotListen:
        """Open the port and begin to serve; see `open` and `serve`."""
        address = await self.open(host, port)
        if isinstance(address, ListeningAddress):
            self.serve(router)
        return address

    async def open(self, host: str = LOCALHOST, port: int = TEXT_SERVER_PORT) -> ListeningAddress | CannotListen:
        """Open the port. Connections wait until `serve`.

        Args:
            host: address to listen on. With `LOCALHOST` the server also listens on `DEBIAN_HOST`, if the machine has
                that address and no other program listens there.
            port: TCP port. 0 selects any free port.
        """
        if not 0 <= port <= 65535:
            return CannotListen(host, port, "a port must be a number from 0 to 65535")
        try:
            self._bound = await bind(host, port)
        except (OSError, UnicodeError) as error:
            return CannotListen.because(error, host, port)
        address = address_of(self._bound)
        if host == LOCALHOST:
            # The participant's window of 2016 connects to the machine's own name, which Debian maps to this address.
            try:
                self._bound += await bind(DEBIAN_HOST, address.port)
            except OSError as error:
                _log.info("programs that connect to %s cannot reach the server: %s", DEBIAN_HOST, error)
        return address

    def serve(self, router: RouterInterface) -> None:
        """Accept connections at the open port.

        Args:
            router: router that decides about all lines. It may have local endpoints, which have no socket.
        """
        self._router = router
        tls = None if self._keys is None else self._keys.tls
        bound, self._bound = self._bound, []
        for each in bound:
            self._door.accept(lambda: _Connection(self), each, tls)
        self._watch = asyncio.get_running_loop().create_task(self._check_idle())

    async def stop(self) -> None:
        """Send the shutdown line to every client, wait a moment for them to close, and close the port."""
        for each in self._bound:
            each.close()
        if self._watch is None:
            return
        self._door.close()
        self._watch.cancel()
        # The router does not know these connections, so they are closed here.
        for connection in tuple(self._without_key):
            connection.abort()
        self._perform(self._router.stop())
        while self._open:
            self._all_closed.clear()
            await self._all_closed.wait()
        await self._door.wait_closed()

    def drop_connections(self) -> None:
        """Close all connections at once. Lines that were not sent yet are lost."""
        for transport in tuple(self._open):
            transport.abort()

    def perform(self, outputs: Iterable[RouterOutput]) -> None:
        """Carry out outputs of the router, and resume reading from throttled clients."""
        self._perform(outputs)
        held, self._held = self._held, {}
        for connection in held.values():
            connection.go_on()

    def hold(self, connection: ConnectionId, held: _Connection) -> None:
        """Throttle a connection: stop reading from it until the next `perform`."""
        self._held[connection] = held

    def admits(self, connection: ConnectionId) -> bool:
        """Return True if a connection may send another line now."""
        return self._router.admits(connection)

    def _perform(self, outputs: Iterable[RouterOutput]) -> None:
        """Carry out outputs of the router, and the outputs that follow from these."""
        waiting = deque(outputs)
        while waiting:
            output = waiting.popleft()
            match output:
                case SendToClient(connection, data):
                    transport = self._transports.get(connection)
                    if transport is not None:
                        transport.write(data)
                        waiting += self._router.report_backlog(connection, transport.get_write_buffer_size())
                case CloseConnection(connection, reason, warning):
                    if warning:
                        self.complaints.warn(warning)
                    _log.info("client %d is disconnected: %s", connection, reason.value)
                    transport = self._transports.pop(connection, None)
                    if transport is not None:
                        _close(transport, reason.flush)
                case LineSkipped(connection, length):
                    self.complaints.warn(f"client {connection} sent a line that is too long; the line is skipped")
                    _log.info("client %d sent a line of %d bytes", connection, length)
                case ClientJoined(connection, name):
                    _log.info("client %d has registered the name %s", connection, name)
                    self._names[connection] = name
                    self._enter_game(connection)
                case ClientLeft(connection, name):
                    _log.info("client %d has given up the name %s", connection, name)
                    self._names.pop(connection, None)
                case Forwarded():
                    pass  # Only the session uses this output. The server has nothing to send.

    def note_game(self, name: str, over: bool) -> None:
        """Record the unique name of the present or next game, and whether the game is over.

        Participants with keys enter this game. From then on, their keys are valid only for this game. A game that is
        over admits no new participants.
        """
        if (name, over) != (self._game, self._over):
            self._game, self._over = name, over
            for connection in tuple(self._with_key):
                self._enter_game(connection)

    # Connections

    def arrived(self, connection: _Connection, transport: Transport) -> bool:
        """Admit a new connection. Return False if the server is full or does not admit the client's machine."""
        encrypted = is_encrypted(transport)
        # Clients with TLS may be on any machine, because they must present a key.
        stranger = None if encrypted else self._admission.refused(transport)
        if stranger is not None:
            self.complaints.warn(f"a client at {stranger} is rejected: its address is in no network of open_to")
            transport.abort()
            return False
        if len(self._open) >= self._door.most:
            # File descriptors are scarce, so the oldest connection without a name is closed.
            self.complaints.warn(f"a connection is closed: all {self._door.most} available file descriptors are in use")
            nameless = next((each for each in self._transports if each not in self._names), None)
            if nameless is None:
                transport.abort()
                return False
            self._transports[nameless].abort()
            self.ended(nameless)
        self._open.add(transport)
        if encrypted:
            if len(self._without_key) >= _MOST_WITHOUT_KEY:
                oldest = next(iter(self._without_key))
                del self._without_key[oldest]
                oldest.abort()
            self._without_key[connection] = None
        return True

    def identify(self, line: bytes) -> Credentials | str:
        """Return the credentials of the key in a line, or the reason why it is refused, as a clause."""
        secret = secret_of(line)
        if secret is None or self._keys is None:
            return "a key is required"
        return self._keys.identify(secret)

    def connected(
        self, connection: _Connection, transport: Transport, shown: Credentials | None
    ) -> ConnectionId | None:
        """Accept or reject a connection. `shown` contains the credentials of its key. If None, it has no key."""
        self._without_key.pop(connection, None)
        now = self._clock()
        self._perform(self._router.make_room(now))
        accepted = self._router.connect(now, shown or (LOCAL if peer_of(transport) is None else PLAIN))
        if isinstance(accepted, TurnedAway):
            self.complaints.warn("a client is rejected: the server is full")
            transport.write(accepted.farewell)
            # Few rejected connections may stay open, because recordings need file descriptors.
            _close(transport, flush=len(self._open) - len(self._transports) <= _MOST_LINGERING)
            return None
        self._transports[accepted] = transport
        if shown is not None:
            self._with_key[accepted] = shown
        return accepted

    def received(self, connection: ConnectionId, data: bytes) -> None:
        """Handle received bytes of a connection."""
        self._perform(self._router.receive_data(connection, data, self._clock()))

    def ended(self, connection: ConnectionId) -> None:
        """Handle the end of the bytes from a client."""
        self._with_key.pop(connection, None)
        self._perform(self._router.eof(connection))
        self._transports.pop(connection, None)

    def lost(self, connection: _Connection, transport: Transport) -> None:
        """Remove a connection that is closed on both sides."""
        self._without_key.pop(connection, None)
        self._open.discard(transport)
        self._all_closed.set()

    async def _check_idle(self) -> None:
        while True:
            await asyncio.sleep(_CHECK_INTERVAL)
            self._perform(self._router.advance(self._clock()))
            if self._keys is not None:
                # A key may be revoked while its client is connected.
                for connection, credentials in tuple(self._with_key.items()):
                    self._turn_out(connection, self._keys.why_not(credentials))

    def _enter_game(self, connection: ConnectionId) -> None:
        """Add a participant with a key to the present game. End the connection if its key does not allow this game."""
        credentials, name = self._with_key.get(connection), self._names.get(connection)
        if self._keys is None or self._game is None or credentials is None or name is None:
            return
        if credentials.one_game and right_of(name) is Right.PARTICIPANT:
            self._turn_out(connection, self._keys.enter(credentials.key, self._game, over=self._over))

    def _turn_out(self, connection: ConnectionId, reason: str | None) -> None:
        """End a connection if there is a reason why its key is no longer valid."""
        if reason is None:
            return
        name = self._names.get(connection)
        sent = SendToClient(connection, SHUTDOWN_LINE if name is None else farewell(name, reason))
        self._with_key.pop(connection, None)
        self._perform([sent])
        self._perform([*self._router.eof(connection), CloseConnection(connection, CloseReason.NOT_ENTITLED)])


class _Connection(BufferedProtocol):
    """One TCP connection. Bytes that arrive after the end of the connection are read and ignored.

    If they were left unread, closing the socket would reset the connection, and the shutdown line could be lost.

    asyncio sends each write at once (TCP_NODELAY). This is important, because the C++ client of 2016 treats a segment
    as one line. It would overlook a ``%%goto`` in the same segment as an ack.
    """

    def __init__(self, server: TextServer) -> None:
        self._server = server
        self._buffer = bytearray(_SEGMENT)
        self._id: ConnectionId | None = None
        self._transport: Transport | None = None
        self._begun = False
        self._waiting = b""
        self._awaits_key = False
        self._timer: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        if not isinstance(transport, Transport) or not self._server.arrived(self, transport):
            return
        self._transport = transport
        if is_encrypted(transport):
            self._awaits_key = True
            self._timer = asyncio.get_running_loop().call_later(_KEY_SECONDS, self._refuse, "a key is required")
        else:
            self._id = self._server.connected(self, transport, None)

    def get_buffer(self, sizehint: int) -> memoryview:
        # asyncio reads further TLS records into slices. Slices of a bytearray would be copies, so this is a memoryview.
        return memoryview(self._buffer)

    def buffer_updated(self, nbytes: int) -> None:
        data = self._waiting + self._buffer[:nbytes]
        if self._awaits_key:
            self._take_key(data)
            return
        begun, self._begun = self._begun, True
        # Web pages can open only connections that begin with an HTTP request, so the first bytes are enough.
        if not begun and self._transport is not None and begins_http(data):
            self._server.complaints.warn("a client is rejected: it sent HTTP, as web pages in browsers do")
            self._transport.abort()
            return
        self._read(data)

    def abort(self) -> None:
        """Close the connection at once."""
        if self._transport is not None:
            self._transport.abort()

    def _take_key(self, data: bytes) -> None:
        """Collect bytes of the first line, which contains the key. Answer the line when it is complete."""
        line, newline, rest = data.partition(b"\n")
        if self._transport is None or self._timer is None:
            return
        if not newline and len(line) <= _LONGEST_KEY_LINE:
            self._waiting = data
            return
        self._timer.cancel()
        found = self._server.identify(line)
        if isinstance(found, str):
            # Nothing is read until the answer, so that the client cannot try another key at once.
            self._transport.pause_reading()
            self._timer = asyncio.get_running_loop().call_later(_WRONG_KEY_SECONDS, self._refuse, found)
            return
        self._awaits_key, self._begun = False, True
        self._transport.write(KeyAnswer(admitted=found.key).line())
        self._id = self._server.connected(self, self._transport, found)
        self._read(rest)

    def _refuse(self, reason: str) -> None:
        """Send a client the reason why its key is refused, and close the connection."""
        if self._transport is not None and not self._transport.is_closing():
            self._transport.write(KeyAnswer(refused=reason).line())
            _close(self._transport, flush=True)

    def go_on(self) -> None:
        """Process the waiting bytes, and resume reading."""
        if self._transport is not None and not self._transport.is_closing():
            self._transport.resume_reading()
            self._read(self._waiting)

    def _read(self, data: bytes) -> None:
        """Pass the admitted lines to the server, one by one.

        Other lines wait here. As reading pauses, still later lines wait in the client's socket (back-pressure).
        """
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
        if self._timer is not None:
            self._timer.cancel()
        if self._transport is not None:
            self._server.lost(self, self._transport)
            # A TLS transport uses much memory and refers to this object. This breaks the reference cycle.
            self._transport = None


def _close(transport: Transport, flush: bool) -> None:
    """Close a connection. If `flush`, first give the other side a moment to read the last bytes."""
    if flush and transport.can_write_eof():
        try:
            transport.write_eof()
        except OSError:  # The other side has closed the connection, but asyncio has not noticed it yet.
            flush = False
    elif flush:
        transport.close()  # TLS sends the pending bytes and then closes both directions at once.
    if flush:
        # A client that does not read must not keep the connection open.
        asyncio.get_running_loop().call_later(_LINGER, transport.abort)
    else:
        transport.abort()
