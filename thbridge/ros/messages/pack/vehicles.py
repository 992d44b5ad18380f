"""Encoders of mavros' messages for robots that are MAVLink vehicles."""

from struct import Struct

from thbridge.ros.messages.pack.fields import UINT32, header, string
from thbridge.ros.messages.records import MavlinkFrame, VehicleState

FRAMING_OK = 1
_FRAME = Struct("<8BIH")
_STATE = Struct("<4?")
_WORD = 8


def mavlink(tick: int, frame: MavlinkFrame) -> bytes:
    """Encode mavros_msgs/Mavlink. The payload consists of 64-bit words, and the last word is filled with zeros."""
    size = len(frame.payload)
    words = -(-size // _WORD)
    numbers = _FRAME.pack(
        FRAMING_OK,
        frame.magic,
        size,
        frame.incompat_flags,
        frame.compat_flags,
        frame.sequence,
        frame.system,
        frame.component,
        frame.message_id,
        frame.checksum,
    )
    payload = frame.payload.ljust(words * _WORD, b"\0")
    no_signature = UINT32.pack(0)
    return header(tick, frame.link) + numbers + UINT32.pack(words) + payload + no_signature


def vehicle_state(tick: int, record: VehicleState) -> bytes:
    """Encode mavros_msgs/State."""
    flags = _STATE.pack(record.connected, record.armed, record.guided, record.manual_input)
    return header(tick) + flags + string(record.mode) + bytes((record.system_status,))
