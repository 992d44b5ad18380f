"""Frame parser, which finds frames in datagrams or in pieces of a stream. The stream may be cut anywhere.

No input raises an exception. Bytes that are not a frame are reported as discarded, and the search continues after the
first of these bytes. So no valid frame is lost because of a corrupt length before it.

Source: the MAVLink developer guide, "Packet Serialization" and "Incompatibility Flags".
"""

import re
from dataclasses import dataclass
from enum import StrEnum

from thbridge.mavlink.wire.dialect import SECRETS, crc_extra, longest_payload
from thbridge.mavlink.wire.frames.frame import (
    CHECKSUM_SIZE,
    HEADER_V1,
    HEADER_V2,
    SIGNATURE_SIZE,
    SIGNED,
    V1,
    V2,
    Frame,
    checksum_of,
)

_MAGIC = re.compile(b"[\xfd\xfe]")
"""First byte of any frame."""

_LIKELY = re.compile(rb"\xfe|\xfd(?:.[\x00\x01]|.?\Z)", re.DOTALL)
"""Start of a frame without unknown flags. With this pattern, a flood of frames with unknown flags is skipped faster."""


class FrameFault(StrEnum):
    """Reason why bytes are discarded. It completes the log message "bytes were discarded: ..."."""

    GARBAGE = "no frame begins here"
    FLAGS = "a frame with unsupported features"
    UNKNOWN = "a message that is not in the dialect, so that it cannot be checked"
    LENGTH = "a frame longer than its message"
    CHECKSUM = "a frame with a wrong checksum"
    CUT = "an incomplete frame"
    SECRET = "a signing key; keys come from a file, never from the wire"


@dataclass(frozen=True, slots=True)
class DiscardedBytes:
    """Discarded bytes. Only their number is stored.

    Attributes:
        size: number of bytes.
        reason: reason why the first byte was discarded.
    """

    size: int
    reason: FrameFault


@dataclass(frozen=True, slots=True)
class _Bad:
    """Invalid frame with a valid first byte.

    Attributes:
        size: size in bytes according to its header.
        reason: its fault.
    """

    size: int
    reason: FrameFault


class FrameParser:
    """Parser of a byte stream. Between two calls, it keeps less than one frame."""

    def __init__(self) -> None:
        self._held = b""

    def receive_data(self, data: bytes) -> list[Frame | DiscardedBytes]:
        """Return the frames and discarded bytes in order, each as early as it can be identified.

        The sum of their sizes is the number of received bytes. Only the division of discarded bytes into items depends
        on the pieces of the stream.
        """
        found, self._held = _search(self._held + data, ended=False)
        return found

    def end(self) -> list[Frame | DiscardedBytes]:
        """Return the frames and discarded bytes from the kept bytes at the end of a stream, and reset the parser."""
        found, self._held = _search(self._held, ended=True)
        return found


def parse_datagram(datagram: bytes) -> list[Frame | DiscardedBytes]:
    """Return the frames and discarded bytes of a datagram. A datagram contains only complete frames."""
    return _search(datagram, ended=True)[0]


def frame_of(data: bytes) -> Frame | None:
    """Return the frame that consists of exactly these bytes, or None."""
    match parse_datagram(data):
        case [Frame() as frame]:
            return frame
    return None


def _search(held: bytes, ended: bool) -> tuple[list[Frame | DiscardedBytes], bytes]:
    """Return frames and discarded bytes, and the remaining bytes, which may be the start of a frame."""
    found: list[Frame | DiscardedBytes] = []
    # `lost`: start of the pending discarded bytes. `reason`: their fault. `claimed`: their end by their header.
    lost, reason, claimed = 0, FrameFault.GARBAGE, 0
    place = 0
    while (magic := (_LIKELY if place < claimed else _MAGIC).search(held, place)) is not None:
        start = magic.start()
        what = _frame_v1_at(held, start) if held[start] == V1 else _frame_v2_at(held, start)
        if what is None:
            if not ended:
                break
            what = _Bad(len(held) - start, FrameFault.CUT)
        end = start + what.size
        if isinstance(what, Frame):
            if start > lost:
                found.append(DiscardedBytes(start - lost, reason))
            secret = what.message_id in SECRETS
            found.append(DiscardedBytes(what.size, FrameFault.SECRET) if secret else what)
            lost, reason, claimed, place = end, FrameFault.GARBAGE, end, end
            continue
        # A valid frame may be inside an invalid frame. Further invalid frames inside it are not reported.
        if start >= claimed:
            if start > lost:
                found.append(DiscardedBytes(start - lost, reason))
            lost, reason, claimed = start, what.reason, end
        place = start + 1
    kept = len(held) if magic is None else magic.start()
    if kept > lost:
        found.append(DiscardedBytes(kept - lost, reason))
    return found, held[kept:]


def _frame_v1_at(held: bytes, start: int) -> Frame | _Bad | None:
    """Return the frame that begins at a magic byte of version 1, or its fault. Return None if it is incomplete."""
    begin = start + HEADER_V1.size
    if len(held) < begin:
        return None
    _, length, sequence, system, component, message_id = HEADER_V1.unpack_from(held, start)
    end = begin + length
    size = end + CHECKSUM_SIZE - start
    seed = crc_extra(message_id)
    if seed is None:
        return _Bad(size, FrameFault.UNKNOWN)
    # A newer dialect may extend a message only in version 2.
    if length > longest_payload(message_id):
        return _Bad(size, FrameFault.LENGTH)
    if len(held) < start + size:
        return None
    if not _is_intact(held, start, end, seed):
        return _Bad(size, FrameFault.CHECKSUM)
    return Frame(system, component, sequence, message_id, held[begin:end], seed, V1)


def _frame_v2_at(held: bytes, start: int) -> Frame | _Bad | None:
    """Return the frame that begins at a magic byte of version 2, or its fault. Return None if it is incomplete."""
    begin = start + HEADER_V2.size
    if len(held) < begin:
        return None
    _, length, incompat, compat, sequence, system, component, low, high = HEADER_V2.unpack_from(held, start)
    end = begin + length
    sealed = end + CHECKSUM_SIZE
    size = sealed - start + (SIGNATURE_SIZE if incompat & SIGNED else 0)
    # By the standard, a receiver must drop a frame with an incompat flag that it does not support.
    if incompat & ~SIGNED:
        return _Bad(size, FrameFault.FLAGS)
    message_id = low | high << 16
    seed = crc_extra(message_id)
    if seed is None:
        return _Bad(size, FrameFault.UNKNOWN)
    if len(held) < start + size:
        return None
    if not _is_intact(held, start, end, seed):
        return _Bad(size, FrameFault.CHECKSUM)
    payload, signature = held[begin:end], held[sealed : start + size]
    return Frame(system, component, sequence, message_id, payload, seed, V2, incompat, compat, signature)


def _is_intact(held: bytes, start: int, end: int, seed: int) -> bool:
    """Return True if the two bytes after the payload are the frame's checksum."""
    return checksum_of(held[start:end], seed) == int.from_bytes(held[end : end + CHECKSUM_SIZE], "little")
