"""A ground station's socket: over UDP as ground stations have it, bound where robots speak to; or over TCP."""

from __future__ import annotations

import asyncio
import socket
import time
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, suppress
from typing import cast

from thbridge.files.errors import reason_of
from thbridge.sockets.addresses import Address
from thbridge.sockets.mavlink.udp import BUFFER, SocketAddress
from thbridge.wire.mavlink.frames.channel import Channel
from thbridge.wire.mavlink.frames.signing import SignatureTimestamps, Signing, SigningKey
from thbridge.wire.mavlink.station.ground_station import GroundStation, StationEvent

CONNECT_SECONDS = 5.0

_LARGEST = 65535
_TURN = 64
"""Datagrams taken at a time."""
_STEP = 0.05
"""Seconds between two looks at the clock, when nothing comes in."""


class Unreachable(Exception):  # noqa: N818 - nothing went wrong with the program
    """There is no way to speak to robots there; as text, why, as a clause without its full stop."""


class StationSocket:
    """A ground station at a socket.

    Args:
        own: connected or bound, and not blocking.
        peer: whom to speak to by UDP; None: whoever speaks to us.
        key: with which frames are signed and verified; None for none.

    Attributes:
        station: what it knows and says.
        waits: it listens where robots may come to; or else it went where they may be.
    """

    def __init__(self, own: socket.socket, peer: SocketAddress | None, key: SigningKey | None) -> None:
        self.station = GroundStation()
        self._socket = own
        self._stream = own.type == socket.SOCK_STREAM
        self.waits = not self._stream and peer is None
        self._peers = set() if peer is None else {peer}
        signing = None if key is None else Signing(key, 0, SignatureTimestamps())
        self._channel = Channel(signing, datagrams=not self._stream)

    @property
    def refused(self) -> int:
        """Frames whose signature was missing, wrong or old."""
        return self._channel.tally.refused

    async def turn(self) -> list[StationEvent]:
        """Wait for what comes in next, or for a moment; what has happened.

        Raises:
            Unreachable: the connection has ended.
        """
        # Its first heartbeat is for the first who is there.
        events = self.station.advance(time.monotonic()) if self._stream or self._peers else []
        await self._send()
        try:
            async with asyncio.timeout(_STEP):
                await self._readable()
        except TimeoutError:
            return events
        for data in self._received():
            for frame in self._channel.receive_data(data, time.time()):
                events += self.station.receive_frame(frame, time.monotonic())
        await self._send()
        return events

    async def _readable(self) -> None:
        """Wait until something has come in."""
        loop = asyncio.get_running_loop()
        ready = asyncio.Event()
        loop.add_reader(self._socket, ready.set)
        try:
            await ready.wait()
        finally:
            loop.remove_reader(self._socket)

    def _received(self) -> Iterator[bytes]:
        for _ in range(_TURN):
            try:
                data, address = self._socket.recvfrom(_LARGEST)
            except BlockingIOError:
                return
            except OSError as error:
                if self._stream:
                    raise Unreachable(reason_of(error)) from None
                continue  # Nobody is there yet.
            if self._stream and not data:
                raise Unreachable("the other side has ended the connection")
            if self.waits:
                self._peers.add(address)
            yield data

    async def _send(self) -> None:
        now = time.time()
        for frame in self.station.take_frames():
            data = self._channel.bytes_of(frame, now)
            if self._stream:
                try:
                    await asyncio.get_running_loop().sock_sendall(self._socket, data)
                except OSError as error:
                    raise Unreachable(reason_of(error)) from None
            for peer in self._peers:
                with suppress(OSError):  # Nobody is there yet; what matters is sent again.
                    self._socket.sendto(data, peer)


@asynccontextmanager
async def linked(address: Address, tcp: bool, key: SigningKey | None) -> AsyncIterator[StationSocket]:
    """A ground station at an address, while it lasts.

    By UDP it takes the address for its own, as ground stations do, where that can be; else it speaks to it.

    Raises:
        Unreachable: there is no such address, or nobody takes connections there.
    """
    kind = socket.SOCK_STREAM if tcp else socket.SOCK_DGRAM
    loop = asyncio.get_running_loop()
    try:
        family, _, _, _, found = (await loop.getaddrinfo(address.host, address.port, type=kind))[0]
    except OSError as error:
        raise Unreachable(reason_of(error)) from None
    except UnicodeError:
        raise Unreachable("that is not a host's name") from None
    there = cast(SocketAddress, found)
    with socket.socket(family, kind) as own:
        own.setblocking(False)
        peer: SocketAddress | None = None
        if tcp:
            try:
                async with asyncio.timeout(CONNECT_SECONDS):
                    await loop.sock_connect(own, there)
            except TimeoutError:
                raise Unreachable("nobody answers") from None
            except OSError as error:
                raise Unreachable(reason_of(error)) from None
        else:
            own.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, BUFFER)
            try:
                own.bind(there)
            except OSError:
                peer = there
        yield StationSocket(own, peer, key)
