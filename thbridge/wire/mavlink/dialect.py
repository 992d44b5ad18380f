"""MAVLink's messages: pymavlink's generated dialect `all`, which knows those of ArduPilot and of development too."""

from collections.abc import Sequence
from dataclasses import dataclass
from struct import Struct
from typing import cast

from pymavlink.dialects.v20 import all as mav
from pymavlink.dialects.v20.all import MAVLink_message as Message

from thbridge.wire.mavlink.extra_messages import ADDED

__all__ = [
    "EVERYBODY",
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

EVERYBODY = 0
"""As a target: every system, or every component."""

TEXT_SIZE = 50
"""Bytes of a sentence that one STATUSTEXT has room for."""

_KINDS = mav.mavlink_map | ADDED

SECRETS = frozenset({mav.MAVLINK_MSG_ID_SETUP_SIGNING})
"""Messages that carry a key: they are thrown away where they come in, so that nothing forwards or records them."""


@dataclass(frozen=True, slots=True)
class _Field:
    """A field as it lies in a payload.

    Attributes:
        name: of the attribute that holds it as it travels.
        start: which of the payload's values is its first.
        stop: one more than its last; text is one value.
        is_array: whether its value is a list.
    """

    name: str
    start: int
    stop: int
    is_array: bool


@dataclass(frozen=True, slots=True)
class _Layout:
    """How a message lies in its payload.

    Attributes:
        kind: the message's class.
        seed: what it adds to the checksum.
        values: all of its values.
        fields: in the order of the payload.
        declared: the same, in the order in which the class takes them.
    """

    kind: type[Message]
    seed: int
    values: Struct
    fields: tuple[_Field, ...]
    declared: tuple[_Field, ...]


def crc_extra(message_id: int) -> int | None:
    """The seed that a message's layout adds to the checksum; None for a message that the dialect does not know."""
    layout = _LAYOUTS.get(message_id)
    return None if layout is None else layout.seed


def longest_payload(message_id: int) -> int:
    """Bytes of a message with all its extensions; 0 for a message that the dialect does not know."""
    layout = _LAYOUTS.get(message_id)
    return 0 if layout is None else layout.values.size


def name_of(message_id: int) -> str:
    """What the dialect calls a message; its number where it does not know it."""
    kind = _KINDS.get(message_id)
    return str(message_id) if kind is None else kind.msgname


def payload_of(message: Message) -> bytes:
    """The message's payload, zeros at its end cut off as MAVLink 2 does (but never the first byte).

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
    """The message in a payload of any length: what is missing is zero, what is too much is cut off.

    None for a message that the dialect does not know.
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
    """The system and component that a message is meant for; `EVERYBODY` where it names none."""
    if isinstance(message, mav.MAVLink_manual_control_message):
        # The one message that calls its target otherwise.
        return message.target, EVERYBODY
    system: object = getattr(message, "target_system", EVERYBODY)
    component: object = getattr(message, "target_component", EVERYBODY)
    return int(cast(int, system)), int(cast(int, component))


class _AnyFields:
    def __init__(self, *fields: object) -> None:
        """As every message class is called."""


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
