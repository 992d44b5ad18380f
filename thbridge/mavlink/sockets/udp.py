"""MAVLink over UDP: a socket for each target, and a socket for stations that send first. Each peer has a link."""

from __future__ import annotations

import asyncio
import ipaddress
import socket
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, cast

from sim.common.robot_numbers import index_of
from thbridge.mavlink.sockets.links import GARBAGE_LIMIT, MavlinkLinks
from thbridge.mavlink.wire.frames.channel import Channel
from thbridge.mavlink.wire.outgoing import LinkId
from thbridge.sockets.addresses import Address, UdpTarget
from thbridge.sockets.admission import OWN_MACHINE, Admission
from thbridge.sockets.errors import CannotListen

MAX_PEERS = 32
"""Maximum number of peers of one socket in addition to its target. A further peer replaces one of them.

Peers without a valid frame are replaced first, then peers younger than `SETTLED_SECONDS`. In each of these groups, the
peer whose last frame is oldest is replaced.
"""

SETTLED_SECONDS = 3.0
"""Minimum time between the first and the last valid frame of a peer that is replaced last, seconds. A peer with a
forged address is younger."""

MEETINGS = 64
"""Maximum number of new peers of one socket per second. Datagrams of further new peers are dropped."""

STALE_SECONDS = 60.0
"""A peer is forgotten after this number of seconds without a valid frame. The target is never forgotten."""

MUTE_SECONDS = 10.0
"""Seconds for which a peer is ignored after it has sent only invalid bytes."""

_DATAGRAM = 1200
"""Maximum size of a sent datagram in bytes. This is below the packet size of any network."""

_TURN = 64
"""Maximum number of datagrams plus frames that are read at a time. The limit leaves time for other work in a flood."""

_LARGEST = 8192
"""Maximum number of bytes that are read from a datagram. This is above the packet size of any network."""

BUFFER = 4 * 1024 * 1024
"""Requested size of the system's socket buffers, bytes. The buffers must store all datagrams of a tick.

The system may grant less.
"""

SocketAddress = tuple[str, int] | tuple[str, int, int, int]
"""Address as a tuple of Python's sockets, for IPv4 or IPv6."""


@dataclass(slots=True)
class _Peer:
    """Peer of a socket. Times are seconds of the loop's clock.

    Attributes:
        channel: codec of its frames.
        last_received: time of its last valid frame. Before the first valid frame, time of its first datagram.
        first_good: time of its first valid frame.
        link: its link. None before its first valid frame.
        muted: end of the time in which it is ignored.
    """

    channel: Channel
    last_received: float
    first_good: float = 0.0
    link: LinkId | None = None
    muted: float = 0.0

    @property
    def rank(self) -> tuple[bool, bool, float]:
        """Sorting key. The peer with the smallest key is replaced first."""
        settled = self.link is not None and self.last_received - self.first_good > SETTLED_SECONDS
        return self.link is not None, settled, self.last_received


@dataclass(frozen=True, slots=True)
class _Outlet:
    """Transport of a link."""

    socket: socket.socket
    address: SocketAddress

    def send_frames(self, frames: Sequence[bytes]) -> int:
        """Send frames in as few datagrams as possible."""
        unsent = first = 0
        while first < len(frames):
            last, size = first + 1, len(frames[first])
            while last < len(frames) and size + len(frames[last]) <= _DATAGRAM:
                size += len(frames[last])
                last += 1
            try:
                self.socket.sendto(b"".join(frames[first:last]), self.address)
            except ConnectionRefusedError:
                pass  # The system reports an earlier datagram that was refused, not this one.
            except OSError:
                unsent += last - first
            first = last
        return unsent


