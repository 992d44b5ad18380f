"""Ports and addresses of participants.

Source: DDSI-RTPS 2.3, section 9.6.1.
"""

from collections.abc import Sequence

from thbridge.ros2graph.wire.rtps.parameters import UdpAddress

LOOPBACK = "127.0.0.1"
MULTICAST_HOST = "239.255.0.1"
LARGEST_DOMAIN = 232
"""Largest domain whose ports are below 65536."""
PARTICIPANT_IDS = 120
"""Number of participants of a domain that have ports on a machine."""
PROBED_IDS = 32
"""Number of participants on this machine that get announcements, as ROS 2 does it."""

_BASE, _PER_DOMAIN = 7400, 250


def metatraffic_port(domain: int, participant: int) -> int:
    """Return the port on which a participant receives discovery. The next port receives messages."""
    return _BASE + _PER_DOMAIN * domain + 10 + 2 * participant


def multicast_port(domain: int) -> int:
    """Return the port on which all participants of a domain receive discovery."""
    return _BASE + _PER_DOMAIN * domain


def initial_addresses(domain: int, interface: str) -> list[UdpAddress]:
    """Return the addresses that get our announcements: participants on this machine, and others by multicast."""
    local = [UdpAddress(LOOPBACK, metatraffic_port(domain, each)) for each in range(PROBED_IDS)]
    return local if is_loopback(interface) else [UdpAddress(MULTICAST_HOST, multicast_port(domain))]


def is_loopback(host: str) -> bool:
    """Return True if only programs on this machine can use the address."""
    return host.startswith("127.")


def reach_on_loopback(addresses: Sequence[UdpAddress], source: str) -> UdpAddress | None:
    """Select the address of a participant on this machine: its port, on loopback.

    A participant that uses all interfaces may announce only addresses of the network. Its socket is bound to all.
    """
    return next((UdpAddress(LOOPBACK, each.port) for each in addresses), None)


def reach_on_network(addresses: Sequence[UdpAddress], source: str) -> UdpAddress | None:
    """Select the address from which the participant sent; otherwise its first one that is not loopback."""
    others = [each for each in addresses if not is_loopback(each.host)]
    return next((each for each in others if each.host == source), next(iter(others), None))
