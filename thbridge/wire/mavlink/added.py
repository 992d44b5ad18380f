"""Messages of MAVLink's `common` that pymavlink's dialect `all` lacks, made as its generator makes them."""

import struct
from typing import NamedTuple

import fastcrc
from pymavlink.dialects.v20.all import MAVLink_message as Message


class _Field(NamedTuple):
    """A field: its type, its name, and how many of that type it has; 0 where it is no array."""

    kind: str
    name: str
    length: int = 0


def _names(fields: tuple[_Field, ...]) -> list[str]:
    return [field.name for field in fields]


def _kinds(fields: tuple[_Field, ...]) -> list[str]:
    return [field.kind for field in fields]


def _lengths(fields: tuple[_Field, ...]) -> list[int]:
    """How many values each field is; text is one."""
    return [1 if field.kind == "char" else max(1, field.length) for field in fields]


def _array_lengths(fields: tuple[_Field, ...]) -> list[int]:
    return [field.length for field in fields]


def _orders(declared: tuple[_Field, ...], on_wire: tuple[_Field, ...]) -> list[int]:
    """Where on the wire each declared field lies."""
    return [on_wire.index(field) for field in declared]


def _crc_extra(name: str, fields: tuple[_Field, ...]) -> int:
    """The seed of a message's checksum, of its fields in the order of the wire.

    Source: the MAVLink developer guide, "CRC_EXTRA calculation".
    """
    text = f"{name} ".encode()
    for field in fields:
        text += f"{field.kind} {field.name} ".encode() + (bytes((field.length,)) if field.length else b"")
    checksum: int = fastcrc.crc16.mcrf4xx(text)
    return checksum & 0xFF ^ checksum >> 8


class CommandCancel(Message):
    """COMMAND_CANCEL: give up a command that takes its time."""

    _DECLARED = (
        _Field("uint8_t", "target_system"),
        _Field("uint8_t", "target_component"),
        _Field("uint16_t", "command"),
    )
    # On the wire, larger fields come first.
    _FIELDS = (_DECLARED[2], *_DECLARED[:2])
    id = 80
    msgname = "COMMAND_CANCEL"
    ordered_fieldnames = _names(_FIELDS)
    orders = _orders(_DECLARED, _FIELDS)
    fieldnames = _names(_DECLARED)
    fieldtypes = _kinds(_DECLARED)
    lengths = _lengths(_FIELDS)
    array_lengths = _array_lengths(_FIELDS)
    crc_extra = _crc_extra(msgname, _FIELDS)
    unpacker = struct.Struct("<HBB")

    def __init__(self, target_system: int, target_component: int, command: int) -> None:
        super().__init__(self.id, self.msgname)
        self._fieldnames = self.fieldnames
        self.target_system = target_system
        self.target_component = target_component
        self.command = command


class ProtocolVersion(Message):
    """PROTOCOL_VERSION: which versions of MAVLink are spoken, times 100; hashes of nothing."""

    _FIELDS = (
        _Field("uint16_t", "version"),
        _Field("uint16_t", "min_version"),
        _Field("uint16_t", "max_version"),
        _Field("uint8_t", "spec_version_hash", 8),
        _Field("uint8_t", "library_version_hash", 8),
    )
    id = 300
    msgname = "PROTOCOL_VERSION"
    ordered_fieldnames = _names(_FIELDS)
    orders = _orders(_FIELDS, _FIELDS)
    fieldnames = _names(_FIELDS)
    fieldtypes = _kinds(_FIELDS)
    lengths = _lengths(_FIELDS)
    array_lengths = _array_lengths(_FIELDS)
    crc_extra = _crc_extra(msgname, _FIELDS)
    unpacker = struct.Struct("<HHH8B8B")

    def __init__(
        self,
        version: int,
        min_version: int,
        max_version: int,
        spec_version_hash: list[int],
        library_version_hash: list[int],
    ) -> None:
        super().__init__(self.id, self.msgname)
        self._fieldnames = self.fieldnames
        self.version = version
        self.min_version = min_version
        self.max_version = max_version
        self.spec_version_hash = spec_version_hash
        self.library_version_hash = library_version_hash


class ComponentMetadata(Message):
    """COMPONENT_METADATA: where files about a component are; nowhere, when its uri is empty."""

    _FIELDS = (_Field("uint32_t", "time_boot_ms"), _Field("uint32_t", "file_crc"), _Field("char", "uri", 100))
    id = 397
    msgname = "COMPONENT_METADATA"
    ordered_fieldnames = _names(_FIELDS)
    orders = _orders(_FIELDS, _FIELDS)
    fieldnames = _names(_FIELDS)
    fieldtypes = _kinds(_FIELDS)
    lengths = _lengths(_FIELDS)
    array_lengths = _array_lengths(_FIELDS)
    crc_extra = _crc_extra(msgname, _FIELDS)
    unpacker = struct.Struct("<II100s")

    def __init__(self, time_boot_ms: int, file_crc: int, uri: bytes) -> None:
        super().__init__(self.id, self.msgname)
        self._fieldnames = self.fieldnames
        self.time_boot_ms = time_boot_ms
        self.file_crc = file_crc
        self._uri_raw = uri
        self.uri = uri.split(b"\0", 1)[0].decode("ascii", errors="replace")


ADDED: dict[int, type[Message]] = {kind.id: kind for kind in (CommandCancel, ProtocolVersion, ComponentMetadata)}
