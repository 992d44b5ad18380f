"""MAVLink over TCP: a port for ground stations, each with a link of its own."""

from __future__ import annotations

import asyncio
import socket
from asyncio import Protocol, Transport
from collections.abc import Sequence

from thbridge.protocols.mavlink.frames.channel import Channel
from thbridge.protocols.mavlink.outgoing import LinkId
from thbridge.sockets.addresses import Address
from thbridge.sockets.errors import CannotListen
from thbridge.sockets.http_refusal import begins_http
from thbridge.sockets.mavlink.links import GARBAGE_LIMIT, MavlinkLinks

CONNECTIONS = 32
"""Most connections at a time; further ones are turned away."""

BACKLOG = 1024 * 1024
"""Bytes that may wait for a peer that does not read before its connection is cut off."""

_LINGER = 1.0
"""Seconds that a peer has at the end to read what it was sent."""


class TcpPort:
    """TCP port, open but not served yet.

    Args:
        links: links of the session.
        own: socket, bound and listening.

    Attributes:
        where: its address.
    """

    def __init__(self, links: MavlinkLinks, own: socket.socket) -> None:
        self.links = links
        where = own.getsockname()
        self.where = Address(where[0], where[1])
        self._socket = own
        self._server: asyncio.Server | None = None
        self._open: set[_Connection] = set()
        self._all_closed = asyncio.Event()

    async def serve(self) -> None:
        """Accept connections of ground stations."""
        self._server = await asyncio.get_running_loop().create_server(lambda: _Connection(self), sock=self._socket)

    async def close(self) -> None:
        """Close the port and all connections."""
        if self._server is None:
            self._socket.close()
            return
        self._server.close()
        for connection in tuple(self._open):
            connection.close()
        while self._open:
            self._all_closed.clear()
            await self._all_closed.wait()
        await self._server.wait_closed()

    @property
    def is_full(self) -> bool:
        """True when no further connection is accepted."""
        return len(self._open) >= CONNECTIONS

    def connection_opened(self, connection: _Connection) -> None:
        """Add a connection."""
        self._open.add(connection)

    def connection_closed(self, connection: _Connection) -> None:
        """Remove a connection that is closed on both sides."""
        self._open.discard(connection)
        self._all_closed.set()


async def tcp_port(links: MavlinkLinks, address: Address) -> TcpPort | CannotListen:
    """Open a port; 0 takes any that is free."""
    try:
        found = await asyncio.get_running_loop().getaddrinfo(address.host, address.port, type=socket.SOCK_STREAM)
        family, _, _, _, where = found[0]
        own = socket.create_server((where[0], where[1]), family=family, backlog=CONNECTIONS)
    except (OSError, UnicodeError) as error:
        return CannotListen.because(error, address.host, address.port)
    return TcpPort(links, own)


class _Connection(Protocol):
    """Connection of one ground station."""

    def __init__(self, port: TcpPort) -> None:
        self._port = port
        self._channel: Channel = port.links.channel(datagrams=False)
        self._name = ""
        self._link: LinkId | None = None
        self._transport: Transport | None = None
        self._lingering: asyncio.TimerHandle | None = None
        self._begun = False

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        if not isinstance(transport, Transport):
            return
        peer = transport.get_extra_info("peername") or ("", 0)  # it was gone before it was asked
        self._name = f"tcp {Address(peer[0], peer[1])}"
        self._transport = transport
        if self._port.is_full:
            self._port.links.complaints.warn(f"MAVLink: {CONNECTIONS} are connected by TCP; others are turned away")
            transport.abort()
            return
        self._port.connection_opened(self)
        self._link = self._port.links.open(self._name, self._channel, self)

    def data_received(self, data: bytes) -> None:
        begun, self._begun = self._begun, True
        if not begun and begins_http(data):
            self._cut_off("speaks HTTP, as a page in a browser does")
        if self._transport is None or self._transport.is_closing():
            return
        frames = self._port.links.frames_in(self._name, self._channel, data)
        if self._link is not None:
            self._port.links.receive(self._link, frames)
        if self._channel.bytes_since_good > GARBAGE_LIMIT:
            self._cut_off("sends nothing of use")

    def connection_lost(self, exc: Exception | None) -> None:
        self._leave()
        if self._lingering is not None:
            self._lingering.cancel()
        self._port.connection_closed(self)

    def send_frames(self, frames: Sequence[bytes]) -> int:
        """See `thbridge.sockets.mavlink.links.FrameSender`."""
        if self._transport is None or self._transport.is_closing():
            return len(frames)
        self._transport.write(b"".join(frames))
        if self._transport.get_write_buffer_size() > BACKLOG:
            self._cut_off("does not read")
        return 0

    def close(self) -> None:
        """Close the connection once the other side has had a moment to read what it was sent."""
        self._leave()
        if self._transport is not None:
            self._transport.close()
            self._lingering = asyncio.get_running_loop().call_later(_LINGER, self._transport.abort)

    def _cut_off(self, why: str) -> None:
        if self._transport is not None and not self._transport.is_closing():
            self._port.links.complaints.warn(f"MAVLink: {self._name} {why}, and is cut off")
            self._transport.abort()

    def _leave(self) -> None:
        if self._link is not None:
            self._port.links.close(self._link)
            self._link = None
