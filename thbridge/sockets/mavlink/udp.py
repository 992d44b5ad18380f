"""MAVLink over UDP: a socket for each target and one that waits to be spoken to, and a link for everybody they hear."""

from __future__ import annotations

import asyncio
import ipaddress
import socket
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, cast

from thbridge.files.errors import reason_of
from thbridge.sockets.addresses import Address, address_in
from thbridge.sockets.errors import CannotListen
from thbridge.sockets.mavlink.links import GARBAGE, MavlinkLinks
from thbridge.wire.mavlink.frames.channel import Channel
from thbridge.wire.mavlink.outgoing import LinkId

PEERS = 32
"""Who speaks to one socket beside its target, if it has one; one more, and who was silent for longest is forgotten."""

SILENT = 60.0
"""Seconds after which somebody who has said nothing good is forgotten; the target never is."""

MUTED = 10.0
"""Seconds for which nobody listens to a peer that sent nothing but garbage."""

_DATAGRAM = 1200
"""Bytes that are sent as one datagram: fewer than any network's packets have."""

_TURN = 64
"""Datagrams taken at a time, so that a peer that floods us leaves turns to the others."""

_LARGEST = 65535
BUFFER = 4 * 1024 * 1024
"""Bytes that the system is asked to keep for us while a tick runs; it may grant fewer."""

SocketAddress = tuple[str, int] | tuple[str, int, int, int]
"""As sockets have it: of IPv4, or of IPv6."""


class UdpTarget(NamedTuple):
    """To whom a socket speaks from the start.

    Attributes:
        address: theirs.
        robot: the only one that they find there, from 0; None: all robots.
    """

    address: Address
    robot: int | None = None

    def __str__(self) -> str:
        return f"{self.address}" if self.robot is None else f"{self.address}/{self.robot + 1}"


def target_in(text: str) -> UdpTarget | None:
    """The target that HOST:PORT means, or HOST:PORT/ROBOT with a robot's number from 1. None: it means none."""
    where, slash, number = text.partition("/")
    address = address_in(where)
    if address is None or not slash:
        return None if address is None else UdpTarget(address)
    if not (number.isascii() and number.isdecimal() and int(number) > 0):
        return None
    return UdpTarget(address, int(number) - 1)


@dataclass(slots=True)
class _Peer:
    """Somebody who speaks to a socket.

    Attributes:
        channel: what it says.
        heard: seconds of the loop's clock when its last good frame came, or else when it first spoke.
        link: None as long as nothing good has come.
        muted: until then it is not listened to.
    """

    channel: Channel
    heard: float
    link: LinkId | None = None
    muted: float = 0.0


@dataclass(frozen=True, slots=True)
class _Outlet:
    """A link's way out."""

    socket: socket.socket
    address: SocketAddress

    def carry(self, frames: Sequence[bytes]) -> int:
        """As many frames to a datagram as go in."""
        unsent = first = 0
        while first < len(frames):
            last, size = first + 1, len(frames[first])
            while last < len(frames) and size + len(frames[last]) <= _DATAGRAM:
                size += len(frames[last])
                last += 1
            try:
                self.socket.sendto(b"".join(frames[first:last]), self.address)
            except ConnectionRefusedError:
                pass  # Nobody is there yet, which an earlier datagram has found out; this one is none the worse.
            except OSError:
                unsent += last - first
            first = last
        return unsent


