"""Robots as MAVLink vehicles: mavros' types."""

from dataclasses import dataclass
from struct import Struct

from thbridge.ros.cursor import UINT32, Cursor

FRAMING_OK = 1
_NUMBERS = Struct("<8BIH")
_WORD = 8
_MOST_WORDS = 32


@dataclass(frozen=True, slots=True)
class HeardFrame:
    """A MAVLink frame as mavros_msgs/Mavlink tells it.

    Attributes:
        link: what the header's frame says; the name of a link, where we recorded it.
        magic: first byte of the frame, which tells its version.
        incompat_flags: of version 2, as the next one.
        compat_flags: see there.
        sequence: the sender's count.
        system: of the sender.
        component: of the sender.
        message_id: what kind of message.
        checksum: as it is said to stand in the frame.
        payload: without what fills its last word up.
    """

    link: str
    magic: int
    incompat_flags: int
    compat_flags: int
    sequence: int
    system: int
    component: int
    message_id: int
    checksum: int
    payload: bytes


def mavlink(data: bytes) -> HeardFrame:
    """mavros_msgs/Mavlink; a signature is left out. Raises ValueError for a frame that was damaged, too."""
    cursor = Cursor(data)
    _, link = cursor.header()
    numbers: tuple[int, ...] = _NUMBERS.unpack(cursor.take(_NUMBERS.size))
    status, magic, size, incompat_flags, compat_flags, sequence, system, component, message_id, checksum = numbers
    words = cursor.integer(UINT32)
    if status != FRAMING_OK:
        raise ValueError(f"the frame was damaged: framing status {status}")
    if words > _MOST_WORDS or size > words * _WORD:
        raise ValueError(f"{size} bytes are not in {words} words of 64 bits")
    payload = cursor.take(words * _WORD)[:size]
    return HeardFrame(
        link, magic, incompat_flags, compat_flags, sequence, system, component, message_id, checksum, payload
    )
