"""Credentials of a connection (the key and the rights of this key), and the lines in which keys are sent."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import msgspec


class Right(StrEnum):
    """Right of a key."""

    PARTICIPANT = "participant"
    HIDER = "hider"
    ROBOTS = "robots"
    WATCH = "watch"
    INTERVENE = "intervene"
    ADMIN = "admin"


@dataclass(frozen=True, slots=True)
class Credentials:
    """Credentials of a connection.

    Attributes:
        key: name of the connection's key; empty if there is no key.
        rights: rights of the connection.
        extended: False if the connection may only use the protocol of 2016.
        seats: names of the seats that a participant's program may take; empty for all.
    """

    key: str = ""
    rights: tuple[Right, ...] = (Right.ADMIN,)
    extended: bool = True
    seats: tuple[str, ...] = ()

    def may(self, right: Right) -> bool:
        """Return True if the connection has a right.

        Admins have all rights. The right to intervene includes the right to watch.
        """
        includes = right is Right.WATCH and Right.INTERVENE in self.rights
        return right in self.rights or includes or Right.ADMIN in self.rights

    @property
    def one_game(self) -> bool:
        """True for a participant's key, which is valid for one game only."""
        return Right.PARTICIPANT in self.rights and Right.ADMIN not in self.rights

    def __str__(self) -> str:
        return f"{self.key} ({', '.join(self.rights)})"


LOCAL = Credentials()
"""Credentials of clients on this machine: all rights, without a key."""
PLAIN = Credentials(extended=False)
"""Credentials of clients that connect from other machines and present no key."""


class KeyAnswer(msgspec.Struct, frozen=True, omit_defaults=True, forbid_unknown_fields=True):
    """Answer of the text server to a key, as one line of JSON.

    Attributes:
        admitted: name of the key; empty if the client is refused.
        refused: reason for the refusal, as a clause.
    """

    admitted: str = ""
    refused: str = ""

    def line(self) -> bytes:
        """Return the answer as a line."""
        return msgspec.json.encode(self) + b"\n"


def key_line(secret: str) -> bytes:
    """Return the first line of a client, with its key."""
    return msgspec.json.encode({"key": secret}) + b"\n"


def secret_of(line: bytes) -> str | None:
    """Return the key in a client's first line; None if the line has no key."""
    try:
        value: object = msgspec.json.decode(line)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        return None
    key = value.get("key") if isinstance(value, dict) else None
    return key if isinstance(key, str) else None


def parse_answer(line: bytes) -> KeyAnswer | None:
    """Return the server's answer in a line; None if the line is not an answer."""
    try:
        return msgspec.json.decode(line, type=KeyAnswer)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        return None
