"""Datagrams of RTPS: a header, and submessages. We write little endian, and read both byte orders.

Source: DDSI-RTPS 2.3, sections 8.3 and 9.4.
"""

import struct
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from thbridge.ros2graph.wire.rtps.guids import PREFIX_SIZE, UNKNOWN, UNKNOWN_PREFIX, Guid
from thbridge.ros2graph.wire.rtps.parameters import Parameter, decode_list

VENDOR = b"\x00\x00"
"""Vendor id of our datagrams: unknown. OMG assigns others."""
CYCLONE_VENDOR = b"\x01\x10"
EPROSIMA_VENDOR = b"\x01\x0f"
VERSION = b"\x02\x03"
PREFIX_AT, HEADER_SIZE = 8, 20
"""Offset of the participant's prefix in a datagram, and of the first submessage."""

READER_AT = 20
"""Offset of the reader's id in the bytes of `encode_data` and `encode_fragment`."""
MOST_BITS = 256
"""Maximum number of sequence numbers in a set."""
_LARGEST = 1 << 62
"""Sequence numbers above it are refused, so that sums of them stay sequence numbers."""

_ACKNACK, _HEARTBEAT, _GAP, _INFO_TS, _INFO_SRC, _INFO_DST = 0x06, 0x07, 0x08, 0x09, 0x0C, 0x0E
_NACK_FRAG, _HEARTBEAT_FRAG, _DATA, _DATA_FRAG = 0x12, 0x13, 0x15, 0x16

_DATA_HEAD = struct.Struct("<BBHII BBHHH4s4siI")
_FRAGMENT_HEAD = struct.Struct("<BBHII BBHHH4s4siIIHHI")
_HEARTBEAT_BYTES = struct.Struct("<BBH4s4siIiII")


@dataclass(frozen=True, slots=True)
class Data:
    """Sample of a writer.

    Attributes:
        writer: GUID of the writer.
        reader: id of the reader; `UNKNOWN` for all.
        sequence: sequence number, from 1.
        payload: message with its CDR header, or the key of a disposed sample.
        inline: inline quality of service.
    """

    writer: Guid
    reader: bytes
    sequence: int
    payload: bytes
    inline: Sequence[Parameter]


@dataclass(frozen=True, slots=True)
class DataFragment:
    """Fragment of a sample. See `Data`.

    Attributes:
        first: number of the first fragment in `payload`, from 1.
        count: number of fragments in `payload`.
        fragment_size: bytes of each fragment except the last.
        size: bytes of the whole sample.
    """

    writer: Guid
    reader: bytes
    sequence: int
    payload: bytes
    inline: Sequence[Parameter]
    first: int
    count: int
    fragment_size: int
    size: int


@dataclass(frozen=True, slots=True)
class Heartbeat:
    """Announcement of the samples that a writer keeps: `first` to `last`. If `final`, no acknowledgment is needed."""

    writer: Guid
    reader: bytes
    first: int
    last: int
    count: int
    final: bool


@dataclass(frozen=True, slots=True)
class HeartbeatFragment:
    """Announcement of the fragments of a sample that were sent."""

    writer: Guid
    reader: bytes
    sequence: int
    last: int


@dataclass(frozen=True, slots=True)
class Acknowledgment:
    """Acknowledgment of all samples before `base`, and request of samples (ACKNACK)."""

    reader: Guid
    writer: bytes
    base: int
    missing: Sequence[int]
    count: int
    final: bool

    @property
    def requests_heartbeat(self) -> bool:
        """True if it comes from a reader that had no heartbeat yet. It acknowledges nothing."""
        return self.base <= 1 and not self.missing and not self.final


@dataclass(frozen=True, slots=True)
class FragmentRequest:
    """Request of fragments of a sample (NACK_FRAG)."""

    reader: Guid
    writer: bytes
    sequence: int
    missing: Sequence[int]
    count: int


