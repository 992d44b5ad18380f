"""Listening sockets of a session's servers, which leave it the descriptors that it needs to record.

A process has a number of descriptors (RLIMIT_NOFILE), and connections of strangers must not take the last of them: the
next journal, bag or part of a bag could not be opened. So all servers of a process keep below the same mark. The system
gives a new connection the lowest number that is free: one at the mark means that all below are in use, by whatever, and
it is closed before anybody hears of it. Where few are below the mark, servers share them, so that a flood at one leaves
the others room.
"""

from __future__ import annotations

import asyncio
import errno
import logging
import os
import resource
import socket
import ssl
from asyncio import BaseProtocol
from collections.abc import Callable, Sequence
from typing import ClassVar
from weakref import WeakSet

from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.tls import begin_connection

_log = logging.getLogger(__name__)

_AT_ONCE = 16
"""Most connections that one socket accepts in a round of the loop: there is other work between them, such as a tick."""

_REFUSED_AT_ONCE = 64
"""Most connections that are closed in place of one that is accepted."""

_AGAIN_SECONDS = 1.0
"""Seconds until the next attempt, where the system cannot accept."""

_MOST_ARRIVING = 256
"""Connections at a socket for TLS before the end of their handshake; one more takes the oldest's place. They are many
rounds' worth, for whoever means well needs some rounds."""

BACKLOG = 4096
"""Connections that may wait until they are accepted; beyond, the system lets them try again after a second."""

DESCRIPTORS = 12_288
"""Descriptors that a process should be allowed."""

RESERVED = 64
"""Descriptors that no connection may have; a quarter of all, where there are fewer than 256."""

_OWN = 64
"""Descriptors of a session with all doors open and nobody at them: some 50."""


class ServerDoor:
    """The listening sockets of one server, and how many connections it may have.

    Args:
        wanted: most connections, where there are descriptors enough.
        weight: its share beside other servers' of this process where there are not.
    """

    _open: ClassVar[WeakSet[ServerDoor]] = WeakSet()
    """Those of the process that accept connections."""

    def __init__(self, wanted: int, weight: int = 1) -> None:
        raise_limit()
        self._wanted = wanted
        self._weight = weight
        self._acceptors: list[_Acceptor] = []

    @property
    def most(self) -> int:
        """Connections that the server may have now."""
        doors = [*self._open, *({self} - set(self._open))]
        shares = fair_shares([(each._wanted, each._weight) for each in doors], mark() - _OWN)
        return max(1, shares[doors.index(self)])

    async def listen(
        self, connection: Callable[[], BaseProtocol], host: str, port: int, tls: ssl.SSLContext | None = None
    ) -> ListeningAddress:
        """Begin to accept at all addresses of a host; port 0 takes any that is free.

        Args:
            connection: makes the protocol of a connection.
            host: name or address.
            port: at all of them.
            tls: for connections that begin with a TLS handshake; None: none may.

        Returns:
            The first address.

        Raises:
            OSError, UnicodeError: it cannot.
        """
        loop = asyncio.get_running_loop()
        found = await loop.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
        bound: list[socket.socket] = []
        try:
            for family, _, _, _, where in dict.fromkeys(found):
                bound.append(socket.create_server(where, family=family, backlog=BACKLOG))
        except OSError:
            for each in bound:
                each.close()
            raise
        address = ListeningAddress(*bound[0].getsockname()[:2])
        for each in bound:
            self.accept(connection, each, tls)
        return address

    def accept(
        self, connection: Callable[[], BaseProtocol], bound: socket.socket, tls: ssl.SSLContext | None = None
    ) -> None:
        """Begin to accept at a socket that listens already, and is this object's from now on; see `listen`."""
        self._acceptors.append(_Acceptor(connection, bound, tls))
        self._open.add(self)

    def close(self) -> None:
        """Accept no more."""
        for each in self._acceptors:
            each.close()
        self._open.discard(self)

    async def wait_closed(self) -> None:
        """Wait until all is closed."""
        for each in self._acceptors:
            await each.wait_closed()
        self._acceptors = []


