"""Network addresses as people write them: HOST:PORT."""

from dataclasses import dataclass
from typing import NamedTuple


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


def address_in(text: str) -> Address | None:
    """Parse HOST:PORT, with an IPv6 host in brackets; None when it is invalid."""
    host, colon, number = text.rpartition(":")
    if not (colon and number.isascii() and number.isdecimal() and 0 < int(number) <= 65535):
        return None
    bare = host.removeprefix("[").removesuffix("]")
    bracketed = host == f"[{bare}]"
    if not bare or bare != bare.strip() or set(bare) & set("[]/ ") or (":" in bare) != bracketed:
        return None
    return Address(bare, int(number))
