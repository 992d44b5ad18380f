"""Network addresses in the form HOST:PORT, and their defaults."""

from dataclasses import dataclass
from typing import NamedTuple

LOCALHOST = "127.0.0.1"
DEBIAN_HOST = "127.0.1.1"
"""Loopback address of a Debian machine's own name. The participant's window of 2016 connects to this address."""
LONGEST_HOST = 253
"""Maximum length of a machine's name (RFC 1035)."""
TEXT_SERVER_PORT = 6009
WATCH_PORT = 6010
ROS_MASTER_PORT = 11311
ROS_MASTER_URI = f"http://{LOCALHOST}:{ROS_MASTER_PORT}"


class Address(NamedTuple):
    """Network address of a program."""

    host: str
    port: int

    def __str__(self) -> str:
        return f"[{self.host}]:{self.port}" if ":" in self.host else f"{self.host}:{self.port}"


@dataclass(frozen=True, slots=True)
class ListeningAddress:
    """Address of an open server."""

    host: str
    port: int


def parse_address(text: str) -> Address | None:
    """Parse HOST:PORT, with an IPv6 host in brackets. Return None if it is invalid."""
    host, colon, number = text.rpartition(":")
    if not (colon and number.isascii() and number.isdecimal() and len(number) <= 5 and 0 < int(number) <= 65535):
        return None
    bare = host.removeprefix("[").removesuffix("]")
    bracketed = host == f"[{bare}]"
    if (
        not (bare.isprintable() and 0 < len(bare) <= LONGEST_HOST)
        or bare != bare.strip()
        or set(bare) & set("[]/ ")
        or (":" in bare) != bracketed
    ):
        return None
    return Address(bare, int(number))


class UdpTarget(NamedTuple):
    """Target to which a UDP socket sends without waiting for a first message.

    Attributes:
        address: address of the station.
        number: number of the only robot on the link, from 1. If None, all robots are on the link.
    """

    address: Address
    number: int | None = None

    def __str__(self) -> str:
        return f"{self.address}" if self.number is None else f"{self.address}/{self.number}"


def parse_target(text: str) -> UdpTarget | None:
    """Parse HOST:PORT, or HOST:PORT/ROBOT with a robot's number from 1. Return None if it is invalid."""
    where, slash, number = text.partition("/")
    address = parse_address(where)
    if address is None or not slash:
        return None if address is None else UdpTarget(address)
    if not (number.isascii() and number.isdecimal() and len(number) <= 5 and int(number) > 0):
        return None
    return UdpTarget(address, int(number))
