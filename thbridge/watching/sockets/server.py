"""Watch server, which sends a session's messages over TCP to researchers' windows, and handles their requests.

All code runs on the thread of one event loop. Watchers cannot slow the session down: unread messages are in a bounded
queue. When the queue is full, messages are dropped, and the status contains the number of dropped messages.
"""

from __future__ import annotations

import asyncio
import logging
from asyncio import Protocol as AsyncioProtocol
from asyncio import Transport
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Protocol

from thbridge.credentials import Right
from thbridge.files.ros.definitions import Definitions
from thbridge.recording.bag.writing.stream import BEGINNING, BagStream, ChunkMaker
from thbridge.ros.messages import types
from thbridge.ros.topics import RosMessage, Topic
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.admission import peer_of
from thbridge.sockets.errors import CannotListen
from thbridge.sockets.http_refusal import begins_http
from thbridge.sockets.keys import KeyVerifier
from thbridge.sockets.listening import ServerDoor
from thbridge.sockets.tls import is_encrypted
from thbridge.sockets.warn_once import WarnOnce
from thbridge.watching.sockets.backlog import Backlog
from thbridge.watching.sockets.history import MessageHistory
from thbridge.watching.wire import (
    STATUS,
    WatcherAdmitted,
    WatcherRequest,
    WatcherSession,
    WatchRefusal,
    WatchStatus,
    refusal,
)

MAX_WATCHERS = 8
"""Maximum number of watchers at a time; further watchers are rejected."""

MAX_CONNECTIONS = 256
"""Maximum number of connections. A further connection replaces a connection that is not admitted.

The event loop accepts fewer connections at a time, so it reads a client's key before the client can be replaced.
"""

_log = logging.getLogger(__name__)

_STATUS = Topic(STATUS, types.STRING, latched=True)
_KEY_SECONDS = 10.0
"""Seconds within which a client must send its key."""
_WRONG_KEY_SECONDS = 1.0
"""Delay in seconds before the server answers that a key is wrong. After the answer, the client may try again."""
_LINGER = 1.0
"""Seconds for which a rejected watcher can still read the reason."""
_HEARTBEAT = 1.0
_SEGMENT = 256 * 1024
"""Number of bytes written to a socket at a time. It is small, because data in a socket's buffer cannot be dropped."""


@dataclass(frozen=True, slots=True)
class SessionPace:
    """Pace of the session; `WatchStatus` describes the attributes."""

    paused: bool
    rate: float
    lag: float


class WatchedSession(Protocol):
    """Session that the server shows to watchers."""

    def ask(self, watcher: str, wish: Mapping[str, object], key: str = "") -> str | None:
        """Carry out a watcher's request; `key` is the name of the watcher's key, if there is one.

        Return None, or the reason for a refusal.
        """

    def pace(self) -> SessionPace:
        """Return the session's pace."""

    def unwatched(self) -> None:
        """Record that the last watcher has disconnected."""


