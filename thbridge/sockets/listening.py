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
import os
import resource
import socket
from asyncio import BaseProtocol
from collections.abc import Callable, Sequence
from typing import ClassVar
from weakref import WeakSet

from thbridge.sockets.addresses import ListeningAddress

_AT_ONCE = 16
"""Most connections that one socket accepts in a round of the loop: there is other work between them, such as a tick."""

_REFUSED_AT_ONCE = 64
"""Most connections that are closed in place of one that is accepted."""

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
        self._servers: list[asyncio.Server] = []

    @property
    def most(self) -> int:
        """Connections that the server may have now."""
        doors = [*self._open, *({self} - set(self._open))]
        shares = fair_shares([(each._wanted, each._weight) for each in doors], mark() - _OWN)
        return max(1, shares[doors.index(self)])

    async def listen(self, connection: Callable[[], BaseProtocol], host: str, port: int) -> ListeningAddress:
        """Begin to accept at all addresses of a host; port 0 takes any that is free.

        Args:
            connection: makes the protocol of a connection.
            host: name or address.
            port: at all of them.

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
            await self.accept(connection, each)
        return address

    async def accept(self, connection: Callable[[], BaseProtocol], bound: socket.socket) -> None:
        """Begin to accept at a socket that listens already, and is this object's from now on."""
        own = _MarkedSocket(bound.family, bound.type, bound.proto, bound.detach())
        loop = asyncio.get_running_loop()
        self._servers.append(await loop.create_server(connection, sock=own, backlog=_AT_ONCE))
        self._open.add(self)

    def close(self) -> None:
        """Accept no more."""
        for server in self._servers:
            server.close()
        self._open.discard(self)

    async def wait_closed(self) -> None:
        """Wait until all is closed."""
        for server in self._servers:
            await server.wait_closed()
        self._servers = []


class _MarkedSocket(socket.socket):
    """Listening socket that closes what it accepts at the mark or above it."""

    def listen(self, backlog: int = BACKLOG) -> None:
        # A loop says here how many it accepts at once; those that wait are another matter.
        super().listen(BACKLOG)

    def accept(self) -> tuple[socket.socket, object]:
        # Here, for a loop accepts some before it makes anything of the first.
        for _ in range(_REFUSED_AT_ONCE):
            accepted, peer = super().accept()
            if accepted.fileno() < mark():
                return accepted, peer
            accepted.close()
        raise ConnectionAbortedError


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
