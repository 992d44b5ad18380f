"""Credentials of a connection: the key that it has shown, with its rights; and the lines by which keys are shown."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import msgspec


class Right(StrEnum):
    """Rights of a key."""

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
        key: name of the key that was shown; empty: none was.
        rights: what the connection may do.
        extended: False where it may speak as in 2016 only.
    """

    key: str = ""
    rights: tuple[Right, ...] = (Right.ADMIN,)
    extended: bool = True

    def may(self, right: Right) -> bool:
        """Return True where it has a right; an admin has all, and whoever may intervene may watch."""
        includes = right is Right.WATCH and Right.INTERVENE in self.rights
        return right in self.rights or includes or Right.ADMIN in self.rights

    @property
    def one_game(self) -> bool:
        """True where it is a participant's of one game, which cannot begin another."""
        return Right.PARTICIPANT in self.rights and Right.ADMIN not in self.rights

    def __str__(self) -> str:
        return f"{self.key} ({', '.join(self.rights)})"


LOCAL = Credentials()
"""Credentials of whoever is on this machine: everything may be said, without a key."""
PLAIN = Credentials(extended=False)
"""Credentials of whoever is on another machine and shows no key."""


class KeyAnswer(msgspec.Struct, frozen=True, omit_defaults=True, forbid_unknown_fields=True):
    """Answer of the text server to a key; it is one line of JSON.

    Attributes:
        admitted: name of the key; empty: the client is refused.
        refused: the reason, as a clause.
    """

    admitted: str = ""
    refused: str = ""

    def line(self) -> bytes:
        """Return the line."""
        return msgspec.json.encode(self) + b"\n"


def key_line(secret: str) -> bytes:
    """Return the first line of a client, with its key."""
    return msgspec.json.encode({"key": secret}) + b"\n"


def secret_of(line: bytes) -> str | None:
    """Return the key in a client's first line; None where there is none."""
    try:
        value: object = msgspec.json.decode(line)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        return None
    key = value.get("key") if isinstance(value, dict) else None
    return key if isinstance(key, str) else None


def parse_answer(line: bytes) -> KeyAnswer | None:
    """Return the server's answer in a line; None where it is none."""
    try:
        return msgspec.json.decode(line, type=KeyAnswer)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        return None
