"""Listening sockets of a session's servers. They never use up the file descriptors that the session needs to record.

A process has a limited number of descriptors (RLIMIT_NOFILE). Connections from outside must not use up the last
descriptors, because the session must be able to open its next journal or bag. So all servers of a process use
only descriptors with numbers below a common limit. The system gives a new connection the lowest free number. If that
number is not below the limit, all descriptors below the limit are in use, and the connection is closed at once. If
there are few descriptors below the limit, each server gets a share of them. So a flood of connections at one server
does not block the others.
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
"""Maximum number of connections that one socket accepts in one round of the event loop. The limit leaves time for other
work, such as ticks."""

_REFUSED_AT_ONCE = 64
"""Maximum number of connections in a row that are closed because they are above the mark, or because their clients have
left."""

_AGAIN_SECONDS = 1.0
"""Seconds until the next attempt if the system cannot accept connections."""

_MOST_ARRIVING = 256
"""Maximum number of unfinished TLS handshakes at a socket. A new handshake replaces the oldest handshake. The number is
much larger than `_AT_ONCE`, because an honest handshake needs several rounds."""

BACKLOG = 4096
"""Maximum number of connections that wait to be accepted. Further clients try again after a second, by TCP."""

DESCRIPTORS = 12_288
"""Limit for the number of file descriptors that a process requests."""

RESERVED = 64
"""Number of descriptors that connections may not use. If the limit is below 256, a quarter of it is reserved."""

_OWN = 64
"""Number of descriptors that a session without clients may need. With all servers open, it needs about 50."""


class ServerDoor:
    """Listening sockets of one server, and its maximum number of connections.

    Args:
        wanted: maximum number of connections if there are enough descriptors.
        weight: share of the server, relative to other servers of this process, if there are too few descriptors.
    """

    _open: ClassVar[WeakSet[ServerDoor]] = WeakSet()
    """Instances of this process that accept connections."""

    def __init__(self, wanted: int, weight: int = 1) -> None:
        raise_limit()
        self._wanted = wanted
        self._weight = weight
        self._acceptors: list[_Acceptor] = []

    @property
    def most(self) -> int:
        """Maximum number of connections of the server at present."""
        doors = [*self._open, *({self} - set(self._open))]
        shares = fair_shares([(each._wanted, each._weight) for each in doors], mark() - _OWN)
        return max(1, shares[doors.index(self)])

    async def listen(
        self, connection: Callable[[], BaseProtocol], host: str, port: int, tls: ssl.SSLContext | None = None
    ) -> ListeningAddress:
        """Begin to accept connections at all addresses of a host. Port 0 selects any free port.

        Args:
            connection: factory of the protocol of a connection.
            host: name or address.
            port: port at all addresses.
            tls: context for connections that begin with a TLS handshake. If None, all connections are plain.

        Returns:
            The first address.

        Raises:
            OSError, UnicodeError: it cannot listen there.
        """
        bound = await bind(host, port)
        address = address_of(bound)
        for each in bound:
            self.accept(connection, each, tls)
        return address

    def accept(
        self, connection: Callable[[], BaseProtocol], bound: socket.socket, tls: ssl.SSLContext | None = None
    ) -> None:
        """Begin to accept connections at a socket that already listens. See `listen`. This object closes the socket."""
        self._acceptors.append(_Acceptor(connection, bound, tls))
        self._open.add(self)

    def close(self) -> None:
        """Stop accepting connections."""
        for each in self._acceptors:
            each.close()
        self._open.discard(self)

    async def wait_closed(self) -> None:
        """Wait until all sockets and unfinished handshakes are closed."""
        for each in self._acceptors:
            await each.wait_closed()
        self._acceptors = []


async def bind(host: str, port: int) -> list[socket.socket]:
    """Return sockets that listen at all addresses of a host. Until `ServerDoor.accept`, connections wait in the system.

    Args:
        host: name or address.
        port: port at all addresses; 0 selects any free port.

    Raises:
        OSError, UnicodeError: it cannot listen there.
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
    return bound


