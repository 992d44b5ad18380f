"""Admission of peers by address: programs of this machine, and of networks from which a server accepts peers."""

import ipaddress
from asyncio import BaseTransport
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypeAlias

Network: TypeAlias = ipaddress.IPv4Network | ipaddress.IPv6Network

_OWN = frozenset({"localhost", "ip6-localhost"})


def parse_network(text: str) -> Network | None:
    """Parse a network, such as 10.0.0.0/24, or a single address. Return None if it is invalid."""
    try:
        return ipaddress.ip_network(text.strip(), strict=False)
    except ValueError:
        return None


def is_own(host: str) -> bool:
    """Return True if only programs of this machine can reach a server at this address or name."""
    try:
        return _plain(host).is_loopback
    except ValueError:
        return host.lower() in _OWN


@dataclass(frozen=True, slots=True)
class Admission:
    """Admission to a server.

    Attributes:
        networks: networks of the admitted machines. This machine is always admitted.
    """

    networks: tuple[Network, ...] = ()

    @classmethod
    def to(cls, networks: Iterable[str]) -> "Admission":
        """Return the admission of these networks, without the invalid ones."""
        return cls(tuple(network for text in networks if (network := parse_network(text)) is not None))

    def refused(self, transport: BaseTransport) -> str | None:
        """Return the address of a peer that is not admitted, for people. If the peer is admitted, return None."""
        peer = peer_of(transport)
        return None if peer is None or self.admits(peer) else peer

    def admits(self, host: str) -> bool:
        """Return True if peers at this address are admitted."""
        try:
            address = _plain(host)
        except ValueError:
            return False
        return address.is_loopback or any(address in network for network in self.networks)


OWN_MACHINE = Admission()
"""Admission of programs of this machine only."""


def peer_of(transport: BaseTransport) -> str | None:
    """Return the address of a peer on another machine. If the peer is a program of this machine, return None."""
    peer, own = transport.get_extra_info("peername"), transport.get_extra_info("sockname")
    if peer is None:
        return "a client that has left"  # A connection that was reset at once no longer has an address.
    # Both programs are on one machine if their sockets have no addresses (Unix sockets) or have the same address.
    if not isinstance(peer, tuple) or peer[0] == own[0] or is_own(str(peer[0])):
        return None
    return str(peer[0])


def _plain(host: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address:
    """Return an address without its zone, and an IPv4-mapped IPv6 address as IPv4. Raises ValueError."""
    address = ipaddress.ip_address(host.partition("%")[0])
    # A socket for both versions of IP shows IPv4 peers with mapped addresses.
    mapped = address.ipv4_mapped if isinstance(address, ipaddress.IPv6Address) else None
    return mapped or address
