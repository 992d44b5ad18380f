"""The watch door's sockets: researchers' windows hear over TCP what a session's bag hears, and may ask for things.

Everything happens on the thread of one event loop. Nothing that a watcher does or leaves undone slows the session: what
it does not read waits for it within bounds, and beyond those it loses messages and is told how many.
"""

from __future__ import annotations

import asyncio
import logging
from asyncio import Protocol as AsyncioProtocol
from asyncio import Transport
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from thbridge.files.errors import reason_of
from thbridge.files.ros.definitions import Definitions
from thbridge.recording.bag.stream import BEGINNING, BagStream, ChunkMaker
from thbridge.ros.messages import types
from thbridge.ros.topics import RosMessage, Topic
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.errors import CannotListen
from thbridge.wire.backlog import Backlog
from thbridge.wire.watch_protocol import (
    STATUS,
    WatcherAdmitted,
    WatcherRequest,
    WatcherSession,
    WatchRefusal,
    WatchStatus,
    refusal,
)

DEFAULT_PORT = 6010

WATCHERS = 8
"""Who comes when so many watch is turned away."""

CALLERS = 4 * WATCHERS
"""Who comes when so many are connected, with the key or without, is not even told so."""

_log = logging.getLogger(__name__)

_STATUS = Topic(STATUS, types.STRING, latched=True)
_KEY_SECONDS = 10.0
"""How long a key may take to come."""
_LINGER = 1.0
"""Seconds that a watcher which is cut off has to read why."""
_HEARTBEAT = 1.0
_SEGMENT = 256 * 1024
"""Bytes that are given to a socket at a time; what the socket has not taken cannot be dropped any more."""


@dataclass(frozen=True, slots=True)
class SessionPace:
    """How the session runs; attributes as those of `Status`."""

    paused: bool
    rate: float
    lag: float


class WatchedSession(Protocol):
    """What is behind the door."""

    def ask(self, watcher: str, wish: Mapping[str, object]) -> str | None:
        """Somebody asks for something: granted, or the answer says why not, for people."""

    def pace(self) -> SessionPace:
        """How it runs."""

    def unwatched(self) -> None:
        """The last watcher has gone."""


class WatchServer:
    """Says a session's messages to whoever connects, and passes on what they ask for.

    Args:
        house: grants.
        key: that watchers have to know; None lets in whoever can connect.
        definitions: of message types; None takes them from an installed ROS, where there is one.
    """

    def __init__(self, house: WatchedSession, key: str | None = None, definitions: Definitions | None = None) -> None:
        self._house = house
        self._key = key
        self._stream = BagStream(definitions or Definitions())
        self._levels: dict[Topic, RosMessage] = {}
        self._latest: Sequence[RosMessage] = ()
        self._stamp_ns = 0
        self._watchers: list[_Watcher] = []
        self._open: set[_Watcher] = set()
        self._met = 0
        self._all_closed = asyncio.Event()
        self._server: asyncio.Server | None = None
        self._heart: asyncio.Task[None] | None = None

    async def start(self, host: str, port: int) -> ListeningAddress | CannotListen:
        """Begin to serve; port 0 takes any that is free."""
        loop = asyncio.get_running_loop()
        try:
            server = await loop.create_server(
                lambda: _Watcher(self, WatcherSession(self._key), ChunkMaker(self._stream)), host, port
            )
        except OSError as error:
            return CannotListen(host, port, reason_of(error))
        except UnicodeError:
            return CannotListen(host, port, "that is not a host's name")
        self._server = server
        self._heart = loop.create_task(self._beat())
        address = server.sockets[0].getsockname()
        return ListeningAddress(address[0], address[1])

    async def stop(self) -> None:
        """Close the port; what was said last has a moment to be read."""
        if self._server is None or self._heart is None:
            return
        self._server.close()
        self._heart.cancel()
        for watcher in tuple(self._open):
            watcher.close()
        while self._open:
            self._all_closed.clear()
            await self._all_closed.wait()
        await self._server.wait_closed()
        self._server = None

    def take(self, tick: int, messages: Iterable[RosMessage]) -> None:
        """Say what is said in a tick; see `thbridge.app.session.broadcast.Listener`."""
        for message in self._latest:
            if message.topic.latched:
                self._levels[message.topic] = message
        self._latest = tuple(messages)
        for message in self._latest:
            self._stamp_ns = message.stamp_ns
        self._say(self._watchers, self._latest)

    def tell_status(self) -> None:
        """Tell every watcher how things stand."""
        for watcher in self._watchers:
            self._tell_status(watcher)

    # What watchers do

    @property
    def is_crowded(self) -> bool:
        """Whether so many stand at the door that nobody else is even told to go away."""
        return len(self._open) >= CALLERS

    def meet(self, watcher: _Watcher) -> int:
        """Somebody connects; a number for them."""
        self._open.add(watcher)
        self._met += 1
        return self._met

    def admit(self, watcher: _Watcher) -> None:
        """Somebody begins to watch: they hear what is in force, then all of the tick that was last."""
        if len(self._watchers) >= WATCHERS:
            self.turn_away(watcher, WatchRefusal("", f"{WATCHERS} others watch already"))
            return
        self._watchers.append(watcher)
        _log.info("watcher %d has come", watcher.number)
        watcher.write(BEGINNING)
        said_again = {message.topic for message in self._latest if message.topic.latched}
        levels = [level for topic, level in self._levels.items() if topic not in said_again]
        self._say([watcher], [*sorted(levels, key=lambda level: level.stamp_ns), *self._latest])
        self.tell_status()

    def turn_away(self, watcher: _Watcher, why: WatchRefusal) -> None:
        """Somebody who does not watch is told why, and sent away."""
        watcher.write(BEGINNING)
        watcher.refuse(why)
        self._tell_status(watcher)
        watcher.close()

    def ask(self, watcher: _Watcher, wish: WatcherRequest) -> None:
        """Somebody asks for something; all are told how things stand then."""
        reason = self._house.ask(f"watcher {watcher.number}", wish.value)
        if reason is None:
            watcher.guest.granted()
        else:
            watcher.guest.refused()
            watcher.refuse(refusal(wish.line, reason))
        self.tell_status()

    def lost(self, watcher: _Watcher) -> None:
        """Somebody's connection is closed on both sides."""
        self.left(watcher)
        self._open.discard(watcher)
        self._all_closed.set()

    def left(self, watcher: _Watcher) -> None:
        """Somebody watches no longer, if they ever did."""
        if watcher in self._watchers:
            self._watchers.remove(watcher)
            _log.info("watcher %d has gone", watcher.number)
            if not self._watchers:
                self._house.unwatched()
            self.tell_status()

    # What they are told

    def _say(self, watchers: Sequence[_Watcher], messages: Iterable[RosMessage]) -> None:
        if not watchers:
            return
        for message in messages:
            connection, record = self._stream.record(message)
            for watcher in watchers:
                watcher.backlog.put(connection.number, record, message.topic.latched)
        for watcher in watchers:
            watcher.flush()

    def _tell_status(self, watcher: _Watcher) -> None:
        pace = self._house.pace()
        status = replace(
            watcher.status,
            paused=pace.paused,
            rate=pace.rate,
            lag=pace.lag,
            watchers=len(self._watchers),
            dropped=watcher.backlog.dropped,
        )
        self._say([watcher], [RosMessage(_STATUS, self._stamp_ns, status.data())])

    def _watcher(self) -> _Watcher:
        return _Watcher(self, WatcherSession(self._key), ChunkMaker(self._stream))

    async def _beat(self) -> None:
        while True:
            await asyncio.sleep(_HEARTBEAT)
            self.tell_status()


