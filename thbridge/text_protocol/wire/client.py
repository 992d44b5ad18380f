"""Text protocol as one of our own programs speaks it, without the socket.

`ClientSession` lives as long as one connection: send its `hello`, feed it what arrives, carry out the events. It
registers as an extended client, answers pings and keeps the server's own lines to itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto
from typing import TypeAlias

from thbridge.line_splitter import LineSplitter, OverlongLine
from thbridge.text_protocol.wire.lines import EXTENDED, TextCommand, TextMessage, encode_line, parse_tokens, tokens
from thbridge.text_protocol.wire.notice import REFUSED, SERVER, Notice, is_notice, parse_notice

_PONG_LINE = encode_line(f"{TextCommand.PONG} ")


@dataclass(frozen=True, slots=True)
class NameRegistered:
    """The server has accepted our name: the moment to introduce ourselves to the other programs."""


@dataclass(frozen=True, slots=True)
class SendToServer:
    """Bytes to be written to the server."""

    data: bytes


class ServerCloseReason(Enum):
    """Reason why the server ends the connection."""

    REFUSED = auto()
    """Our name is already held, or the server is full."""
    STOPPED = auto()


@dataclass(frozen=True, slots=True)
class ClosedByServer:
    """The server has announced the end of this connection; nothing more will come on it.

    Attributes:
        reason: kind of reason.
        detail: what the server says of it, as a clause; empty: nothing.
    """

    reason: ServerCloseReason
    detail: str = ""


ClientSessionEvent: TypeAlias = NameRegistered | TextMessage | SendToServer | ClosedByServer | OverlongLine


class ClientSession:
    """One connection of the program called `name`.

    Args:
        name: the name to register under.
        token: one word that marks this run of the program, so that it may replace its own dead connection; drawn
            anew at each start, kept over reconnections.

    Attributes:
        hello: registration line, to be sent first.

    Raises:
        ValueError: name or token is not one word.
    """

    def __init__(self, name: str, token: str) -> None:
        if tokens(f"{name} {token}") != [name, token]:
            raise ValueError(f"name and token are one word each, not {name!r} and {token!r}")
        self.hello = encode_line(f"{TextCommand.SETID} {name} {EXTENDED} {token}")
        self._lines = LineSplitter()
        self._registered = False
        self._ended = False
        self._refused = ""

    def receive_data(self, data: bytes) -> list[ClientSessionEvent]:
        """Return the events in bytes from the server; none after `ClosedByServer`."""
        events: list[ClientSessionEvent] = []
        for line in self._lines.feed(data):
            if self._ended:
                break
            events += [line] if isinstance(line, OverlongLine) else self._handle(tokens(line))
        return events

    def _handle(self, parts: list[str]) -> list[ClientSessionEvent]:
        # The server's own lines are recognized whole: a routed line that begins like one always names its parties.
        match parts:
            case [TextCommand.PING]:
                return [SendToServer(_PONG_LINE)]
            case [TextCommand.ACK] if not self._registered:
                self._registered = True
                return [NameRegistered()]
            case [TextCommand.SHUTDOWN]:
                self._ended = True
                stops = self._registered and not self._refused
                reason = ServerCloseReason.STOPPED if stops else ServerCloseReason.REFUSED
                return [ClosedByServer(reason, self._refused)]
            case _:
                message = parse_tokens(parts)
                if not isinstance(message, TextMessage):
                    return []
                if message.sender == SERVER and is_notice(message):
                    told = parse_notice(message)
                    if isinstance(told, Notice) and told.kind == REFUSED:
                        self._refused = str(told.fields.get("reason", ""))
                return [message]
