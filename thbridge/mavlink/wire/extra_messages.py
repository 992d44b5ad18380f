"""Messages and fields of MAVLink's `common` that pymavlink's dialect `all` does not have, in pymavlink's form.

Source: the MAVLink developer guide, "Packet Serialization", on the order of fields and on CRC_EXTRA.
"""

import re
import struct
from collections.abc import Callable
from typing import NamedTuple, TypeVar

import fastcrc
from pymavlink.dialects.v20.all import MAVLink_message as Message

M = TypeVar("M", bound=Message)

_DECLARATION = re.compile(r"(\w+)(?:\[(\d+)\])? (\w+)")
_FORMATS = {"char": "s", "uint8_t": "B", "uint16_t": "H", "uint32_t": "I"}


class _Field(NamedTuple):
    """Declaration of a field: type, name and length. The length is 0 if the field is not an array."""

    kind: str
    length: int
    name: str

    @property
    def format(self) -> str:
        return f"{self.length or ''}{_FORMATS[self.kind]}"

    @property
    def values(self) -> int:
        """Number of values in a payload. A text is one value."""
        return 1 if self.kind == "char" else max(1, self.length)


def _field(declaration: str) -> _Field:
    match = _DECLARATION.fullmatch(declaration)
    if match is None:
        raise ValueError(f"{declaration!r} declares no field")
    return _Field(match[1], int(match[2] or 0), match[3])


class _Added(Message):
    """Message class built from field declarations.

    Args:
        values: values of the fields in the order of declaration. Texts are bytes.
    """

    def __init_subclass__(cls, *, number: int, name: str, fields: tuple[str, ...]) -> None:
        declared = [_field(declaration) for declaration in fields]
        # MAVLink sends larger types first. Fields of the same size keep their order.
        on_wire = sorted(declared, key=lambda field: -struct.calcsize(_FORMATS[field.kind]))
        cls.id, cls.msgname = number, name
        cls.fieldnames = [field.name for field in declared]
        cls.fieldtypes = [field.kind for field in declared]
        cls.ordered_fieldnames = [field.name for field in on_wire]
        cls.orders = [on_wire.index(field) for field in declared]
        cls.lengths = [field.values for field in on_wire]
        cls.array_lengths = [field.length for field in on_wire]
        cls.crc_extra = _crc_extra(name, on_wire)
        cls.unpacker = struct.Struct("<" + "".join(field.format for field in on_wire))

    def __init__(self, *values: int | bytes | list[int]) -> None:
        super().__init__(self.id, self.msgname)
        self._fieldnames = self.fieldnames
        for name, value in zip(self.fieldnames, values, strict=True):
            if isinstance(value, bytes):
                # Like the generated classes, store a text as bytes and as str.
                setattr(self, f"_{name}_raw", value)
                setattr(self, name, value.split(b"\0", 1)[0].decode("ascii", errors="replace"))
            else:
                setattr(self, name, value)


def _crc_extra(name: str, on_wire: list[_Field]) -> int:
    """Return CRC_EXTRA of a message from its fields in the order of the wire."""
    text = f"{name} ".encode()
    for field in on_wire:
        text += f"{field.kind} {field.name} ".encode() + (bytes((field.length,)) if field.length else b"")
    checksum: int = fastcrc.crc16.mcrf4xx(text)
    return checksum & 0xFF ^ checksum >> 8


class CommandCancel(
    _Added,
    number=80,
    name="COMMAND_CANCEL",
    fields=("uint8_t target_system", "uint8_t target_component", "uint16_t command"),
):
    """Request to cancel a long-running command."""

    command: int


class ProtocolVersion(
    _Added,
    number=300,
    name="PROTOCOL_VERSION",
    fields=(
        "uint16_t version",
        "uint16_t min_version",
        "uint16_t max_version",
        "uint8_t[8] spec_version_hash",
        "uint8_t[8] library_version_hash",
    ),
):
    """Supported versions of MAVLink, times 100. The hashes are zero."""


class ComponentMetadata(
    _Added,
    number=397,
    name="COMPONENT_METADATA",
    fields=("uint32_t time_boot_ms", "uint32_t file_crc", "char[100] uri"),
):
    """URI and checksum of the general metadata file, which lists the other files about a component."""


class ComponentInformation(
    _Added,
    number=395,
    name="COMPONENT_INFORMATION",
    fields=(
        "uint32_t time_boot_ms",
        "uint32_t general_metadata_file_crc",
        "char[100] general_metadata_uri",
        "uint32_t peripherals_metadata_file_crc",
        "char[100] peripherals_metadata_uri",
    ),
):
    """Predecessor of COMPONENT_METADATA. Older stations still request it."""


_OURS = (CommandCancel, ProtocolVersion, ComponentInformation, ComponentMetadata)

ADDED: dict[int, type[Message]] = {kind.id: kind for kind in _OURS}


def extended(declaration: str) -> Callable[[type[M]], type[M]]:
    """Return a class decorator that appends an extension field to a generated message. CRC_EXTRA stays the same."""
    field = _field(declaration)

    def with_field(kind: type[M]) -> type[M]:
        kind.ordered_fieldnames = [*kind.ordered_fieldnames, field.name]
        kind.orders = [*kind.orders, len(kind.orders)]
        kind.lengths = [*kind.lengths, field.values]
        kind.array_lengths = [*kind.array_lengths, field.length]
        kind.unpacker = struct.Struct(kind.unpacker.format + field.format)
        return kind

    return with_field