@dataclass(frozen=True, slots=True)
class SampleGap:
    """Samples that will not come: `first` to `base` - 1, and `others`."""

    writer: Guid
    reader: bytes
    first: int
    base: int
    others: Sequence[int]


Submessage: TypeAlias = (
    Data | DataFragment | Heartbeat | HeartbeatFragment | Acknowledgment | FragmentRequest | SampleGap
)


def encode_header(prefix: bytes) -> bytes:
    """Return the header of our datagrams."""
    return b"RTPS" + VERSION + VENDOR + prefix


def encode_destination(prefix: bytes) -> bytes:
    """Return a submessage that directs the following ones to a participant."""
    return struct.pack("<BBH", _INFO_DST, 1, PREFIX_SIZE) + prefix


def encode_data(
    writer: bytes, sequence: int, payload: bytes, stamp_ns: int, inline: bytes = b"", *, key: bool = False
) -> bytes:
    """Return a sample for all readers, with its timestamp.

    Args:
        writer: id of the writer.
        sequence: sequence number.
        payload: message with its CDR header; the key if the sample is disposed.
        stamp_ns: time of the message, nanoseconds since 1970.
        inline: inline quality of service, empty for none.
        key: whether the payload is only the key.
    """
    padding = bytes(-len(payload) % 4)
    head = _DATA_HEAD.pack(
        *(_INFO_TS, 1, 8, *_ntp(stamp_ns)),
        *(_DATA, 1 | (2 if inline else 0) | (8 if key else 4), 20 + len(inline) + len(payload) + len(padding)),
        *(0, 16, UNKNOWN, writer, sequence >> 32, sequence & 0xFFFFFFFF),
    )
    return b"".join((head, inline, payload, padding))


