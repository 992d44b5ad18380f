"""MAVLink's messages: pymavlink's generated dialect `all`, which includes ArduPilot's and development messages."""

from collections.abc import Sequence
from dataclasses import dataclass
from struct import Struct
from typing import cast

from pymavlink.dialects.v20 import all as mav
from pymavlink.dialects.v20.all import MAVLink_message as Message

from thbridge.mavlink.wire.extra_messages import ADDED

__all__ = [
    "BROADCAST",
    "SECRETS",
    "TEXT_SIZE",
    "Message",
    "crc_extra",
    "decoded",
    "longest_payload",
    "mav",
    "name_of",
    "payload_of",
    "target_of",
]

BROADCAST = 0
"""Target id of every system, or every component."""

TEXT_SIZE = 50
"""Bytes of text in one STATUSTEXT."""

_KINDS = mav.mavlink_map | ADDED

SECRETS = frozenset({mav.MAVLINK_MSG_ID_SETUP_SIGNING})
"""Messages that carry a key: they are discarded on receipt, so that they are neither forwarded nor recorded."""


@dataclass(frozen=True, slots=True)
class _Field:
    """Position of a field in a payload.

    Attributes:
        name: attribute of the message class that holds it in wire form.
        start: index of its first value among the payload's values.
        stop: index after its last value; text is one value.
        is_array: True when its value is a list.
    """

    name: str
    start: int
    stop: int
    is_array: bool


@dataclass(frozen=True, slots=True)
class _Layout:
    """Layout of a message's payload.

    Attributes:
        kind: the message's class.
        seed: CRC_EXTRA byte that it adds to the checksum.
        values: struct of all its values.
        fields: fields in the order of the payload.
        declared: the same fields, in the order of the class's arguments.
    """

    kind: type[Message]
    seed: int
    values: Struct
    fields: tuple[_Field, ...]
    declared: tuple[_Field, ...]


def crc_extra(message_id: int) -> int | None:
    """Return CRC_EXTRA, the seed that a message's layout adds to the checksum; None for an unknown message."""
    layout = _LAYOUTS.get(message_id)
    return None if layout is None else layout.seed


def longest_payload(message_id: int) -> int:
    """Return the bytes of a payload with all extensions; 0 for an unknown message."""
    layout = _LAYOUTS.get(message_id)
    return 0 if layout is None else layout.values.size


def name_of(message_id: int) -> str:
    """Return a message's name in the dialect; its number for an unknown message."""
    kind = _KINDS.get(message_id)
    return str(message_id) if kind is None else kind.msgname


def payload_of(message: Message) -> bytes:
    """Encode a message's payload; zeros at its end are cut off as in MAVLink 2 (but never the first byte).

    Raises:
        struct.error, OverflowError: a field does not fit its type.
    """
    # By its own class, which may have more fields at its end than the dialect's.
    layout = _BY_CLASS.get(type(message)) or _layout_of(type(message))
    values: list[object] = []
    for field in layout.fields:
        value: object = getattr(message, field.name)
        if field.is_array:
            values += cast("Sequence[object]", value)[: field.stop - field.start]
        else:
            values.append(value)
    payload = layout.values.pack(*values)
    return payload.rstrip(b"\0") or payload[:1]


def decoded(message_id: int, payload: bytes) -> Message | None:
    """Decode a payload of any length: missing bytes are zero, surplus bytes are cut off.

    Returns:
        The message; None when the dialect does not know it.
    """
    layout = _LAYOUTS.get(message_id)
    if layout is None:
        return None
    size = layout.values.size
    values: tuple[object, ...] = layout.values.unpack(payload[:size].ljust(size, b"\0"))
    fields: list[object] = []
    for field in layout.declared:
        if field.is_array:
            fields.append(list(values[field.start : field.stop]))
        else:
            value = values[field.start]
            fields.append(value.rstrip(b"\0") if isinstance(value, bytes) else value)
    # Each message class takes its own fields, by place.
    return cast(Message, cast("type[_AnyFields]", layout.kind)(*fields))


def target_of(message: Message) -> tuple[int, int]:
    """Return the target system and component of a message; `BROADCAST` where it names none."""
    if isinstance(message, mav.MAVLink_manual_control_message):
        # The only message whose target field has another name.
        return message.target, BROADCAST
    system: object = getattr(message, "target_system", BROADCAST)
    component: object = getattr(message, "target_component", BROADCAST)
    return int(cast(int, system)), int(cast(int, component))


class _AnyFields:
    def __init__(self, *fields: object) -> None:
        """Take the fields by position, as every message class does."""


def _layout_of(kind: type[Message]) -> _Layout:
    fields, place = [], 0
    for index, (name, length) in enumerate(zip(kind.ordered_fieldnames, kind.lengths, strict=True)):
        # A message shows text as str up to its first zero; beside it, it keeps the bytes.
        is_text = kind.array_lengths[index] > 0 and length == 1
        fields.append(_Field(f"_{name}_raw" if is_text else name, place, place + length, length > 1))
        place += length
    declared = tuple(fields[index] for index in kind.orders)
    return _Layout(kind, kind.crc_extra, kind.unpacker, tuple(fields), declared)


_LAYOUTS = {message_id: _layout_of(kind) for message_id, kind in _KINDS.items()}
_BY_CLASS = {layout.kind: layout for layout in _LAYOUTS.values()}
