"""What comes into a session from outside: all that a run depends on beside its study.

Each input is a value. It is taken between two ticks and acts in the one that follows, or, where somebody inside speaks
freely (a person, a simulated participant), in the tick in which it was said. A recording holds every input, before
whatever follows from it; a session that is given the same ones in the same ticks does the same.
"""

import json
from dataclasses import dataclass
from typing import TypeAlias, TypeVar, get_args

import msgspec
import numpy as np

from thbridge.roles.robot_requests import PaceRequest, Request
from thbridge.ros.messages.records import InputRecord
from thbridge.wire.mavlink.dialect import name_of
from thbridge.wire.mavlink.frames.frame import Frame
from thbridge.wire.mavlink.outgoing import LinkId
from thbridge.wire.router import ConnectionId
from thbridge.wire.text import TextMessage


@dataclass(frozen=True, slots=True)
class Opened:
    """A connection was opened at the text server, at `now` seconds of its clock."""

    connection: ConnectionId
    now: float


@dataclass(frozen=True, slots=True)
class Received:
    """Bytes came in at the text server: a line, or part of one. `sender` is what the connection was called then."""

    connection: ConnectionId
    sender: str
    data: bytes
    now: float


@dataclass(frozen=True, slots=True)
class Closed:
    """A connection ended at the text server."""

    connection: ConnectionId
    sender: str


@dataclass(frozen=True, slots=True)
class Backlogged:
    """So many bytes waited for a connection that it was given up."""

    connection: ConnectionId
    sender: str
    size: int


@dataclass(frozen=True, slots=True)
class Advanced:
    """The text server's clock showed `now` seconds, and somebody was pinged or dropped for it."""

    now: float


@dataclass(frozen=True, slots=True)
class Said:
    """The participant inside this process said something."""

    message: TextMessage


@dataclass(frozen=True, slots=True)
class Registered:
    """The server has (again) accepted the name of a program that runs by itself."""


@dataclass(frozen=True, slots=True)
class Heard:
    """The server passed a message on to a program that runs by itself."""

    message: TextMessage


@dataclass(frozen=True, slots=True)
class Asked:
    """Somebody, for example the ROS node of this name, asked something of the robots."""

    sender: str
    request: Request


@dataclass(frozen=True, slots=True)
class LinkOpened:
    """A link to the robots' vehicles was opened.

    Attributes:
        link: its number.
        name: of the link.
        robot: the only one that is to be found there, from 0; None: all are.
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
class Framed:
    """A frame came in on a link, checked and without its signature.

    Attributes:
        link: which.
        sender: the link's name.
        frame: what came.
        robot: the only one that is to hear it; None: whoever it is meant for.
    """

    link: LinkId
    sender: str
    frame: Frame
    robot: int | None = None


@dataclass(frozen=True, slots=True)
class KeptAlive:
    """The session stood, or was slow, while time went on for ground stations; vehicles said that they are there."""


Input: TypeAlias = (
    Opened
    | Received
    | Closed
    | Backlogged
    | Advanced
    | Said
    | Registered
    | Heard
    | Asked
    | LinkOpened
    | LinkClosed
    | Framed
    | KeptAlive
)

T = TypeVar("T")
_KINDS: dict[str, type[Input]] = {kind.__name__.lower(): kind for kind in get_args(Input)}
_REQUESTS: dict[str, type[Request]] = {kind.__name__: kind for kind in get_args(Request)}


def to_record(item: Input) -> InputRecord:
    """The input as it is recorded; nothing of it is lost."""
    kind = type(item).__name__.lower()
    if isinstance(item, Asked):
        line = _readable(f"{type(item.request).__name__} {_json(item.request)}")
        return InputRecord(kind, item.sender, line, encode_request(item.sender, item.request))
    return InputRecord(kind, *_for_people(item), _json(item))


def from_record(record: InputRecord) -> Input:
    """The input that was recorded.

    Raises:
        ValueError: it is none, or one of another release.
    """
    kind = _KINDS.get(record.kind)
    if kind is None:
        raise ValueError(f"no input is of the kind {record.kind!r}")
    value: object = json.loads(record.json)
    return decode_request(value) if kind is Asked else decode_value(value, kind)


def encode_request(sender: str, request: Request | PaceRequest) -> str:
    """A request as JSON, in one line: who asks, its name, its fields."""
    name = type(request).__name__
    return f'{{"sender":{json.dumps(sender)},"request":{json.dumps(name)},"fields":{_json(request)}}}'


def decode_request(value: object) -> Asked:
    """What the JSON of a request asks.

    Raises:
        ValueError: nobody can be asked for that.
    """
    match value:
        case {"sender": str(sender), "request": str(name), "fields": fields} if name in _REQUESTS:
            return Asked(sender, decode_value(fields, _REQUESTS[name]))
    raise ValueError("nobody can be asked for that")


def _for_people(item: Input) -> tuple[str, str]:
    """Who it came from, and what it was."""
    match item:
        case Opened(connection):
            return f"connection {connection}", "a connection is opened"
        case Received(_, sender, data):
            return _readable(sender), data.decode(errors="replace").rstrip("\r\n")
        case Closed(_, sender):
            return _readable(sender), "the connection has ended"
        case Backlogged(_, sender, size):
            return _readable(sender), f"the connection is given up: {size} bytes wait for it"
        case Advanced():
            return "", "somebody has been silent for long"
        case Said(message) | Heard(message):
            return _readable(message.sender), _readable(message.line())
        case Registered():
            return "", "the server has accepted the name"
        case Asked(sender):
            return _readable(sender), ""
        case LinkOpened(_, name):
            return _readable(name), "a link is opened"
        case LinkClosed(_, sender):
            return _readable(sender), "the link has ended"
        case KeptAlive():
            return "", "robots say that they are there"
        case Framed(_, sender, frame):
            return _readable(sender), f"{name_of(frame.message_id)} of {frame.system}/{frame.component}"


def _readable(text: str) -> str:
    """Text that a bag can hold: what UTF-8 cannot (lone surrogates) becomes a question mark."""
    return text.encode(errors="replace").decode()


def _json(value: object) -> str:
    """A dataclass as JSON: floats to their last bit, infinities and NaN by Python's names, bytes in base 64."""
    return json.dumps(msgspec.to_builtins(value, enc_hook=_plain), separators=(",", ":"))


def _plain(value: object) -> object:
    if isinstance(value, np.ndarray):
        rows: object = value.tolist()
        return rows
    raise NotImplementedError(f"no way to record a {type(value).__name__}")


def decode_value(value: object, kind: type[T]) -> T:
    """The dataclass that JSON tells. Raises ValueError."""
    try:
        return msgspec.convert(value, kind, dec_hook=_array)
    except msgspec.ValidationError as error:
        raise ValueError(str(error)) from None


def _array(kind: type, value: object) -> object:
    return np.array(value, dtype=np.float64)
