"""Inputs of a session from outside: all that a run depends on in addition to its study.

Each input is a value. It arrives between two ticks and acts in the next one. Only a message of the participant in this
process (a person or a bot) acts in the tick in which it was sent. A recording contains every input, before its effects.
A session with the same inputs in the same ticks behaves identically.
"""

from dataclasses import dataclass
from typing import TypeAlias

from thbridge.credentials import LOCAL, Credentials
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.outgoing import LinkId
from thbridge.roles.shared.robot_requests import Request
from thbridge.text_protocol.wire.lines import TextMessage
from thbridge.text_protocol.wire.router import ConnectionId


@dataclass(frozen=True, slots=True)
class ConnectionOpened:
    """A connection was opened at the text server, at `now` seconds of its clock, with credentials."""

    connection: ConnectionId
    now: float
    credentials: Credentials = LOCAL


@dataclass(frozen=True, slots=True)
class BytesReceived:
    """Bytes came in at the text server: a line, or part of one. `sender` is the connection's name at that time."""

    connection: ConnectionId
    sender: str
    data: bytes
    now: float


@dataclass(frozen=True, slots=True)
class ConnectionClosed:
    """A connection ended at the text server."""

    connection: ConnectionId
    sender: str


@dataclass(frozen=True, slots=True)
class ConnectionBacklogged:
    """A connection was closed because its client did not read: `size` bytes were queued for it."""

    connection: ConnectionId
    sender: str
    size: int


@dataclass(frozen=True, slots=True)
class ClockAdvanced:
    """The text server's clock advanced to `now` seconds, and therefore a connection was pinged or dropped."""

    now: float


@dataclass(frozen=True, slots=True)
class ParticipantSent:
    """The participant inside this process sent a message."""

    message: TextMessage


@dataclass(frozen=True, slots=True)
class NameAccepted:
    """The server of another process has (again) accepted this program's name."""


@dataclass(frozen=True, slots=True)
class MessageForwarded:
    """The server of another process forwarded a message to this program."""

    message: TextMessage


@dataclass(frozen=True, slots=True)
class ClientRequest:
    """A client, for example the ROS node of this name, sent a request."""

    sender: str
    request: Request


@dataclass(frozen=True, slots=True)
class LinkOpened:
    """A link to the robots' vehicles was opened.

    Attributes:
        link: its number.
        name: name of the link.
        robot: index of the only robot on the link, from 0; None for all robots.
    """

    link: LinkId
    name: str
    robot: int | None = None


@dataclass(frozen=True, slots=True)
class LinkClosed:
    """A link ended; `sender` is its name."""

    link: LinkId
    sender: str


@dataclass(frozen=True, slots=True)
class FrameReceived:
    """A frame was received on a link, checked and without its signature.

    Attributes:
        link: its number.
        sender: name of the link.
        frame: the frame.
        robot: index of the only robot that receives it, from 0; None for the robots that it addresses.
    """

    link: LinkId
    sender: str
    frame: Frame
    robot: int | None = None


@dataclass(frozen=True, slots=True)
class HeartbeatsSent:
    """The session was paused or slow, and vehicles sent heartbeats to ground stations in real time."""


Input: TypeAlias = (
    ConnectionOpened
    | BytesReceived
    | ConnectionClosed
    | ConnectionBacklogged
    | ClockAdvanced
    | ParticipantSent
    | NameAccepted
    | MessageForwarded
    | ClientRequest
    | LinkOpened
    | LinkClosed
    | FrameReceived
    | HeartbeatsSent
)


class InputQueue:
    """Queue of the inputs of the next tick."""

    def __init__(self) -> None:
        self._inputs: list[Input] = []

    def add(self, item: Input) -> None:
        """Add an input."""
        self._inputs.append(item)

    def take(self) -> list[Input]:
        """Return the inputs since the last call, in order."""
        taken, self._inputs = self._inputs, []
        return taken
