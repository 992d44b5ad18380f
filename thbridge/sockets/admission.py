"""Admission of peers by their address: programs of this machine, and of the networks that a door is open to."""

import ipaddress
from asyncio import BaseTransport
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypeAlias

Network: TypeAlias = ipaddress.IPv4Network | ipaddress.IPv6Network

_OWN = frozenset({"localhost", "ip6-localhost"})


def parse_network(text: str) -> Network | None:
    """Parse a network, such as 10.0.0.0/24, or a single address; None when it is invalid."""
    try:
        return ipaddress.ip_network(text.strip(), strict=False)
    except ValueError:
        return None


def is_own(host: str) -> bool:
    """Return True for an address, or a name, at which only programs of this machine reach a server."""
    try:
        return _plain(host).is_loopback
    except ValueError:
        return host.lower() in _OWN


@dataclass(frozen=True, slots=True)
class Admission:
    """Admission to a server.

    Attributes:
        networks: whose machines are admitted, beside this one.
    """

    networks: tuple[Network, ...] = ()

    @classmethod
    def to(cls, networks: Iterable[str]) -> "Admission":
        """The admission of these networks; those that are invalid are left out."""
        return cls(tuple(network for text in networks if (network := parse_network(text)) is not None))

    def refused(self, transport: BaseTransport) -> str | None:
        """Return the address of a peer that is not admitted, for people; None for one that is."""
        peer = peer_of(transport)
        return None if peer is None or self.admits(peer) else peer

    def admits(self, host: str) -> bool:
        """Return True for the address of a peer that is admitted."""
        try:
            address = _plain(host)
        except ValueError:
            return False
        return address.is_loopback or any(address in network for network in self.networks)


OWN_MACHINE = Admission()
"""Admission of programs of this machine alone."""


def peer_of(transport: BaseTransport) -> str | None:
    """Return the address of another machine's peer; None for a program of this machine."""
    peer, own = transport.get_extra_info("peername"), transport.get_extra_info("sockname")
    if peer is None:
        return "somebody who has left"  # Whoever resets a connection at once has no address any more.
    # Sockets without addresses connect programs of one machine, and so do those whose addresses are the same.
    if not isinstance(peer, tuple) or peer[0] == own[0] or is_own(str(peer[0])):
        return None
    return str(peer[0])


def _plain(host: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address:
    """Return an address without its zone, as IPv4 where IPv6 only wraps it. Raises ValueError."""
    address = ipaddress.ip_address(host.partition("%")[0])
    mapped = address.ipv4_mapped if isinstance(address, ipaddress.IPv6Address) else None
    return mapped or address
