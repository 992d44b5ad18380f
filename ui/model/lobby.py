"""What the program that runs the games and the participant's window tell each other before and after a game.

The window is a process of its own, so that nothing of a game can be in it that the game has not told. One JSON object a
line: the host's at the window's standard input, the window's at its standard output.
"""

from typing import TypeAlias

import msgspec


class Offer(msgspec.Struct, frozen=True, tag=True):
    """Host: show the start page.

    Attributes:
        least: robots that may be chosen at the least.
        most: and at the most.
        usual: what the study plays with.
    """

    least: int
    most: int
    usual: int


class Preparing(msgspec.Struct, frozen=True, tag=True):
    """Host: what was asked for is being made ready; `sentence` says so to people."""

    sentence: str


class Join(msgspec.Struct, frozen=True, tag=True):
    """Host: the game waits at this address.

    Attributes:
        host: of its text server.
        port: of its text server.
        token: by which the server knows this participant again.
        practice: it is the practice game.
    """

    host: str
    port: int
    token: str
    practice: bool


class Begin(msgspec.Struct, frozen=True, tag=True):
    """Window: play with so many robots."""

    robots: int


class Practise(msgspec.Struct, frozen=True, tag=True):
    """Window: play the practice game."""


class Back(msgspec.Struct, frozen=True, tag=True):
    """Window: this game is left; back to the start page."""


class WindowClosed(msgspec.Struct, frozen=True, tag=True):
    """Window: it was closed on purpose."""


FromHost: TypeAlias = Offer | Preparing | Join
FromWindow: TypeAlias = Begin | Practise | Back | WindowClosed

_from_host: msgspec.json.Decoder[FromHost] = msgspec.json.Decoder(FromHost)
_from_window: msgspec.json.Decoder[FromWindow] = msgspec.json.Decoder(FromWindow)


def encode(said: FromHost | FromWindow) -> bytes:
    """A line that says this."""
    return msgspec.json.encode(said) + b"\n"


def decode_from_host(text: bytes) -> FromHost:
    """What a line of the host says. Raises msgspec.DecodeError."""
    return _from_host.decode(text)


def decode_from_window(text: bytes) -> FromWindow:
    """What a line of the window says. Raises msgspec.DecodeError."""
    return _from_window.decode(text)
