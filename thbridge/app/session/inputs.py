"""Inputs of a session from outside. Only the study and the inputs determine a run.

Each input is a value. It arrives between two ticks and takes effect in the next tick. There is one exception: a message
of the participant in this process (a person or a bot) takes effect in the tick in which it was sent. A recording
contains every input, before the effects of the input. Sessions with the same inputs in the same ticks are identical.
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
    """Input: a connection was opened at the text server, at `now` seconds of the server's clock, with credentials."""

    connection: ConnectionId
    now: float
    credentials: Credentials = LOCAL


@dataclass(frozen=True, slots=True)
class BytesReceived:
    """Input: the text server received a line, or part of a line. `sender` is the connection's name at that time."""

    connection: ConnectionId
    sender: str
    data: bytes
    now: float


@dataclass(frozen=True, slots=True)
class ConnectionClosed:
    """Input: a connection of the text server ended."""

    connection: ConnectionId
    sender: str


@dataclass(frozen=True, slots=True)
class ConnectionBacklogged:
    """Input: a connection was closed, because its client did not read, and `size` bytes were queued for this client."""

    connection: ConnectionId
    sender: str
    size: int


@dataclass(frozen=True, slots=True)
class ClockAdvanced:
    """Input: the text server's clock advanced to `now` seconds, so that a connection was pinged or dropped."""

    now: float


@dataclass(frozen=True, slots=True)
class ParticipantSent:
    """Input: the participant in this process sent a message."""

    message: TextMessage


@dataclass(frozen=True, slots=True)
class NameAccepted:
    """Input: the server of another process accepted this program's name, for the first time or again."""


@dataclass(frozen=True, slots=True)
class MessageForwarded:
    """Input: the server of another process forwarded a message to this program."""

    message: TextMessage


@dataclass(frozen=True, slots=True)
class ClientRequest:
    """Input: a client, for example the ROS node with the name `sender`, sent a request."""

    sender: str
    request: Request


@dataclass(frozen=True, slots=True)
class LinkOpened:
    """Input: a link to the robots' vehicles was opened.

    Attributes:
        link: number of the link.
        name: name of the link.
        robot: index of the only robot on the link, from 0. If None, the link is for all robots.
    """

    link: LinkId
    name: str
    robot: int | None = None


@dataclass(frozen=True, slots=True)
class LinkClosed:
    """Input: a link ended; `sender` is the name of the link."""

    link: LinkId
    sender: str


@dataclass(frozen=True, slots=True)
class FrameReceived:
    """Input: a frame was received on a link.

    Attributes:
        link: number of the link.
        sender: name of the link.
        frame: the frame, checked and without signature.
        robot: index of the only robot that receives the frame, from 0. If None, all robots that the frame addresses
            receive it.
    """

    link: LinkId
    sender: str
    frame: Frame
    robot: int | None = None


@dataclass(frozen=True, slots=True)
class HeartbeatsSent:
    """Input: vehicles sent heartbeats to ground stations in real time, because the session was paused or slow."""


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

    @property
    def is_empty(self) -> bool:
        """True if the next tick has no inputs so far."""
        return not self._inputs

    def take(self) -> list[Input]:
        """Return the inputs since the last call, in order."""
        taken, self._inputs = self._inputs, []
        return taken