def address_of(bound: Sequence[socket.socket]) -> ListeningAddress:
    """Return the first address at which sockets listen."""
    return ListeningAddress(*bound[0].getsockname()[:2])


class _Acceptor:
    """Acceptor of connections at one listening socket. It starts the protocol of each connection, with or without TLS.

    asyncio's own server is not used, because it accepts before the first bytes can be inspected.
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
        """Stop accepting connections, and close connections that have no protocol yet."""
        if self._again is not None:
            self._again.cancel()
        self._loop.remove_reader(self._bound)
        self._bound.close()
        for task in self._arriving:
            task.cancel()

    async def wait_closed(self) -> None:
        """Wait until all unfinished handshakes have ended."""
        await asyncio.gather(*self._arriving, return_exceptions=True)

    def _begin(self) -> None:
        self._again = None
        self._loop.add_reader(self._bound, self._accept)

    def _accept(self) -> None:
        try:
            for _ in range(_AT_ONCE):
                self._welcome(self._next())
        except (BlockingIOError, InterruptedError, ConnectionAbortedError):
            # No further connection waits, its client has left, or enough connections were refused in this round.
            return
        except OSError as error:
            # The system has no descriptor or no memory left, so an immediate attempt would fail too.
            _log.warning("accepting no clients for one second: %s", error)
            self._loop.remove_reader(self._bound)
            self._again = self._loop.call_later(_AGAIN_SECONDS, self._begin)

    def _next(self) -> socket.socket:
        """Return a connection with a descriptor below the mark whose client has not left.

        A client that opens connections without end has left most of them. They must not fill the queue of the system
        (`BACKLOG`), because an honest client would have to wait for a second.

        Raises:
            OSError: no connection waits (BlockingIOError), or the system cannot accept one.
        """
        for _ in range(_REFUSED_AT_ONCE):
            accepted, _ = self._bound.accept()
            accepted.setblocking(False)
            if accepted.fileno() < mark() and not _has_left(accepted):
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


def _has_left(accepted: socket.socket) -> bool:
    """Return True if the client of a connection has closed it without sending anything."""
    try:
        return not accepted.recv(1, socket.MSG_PEEK)
    except BlockingIOError:
        return False
    except OSError:
        return True


def raise_limit() -> None:
    """Raise this process's limit of descriptors, usually 1024, to the wanted limit or to the allowed maximum."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = DESCRIPTORS if hard == resource.RLIM_INFINITY else min(DESCRIPTORS, hard)
    if soft != resource.RLIM_INFINITY and soft < wanted:
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))


def mark() -> int:
    """Return the smallest descriptor that connections may not use."""
    soft, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    most = DESCRIPTORS if soft == resource.RLIM_INFINITY else soft
    return most - min(RESERVED, most // 4)


def check_room() -> None:
    """Check that an outgoing connection would get a descriptor below the mark.

    The check is needed where peers determine the addresses and the number of outgoing connections.

    Raises:
        OSError: there is no such descriptor (EMFILE).
    """
    # The system gives the lowest free descriptor, so this probe gets the descriptor that the connection would get.
    probe = os.open(os.devnull, os.O_RDONLY | os.O_CLOEXEC)
    os.close(probe)
    if probe >= mark():
        raise OSError(errno.EMFILE, os.strerror(errno.EMFILE))


def fair_shares(wishes: Sequence[tuple[int, int]], room: int) -> list[int]:
    """Return each server's share of a total: the wanted number, but at most its fair share by weight.

    If a server wants less than its fair share, the other servers divide the rest.

    Args:
        wishes: wanted number and weight of each server.
        room: total of all shares.
    """
    shares = [0] * len(wishes)
    left, waiting = max(0, room), list(range(len(wishes)))
    while waiting:
        # Servers that want less than their fair share get their wish first, so that the others can divide the rest.
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
