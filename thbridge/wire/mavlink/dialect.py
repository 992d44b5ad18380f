"""MAVLink's messages: pymavlink's generated dialect `all`, which knows those of ArduPilot and of development too."""

from typing import cast

from pymavlink.dialects.v20 import all as mav
from pymavlink.dialects.v20.all import MAVLink_message as Message

__all__ = ["EVERYBODY", "Message", "crc_extra", "decoded", "mav", "name_of", "payload_of", "target_of"]

EVERYBODY = 0
"""As a target: every system, or every component."""

_PACKER = mav.MAVLink(None)
"""Holds no state that matters here: messages are packed with it, and their headers thrown away."""


def crc_extra(message_id: int) -> int | None:
    """The seed that a message's layout adds to the checksum; None for a message that the dialect does not know."""
    kind = mav.mavlink_map.get(message_id)
    return None if kind is None else kind.crc_extra


def name_of(message_id: int) -> str:
    """What the dialect calls a message; its number where it does not know it."""
    kind = mav.mavlink_map.get(message_id)
    return str(message_id) if kind is None else kind.msgname


def payload_of(message: Message) -> bytes:
    """The message's payload, zeros at its end cut off as MAVLink 2 does (but never the first byte).

    Raises:
        struct.error: a field does not fit its type.
    """
    message.pack(_PACKER)
    return bytes(message.get_payload() or b"")


def decoded(message_id: int, payload: bytes) -> Message | None:
    """The message in a payload of any length: what is missing is zero, what is too much is cut off.

    None for a message that the dialect does not know.
    """
    kind = mav.mavlink_map.get(message_id)
    if kind is None:
        return None
    size = kind.unpacker.size
    values: list[object] = list(kind.unpacker.unpack(payload[:size].ljust(size, b"\0")))
    fields = list(_fields(values, kind))
    # Each message class takes its own fields, by place.
    return cast(Message, cast("type[_AnyFields]", kind)(*fields))


def target_of(message: Message) -> tuple[int, int]:
    """The system and component that a message is meant for; `EVERYBODY` where it names none."""
    system: object = getattr(message, "target_system", EVERYBODY)
    component: object = getattr(message, "target_component", EVERYBODY)
    return int(cast(int, system)), int(cast(int, component))


class _AnyFields:
    def __init__(self, *fields: object) -> None:
        """As every message class is called."""


def _fields(values: list[object], kind: type[Message]) -> list[object]:
    """The fields in their declared order, from the values in the order of the wire; an array becomes a list."""
    starts, place = [], 0
    for length in kind.lengths:
        starts.append(place)
        place += length
    fields: list[object] = []
    for index in kind.orders:
        start, length = starts[index], kind.lengths[index]
        value: object = values[start] if length == 1 else values[start : start + length]
        fields.append(value.rstrip(b"\0") if isinstance(value, bytes) else value)
    return fields
