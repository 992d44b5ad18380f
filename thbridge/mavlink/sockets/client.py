"""Socket of our ground station. It uses TCP, or UDP, usually bound to the port to which robots send."""

from __future__ import annotations

import asyncio
import socket
import time
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, suppress
from typing import cast

from thbridge.files.errors import reason_of
from thbridge.mavlink.sockets.links import TimestampStore
from thbridge.mavlink.sockets.udp import BUFFER, SocketAddress
from thbridge.mavlink.station.ground_station import GroundStation, StationEvent
from thbridge.mavlink.wire.frames.channel import Channel
from thbridge.mavlink.wire.frames.signing import KnownTimestamps, SignatureTimestamps, Signing, SigningKey
from thbridge.sockets.addresses import Address

CONNECT_SECONDS = 5.0

_LARGEST = 65535
_TURN = 64
"""Maximum number of datagrams that are read at a time."""
_STEP = 0.05
"""Seconds between two checks of the clock when nothing is received."""


class Unreachable(Exception):  # noqa: N818 - not an error of the program
    """Failure to reach robots. Its text is the reason, as a clause without a full stop."""


class StationSocket:
    """Ground station with its socket.

    Args:
        own: socket, connected or bound, non-blocking.
        peer: UDP address to send to. If None, frames go to all addresses from which frames came.
        key: key to sign and verify frames, or None.
        known: timestamps of earlier stations with this key.

    Attributes:
        station: the ground station.
        is_listening: True if it waits for robots to send first, False if it sends to a given address.
    """

    def __init__(
        self,
        own: socket.socket,
        peer: SocketAddress | None,
        key: SigningKey | None,
        known: KnownTimestamps | None = None,
    ) -> None:
        self.station = GroundStation()
        self._socket = own
        self._stream = own.type == socket.SOCK_STREAM
        self.is_listening = not self._stream and peer is None
        self._peers = set() if peer is None else {peer}
        # Robots reject a timestamp that is not newer than the last one from this station.
        self._timestamps = SignatureTimestamps(known)
        signing = None if key is None else Signing(key, 0, self._timestamps)
        self._channel = Channel(signing, datagrams=not self._stream)

    @property
    def known(self) -> KnownTimestamps:
        """Timestamps of all frames so far. The next station with this key needs them."""
        return self._timestamps.known

    @property
    def refused(self) -> int:
        """Number of frames whose signature was missing, wrong or old."""
        return self._channel.counts.refused

    async def poll(self) -> list[StationEvent]:
        """Wait briefly for frames, process them, and return the events.

        Raises:
            Unreachable: the connection has ended.
        """
        # A listening station does not know any address before a robot has sent a frame.
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
        """Wait until the socket is readable."""
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
                continue  # An earlier datagram was refused, because the peer's port is not open yet.
            if self._stream and not data:
                raise Unreachable("the robots' program closed the connection")
            if self.is_listening:
                self._peers.add(address)
            yield data

    async def _send(self) -> None:
        now = time.time()
        for frame in self.station.take_frames():
            data = self._channel.encode(frame, now)
            if self._stream:
                try:
                    await asyncio.get_running_loop().sock_sendall(self._socket, data)
                except OSError as error:
                    raise Unreachable(reason_of(error)) from None
            for peer in self._peers:
                with suppress(OSError):  # The peer's port may not be open yet. Heartbeats and commands are repeated.
                    self._socket.sendto(data, peer)


@asynccontextmanager
async def open_station(
    address: Address, tcp: bool, key: SigningKey | None, store: TimestampStore | None = None
) -> AsyncIterator[StationSocket]:
    """Open a ground station at an address.

    If there are no timestamps of earlier stations, the first frame of a robot may be a minute old, because clocks may
    differ.

    For UDP, the station binds to the address if possible, as ground stations usually do. Otherwise it sends to the
    address.

    Raises:
        Unreachable: the address does not exist, or no program answers at it.
    """
    kind = socket.SOCK_STREAM if tcp else socket.SOCK_DGRAM
    loop = asyncio.get_running_loop()
    try:
        family, _, _, _, found = (await loop.getaddrinfo(address.host, address.port, type=kind))[0]
    except OSError as error:
        raise Unreachable(reason_of(error)) from None
    except UnicodeError:
        raise Unreachable("this is not the name of a host") from None
    there = cast(SocketAddress, found)
    with socket.socket(family, kind) as own:
        own.setblocking(False)
        peer: SocketAddress | None = None
        if tcp:
            try:
                async with asyncio.timeout(CONNECT_SECONDS):
                    await loop.sock_connect(own, there)
            except TimeoutError:
                raise Unreachable("no program answers at this address") from None
            except OSError as error:
                raise Unreachable(reason_of(error)) from None
        else:
            own.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, BUFFER)
            try:
                own.bind(there)
            except OSError:
                peer = there
        station = StationSocket(own, peer, key, None if store is None else store.read())
        try:
            yield station
        finally:
            if store is not None:
                store.write(station.known)