def encode_fragments(
    writer: bytes, sequence: int, payload: bytes, stamp_ns: int, size: int, inline: bytes = b""
) -> list[bytes]:
    """Return the fragments of a large sample, each as a submessage for all readers. `size` is that of a fragment."""
    fragments = []
    for at in range(0, len(payload), size):
        piece = payload[at : at + size]
        # Each fragment has the inline quality of service: Fast DDS reads that of the fragment that arrives first.
        padding = bytes(-len(piece) % 4)
        head = _FRAGMENT_HEAD.pack(
            *(_INFO_TS, 1, 8, *_ntp(stamp_ns)),
            *(_DATA_FRAG, 1 | (2 if inline else 0), 32 + len(inline) + len(piece) + len(padding)),
            *(0, 28, UNKNOWN, writer, sequence >> 32, sequence & 0xFFFFFFFF),
            *(at // size + 1, 1, size, len(payload)),
        )
        fragments.append(b"".join((head, inline, piece, padding)))
    return fragments


def encode_heartbeat(reader: bytes, writer: bytes, first: int, last: int, count: int, *, final: bool) -> bytes:
    """Return the announcement of the kept samples."""
    return _HEARTBEAT_BYTES.pack(
        *(_HEARTBEAT, 3 if final else 1, 28, reader, writer),
        *(first >> 32, first & 0xFFFFFFFF, last >> 32, last & 0xFFFFFFFF, count & 0x7FFFFFFF),
    )


def encode_acknowledgment(
    reader: bytes, writer: bytes, base: int, missing: Sequence[int], count: int, *, final: bool
) -> bytes:
    """Return the acknowledgment of all samples before `base`, and the request of the missing ones."""
    body = reader + writer + _long(base) + _bits(base, missing) + struct.pack("<i", count & 0x7FFFFFFF)
    return struct.pack("<BBH", _ACKNACK, 3 if final else 1, len(body)) + body


def encode_fragment_request(reader: bytes, writer: bytes, sequence: int, missing: Sequence[int], count: int) -> bytes:
    """Return the request of fragments of a sample. `missing` is sorted and not empty."""
    base = missing[0]
    body = reader + writer + _long(sequence) + struct.pack("<I", base) + _bits(base, missing)
    body += struct.pack("<i", count & 0x7FFFFFFF)
    return struct.pack("<BBH", _NACK_FRAG, 1, len(body)) + body


def encode_gap(reader: bytes, writer: bytes, gone: Sequence[int]) -> bytes:
    """Return the statement that samples will not come. `gone` is sorted, not empty, and spans at most 256 numbers."""
    first = gone[0]
    body = reader + writer + _long(first) + _long(first + 1) + _bits(first + 1, gone[1:])
    return struct.pack("<BBH", _GAP, 1, len(body)) + body


def decode_datagram(datagram: bytes, own_prefix: bytes) -> tuple[bytes, bytes, Iterator[Submessage]]:
    """Return the vendor of a datagram, the prefix of its participant, and the submessages for us.

    Args:
        datagram: received bytes.
        own_prefix: our prefix.

    Raises:
        ValueError: these are no bytes of RTPS 2. The iterator raises it also, at an invalid submessage.
    """
    if len(datagram) < HEADER_SIZE or datagram[:4] != b"RTPS" or datagram[4] != 2:
        raise ValueError("the datagram has no header of RTPS 2")
    prefix = datagram[PREFIX_AT:HEADER_SIZE]
    return datagram[6:8], prefix, _submessages(datagram, prefix, own_prefix)


def _submessages(datagram: bytes, prefix: bytes, own_prefix: bytes) -> Iterator[Submessage]:
    at, end, for_us = HEADER_SIZE, len(datagram), True
    while at + 4 <= end:
        kind, flags = datagram[at], datagram[at + 1]
        order = "<" if flags & 1 else ">"
        size = int.from_bytes(datagram[at + 2 : at + 4], "little" if flags & 1 else "big")
        at += 4
        # Size 0 stands for "up to the end of the datagram", except for timestamps without time and padding.
        if at + size > end:
            raise ValueError("a submessage is longer than its datagram")
        if size == 0 and kind in _DECODERS:
            size = end - at
        if kind == _INFO_DST:
            wanted = datagram[at : at + PREFIX_SIZE]
            for_us = wanted in {own_prefix, UNKNOWN_PREFIX}
        elif kind == _INFO_SRC:
            prefix = datagram[at + 8 : at + 8 + PREFIX_SIZE]
            if len(prefix) < PREFIX_SIZE:
                raise ValueError("a source is too short")
        elif for_us and kind in _DECODERS:
            try:
                yield _DECODERS[kind](datagram[at : at + size], prefix, flags, order)
            except struct.error:
                raise ValueError("a submessage is too short") from None
        at += size


def _decode_data(body: bytes, prefix: bytes, flags: int, order: str) -> Data:
    to_inline, reader, writer, sequence = _sample_head(body, order)
    inline, at = _inline(body, 4 + to_inline, flags, order)
    payload = body[at:] if flags & 0x0C else b""
    return Data(prefix + writer, reader, sequence, payload, inline)


def _decode_fragment(body: bytes, prefix: bytes, flags: int, order: str) -> DataFragment:
    to_inline, reader, writer, sequence = _sample_head(body, order)
    first, count, fragment_size, size = struct.unpack_from(order + "IHHI", body, 20)
    if not (first and count and fragment_size and size):
        raise ValueError("a fragment has the number or size 0")
    inline, at = _inline(body, 4 + to_inline, flags, order)
    return DataFragment(
        prefix + writer, reader, sequence, body[at:], inline, first, count, fragment_size, size
    )  # fmt: skip


def _sample_head(body: bytes, order: str) -> tuple[int, bytes, bytes, int]:
    to_inline, reader, writer = struct.unpack_from(order + "2xH4s4s", body)
    return to_inline, reader, writer, _sequence(body, 12, order)


def _inline(body: bytes, at: int, flags: int, order: str) -> tuple[Sequence[Parameter], int]:
    if not flags & 2:
        return (), at
    found, size = decode_list(body[at:], order)
    return found, at + size


def _decode_heartbeat(body: bytes, prefix: bytes, flags: int, order: str) -> Heartbeat:
    reader, writer = body[:4], body[4:8]
    first, last = _sequence(body, 8, order), _sequence(body, 16, order, least=0)
    (count,) = struct.unpack_from(order + "I", body, 24)
    if first > last + 1:
        raise ValueError("a heartbeat ends before it begins")
    return Heartbeat(prefix + writer, reader, first, last, count, bool(flags & 2))


def _decode_heartbeat_fragment(body: bytes, prefix: bytes, flags: int, order: str) -> HeartbeatFragment:
    (last,) = struct.unpack_from(order + "I", body, 16)
    return HeartbeatFragment(prefix + body[4:8], body[:4], _sequence(body, 8, order), last)


def _decode_acknowledgment(body: bytes, prefix: bytes, flags: int, order: str) -> Acknowledgment:
    # Fast DDS asks for a first heartbeat by an acknowledgment of 0.
    base = _sequence(body, 8, order, least=0)
    missing, at = _set(body, 16, base, order)
    (count,) = struct.unpack_from(order + "I", body, at)
    return Acknowledgment(prefix + body[:4], body[4:8], base, missing, count, bool(flags & 2))


def _decode_fragment_request(body: bytes, prefix: bytes, flags: int, order: str) -> FragmentRequest:
    (base,) = struct.unpack_from(order + "I", body, 16)
    missing, at = _set(body, 20, base, order)
    (count,) = struct.unpack_from(order + "I", body, at)
    return FragmentRequest(prefix + body[:4], body[4:8], _sequence(body, 8, order), missing, count)


def _decode_gap(body: bytes, prefix: bytes, flags: int, order: str) -> SampleGap:
    first, base = _sequence(body, 8, order), _sequence(body, 16, order)
    others, _ = _set(body, 24, base, order)
    return SampleGap(prefix + body[4:8], body[:4], first, base, others)


_DECODERS: dict[int, Callable[[bytes, bytes, int, str], Submessage]] = {
    _DATA: _decode_data,
    _DATA_FRAG: _decode_fragment,
    _HEARTBEAT: _decode_heartbeat,
    _HEARTBEAT_FRAG: _decode_heartbeat_fragment,
    _ACKNACK: _decode_acknowledgment,
    _NACK_FRAG: _decode_fragment_request,
    _GAP: _decode_gap,
}


def _ntp(ns: int) -> tuple[int, int]:
    """Return seconds, and their fraction in units of 2^-32. It is rounded up, so that whole nanoseconds survive."""
    seconds, rest = divmod(ns, 1_000_000_000)
    return seconds & 0xFFFFFFFF, -(-(rest << 32) // 1_000_000_000)


def _long(number: int) -> bytes:
    return struct.pack("<iI", number >> 32, number & 0xFFFFFFFF)


def _sequence(body: bytes, at: int, order: str, least: int = 1) -> int:
    high, low = struct.unpack_from(order + "iI", body, at)
    number: int = (high << 32) + low
    if not least <= number < _LARGEST:
        raise ValueError("a sequence number is out of range")
    return number


def _bits(base: int, numbers: Sequence[int]) -> bytes:
    """Return the size of a bitmap, and the bitmap. The first bit of a word is its highest bit."""
    if not numbers:
        return bytes(4)
    size = max(numbers) - base + 1
    words = [0] * ((size + 31) // 32)
    for number in numbers:
        words[(number - base) >> 5] |= 1 << (31 - ((number - base) & 31))
    return struct.pack(f"<I{len(words)}I", size, *words)


def _set(body: bytes, at: int, base: int, order: str) -> tuple[Sequence[int], int]:
    """Return the numbers of a bitmap, and the offset of its end."""
    (size,) = struct.unpack_from(order + "I", body, at)
    if size > MOST_BITS:
        raise ValueError("a set has too many numbers")
    words = struct.unpack_from(f"{order}{(size + 31) // 32}I", body, at + 4)
    numbers = [base + bit for bit in range(size) if words[bit >> 5] & 1 << (31 - (bit & 31))]
    return numbers, at + 4 + 4 * len(words)
