"""Watch protocol, with which a researcher's window observes a session: both sides, without sockets.

The session sends an endless rosbag of format 2.0: magic, bag header, then chunks, each with an index. The watcher sends
JSON objects, one per line: first the key, if a key is required, then requests.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import TypeAlias

import msgspec

from thbridge.credentials import LOCAL, Credentials, Right
from thbridge.line_splitter import LineSplitter, OverlongLine

STATUS = "/watch/status"
"""Topic of the watch server's own messages: std_msgs/String with a `WatchStatus` as JSON."""

MAGIC = b"#ROSBAG V2.0\n"

MISTAKES = 20
"""The server disconnects a watcher after this number of successive refusals."""

_LARGEST = 64 * 2**20
"""Largest size of a record, in bytes. A costmap of 400 m by 400 m with cells of 5 cm is smaller."""

_SHOWN = 80
"""Maximum number of characters of a refused line that its refusal contains."""

_U32 = struct.Struct("<I")
_TIME = struct.Struct("<II")


@dataclass(frozen=True, slots=True)
class SessionMessage:
    """Message of a session.

    Attributes:
        topic: topic of the message.
        msgtype: type of the message, for example "nav_msgs/Odometry".
        stamp_ns: time of publication, nanoseconds of ROS time.
        data: content, as serialized by ROS 1.
    """

    topic: str
    msgtype: str
    stamp_ns: int
    data: bytes


@dataclass(frozen=True, slots=True)
class BrokenStream:
    """Event: the stream does not come from a session, and cannot be read any further."""

    reason: str


@dataclass(frozen=True, slots=True)
class WatchRefusal:
    """Refusal of a request.

    Attributes:
        request: beginning of the request's line.
        reason: reason in words for people.
    """

    request: str
    reason: str


@dataclass(frozen=True, slots=True)
class WatchStatus:
    """State of the watch server for one watcher, sent once a second and after every change.

    Attributes:
        paused: True if the session is paused until a request to resume or to step.
        rate: requested simulated seconds per second; 0 means as fast as possible.
        lag: seconds by which the session is behind this rate.
        watchers: number of all watchers, including this watcher.
        dropped: number of messages that this watcher did not get because it reads too slowly.
        refused: the latest refused request of this watcher; None if no request was refused.
        refusals: number of refused requests.
        bag: path of the session's bag on the session's machine; empty if the session records no bag.
        ended: True if the session has ended and the bag is complete; then this status is the last status.
        game: address (HOST:PORT) of the text server of the game, at which this watcher may play a seat; empty if the
            watcher may only watch.
    """

    paused: bool
    rate: float
    lag: float
    watchers: int
    dropped: int
    refused: WatchRefusal | None = None
    refusals: int = 0
    bag: str = ""
    ended: bool = False
    game: str = ""

    def data(self) -> bytes:
        """Return the status as a serialized std_msgs/String."""
        text = msgspec.json.encode(self)
        return _U32.pack(len(text)) + text


def parse_status(message: SessionMessage) -> WatchStatus | None:
    """Return the status in a message; None if the message is not a status."""
    if message.topic != STATUS:
        return None
    try:
        return msgspec.json.decode(message.data[_U32.size :], type=WatchStatus)
    except msgspec.DecodeError:
        return None


# The watcher's side


class BagStreamReader:
    """Splitter of a session's bytes into messages; the bytes may come in segments of any size."""

    def __init__(self) -> None:
        self._held = bytearray()
        self._begun = False
        self._broken = False
        self._connections: dict[int, tuple[str, str]] = {}

    def feed(self, data: bytes) -> list[SessionMessage | BrokenStream]:
        """Return the messages that `data` completes; after a `BrokenStream`, return no more messages."""
        if self._broken:
            return []
        self._held += data
        messages: list[SessionMessage | BrokenStream] = []
        try:
            self._begin()
            for header, body in self._records():
                messages += self._record(header, body)
        except (ValueError, LookupError, struct.error) as error:
            self._broken = True
            self._held.clear()
            messages.append(BrokenStream(f"this is not the watch port of a session: {error}"))
        return messages

    def _begin(self) -> None:
        if not self._begun:
            beginning = bytes(self._held[: len(MAGIC)])
            if not MAGIC.startswith(beginning):
                raise ValueError("the data do not begin like a bag of format 2.0")
            if len(beginning) == len(MAGIC):
                self._begun = True
                del self._held[: len(MAGIC)]

    def _records(self) -> Iterator[tuple[bytes, bytes]]:
        """Yield the complete records, and finally remove these records from the buffer."""
        at = 0
        try:
            while self._begun and (sizes := _sizes(self._held, at)) is not None:
                header, body = sizes
                start = at + 8 + header
                record = bytes(self._held[at + 4 : at + 4 + header]), bytes(self._held[start : start + body])
                at = start + body
                yield record
        finally:
            del self._held[:at]

    def _record(self, header: bytes, body: bytes) -> Iterator[SessionMessage]:
        fields = _fields(header)
        match fields[b"op"][0]:
            case 0x05:  # a chunk
                if fields[b"compression"] != b"none":
                    raise ValueError("a chunk is compressed")
                at = 0
                while at < len(body):
                    sizes = _sizes(body, at)
                    if sizes is None:
                        raise ValueError("a chunk is incomplete")
                    inner, size = sizes
                    start = at + 8 + inner
                    yield from self._record(body[at + 4 : at + 4 + inner], body[start : start + size])
                    at = start + size
            case 0x07:  # a connection
                (number,) = _U32.unpack(fields[b"conn"])
                self._connections[number] = fields[b"topic"].decode(), _fields(body)[b"type"].decode()
            case 0x02:  # a message
                (number,) = _U32.unpack(fields[b"conn"])
                seconds, nanoseconds = _TIME.unpack(fields[b"time"])
                topic, msgtype = self._connections[number]
                yield SessionMessage(topic, msgtype, seconds * 1_000_000_000 + nanoseconds, body)
            case 0x03 | 0x04:  # the bag's header, and an index
                pass
            case kind:
                raise ValueError(f"a record has the unknown kind {kind}")