class WatchServer:
    """Server that sends a session's messages to all watchers, and passes their requests to the session.

    Args:
        session: the session, which carries out requests.
        keys: keys that watchers must send; watchers on other machines must use TLS. If None, all programs on this
            machine are admitted.
        definitions: message definitions. If None, the definitions of an installed ROS are used, if there is one.
        bag: path of the session's bag; None if the session records no bag.
        game: function that returns the address (HOST:PORT) of the game's text server; empty if it is not open.
    """

    def __init__(
        self,
        session: WatchedSession,
        keys: KeyVerifier | None = None,
        definitions: Definitions | None = None,
        bag: Path | None = None,
        game: Callable[[], str] = str,
    ) -> None:
        self._game = game
        self._bag = "" if bag is None else str(bag.absolute())
        self._ended = False
        self.complaints = WarnOnce(_log)
        """Warnings about clients."""
        self._session = session
        self._keys = keys
        self._stream = BagStream(definitions or Definitions())
        self._history = MessageHistory()
        self._latest: Sequence[RosMessage] = ()
        self._stamp_ns = 0
        self._watchers: list[_Watcher] = []
        self._open: dict[_Watcher, None] = {}
        self._connection_count = 0
        self._all_closed = asyncio.Event()
        self._door = ServerDoor(MAX_CONNECTIONS)
        self._heart: asyncio.Task[None] | None = None

    async def start(self, host: str, port: int) -> ListeningAddress | CannotListen:
        """Start the server; port 0 selects any free port."""
        try:
            tls = None if self._keys is None else self._keys.tls
            address = await self._door.listen(self._watcher, host, port, tls)
        except (OSError, UnicodeError) as error:
            return CannotListen.because(error, host, port)
        self._ended = False
        self._heart = asyncio.get_running_loop().create_task(self._beat())
        return address

    async def stop(self) -> None:
        """Report the end of the session, and close the port after a delay in which watchers read the last messages."""
        if self._heart is None:
            return
        self._door.close()
        self._heart.cancel()
        self._ended = True
        self.tell_status()
        for watcher in tuple(self._open):
            watcher.close()
        while self._open:
            self._all_closed.clear()
            await self._all_closed.wait()
        await self._door.wait_closed()
        self._heart = None

    def take(self, tick: int, messages: Iterable[RosMessage]) -> None:
        """Send the messages of a tick; see `thbridge.app.session.broadcast.Listener`."""
        for message in self._latest:
            self._history.take(message)
        self._latest = tuple(messages)
        for message in self._latest:
            self._stamp_ns = message.stamp_ns
        self._send(self._watchers, self._latest)

    def tell_status(self) -> None:
        """Send each watcher its status."""
        for watcher in self._watchers:
            self._send_status(watcher)

    # Connections and requests of watchers

    def connection_opened(self, watcher: _Watcher) -> int:
        """Add a connection and return its number."""
        if len(self._open) >= self._door.most:
            # Clients that have a key send the key at once. So a client with a wrong key is replaced first, then the
            # oldest client that has not sent a key.
            deaf = next((each for each in self._open if each.deaf), None)
            (deaf or next(each for each in self._open if each not in self._watchers)).abort()
        self._open[watcher] = None
        self._connection_count += 1
        return self._connection_count

    def admit(self, watcher: _Watcher) -> None:
        """Add a watcher, and send it the messages of the history, then all messages of the last tick."""
        if len(self._watchers) >= MAX_WATCHERS:
            self.turn_away(watcher, WatchRefusal("", f"{MAX_WATCHERS} watchers are connected already"))
            return
        self._watchers.append(watcher)
        _log.info("watcher %d has connected", watcher.number)
        watcher.write(BEGINNING)
        self._send([watcher], [*self._history.before(self._latest), *self._latest])
        self.tell_status()

    def turn_away(self, watcher: _Watcher, why: WatchRefusal) -> None:
        """Send the reason to a rejected client, and close the connection."""
        watcher.write(BEGINNING)
        watcher.refuse(why)
        self._send_status(watcher)
        watcher.close()

    def ask(self, watcher: _Watcher, wish: WatcherRequest) -> None:
        """Handle a watcher's request, and send the status to all watchers."""
        credentials = watcher.decoder.credentials
        if credentials.may(Right.INTERVENE):
            name = f" ({credentials.key})" if credentials.key else ""
            reason = self._session.ask(f"watcher {watcher.number}{name}", wish.value, credentials.key)
        else:
            reason = "this key allows watching only"
        if reason is None:
            watcher.decoder.granted()
        else:
            watcher.decoder.refused()
            watcher.refuse(refusal(wish.line, reason))
        self.tell_status()

    def lost(self, watcher: _Watcher) -> None:
        """Remove a connection that both sides have closed."""
        self.left(watcher)
        self._open.pop(watcher, None)
        self._all_closed.set()

    def left(self, watcher: _Watcher) -> None:
        """Remove a watcher; this has no effect if the watcher was not admitted."""
        if watcher in self._watchers:
            self._watchers.remove(watcher)
            _log.info("watcher %d has disconnected", watcher.number)
            if not self._watchers:
                self._session.unwatched()
            self.tell_status()

    # Messages to watchers

    def _send(self, watchers: Sequence[_Watcher], messages: Iterable[RosMessage]) -> None:
        if not watchers:
            return
        for message in messages:
            connection, record = self._stream.record(message)
            for watcher in watchers:
                watcher.backlog.put(connection.number, record, message.topic.latched)
        for watcher in watchers:
            watcher.flush()

    def _send_status(self, watcher: _Watcher) -> None:
        pace = self._session.pace()
        status = replace(
            watcher.status,
            paused=pace.paused,
            rate=pace.rate,
            lag=pace.lag,
            watchers=len(self._watchers),
            dropped=watcher.backlog.dropped,
            bag=self._bag,
            ended=self._ended,
            game=self._game() if watcher.decoder.credentials.may(Right.INTERVENE) else "",
        )
        self._send([watcher], [RosMessage(_STATUS, self._stamp_ns, status.data())])

    def _watcher(self) -> _Watcher:
        identify = None if self._keys is None else self._keys.identify
        return _Watcher(self, WatcherSession(identify), ChunkMaker(self._stream))

    async def _beat(self) -> None:
        while True:
            await asyncio.sleep(_HEARTBEAT)
            if self._keys is not None:
                for watcher in tuple(self._watchers):
                    reason = self._keys.why_not(watcher.decoder.credentials)
                    if reason is not None:
                        watcher.refuse(WatchRefusal("", reason))
                        self._send_status(watcher)
                        watcher.close()
            self.tell_status()