class UdpPort:
    """A socket, and all who are reached by it.

    Args:
        links: where its frames come from and go to.
        own: bound, and not blocking.
        target: to whom it speaks from the start; None: to nobody before they speak to it.
        robot: the only one that is found there, from 0; None: all robots.
    """

    def __init__(
        self, links: MavlinkLinks, own: socket.socket, target: SocketAddress | None, robot: int | None = None
    ) -> None:
        self._links = links
        self._robot = robot
        self._socket = own
        self._target = target
        self._peers: dict[SocketAddress, _Peer] = {}
        self._sweep: asyncio.TimerHandle | None = None

    @property
    def where(self) -> Address:
        """Its own address."""
        host, port, *_ = cast(SocketAddress, self._socket.getsockname())
        return Address(host, port)

    def serve(self) -> None:
        """Begin to speak and listen."""
        loop = asyncio.get_running_loop()
        if self._target is not None:
            first = self._peers[self._target] = _Peer(self._links.channel(datagrams=True), loop.time())
            self._open(first, self._target)
        loop.add_reader(self._socket, self._readable)
        self._forget_silent()

    def close(self) -> None:
        """Speak and listen no more."""
        asyncio.get_running_loop().remove_reader(self._socket)
        if self._sweep is not None:
            self._sweep.cancel()
        for address in tuple(self._peers):
            self._forget(address)
        self._socket.close()

    def _forget_silent(self) -> None:
        """Those who have gone would cost a heartbeat of every robot for ever."""
        loop = asyncio.get_running_loop()
        for address, peer in tuple(self._peers.items()):
            if address != self._target and loop.time() - peer.heard > SILENT:
                self._forget(address)
        self._sweep = loop.call_later(SILENT / 4.0, self._forget_silent)

    def _readable(self) -> None:
        for _ in range(_TURN):
            try:
                data, address = self._socket.recvfrom(_LARGEST)
            except BlockingIOError:
                return
            except OSError:
                continue  # Some target is not there, as the network says.
            self._received(data, address)

    def _received(self, data: bytes, address: SocketAddress) -> None:
        now = asyncio.get_running_loop().time()
        peer = self._peers.get(address) or self._meet(address, now)
        if now < peer.muted:
            return
        frames = self._links.frames_in(_name(address), peer.channel, data)
        if frames:
            peer.heard = now
            self._open(peer, address)
            if peer.link is not None:
                self._links.receive(peer.link, frames)
        elif peer.channel.spoiled > GARBAGE:
            peer.channel.spoiled = 0
            peer.muted = now + MUTED
            self._links.complaints.warn(f"MAVLink: {_name(address)} sends nothing of use, and is not listened to")

    def _meet(self, address: SocketAddress, now: float) -> _Peer:
        if len(self._peers) > PEERS:
            others = (there for there in self._peers if there != self._target)
            # Whoever has said nothing good yet goes first: strangers drive no ground station out.
            self._forget(min(others, key=lambda there: (self._peers[there].link is not None, self._peers[there].heard)))
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
    """A socket for a target, on this machine alone if the target is on it; not in use yet."""
    found = await _bound(target.address, lambda there, family: (_local(there[0], family), 0))
    return found if isinstance(found, CannotListen) else UdpPort(links, found.socket, found.given, target.robot)


async def udp_listener(links: MavlinkLinks, where: Address) -> UdpPort | CannotListen:
    """A socket at this address, for whoever speaks to it first; not in use yet."""
    found = await _bound(where, lambda there, family: there)
    return found if isinstance(found, CannotListen) else UdpPort(links, found.socket, None)


class _Bound(NamedTuple):
    """A socket, and the address for which it was made."""

    socket: socket.socket
    given: SocketAddress


async def _bound(given: Address, own_for: Callable[[SocketAddress, int], SocketAddress]) -> _Bound | CannotListen:
    """A socket for a given address, bound to what `own_for` makes of it and its family."""
    try:
        found = await asyncio.get_running_loop().getaddrinfo(given.host, given.port, type=socket.SOCK_DGRAM)
        family, there = found[0][0], cast(SocketAddress, found[0][4])
        own = socket.socket(family, socket.SOCK_DGRAM)
        try:
            own.setblocking(False)
            own.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
            own.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, BUFFER)
            own.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, BUFFER)
            own.bind(own_for(there, family))
        except OSError:
            own.close()
            raise
    except OSError as error:
        return CannotListen(given.host, given.port, reason_of(error))
    except UnicodeError:
        return CannotListen(given.host, given.port, "that is not a host's name")
    return _Bound(own, there)


def _local(host: str, family: int) -> str:
    """The address to bind to in order to speak with a host."""
    if ipaddress.ip_address(host.partition("%")[0]).is_loopback:
        return host
    return "::" if family == socket.AF_INET6 else "0.0.0.0"


def _name(address: SocketAddress) -> str:
    return f"udp {Address(address[0], address[1])}"
