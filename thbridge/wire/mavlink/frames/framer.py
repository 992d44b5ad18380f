"""Finds the frames in bytes: of a stream in any pieces, or of datagrams.

Nothing that comes in is an error. What is no frame is told as noise, and behind its first byte the search goes on: a
good frame is never lost because a length before it was corrupt.

Source: the MAVLink developer guide, "Packet Serialization" and "Incompatibility Flags".
"""

import re
from dataclasses import dataclass
from enum import StrEnum

from thbridge.wire.mavlink.dialect import SECRETS, crc_extra, longest_payload
from thbridge.wire.mavlink.frames.frame import (
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
"""Where a frame may begin."""

_LIKELY = re.compile(rb"\xfe|\xfd(?:.[\x00\x01]|.?\Z)", re.DOTALL)
"""The same, but for frames with flags that nobody here knows: quicker through a flood of such."""


class FrameFault(StrEnum):
    """What is wrong with bytes that are thrown away, as the end of the sentence "thrown away: ..."."""

    GARBAGE = "no frame begins here"
    FLAGS = "a frame that asks for features nobody here has"
    UNKNOWN = "a message that the dialect does not know, so that it cannot be checked"
    LENGTH = "a frame longer than its message"
    CHECKSUM = "a frame with a wrong checksum"
    CUT = "a frame that was cut off"
    SECRET = "a signing key; keys come from a file, never from the wire"


@dataclass(frozen=True, slots=True)
class DiscardedBytes:
    """Bytes that were thrown away; what they were is not kept.

    Attributes:
        size: how many.
        reason: what was wrong with the first of them.
    """

    size: int
    reason: FrameFault


@dataclass(frozen=True, slots=True)
class _Bad:
    """No frame, though its first byte is right.

    Attributes:
        size: bytes that it claims.
        reason: what is wrong with it.
    """

    size: int
    reason: FrameFault


class FrameParser:
    """Takes bytes as they come and gives the frames in them; keeps less than one frame back."""

    def __init__(self) -> None:
        self._held = b""

    def receive_data(self, data: bytes) -> list[Frame | DiscardedBytes]:
        """Frames, and what was thrown away, in order; each as soon as it is certain.

        The sizes of frames and noise are those of the bytes that came in; only how noise is divided depends on the
        pieces that they came in.
        """
        found, self._held = _search(self._held + data, ended=False)
        return found

    def end(self) -> list[Frame | DiscardedBytes]:
        """Nothing follows: what is in the bytes kept back. Afterwards the framer is as new."""
        found, self._held = _search(self._held, ended=True)
        return found


def frames_of(datagram: bytes) -> list[Frame | DiscardedBytes]:
    """What is in a datagram whose sender puts whole frames in each."""
    return _search(datagram, ended=True)[0]


def frame_of(data: bytes) -> Frame | None:
    """The one frame that these bytes are; None: they are anything else."""
    match frames_of(data):
        case [Frame() as frame]:
            return frame
    return None


def _search(held: bytes, ended: bool) -> tuple[list[Frame | DiscardedBytes], bytes]:
    """What is in bytes, and those of them that more has to follow to know."""
    found: list[Frame | DiscardedBytes] = []
    lost, reason, claimed = 0, FrameFault.GARBAGE, 0  # Where noise begins, what it is, and where it says that it ends.
    place = 0
    while (magic := (_LIKELY if place < claimed else _MAGIC).search(held, place)) is not None:
        start = magic.start()
        what = _frame_at(held, start)
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
        # Inside what is no frame there may be one; that another is none either is no news.
        if start >= claimed:
            if start > lost:
                found.append(DiscardedBytes(start - lost, reason))
            lost, reason, claimed = start, what.reason, end
        place = start + 1
    kept = len(held) if magic is None else magic.start()
    if kept > lost:
        found.append(DiscardedBytes(kept - lost, reason))
    return found, held[kept:]


def _frame_at(held: bytes, start: int) -> Frame | _Bad | None:
    """What begins at a magic byte; None: more has to come to know it."""
    return _frame_v1_at(held, start) if held[start] == V1 else _frame_v2_at(held, start)


def _frame_v1_at(held: bytes, start: int) -> Frame | _Bad | None:
    begin = start + HEADER_V1.size
    if len(held) < begin:
        return None
    _, length, sequence, system, component, message_id = HEADER_V1.unpack_from(held, start)
    end = begin + length
    size = end + CHECKSUM_SIZE - start
    seed = crc_extra(message_id)
    if seed is None:
        return _Bad(size, FrameFault.UNKNOWN)
    # Only version 2 lets a newer dialect make a message longer.
    if length > longest_payload(message_id):
        return _Bad(size, FrameFault.LENGTH)
    if len(held) < start + size:
        return None
    if not _is_intact(held, start, end, seed):
        return _Bad(size, FrameFault.CHECKSUM)
    return Frame(system, component, sequence, message_id, held[begin:end], seed, V1)


def _frame_v2_at(held: bytes, start: int) -> Frame | _Bad | None:
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
    """Whether the checksum behind a payload's end is that of the frame."""
    return checksum_of(held[start:end], seed) == int.from_bytes(held[end : end + CHECKSUM_SIZE], "little")
