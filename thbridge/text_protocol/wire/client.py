"""Client's part of the text protocol for our own programs, without the socket.

A `ClientSession` is for one connection. Send its `hello`, pass the received bytes to `receive_data`, and carry out the
events. The session registers as an extended client, answers pings, and handles the server's own lines itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto
from typing import TypeAlias

from thbridge.line_splitter import LineSplitter, OverlongLine
from thbridge.text_protocol.wire.lines import EXTENDED, TextCommand, TextMessage, encode_line, parse_tokens, tokens
from thbridge.text_protocol.wire.notice_format import REFUSED, SERVER, Notice, is_notice, parse_notice

_PONG_LINE = encode_line(f"{TextCommand.PONG} ")


@dataclass(frozen=True, slots=True)
class NameRegistered:
    """Event: the server has accepted our name. Now the program must introduce itself to the other programs."""


@dataclass(frozen=True, slots=True)
class SendToServer:
    """Bytes to be written to the server."""

    data: bytes


class ServerCloseReason(Enum):
    """Reason why the server ends the connection."""

    REFUSED = auto()
    """Another program has our name, or the server is full."""
    STOPPED = auto()


@dataclass(frozen=True, slots=True)
class ClosedByServer:
    """Event: the server has announced the end of this connection. No more messages follow.

    Attributes:
        reason: kind of reason.
        detail: the server's explanation, as a clause. Empty if there is none.
    """

    reason: ServerCloseReason
    detail: str = ""


ClientSessionEvent: TypeAlias = NameRegistered | TextMessage | SendToServer | ClosedByServer | OverlongLine


class ClientSession:
    """One connection of the program `name`.

    Args:
        name: name to register.
        token: one random word for this run of the program, the same at each reconnection. With this word, the program
            may replace its own dead connection.

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
        """Return the events in bytes from the server. After `ClosedByServer` there are no more events."""
        events: list[ClientSessionEvent] = []
        for line in self._lines.feed(data):
            if self._ended:
                break
            events += [line] if isinstance(line, OverlongLine) else self._handle(tokens(line))
        return events

    def _handle(self, parts: list[str]) -> list[ClientSessionEvent]:
        # A server's own line has exactly one word. Routed lines may begin with the same word, but are longer.
        match parts:
            case [TextCommand.PING]:
                return [SendToServer(_PONG_LINE)]
            # The first ack answers the registration. Further acks need no reaction.
            case [TextCommand.ACK] if not self._registered:
                self._registered = True
                return [NameRegistered()]
            case [TextCommand.SHUTDOWN]:
                self._ended = True
                # Before the registration, this line means that the server rejects the client.
                stops = self._registered and not self._refused
                reason = ServerCloseReason.STOPPED if stops else ServerCloseReason.REFUSED
                return [ClosedByServer(reason, self._refused)]
            case _:
                message = parse_tokens(parts)
                if not isinstance(message, TextMessage):
                    return []
                if message.sender == SERVER and is_notice(message):
                    received = parse_notice(message)
                    if isinstance(received, Notice) and received.kind == REFUSED:
                        self._refused = str(received.fields.get("reason", ""))
                return [message]
