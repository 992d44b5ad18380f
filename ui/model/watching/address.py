"""Addresses of running sessions, as people type them."""

import re
from dataclasses import dataclass
from pathlib import Path

from thbridge.files.errors import BadFile

_ADDRESS = re.compile(r"(?P<host>[^\s/]+):(?P<port>[0-9]{1,5})")


@dataclass(frozen=True, slots=True)
class SessionAddress:
    """Address of the server that lets researchers watch a session."""

    host: str
    port: int

    def __str__(self) -> str:
        """Return the address as people type it."""
        return f"{self.host}:{self.port}"


def address_in(text: str) -> SessionAddress | None:
    """Return the address in a text. If the text is the path of a recording, return None.

    Raises:
        BadFile: the port is out of range.
    """
    found = _ADDRESS.fullmatch(text)
    if found is None or Path(text).exists():
        return None
    port = int(found["port"])
    if not 0 < port < 65536:
        raise BadFile(Path(text), f"{port} is not a port", "enter the port that the session printed, 1 to 65535")
    return SessionAddress(found["host"], port)
