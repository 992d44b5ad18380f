"""TCPROS encoding: frames, and the headers at the beginning of every connection.

All data are frames. A frame is a length of 32 bits (little endian), and this number of bytes. The first frame of each
side is its header. A header consists of ``name=value`` fields, which are small frames. Later frames are messages,
requests or responses.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

HEADER_LIMIT = 1 << 18
"""Maximum size of a header, bytes. One of its fields is the complete definition of a message."""

BODY_LIMIT = 1 << 26
"""Maximum size of a message or response, bytes. This is enough for a map of 8000 x 8000 cells."""

REQUEST_LIMIT = 1 << 18
"""Maximum size of a request to one of our services, bytes."""

ANY = "*"
"""Type or md5 sum that matches any type or md5 sum."""

HeaderFields: TypeAlias = dict[str, str]

_LENGTH = struct.Struct("<I")

LENGTH_BYTES = _LENGTH.size
"""Size in bytes of the field with the length of a frame's body."""


@dataclass(frozen=True, slots=True)
class MalformedHeader:
    """Bytes that are not a header.

    Attributes:
        reason: reason, as a clause.
    """

    reason: str


@dataclass(frozen=True, slots=True)
class OverlongFrame:
    """Frame that is longer than the limit.

    Attributes:
        length: length of the frame, bytes.
        limit: the limit, bytes.
    """

    length: int
    limit: int

    def __str__(self) -> str:
        return f"a frame of {self.length} bytes, above the limit of {self.limit}"


def frame(body: bytes) -> bytes:
    """Return a frame: the length of the body, then the body."""
    return _LENGTH.pack(len(body)) + body


def encode_header(fields: Mapping[str, str]) -> bytes:
    """Encode a header with its own length. Its fields are sorted by name, as in ROS's tools."""
    return frame(b"".join(frame(f"{name}={value}".encode()) for name, value in sorted(fields.items())))


def decode_header(body: bytes) -> HeaderFields | MalformedHeader:
    """Decode the fields of a header. The argument does not contain the header's own length.

    If a field occurs twice, the last one counts, as in ROS. Bytes that are not UTF-8 become U+FFFD, because some
    message definitions contain Latin-1 in comments.
    """
    fields: HeaderFields = {}
    at = 0
    while at < len(body):
        if len(body) - at < LENGTH_BYTES:
            return MalformedHeader("the header ends inside a field's length")
        (length,) = _LENGTH.unpack_from(body, at)
        at += LENGTH_BYTES
        if length > len(body) - at:
            return MalformedHeader("a field is longer than the rest of the header")
        # Only the first equal sign separates. Message definitions contain further ones, in their constants.
        name, equals, value = body[at : at + length].partition(b"=")
        if not equals:
            return MalformedHeader("a field has no '='")
        fields[name.decode(errors="replace").strip()] = value.decode(errors="replace")
        at += length
    return fields


class FrameBuffer:
    """Splitter of a byte stream into frames. The stream may be cut into segments of any size.

    If the caller takes all complete frames after each `feed`, the buffer stores at most one frame within the limit of
    the next `take`, and the segment that exceeded this limit.
    """

    def __init__(self) -> None:
        self._held = bytearray()

    def __len__(self) -> int:
        return len(self._held)

    def feed(self, data: bytes) -> None:
        """Append received bytes."""
        self._held += data

    def take(self, limit: int) -> bytes | OverlongFrame | None:
        """Take the body of the next frame. Return None while it is incomplete.

        After an `OverlongFrame`, the stream cannot be used.
        """
        if len(self._held) < LENGTH_BYTES:
            return None
        (length,) = _LENGTH.unpack_from(self._held)
        # The length is checked before the body arrives, so that a peer cannot fill the memory.
        if length > limit:
            self._held.clear()
            return OverlongFrame(length, limit)
        end = LENGTH_BYTES + length
        if len(self._held) < end:
            return None
        # A slice of the bytearray itself would copy the body twice.
        body = bytes(memoryview(self._held)[LENGTH_BYTES:end])
        del self._held[:end]
        return body