class _Acceptor:
    """Accepts connections at one listening socket, and gives each its protocol, encrypted where it begins so.

    Of a server of asyncio's, which would accept, nobody can tell what a connection begins with.
    """

    def __init__(
        self, connection: Callable[[], BaseProtocol], bound: socket.socket, tls: ssl.SSLContext | None
    ) -> None:
        self._connection = connection
        self._bound = bound
        self._tls = tls
        self._arriving: dict[asyncio.Task[None], None] = {}
        self._again: asyncio.TimerHandle | None = None
        self._loop = asyncio.get_running_loop()
        bound.setblocking(False)
        self._begin()

    def close(self) -> None:
        """Accept no more, and cut off whoever has not shown yet what it speaks."""
        if self._again is not None:
            self._again.cancel()
        self._loop.remove_reader(self._bound)
        self._bound.close()
        for task in self._arriving:
            task.cancel()

    async def wait_closed(self) -> None:
        """Wait until all is closed."""
        await asyncio.gather(*self._arriving, return_exceptions=True)

    def _begin(self) -> None:
        self._again = None
        self._loop.add_reader(self._bound, self._accept)

    def _accept(self) -> None:
        try:
            for _ in range(_AT_ONCE):
                self._welcome(self._next())
        except (BlockingIOError, InterruptedError, ConnectionAbortedError):
            return
        except OSError as error:
            # No descriptor at all, or no memory: at once it would be so again.
            _log.warning("accepting no clients for one second: %s", error)
            self._loop.remove_reader(self._bound)
            self._again = self._loop.call_later(_AGAIN_SECONDS, self._begin)

    def _next(self) -> socket.socket:
        """Return a connection that is below the mark. Raises OSError, such as BlockingIOError where none waits."""
        for _ in range(_REFUSED_AT_ONCE):
            accepted, _ = self._bound.accept()
            if accepted.fileno() < mark():
                accepted.setblocking(False)
                return accepted
            accepted.close()
        raise ConnectionAbortedError

    def _welcome(self, accepted: socket.socket) -> None:
        if self._tls is not None and len(self._arriving) >= _MOST_ARRIVING:
            oldest = next(iter(self._arriving))
            del self._arriving[oldest]
            oldest.cancel()
        task = self._loop.create_task(begin_connection(self._connection, accepted, self._tls))
        self._arriving[task] = None
        task.add_done_callback(self._arrived)

    def _arrived(self, task: asyncio.Task[None]) -> None:
        self._arriving.pop(task, None)
        if not task.cancelled() and (error := task.exception()) is not None:
            level = logging.INFO if isinstance(error, OSError) else logging.WARNING
            _log.log(level, "a connection failed before it was established: %r", error)


def raise_limit() -> None:
    """Raise the number of descriptors that this process may have, which usually is 1024, as far as wanted."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = DESCRIPTORS if hard == resource.RLIM_INFINITY else min(DESCRIPTORS, hard)
    if soft != resource.RLIM_INFINITY and soft < wanted:
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))


def mark() -> int:
    """Return the least descriptor that no connection may have."""
    soft, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    most = DESCRIPTORS if soft == resource.RLIM_INFINITY else soft
    return most - min(RESERVED, most // 4)


def check_room() -> None:
    """Check that a connection to others has a descriptor below the mark: peers say whom to call, and how many.

    Raises:
        OSError: it has none (EMFILE).
    """
    # The lowest that is free.
    probe = os.open(os.devnull, os.O_RDONLY | os.O_CLOEXEC)
    os.close(probe)
    if probe >= mark():
        raise OSError(errno.EMFILE, os.strerror(errno.EMFILE))


def fair_shares(wishes: Sequence[tuple[int, int]], room: int) -> list[int]:
    """Return what each gets of so much room: what it wants, or as much for its weight as all others who want more.

    Args:
        wishes: what each wants, and its weight.
        room: for all together.
    """
    shares = [0] * len(wishes)
    left, waiting = max(0, room), list(range(len(wishes)))
    while waiting:
        weights = sum(wishes[each][1] for each in waiting)
        content = [each for each in waiting if wishes[each][0] * weights <= left * wishes[each][1]]
        for each in content or waiting:
            wanted, weight = wishes[each]
            shares[each] = wanted if content else left * weight // weights
        if not content:
            break
        left -= sum(wishes[each][0] for each in content)
        waiting = [each for each in waiting if each not in content]
    return shares