class _Watcher(AsyncioProtocol):
    """One TCP connection.

    Attributes:
        number: counts all that ever connected.
        guest: what it says.
        backlog: what it has not read.
        status: what it was told last of its own affairs.
    """

    def __init__(self, server: WatchServer, guest: WatcherSession, chunks: ChunkMaker) -> None:
        self.number = 0
        self.guest = guest
        self.backlog = Backlog()
        self.status = WatchStatus(paused=False, rate=0.0, lag=0.0, watchers=0, dropped=0)
        self._server = server
        self._transport: Transport | None = None
        self._chunks = chunks
        self._full = False
        self._closing = False
        self._mute = False

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        if not isinstance(transport, Transport):
            return
        if self._server.is_crowded:
            transport.abort()
            return
        self._transport = transport
        transport.set_write_buffer_limits(_SEGMENT)
        self.number = self._server.meet(self)
        if self.guest.admitted:
            self._server.admit(self)
        else:
            asyncio.get_running_loop().call_later(_KEY_SECONDS, self._lose_patience)

    def data_received(self, data: bytes) -> None:
        for event in self.guest.feed(data):
            if self._closing:
                return
            match event:
                case WatcherAdmitted():
                    self._server.admit(self)
                case WatcherRequest():
                    self._server.ask(self, event)
                case WatchRefusal() if self.guest.admitted:
                    self.refuse(event)
                    self._server.tell_status()
                case WatchRefusal():
                    self._server.turn_away(self, event)
        if self.guest.unwelcome:
            self.close()

    def eof_received(self) -> bool:
        self._mute = True
        # Who has nothing to ask may still listen: `nc HOST PORT < /dev/null`.
        return self.guest.admitted and not self._closing

    def pause_writing(self) -> None:
        self._full = True

    def resume_writing(self) -> None:
        self._full = False
        self.flush()

    def connection_lost(self, exc: Exception | None) -> None:
        self._closing = True
        self._server.lost(self)

    def refuse(self, why: WatchRefusal) -> None:
        """Remember what is not granted; the next status tells it."""
        self.status = replace(self.status, refused=why, refusals=self.status.refusals + 1)

    def flush(self) -> None:
        """Give the socket what waits, as far as it takes it."""
        while not (self._full or self._closing) and self._transport is not None:
            taken = self.backlog.take(_SEGMENT)
            if not taken:
                return
            self._transport.write(self._chunks.chunk(taken))

    def write(self, data: bytes) -> None:
        """Give the socket these bytes."""
        if self._transport is not None:
            self._transport.write(data)

    def close(self) -> None:
        """End the connection, once the other side has had a moment to read what it was sent."""
        if self._closing or self._transport is None:
            return
        self._closing = True
        self._server.left(self)
        transport = self._transport
        if self._mute:
            transport.close()
            return
        try:
            transport.write_eof()
        except OSError:  # the other side is gone already, though asyncio has not heard of it yet
            transport.abort()
            return
        asyncio.get_running_loop().call_later(_LINGER, transport.abort)

    def _lose_patience(self) -> None:
        if not self.guest.admitted and not self._closing:
            self._server.turn_away(self, WatchRefusal("", "a key is wanted"))