def _sizes(data: bytes | bytearray, at: int) -> tuple[int, int] | None:
    """Return the lengths of header and body of the record at `at`; None while the record is incomplete.

    Raises:
        ValueError: the record is too long.
    """
    if len(data) < at + 4:
        return None
    (header,) = _U32.unpack_from(data, at)
    if header > _LARGEST:
        raise ValueError("the header of a record is too long")
    if len(data) < at + 8 + header:
        return None
    (body,) = _U32.unpack_from(data, at + 4 + header)
    if body > _LARGEST:
        raise ValueError("a record is too long")
    return (header, body) if len(data) >= at + 8 + header + body else None


def _fields(header: bytes) -> dict[bytes, bytes]:
    fields: dict[bytes, bytes] = {}
    at = 0
    while at < len(header):
        (size,) = _U32.unpack_from(header, at)
        name, equals, value = header[at + 4 : at + 4 + size].partition(b"=")
        if not equals or at + 4 + size > len(header):
            raise ValueError("a record is invalid")
        fields[name] = value
        at += 4 + size
    return fields


# The session's side


@dataclass(frozen=True, slots=True)
class WatcherAdmitted:
    """The watcher may receive messages and make requests."""


@dataclass(frozen=True, slots=True)
class WatcherRequest:
    """Request of a watcher.

    Attributes:
        line: the received line.
        value: the JSON object in the line.
    """

    line: str
    value: Mapping[str, object]


WatcherEvent: TypeAlias = WatcherAdmitted | WatcherRequest | WatchRefusal


class WatcherSession:
    """Decoder of one watcher's lines, which also checks the watcher's key.

    Args:
        identify: function that returns the credentials of a key, or a clause with the reason why the key is refused. If
            None, no key is needed.

    Attributes:
        credentials: credentials of the watcher; valid only after the watcher is admitted.
        admitted: True if the watcher may receive messages and make requests.
        rejected: True if the watcher must be disconnected, for one of three reasons: the key is wrong, the first line
            belongs to another protocol (for example of a browser), or too many successive requests were refused.
    """

    def __init__(self, identify: Callable[[str], Credentials | str] | None = None) -> None:
        self.admitted = identify is None
        self.rejected = False
        self.credentials = LOCAL
        self._identify = identify
        self._lines = LineSplitter()
        self._understood = False
        self._mistakes = 0

    def feed(self, data: bytes) -> Iterator[WatcherEvent]:
        """Yield the events of the lines that `data` completes.

        After each request, call `granted` or `refused` before the next event.
        """
        for line in self._lines.feed(data):
            if self.rejected:
                return
            yield from self._read(line)

    def granted(self) -> None:
        """Record that the watcher's latest request was granted."""
        self._mistakes = 0

    def refused(self) -> None:
        """Record that the watcher's latest request was refused."""
        self._mistakes += 1
        self.rejected = self.rejected or self._mistakes >= MISTAKES

    def _read(self, line: str | OverlongLine) -> Iterator[WatcherEvent]:
        if isinstance(line, OverlongLine):
            yield self._misunderstood("", "the line is too long")
            return
        value = _object(line)
        if value is None:
            yield self._misunderstood(line, "the line is not a JSON object")
            return
        self._understood = True
        if self._identify is not None and not self.admitted:
            key = value.get("key")
            found = self._identify(key) if isinstance(key, str) else "the key is wrong"
            if isinstance(found, Credentials) and not found.may(Right.WATCH):
                found = f"the key {found} does not allow watching"
            self.admitted, self.rejected = not isinstance(found, str), isinstance(found, str)
            if isinstance(found, str):
                yield WatchRefusal("", found if "key" in value else "a key is required")
            else:
                self.credentials = found
                yield WatcherAdmitted()
        elif set(value) != {"key"}:  # A key that is not needed is ignored.
            yield WatcherRequest(line, value)

    def _misunderstood(self, line: str, reason: str) -> WatchRefusal:
        # Watchers never send a first line like this. It may come from a browser with a malicious web page.
        self.rejected = self.rejected or not self._understood
        self.refused()
        return refusal(line, reason)


def refusal(line: str, reason: str) -> WatchRefusal:
    """Return the refusal of a line, with the beginning of the line."""
    return WatchRefusal(line[:_SHOWN], reason)


def _object(line: str) -> dict[str, object] | None:
    # Python's own parser is not used, because it accepts NaN, infinity, and numbers that are too large for a float.
    try:
        value: object = msgspec.json.decode(line.encode())
    except (msgspec.DecodeError, RecursionError, UnicodeEncodeError):
        return None
    return {str(name): item for name, item in value.items()} if isinstance(value, dict) else None
