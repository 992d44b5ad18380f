"""TCPROS on the wire: frames, and the header that opens every connection.

Everything is a frame, a length of 32 bits (little endian) and that many bytes. The first frame of either side is its
header, ``name=value`` fields which are small frames themselves; those after it are messages, requests or responses.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

HEADER_LIMIT = 1 << 18
"""Longest header that is read, bytes. A message's whole definition is one of its fields."""

BODY_LIMIT = 1 << 26
"""Longest message or response that is read, bytes: a map of 8000 x 8000 cells."""

REQUEST_LIMIT = 1 << 18
"""Longest request to one of our services that is read, bytes."""

ANY = "*"
"""The type or md5 sum of whoever takes everything."""

HeaderFields: TypeAlias = dict[str, str]

_LENGTH = struct.Struct("<I")

LENGTH_BYTES = _LENGTH.size
"""What a frame has beside its body."""


@dataclass(frozen=True, slots=True)
class MalformedHeader:
    """Bytes that are no header.

    Attributes:
        reason: what is wrong with them, as a clause.
    """

    reason: str


@dataclass(frozen=True, slots=True)
class OverlongFrame:
    """A frame longer than the reader takes.

    Attributes:
        length: what it says of itself, bytes.
        limit: what is taken, bytes.
    """

    length: int
    limit: int

    def __str__(self) -> str:
        return f"a frame of {self.length} bytes, where {self.limit} is the limit"


def frame(body: bytes) -> bytes:
    """A body with its length before it."""
    return _LENGTH.pack(len(body)) + body


def encode_header(fields: Mapping[str, str]) -> bytes:
    """A header, its own length included; the fields in the order of their names, as ROS's tools write them."""
    return frame(b"".join(frame(f"{name}={value}".encode()) for name, value in sorted(fields.items())))


def decode_header(body: bytes) -> HeaderFields | MalformedHeader:
    """The fields of a header, given without its own length.

    Of a field that is there twice the last counts, as for ROS. Text that is not UTF-8 (some message definitions have
    Latin-1 in a comment) loses those characters to U+FFFD.
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
    """Takes a byte stream apart into frames, however it is cut into segments.

    It holds no more than one frame within the limit of the next `take`, and the segment that went beyond it, provided
    that whoever feeds it takes what is complete.
    """

    def __init__(self) -> None:
        self._held = bytearray()

    def __len__(self) -> int:
        return len(self._held)

    def feed(self, data: bytes) -> None:
        """Add bytes as they came."""
        self._held += data

    def take(self, limit: int) -> bytes | OverlongFrame | None:
        """The next frame's body, None while it is incomplete. After `Overlong` the stream is of no more use."""
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

    def take_byte(self) -> int | None:
        """The next single byte, None when there is none."""
        return self._held.pop(0) if self._held else None
