"""Inputs of a session from outside: all that a run depends on beside its study.

Each input is a value. It is taken between two ticks and acts in the one that follows; a message of the participant in
this process (a person, a bot) acts in the tick in which it was sent. A recording holds every input, before its effects;
a session that is given the same ones in the same ticks does the same.
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
    """A connection was closed because so many bytes waited for it."""

    connection: ConnectionId
    sender: str
    size: int


@dataclass(frozen=True, slots=True)
class ClockAdvanced:
    """The text server's clock advanced to `now` seconds, and a connection was pinged or dropped for it."""

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
        name: of the link.
        robot: the only robot on the link, from 0; None: all robots.
    """

    link: LinkId
    name: str
    robot: int | None = None


@dataclass(frozen=True, slots=True)
class LinkClosed:
    """A link of this name ended."""

    link: LinkId
    sender: str


@dataclass(frozen=True, slots=True)
class FrameReceived:
    """A frame came in on a link, checked and without its signature.

    Attributes:
        link: its number.
        sender: name of the link.
        frame: the frame.
        robot: the only robot that gets it, from 0; None: its addressees.
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
    """Inputs that wait for the next tick."""

    def __init__(self) -> None:
        self._inputs: list[Input] = []

    def add(self, item: Input) -> None:
        """Add an input."""
        self._inputs.append(item)

    def take(self) -> list[Input]:
        """Return the inputs since the last call, in order."""
        taken, self._inputs = self._inputs, []
        return taken
