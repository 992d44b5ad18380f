"""Datagrams to send: submessages to the same participant share datagrams."""

from typing import NamedTuple

from thbridge.ros2graph.wire.rtps.parameters import UdpAddress
from thbridge.ros2graph.wire.rtps.submessages import encode_destination, encode_header

MOST_WAITING = 4096
"""Maximum number of datagrams that wait. Further ones are dropped; reliable readers ask for their samples again."""


RESENT_BYTES = 4 << 20
"""Maximum number of bytes that are sent again per tick. A short request can ask for much, so requests are limited."""


class Outgoing(NamedTuple):
    """Datagram to send."""

    address: UdpAddress
    datagram: bytes


class Destination:
    """Address of a participant, with the header of datagrams to it.

    Args:
        address: where it receives.
        own_prefix: our prefix.
        prefix: its prefix. If empty, all participants at the address are meant.
    """

    __slots__ = ("address", "header", "prefix", "size", "waiting")

    def __init__(self, address: UdpAddress, own_prefix: bytes, prefix: bytes = b"") -> None:
        self.address = address
        self.prefix = prefix
        self.header = encode_header(own_prefix) + (encode_destination(prefix) if prefix else b"")
        self.waiting: list[bytes] = []
        self.size = 0


class Outbox:
    """Submessages that wait to be sent, packed into datagrams.

    Args:
        datagram_size: maximum number of bytes of a datagram, unless a single submessage is longer.
    """

    def __init__(self, datagram_size: int) -> None:
        self._limit = datagram_size
        self._open: dict[Destination, None] = {}
        self._ready: list[Outgoing] = []
        self._resendable = RESENT_BYTES
        self.dropped = 0

    def renew(self) -> None:
        """Allow the samples of another tick to be sent again."""
        self._resendable = RESENT_BYTES

    def may_resend(self, size: int) -> bool:
        """Return True if this number of bytes may be sent again in this tick."""
        self._resendable -= size
        return self._resendable >= 0

    def add(self, destination: Destination, submessage: bytes) -> None:
        """Add a submessage for a participant."""
        size = len(submessage)
        if not destination.waiting:
            self._open[destination] = None
            destination.size = len(destination.header)
        elif destination.size + size > self._limit:
            self._close(destination)
            destination.size = len(destination.header)
        destination.waiting.append(submessage)
        destination.size += size

    def drain(self) -> list[Outgoing]:
        """Return all waiting datagrams in order, and forget them."""
        for destination in self._open:
            self._close(destination)
        self._open.clear()
        ready, self._ready = self._ready, []
        return ready

    def _close(self, destination: Destination) -> None:
        if len(self._ready) < MOST_WAITING:
            datagram = b"".join((destination.header, *destination.waiting))
            self._ready.append(Outgoing(destination.address, datagram))
        else:
            self.dropped += 1
        destination.waiting.clear()