class UdpPort:
    """UDP socket with its peers.

    Args:
        links: links of the session.
        own: socket, bound, non-blocking.
        target: peer that exists from the start. If None, there are only peers that send first.
        robot: index of the only robot on its links. If None, all robots are on its links.
        admission: decides by address which peers that send first are accepted.
    """

    def __init__(
        self,
        links: MavlinkLinks,
        own: socket.socket,
        target: SocketAddress | None,
        robot: int | None = None,
        admission: Admission = OWN_MACHINE,
    ) -> None:
        self._admission = admission
        self._links = links
        self._robot = robot
        self._socket = own
        self._target = target
        self._target_host = None if target is None else target[0]
        self._peers: dict[SocketAddress, _Peer] = {}
        self._met: deque[float] = deque(maxlen=MEETINGS)
        self._sweep: asyncio.TimerHandle | None = None

    @property
    def where(self) -> Address:
        """Its own address."""
        host, port, *_ = cast(SocketAddress, self._socket.getsockname())
        return Address(host, port)

    def serve(self) -> None:
        """Start to send and receive."""
        loop = asyncio.get_running_loop()
        if self._target is not None:
            first = self._peers[self._target] = _Peer(self._links.channel(datagrams=True), loop.time())
            self._open(first, self._target)
        loop.add_reader(self._socket, self._readable)
        self._forget_stale()

    def close(self) -> None:
        """Close the socket and all its links."""
        asyncio.get_running_loop().remove_reader(self._socket)
        if self._sweep is not None:
            self._sweep.cancel()
        for address in tuple(self._peers):
            self._forget(address)
        self._socket.close()

    def _forget_stale(self) -> None:
        """Forget stale peers. Otherwise every robot would send heartbeats to all of them forever."""
        loop = asyncio.get_running_loop()
        for address, peer in tuple(self._peers.items()):
            if address != self._target and loop.time() - peer.last_received > STALE_SECONDS:
                self._forget(address)
        self._sweep = loop.call_later(STALE_SECONDS / 4.0, self._forget_stale)

    def _readable(self) -> None:
        read = 0
        while read < _TURN:
            read += 1
            try:
                data, address = self._socket.recvfrom(_LARGEST)
            except BlockingIOError:
                return
            except OSError:
                continue  # The system reports by ICMP that a target's port is closed.
            read += self._received(data, address)

    def _received(self, data: bytes, address: SocketAddress) -> int:
        """Process a datagram, and return the number of its frames."""
        now = asyncio.get_running_loop().time()
        peer = self._peers.get(address) or self._meet(address, now)
        if peer is None or now < peer.muted:
            return 0
        # UDP cannot make a peer wait, so its datagram is dropped.
        if peer.link is not None and not self._links.has_room(peer.link):
            self._links.drop(peer.link, 1)
            return 0
        frames = self._links.frames_in(_name(address), peer.channel, data)
        if frames:
            peer.last_received = now
            peer.first_good = peer.first_good or now
            self._open(peer, address)
            if peer.link is not None:
                self._links.receive(peer.link, frames)
        elif peer.channel.bytes_since_good > GARBAGE_LIMIT:
            peer.channel.bytes_since_good = 0
            peer.muted = now + MUTE_SECONDS
            why = "it sends no valid frames"
            self._links.complaints.warn(f"MAVLink: {_name(address)} is ignored for {MUTE_SECONDS:g} s: {why}")
        return len(frames)

    def _meet(self, address: SocketAddress, now: float) -> _Peer | None:
        if not (self._admission.admits(address[0]) or address[0] == self._target_host):
            why = "its address is in no network of open_to"
            self._links.complaints.warn(f"MAVLink: datagrams of {address[0]} are dropped: {why}")
            return None
        if len(self._met) == MEETINGS and now - self._met[0] < 1.0:
            # Sender addresses of datagrams can be forged, and each new peer needs a channel.
            self._links.complaints.warn(f"MAVLink: more than {MEETINGS} new peers in a second; some peers are ignored")
            return None
        self._met.append(now)
        if len(self._peers) > MAX_PEERS:
            others = (there for there in self._peers if there != self._target)
            self._forget(min(others, key=lambda there: self._peers[there].rank))
        peer = self._peers[address] = _Peer(self._links.channel(datagrams=True), now)
        return peer

    def _forget(self, address: SocketAddress) -> None:
        link = self._peers.pop(address).link
        if link is not None:
            self._links.close(link)

    def _open(self, peer: _Peer, address: SocketAddress) -> None:
        if peer.link is None:
            outlet = _Outlet(self._socket, address)
            peer.link = self._links.open(_name(address), peer.channel, outlet, self._robot)


async def udp_port(links: MavlinkLinks, target: UdpTarget) -> UdpPort | CannotListen:
    """Open an unused socket for a target. Bind it to the loopback interface if the target is on this machine."""
    found = await _bound(target.address, lambda there, family: (_local(there[0], family), 0))
    robot = None if target.number is None else index_of(target.number)
    return found if isinstance(found, CannotListen) else UdpPort(links, found.socket, found.given, robot)


async def udp_listener(
    links: MavlinkLinks, where: Address, admission: Admission = OWN_MACHINE
) -> UdpPort | CannotListen:
    """Open an unused socket at this address. Stations may send to it first."""
    found = await _bound(where, lambda there, family: there)
    return found if isinstance(found, CannotListen) else UdpPort(links, found.socket, None, admission=admission)


class _Bound(NamedTuple):
    """Bound socket, and the address for which it was opened."""

    socket: socket.socket
    given: SocketAddress


async def _bound(given: Address, own_for: Callable[[SocketAddress, int], SocketAddress]) -> _Bound | CannotListen:
    """Open a socket for an address. `own_for` returns the address to bind to, from this address and its family."""
    try:
        found = await asyncio.get_running_loop().getaddrinfo(given.host, given.port, type=socket.SOCK_DGRAM)
        family, there = found[0][0], cast(SocketAddress, found[0][4])
        own = socket.socket(family, socket.SOCK_DGRAM)
        try:
            own.setblocking(False)
            # The target may be the broadcast address of a network.
            own.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
            own.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, BUFFER)
            own.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, BUFFER)
            own.bind(own_for(there, family))
        except OSError:
            own.close()
            raise
    except (OSError, UnicodeError) as error:
        return CannotListen.because(error, given.host, given.port)
    return _Bound(own, there)


def _local(host: str, family: int) -> str:
    """Return the address of this machine to which a socket must be bound to reach a host."""
    if ipaddress.ip_address(host.partition("%")[0]).is_loopback:
        return host
    return "::" if family == socket.AF_INET6 else "0.0.0.0"


def _name(address: SocketAddress) -> str:
    return f"udp {Address(address[0], address[1])}"
