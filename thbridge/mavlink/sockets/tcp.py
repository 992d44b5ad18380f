"""MAVLink over TCP: a port for ground stations, with one link for each station."""

from __future__ import annotations

import asyncio
import socket
from asyncio import Protocol, Transport
from collections import deque
from collections.abc import Sequence

from sim.common.observations import TICK
from thbridge.mavlink.sockets.links import GARBAGE_LIMIT, MavlinkLinks
from thbridge.mavlink.wire.frames.channel import Channel
from thbridge.mavlink.wire.outgoing import LinkId
from thbridge.sockets.addresses import Address
from thbridge.sockets.admission import OWN_MACHINE, Admission
from thbridge.sockets.errors import CannotListen
from thbridge.sockets.http_refusal import begins_http
from thbridge.sockets.listening import ServerDoor

CONNECTIONS = 32
"""Maximum number of connections. A further connection replaces the oldest silent connection. If there is no silent
connection, it is refused."""

BACKLOG = 1024 * 1024
"""A peer is disconnected if it has not read this number of bytes."""

_SEGMENT = 4096
"""Maximum number of bytes that are parsed in one round of the event loop."""

_LINGER = 1.0
"""Time that a peer has to read waiting data before its connection is closed, seconds."""


class TcpPort:
    """TCP port. It is open from the start, and `serve` accepts connections.

    Args:
        links: links of the session.
        own: socket, bound and listening.
        admission: decides by address which stations are accepted.

    Attributes:
        where: its address.
    """

    def __init__(self, links: MavlinkLinks, own: socket.socket, admission: Admission = OWN_MACHINE) -> None:
        self.links = links
        self.admission = admission
        where = own.getsockname()
        self.where = Address(where[0], where[1])
        self._socket = own
        self._door = ServerDoor(CONNECTIONS)
        self._served = False
        self._open: dict[_Connection, None] = {}
        self._all_closed = asyncio.Event()

    async def serve(self) -> None:
        """Accept connections of ground stations."""
        self._served = True
        self._door.accept(lambda: _Connection(self), self._socket)

    async def close(self) -> None:
        """Close the port and all connections."""
        if not self._served:
            self._socket.close()
            return
        self._door.close()
        for connection in tuple(self._open):
            connection.close()
        while self._open:
            self._all_closed.clear()
            await self._all_closed.wait()
        await self._door.wait_closed()

    def connection_opened(self, connection: _Connection) -> bool:
        """Add a connection. Return False if there are too many connections."""
        most = self._door.most
        if len(self._open) >= most:
            self.links.complaints.warn(f"MAVLink: {most} clients are connected over TCP; no more are allowed")
            silent = next((each for each in self._open if not each.has_spoken), None)
            if silent is None:
                return False
            silent.cut_off("is silent, and another client waits")
            del self._open[silent]
        self._open[connection] = None
        return True

    def connection_closed(self, connection: _Connection) -> None:
        """Remove a connection that is closed on both sides."""
        self._open.pop(connection, None)
        self._all_closed.set()


async def tcp_port(links: MavlinkLinks, address: Address, admission: Admission = OWN_MACHINE) -> TcpPort | CannotListen:
    """Open a port. Port 0 selects any free port."""
    try:
        found = await asyncio.get_running_loop().getaddrinfo(address.host, address.port, type=socket.SOCK_STREAM)
        family, _, _, _, where = found[0]
        own = socket.create_server((where[0], where[1]), family=family)
    except (OSError, UnicodeError) as error:
        return CannotListen.because(error, address.host, address.port)
    return TcpPort(links, own, admission)


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
        self._unparsed: deque[bytes] = deque()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        if not isinstance(transport, Transport):
            return
        peer = transport.get_extra_info("peername") or ("", 0)  # The address is empty if the peer has already left.
        self._name = f"tcp {Address(peer[0], peer[1])}"
        self._transport = transport
        stranger = self._port.admission.refused(transport)
        if stranger is not None:
            why = "its address is in no network of open_to"
            self._port.links.complaints.warn(f"MAVLink: a client at {stranger} is rejected: {why}")
        if stranger is not None or not self._port.connection_opened(self):
            transport.abort()
            return
        self._link = self._port.links.open(self._name, self._channel, self)

    def data_received(self, data: bytes) -> None:
        begun, self._begun = self._begun, True
        # A web page in a browser of this machine can connect to any local port.
        if not begun and begins_http(data):
            self.cut_off("sends HTTP, like a web page in a browser")
        self._unparsed.extend(data[at : at + _SEGMENT] for at in range(0, len(data), _SEGMENT))
        self._parse_some()

    def _parse_some(self) -> None:
        """Parse a part of the received bytes.

        Until all received bytes are parsed, no more bytes are read. They wait in the peer's socket and are not lost.
        """
        if self._transport is None or self._transport.is_closing():
            return
        has_room = self._link is None or self._port.links.has_room(self._link)
        if self._unparsed and has_room:
            frames = self._port.links.frames_in(self._name, self._channel, self._unparsed.popleft())
            if self._link is not None:
                self._port.links.receive(self._link, frames)
            if self._channel.bytes_since_good > GARBAGE_LIMIT:
                self.cut_off("sends no valid frames")
                return
        if not self._unparsed:
            self._transport.resume_reading()
            return
        self._transport.pause_reading()
        asyncio.get_running_loop().call_later(0.0 if has_room else TICK, self._parse_some)

    def connection_lost(self, exc: Exception | None) -> None:
        self._leave()
        if self._lingering is not None:
            self._lingering.cancel()
        self._port.connection_closed(self)

    @property
    def has_spoken(self) -> bool:
        """True if a valid frame has arrived."""
        return self._channel.counts.frames > 0

    def send_frames(self, frames: Sequence[bytes]) -> int:
        """See `thbridge.mavlink.sockets.links.FrameSender`."""
        if self._transport is None or self._transport.is_closing():
            return len(frames)
        self._transport.write(b"".join(frames))
        if self._transport.get_write_buffer_size() > BACKLOG:
            self.cut_off("does not read what it is sent")
        return 0

    def close(self) -> None:
        """Close the connection, after the peer had a moment to read waiting data."""
        self._leave()
        if self._transport is not None:
            self._transport.close()
            self._lingering = asyncio.get_running_loop().call_later(_LINGER, self._transport.abort)

    def cut_off(self, why: str) -> None:
        """Close the connection at once."""
        if self._transport is not None and not self._transport.is_closing():
            self._port.links.complaints.warn(f"MAVLink: {self._name} is disconnected: it {why}")
            self._transport.abort()

    def _leave(self) -> None:
        if self._link is not None:
            self._port.links.close(self._link)
            self._link = None
