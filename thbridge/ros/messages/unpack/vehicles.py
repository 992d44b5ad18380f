"""Decoders of mavros' messages for robots that are MAVLink vehicles."""

from struct import Struct

from thbridge.ros.messages.cursor import UINT32, Cursor
from thbridge.ros.messages.records import MavlinkFrame

FRAMING_OK = 1
_NUMBERS = Struct("<8BIH")
_WORD = 8
_MOST_WORDS = 32


def mavlink(data: bytes) -> MavlinkFrame:
    """Decode mavros_msgs/Mavlink without the signature. For a damaged frame, this raises ValueError, too."""
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
    return MavlinkFrame(
        link, magic, incompat_flags, compat_flags, sequence, system, component, message_id, checksum, payload
    )
