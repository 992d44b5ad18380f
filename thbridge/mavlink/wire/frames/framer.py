"""Frame parser: finds frames in a stream that may be cut anywhere, or in datagrams.

No input raises an exception. Bytes that form no frame are reported as discarded, and the search continues after the
first of them. So no valid frame is lost because of a corrupt length before it.

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
"""Start of a frame without unknown flags, to skip a flood of frames with such flags faster."""


class FrameFault(StrEnum):
    """Reason why bytes are discarded; completes the log message "discarded: ..."."""

    GARBAGE = "no frame begins here"
    FLAGS = "a frame with unsupported features"
    UNKNOWN = "a message that is not in the dialect, so that it cannot be checked"
    LENGTH = "a frame longer than its message"
    CHECKSUM = "a frame with a wrong checksum"
    CUT = "an incomplete frame"
    SECRET = "a signing key; keys come from a file, never from the wire"


@dataclass(frozen=True, slots=True)
class DiscardedBytes:
    """Bytes that were discarded; only their number is kept.

    Attributes:
        size: number of bytes.
        reason: fault of the first byte.
    """

    size: int
    reason: FrameFault


@dataclass(frozen=True, slots=True)
class _Bad:
    """Invalid frame with a valid first byte.

    Attributes:
        size: size that its header gives, in bytes.
        reason: its fault.
    """

    size: int
    reason: FrameFault


class FrameParser:
    """Parser of a byte stream; it keeps less than one frame for the next call."""

    def __init__(self) -> None:
        self._held = b""

    def receive_data(self, data: bytes) -> list[Frame | DiscardedBytes]:
        """Return frames and discarded bytes in order, each as soon as it is certain.

        The sizes add up to the number of bytes received. Only the division of discarded bytes into items depends on how
        the stream was cut.
        """
        found, self._held = _search(self._held + data, ended=False)
        return found

    def end(self) -> list[Frame | DiscardedBytes]:
        """Return frames and discarded bytes from the bytes kept so far, at the end of a stream; reset the parser."""
        found, self._held = _search(self._held, ended=True)
        return found


def parse_datagram(datagram: bytes) -> list[Frame | DiscardedBytes]:
    """Return frames and discarded bytes of a datagram, which contains complete frames only."""
    return _search(datagram, ended=True)[0]


def frame_of(data: bytes) -> Frame | None:
    """Return the frame that exactly these bytes form, or None."""
    match parse_datagram(data):
        case [Frame() as frame]:
            return frame
    return None


def _search(held: bytes, ended: bool) -> tuple[list[Frame | DiscardedBytes], bytes]:
    """Return frames and discarded bytes, and the rest, which needs more bytes to be decided."""
    found: list[Frame | DiscardedBytes] = []
    # Start and fault of the pending discarded bytes, and the end that their header gives.
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
        # A valid frame may be inside an invalid one; further invalid frames inside it are not reported.
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
    """Return the frame that begins at a magic byte of version 1, or its fault; None while it is incomplete."""
    begin = start + HEADER_V1.size
    if len(held) < begin:
        return None
    _, length, sequence, system, component, message_id = HEADER_V1.unpack_from(held, start)
    end = begin + length
    size = end + CHECKSUM_SIZE - start
    seed = crc_extra(message_id)
    if seed is None:
        return _Bad(size, FrameFault.UNKNOWN)
    # Only in version 2 may a newer dialect extend a message.
    if length > longest_payload(message_id):
        return _Bad(size, FrameFault.LENGTH)
    if len(held) < start + size:
        return None
    if not _is_intact(held, start, end, seed):
        return _Bad(size, FrameFault.CHECKSUM)
    return Frame(system, component, sequence, message_id, held[begin:end], seed, V1)


def _frame_v2_at(held: bytes, start: int) -> Frame | _Bad | None:
    """Return the frame that begins at a magic byte of version 2, or its fault; None while it is incomplete."""
    begin = start + HEADER_V2.size
    if len(held) < begin:
        return None
    _, length, incompat, compat, sequence, system, component, low, high = HEADER_V2.unpack_from(held, start)
    end = begin + length
    sealed = end + CHECKSUM_SIZE
    size = sealed - start + (SIGNATURE_SIZE if incompat & SIGNED else 0)
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
