"""Lines of the text protocol: framing, tokens and routed messages.

The treasure hunt of 2016 used the protocol of the HRTeam server (2015). Each line is one message in UTF-8. ASCII white
space separates its tokens. The first token is the command.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

EXTENDED = "extended"
"""Second argument of a ``%%setid``, by which our own programs request extensions of the protocol of 2016."""

_TOKEN = re.compile(r"\S+", re.ASCII)


class TextCommand(StrEnum):
    """Commands with a meaning for the server or its programs."""

    ACK = "%%ack"
    ERROR = "%%error"
    FOUND = "%%found"
    GETID = "%%getid"
    GOTO = "%%goto"
    HIDE = "%%hide"
    IMAGE = "%%image"
    MOVE = "%%move"
    PING = "%%ping"
    PONG = "%%pong"
    POSE = "%%pose"
    SCORE = "%%score"
    SEND = "%%send"
    SETID = "%%setid"
    SHUTDOWN = "%%sshhuuttddoowwnn"
    SNAP = "%%snap"
    WHERE = "%%where"


ROUTED = frozenset(
    {
        TextCommand.ERROR,
        TextCommand.FOUND,
        TextCommand.GOTO,
        TextCommand.HIDE,
        TextCommand.IMAGE,
        TextCommand.MOVE,
        TextCommand.POSE,
        TextCommand.SCORE,
        TextCommand.SNAP,
        TextCommand.WHERE,
    }
)
"""Commands that the server passes on to the receiver in the line."""


@dataclass(frozen=True, slots=True)
class UnreadableText:
    """Text that could not be decoded.

    Attributes:
        text: the text in question.
        reason: the fault, as the end of the sentence "cannot be read: ...".
    """

    text: str
    reason: str


@dataclass(frozen=True, slots=True)
class TextMessage:
    """Routed message, ``COMMAND FROM TO CONTENT...``.

    Attributes:
        command: usually one of `ROUTED`. Inside a ``%%send`` it may be any word.
        sender: name of the sending program. It may differ from the name of the connection.
        receiver: name of the receiving program.
        content: the remaining tokens.

    Raises:
        ValueError: a token is empty or contains white space, so that it would change on the wire.
    """

    command: str
    sender: str
    receiver: str
    content: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for token in (self.command, self.sender, self.receiver, *self.content):
            if _TOKEN.fullmatch(token) is None:
                raise ValueError(f"not one token: {token!r}")

    @classmethod
    def of(cls, command: str, sender: str, receiver: str, text: str) -> TextMessage:
        """Return a message with running text as content. The text is split at white space, as on the wire."""
        return cls(command, sender, receiver, tuple(tokens(text)))

    @property
    def text(self) -> str:
        """Content as running text, with single blanks between the tokens."""
        return " ".join(self.content)

    def line(self) -> str:
        """Return the message as it is sent, without the line feed.

        It always ends with one blank, because the Java clients of 2016 cut a fixed number of characters off the end.
        """
        return " ".join((self.command, self.sender, self.receiver, *self.content, ""))


def tokens(line: str) -> list[str]:
    """Split a line at ASCII white space. A no-break space is part of a token, as in the Java programs of 2016."""
    return _TOKEN.findall(line)


def parse_line(line: str) -> TextMessage | UnreadableText:
    """Return the message in a line. If the command is ``%%send``, return the message inside it."""
    return parse_tokens(tokens(line))


def parse_tokens(parts: Sequence[str]) -> TextMessage | UnreadableText:
    """Return the message in a line that is already split into tokens. See `parse_line`."""
    match parts:
        # The two names after ``%%send`` are ignored. The names in the inner message count.
        case [TextCommand.SEND, _, _, command, sender, receiver, *content]:
            return TextMessage(command, sender, receiver, tuple(content))
        case [command, sender, receiver, *content] if command in ROUTED:
            return TextMessage(command, sender, receiver, tuple(content))
        case [command, *_] if command in ROUTED or command == TextCommand.SEND:
            return UnreadableText(" ".join(parts), "it does not name a receiver")
        case _:
            return UnreadableText(" ".join(parts), "it is not a command that is passed on")


def encode_line(line: str) -> bytes:
    """Return a line as bytes with its line feed. UTF-8 cannot encode lone surrogates, so they become question marks."""
    return line.encode("utf-8", errors="replace") + b"\n"
