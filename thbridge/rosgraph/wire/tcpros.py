"""TCPROS encoding: frames, and the header at the beginning of every connection.

Everything is a frame: a length of 32 bits (little endian) and that number of bytes. The first frame of each side is its
header. Its ``name=value`` fields are small frames themselves. Later frames are messages, requests or responses.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

HEADER_LIMIT = 1 << 18
"""Largest header that is read, in bytes. One of its fields is the whole definition of a message."""

BODY_LIMIT = 1 << 26
"""Largest message or response that is read, in bytes: a map of 8000 x 8000 cells."""

REQUEST_LIMIT = 1 << 18
"""Largest request to one of our services that is read, in bytes."""

ANY = "*"
"""Type or md5 sum that matches any other."""

HeaderFields: TypeAlias = dict[str, str]

_LENGTH = struct.Struct("<I")

LENGTH_BYTES = _LENGTH.size
"""Size of a frame's length field, which precedes its body, in bytes."""


@dataclass(frozen=True, slots=True)
class MalformedHeader:
    """Bytes that are not a header.

    Attributes:
        reason: the problem, as a clause.
    """

    reason: str


@dataclass(frozen=True, slots=True)
class OverlongFrame:
    """Frame longer than the limit.

    Attributes:
        length: its length, bytes.
        limit: the limit, bytes.
    """

    length: int
    limit: int

    def __str__(self) -> str:
        return f"a frame of {self.length} bytes, where {self.limit} is the limit"


def frame(body: bytes) -> bytes:
    """Return a body with its length before it."""
    return _LENGTH.pack(len(body)) + body


def encode_header(fields: Mapping[str, str]) -> bytes:
    """Encode a header with its own length; fields are sorted by name, as in ROS's tools."""
    return frame(b"".join(frame(f"{name}={value}".encode()) for name, value in sorted(fields.items())))


def decode_header(body: bytes) -> HeaderFields | MalformedHeader:
    """Decode the fields of a header, given without its own length.

    If a field occurs twice, the last one counts, as in ROS. Characters that are not UTF-8 (some message definitions
    have Latin-1 in a comment) become U+FFFD.
    """
    fields: HeaderFields = {}
    at = 0
    while at < len(body):
        if len(body) - at < LENGTH_BYTES:
            return MalformedHeader("the header ends inside a field's length")
        (length,) = _LENGTH.unpack_from(body, at)
        at += LENGTH_BYTES
        if length > len(body) - at:
            return MalformedHeader("a field is longer than what is left of the header")
        name, equals, value = body[at : at + length].partition(b"=")
        if not equals:
            return MalformedHeader("a field has no '='")
        fields[name.decode(errors="replace").strip()] = value.decode(errors="replace")
        at += length
    return fields


class FrameBuffer:
    """Splitter of a byte stream into frames; the stream may be cut into segments of any size.

    If the caller takes all complete frames after each `feed`, it stores at most one frame within the limit of the next
    `take`, and the segment that exceeded it.
    """

    def __init__(self) -> None:
        self._held = bytearray()

    def __len__(self) -> int:
        return len(self._held)

    def feed(self, data: bytes) -> None:
        """Append received bytes."""
        self._held += data

    def take(self, limit: int) -> bytes | OverlongFrame | None:
        """Take the next frame's body; None while it is incomplete. After `OverlongFrame`, the stream is unusable."""
        if len(self._held) < LENGTH_BYTES:
            return None
        (length,) = _LENGTH.unpack_from(self._held)
        if length > limit:
            self._held.clear()
            return OverlongFrame(length, limit)
        end = LENGTH_BYTES + length
        if len(self._held) < end:
            return None
        body = bytes(memoryview(self._held)[LENGTH_BYTES:end])
        del self._held[:end]
        return body