class _Watcher(AsyncioProtocol):
    """TCP connection of one watcher.

    Attributes:
        number: number of the connection, in the order of connections.
        decoder: decoder of the watcher's lines.
        backlog: messages that the watcher has not read.
        status: status after the last change.
        deaf: True after the watcher has sent a wrong key, which the server answers after a delay.
    """

    def __init__(self, server: WatchServer, decoder: WatcherSession, chunks: ChunkMaker) -> None:
        self.number = 0
        self.decoder = decoder
        self.backlog = Backlog()
        self.status = WatchStatus(paused=False, rate=0.0, lag=0.0, watchers=0, dropped=0)
        self._server = server
        self._transport: Transport | None = None
        self._chunks = chunks
        self._full = False
        self._closing = False
        self.deaf = False
        self._begun = False
        self._input_ended = False
        self._timer: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        if not isinstance(transport, Transport):
            return
        stranger = None if is_encrypted(transport) else peer_of(transport)
        if stranger is not None:
            self._server.complaints.warn(
                f"{stranger} does not use TLS, which other machines must use; the connection is closed"
            )
            transport.abort()
            return
        self._transport = transport
        transport.set_write_buffer_limits(_SEGMENT)
        self.number = self._server.connection_opened(self)
        if self.decoder.admitted:
            self._server.admit(self)
        else:
            self._timer = asyncio.get_running_loop().call_later(_KEY_SECONDS, self._key_timed_out)

    def data_received(self, data: bytes) -> None:
        if self.deaf:
            return
        begun, self._begun = self._begun, True
        if not begun and begins_http(data):
            self._server.complaints.warn("a client sent HTTP, as web browsers do; the connection is closed")
            if self._transport is not None:
                self._transport.abort()
            self._closing = True
            return
        for event in self.decoder.feed(data):
            if self._closing:
                return
            match event:
                case WatcherAdmitted():
                    self._server.admit(self)
                case WatcherRequest():
                    self._server.ask(self, event)
                case WatchRefusal() if self.decoder.admitted:
                    self.refuse(event)
                    self._server.tell_status()
                case WatchRefusal():
                    self.deaf = True
                    turn_away = partial(self._server.turn_away, self, event)
                    asyncio.get_running_loop().call_later(_WRONG_KEY_SECONDS, turn_away)
        if self.decoder.rejected and not self.deaf:
            self.close()

    def eof_received(self) -> bool:
        self._input_ended = True
        # A watcher without requests may end its output and still receive messages (`nc HOST PORT < /dev/null`), except
        # in TLS.
        half_open = self._transport is not None and self._transport.can_write_eof()
        return half_open and self.decoder.admitted and not self._closing

    def pause_writing(self) -> None:
        self._full = True

    def resume_writing(self) -> None:
        self._full = False
        self.flush()

    def connection_lost(self, exc: Exception | None) -> None:
        self._closing = True
        if self._timer is not None:
            self._timer.cancel()
        self._transport = None  # This breaks a reference cycle with a TLS transport, which uses much memory.
        self._server.lost(self)

    def refuse(self, why: WatchRefusal) -> None:
        """Record a refusal, which the next status contains."""
        self.status = replace(self.status, refused=why, refusals=self.status.refusals + 1)

    def flush(self) -> None:
        """Write queued messages to the socket until the socket's buffer is full."""
        # After a failure of the socket, `connection_lost` is called later. Until then, asyncio warns about writes.
        while not (self._full or self._closing) and self._transport is not None and not self._transport.is_closing():
            taken = self.backlog.take(_SEGMENT)
            if not taken:
                return
            self._transport.write(self._chunks.chunk(taken))

    def write(self, data: bytes) -> None:
        """Write bytes to the socket."""
        if self._transport is not None:
            self._transport.write(data)

    def close(self) -> None:
        """Close the connection after a delay in which the other side can read the last bytes."""
        if self._closing or self._transport is None:
            return
        self._closing = True
        self._server.left(self)
        transport = self._transport
        if self._input_ended or not transport.can_write_eof():
            transport.close()
            asyncio.get_running_loop().call_later(_LINGER, transport.abort)
            return
        try:
            transport.write_eof()
        except OSError:  # The other side has already disconnected, but asyncio has not noticed this yet.
            transport.abort()
            return
        asyncio.get_running_loop().call_later(_LINGER, transport.abort)

    def abort(self) -> None:
        """Close the connection at once."""
        self._closing = True
        if self._transport is not None:
            self._transport.abort()
        self._server.lost(self)

    def _key_timed_out(self) -> None:
        if not (self.decoder.admitted or self._closing or self.deaf):
            self._server.turn_away(self, WatchRefusal("", "a key is required"))
