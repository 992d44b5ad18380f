"""Messages of MAVLink: pymavlink's generated dialect `all`, with ArduPilot's and development messages."""

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
"""Target id that addresses all systems or all components."""

TEXT_SIZE = 50
"""Number of bytes of text in one STATUSTEXT."""

_KINDS = mav.mavlink_map | ADDED

SECRETS = frozenset({mav.MAVLINK_MSG_ID_SETUP_SIGNING})
"""Messages that contain a key. They are discarded when they arrive, so that they are neither forwarded nor recorded."""


@dataclass(frozen=True, slots=True)
class _Field:
    """Position of a field in a payload.

    Attributes:
        name: attribute of the message class that contains the field in the form of the wire.
        start: index of its first value among the payload's values.
        stop: index after its last value. A text is one value.
        is_array: True if its value is a list.
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
        seed: CRC_EXTRA byte, which the checksum includes.
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
    """Return CRC_EXTRA of a message: a byte for its layout, which checksums include. None if it is unknown."""
    layout = _LAYOUTS.get(message_id)
    return None if layout is None else layout.seed


def longest_payload(message_id: int) -> int:
    """Return the size in bytes of a payload with all extensions, or 0 if the message is unknown."""
    layout = _LAYOUTS.get(message_id)
    return 0 if layout is None else layout.values.size


def name_of(message_id: int) -> str:
    """Return a message's name in the dialect, or its number as text if it is unknown."""
    kind = _KINDS.get(message_id)
    return str(message_id) if kind is None else kind.msgname


def payload_of(message: Message) -> bytes:
    """Encode a message's payload. As in MAVLink 2, zeros at its end are cut off, except in its first byte.

    Raises:
        struct.error, OverflowError: a field does not fit into its type.
    """
    # The message's own class may have more fields at its end than the dialect's class.
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
    """Decode a payload of any length. Missing bytes count as zero, and surplus bytes are ignored.

    Returns:
        The message, or None if the dialect does not contain it.
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
    # Each message class expects its fields as positional arguments.
    return cast(Message, cast("type[_AnyFields]", layout.kind)(*fields))


def target_of(message: Message) -> tuple[int, int]:
    """Return the target system and component of a message. A missing target is `BROADCAST`."""
    if isinstance(message, mav.MAVLink_manual_control_message):
        # Only in this message the target field has another name.
        return message.target, BROADCAST
    system: object = getattr(message, "target_system", BROADCAST)
    component: object = getattr(message, "target_component", BROADCAST)
    return int(cast(int, system)), int(cast(int, component))


class _AnyFields:
    def __init__(self, *fields: object) -> None:
        """Accept the fields as positional arguments, like every message class."""


def _layout_of(kind: type[Message]) -> _Layout:
    fields, place = [], 0
    for index, (name, length) in enumerate(zip(kind.ordered_fieldnames, kind.lengths, strict=True)):
        # For a text field, a message has a str that ends at the first zero, and also the original bytes.
        is_text = kind.array_lengths[index] > 0 and length == 1
        fields.append(_Field(f"_{name}_raw" if is_text else name, place, place + length, length > 1))
        place += length
    declared = tuple(fields[index] for index in kind.orders)
    return _Layout(kind, kind.crc_extra, kind.unpacker, tuple(fields), declared)


_LAYOUTS = {message_id: _layout_of(kind) for message_id, kind in _KINDS.items()}
_BY_CLASS = {layout.kind: layout for layout in _LAYOUTS.values()}
