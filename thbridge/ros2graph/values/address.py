"""Address of a ROS 2 graph."""

import ipaddress
from dataclasses import dataclass
from enum import StrEnum

MOST_DOMAINS = 232
"""Largest domain id. Larger domains have no UDP ports (DDSI-RTPS, section 9.6.1.1)."""
ROUTER = "127.0.0.1:7447"
"""Default address of zenoh's router."""


class CarrierKind(StrEnum):
    """Protocol that carries the messages of a ROS 2 graph."""

    DDS = "dds"
    ZENOH = "zenoh"


class RosDistribution(StrEnum):
    """Distribution of ROS 2, whose message types are used."""

    JAZZY = "jazzy"
    KILTED = "kilted"


@dataclass(frozen=True, slots=True)
class Ros2Address:
    """Address of a ROS 2 graph. Every program that can reach it can drive robots.

    Attributes:
        carrier: protocol of the graph.
        domain: domain id; only programs of the same domain see each other.
        host: own address on the network; all other addresses of this machine stay closed.
        router: address of zenoh's router, HOST:PORT.
        distribution: distribution whose message types are used.
    """

    carrier: CarrierKind = CarrierKind.DDS
    domain: int = 0
    host: str = "127.0.0.1"
    router: str = ROUTER
    distribution: RosDistribution = RosDistribution.JAZZY

    def __str__(self) -> str:
        where = f"on {self.host}" if self.carrier is CarrierKind.DDS else f"at the router {self.router}"
        protocol = {CarrierKind.DDS: "DDS", CarrierKind.ZENOH: "zenoh"}[self.carrier]
        return f"{self.distribution.value.capitalize()} in domain {self.domain} {where} ({protocol})"


def is_ipv4(text: str) -> bool:
    """Return True for an IPv4 address, such as "127.0.0.1"."""
    try:
        ipaddress.IPv4Address(text)
    except ValueError:
        return False
    return True
