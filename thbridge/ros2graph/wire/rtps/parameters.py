"""Lists of parameters: the data of discovery, and the quality of service inside data submessages.

Source: DDSI-RTPS 2.3, sections 9.4.2.11 and 9.6.2.2.
"""

import struct
from collections.abc import Iterable, Iterator
from enum import IntEnum
from typing import NamedTuple

MOST_PARAMETERS = 256
"""Maximum number of parameters of a list. Those of Fast DDS have about 40."""

_SENTINEL = 1
_LIST_LITTLE, _LIST_BIG = b"\x00\x03", b"\x00\x02"
_UDP_V4 = 1
_NANO = 1_000_000_000
_FOREVER = 0x7FFFFFFF


class Pid(IntEnum):
    """Parameter ids that are read or written."""

    LEASE_DURATION = 0x0002
    TOPIC_NAME = 0x0005
    TYPE_NAME = 0x0007
    DOMAIN_ID = 0x000F
    PROTOCOL_VERSION = 0x0015
    VENDOR_ID = 0x0016
    RELIABILITY = 0x001A
    LIVELINESS = 0x001B
    DURABILITY = 0x001D
    OWNERSHIP = 0x001F
    DEADLINE = 0x0023
    LIFESPAN = 0x002B
    USER_DATA = 0x002C
    UNICAST_LOCATOR = 0x002F
    DEFAULT_UNICAST_LOCATOR = 0x0031
    METATRAFFIC_UNICAST_LOCATOR = 0x0032
    METATRAFFIC_MULTICAST_LOCATOR = 0x0033
    HISTORY = 0x0040
    PARTICIPANT_GUID = 0x0050
    BUILTIN_ENDPOINT_SET = 0x0058
    ENDPOINT_GUID = 0x005A
    ENTITY_NAME = 0x0062
    KEY_HASH = 0x0070
    STATUS_INFO = 0x0071
    DATA_REPRESENTATION = 0x0073
    RELATED_SAMPLE_IDENTITY = 0x0083
    EPROSIMA_RELATED_SAMPLE_IDENTITY = 0x800F


class UdpAddress(NamedTuple):
    """Address of a UDP socket: IPv4 address and port."""

    host: str
    port: int


class Parameter(NamedTuple):
    """Parameter of a list. `order` is the byte order of its value, "<" or ">"."""

    pid: int
    value: bytes
    order: str

    def number(self) -> int:
        """Return the value as a number of 4 bytes."""
        return self._unpack("I")[0]

    def string(self) -> str:
        """Return the value as a string."""
        size = self.number()
        if not 0 < size <= len(self.value) - 4:
            raise ValueError("the text is longer than its parameter")
        return self.value[4 : 3 + size].decode()

    def octets(self) -> bytes:
        """Return the value as a sequence of bytes."""
        size = self.number()
        if size > len(self.value) - 4:
            raise ValueError("the bytes are longer than their parameter")
        return self.value[4 : 4 + size]

    def numbers(self) -> tuple[int, int]:
        """Return the value as two numbers of 4 bytes, for example the kind and the depth of a history."""
        first, second = self._unpack("II")
        return first, second

    def duration_ns(self) -> int | None:
        """Return the value as a duration in nanoseconds. None is infinite."""
        seconds, fraction = self._unpack("iI")
        if seconds == _FOREVER:
            return None
        return max(0, seconds * _NANO + (fraction * _NANO >> 32))

    def guid(self) -> bytes:
        """Return the value as a GUID."""
        if len(self.value) < 16:
            raise ValueError("a GUID is too short")
        return self.value[:16]

    def address(self) -> UdpAddress | None:
        """Return the value as the address of a UDP socket. None is another transport, for example shared memory."""
        if len(self.value) < 24:
            raise ValueError("a locator is too short")
        kind, port = self._unpack("iI")
        if kind != _UDP_V4 or not 0 < port <= 0xFFFF:
            return None
        return UdpAddress(host_text(self.value[20:24]), port)

    def _unpack(self, form: str) -> tuple[int, ...]:
        try:
            return struct.unpack_from(self.order + form, self.value)
        except struct.error:
            raise ValueError("a parameter is too short") from None


def host_text(address: bytes) -> str:
    """Return the text of an IPv4 address, for example "127.0.0.1"."""
    return ".".join(map(str, address))


def numbers(*values: int) -> bytes:
    """Return the bytes of numbers of 4 bytes."""
    return struct.pack(f"<{len(values)}I", *values)


def string(value: str) -> bytes:
    """Return the bytes of a string."""
    data = value.encode() + b"\x00"
    return numbers(len(data)) + data


def octets(value: bytes) -> bytes:
    """Return the bytes of a sequence of bytes."""
    return numbers(len(value)) + value


def duration(ns: int | None) -> bytes:
    """Return the bytes of a duration in nanoseconds. None is infinite."""
    if ns is None:
        return numbers(_FOREVER, 0xFFFFFFFF)
    return numbers(ns // _NANO, -(-((ns % _NANO) << 32) // _NANO))


def locator(address: UdpAddress) -> bytes:
    """Return the bytes of the address of a UDP socket."""
    host = bytes(map(int, address.host.split(".")))
    return numbers(_UDP_V4, address.port) + bytes(12) + host


def encode_inline(parameters: Iterable[tuple[int, bytes]]) -> bytes:
    """Return the bytes of a list, as they are inside of a data submessage."""
    parts = []
    for pid, value in parameters:
        padded = value + bytes(-len(value) % 4)
        parts.append(struct.pack("<HH", pid, len(padded)) + padded)
    parts.append(struct.pack("<HH", _SENTINEL, 0))
    return b"".join(parts)


def encode_payload(parameters: Iterable[tuple[int, bytes]]) -> bytes:
    """Return the bytes of a list as the payload of a data submessage."""
    return _LIST_LITTLE + b"\x00\x00" + encode_inline(parameters)


def decode_payload(payload: bytes) -> Iterator[Parameter]:
    """Yield the parameters of a payload.

    Raises:
        ValueError: the payload is no list of parameters.
    """
    kind = payload[:2]
    if kind not in {_LIST_LITTLE, _LIST_BIG} or len(payload) < 4:
        raise ValueError("the payload is no list of parameters")
    yield from decode_list(payload[4:], "<" if kind == _LIST_LITTLE else ">")[0]


def decode_list(data: bytes, order: str) -> tuple[list[Parameter], int]:
    """Return the parameters of a list, and the number of its bytes.

    Args:
        data: bytes that begin with the list.
        order: byte order, "<" or ">".

    Raises:
        ValueError: the list is incomplete or too long.
    """
    found: list[Parameter] = []
    at = 0
    header = struct.Struct(order + "HH")
    while at + 4 <= len(data):
        pid, size = header.unpack_from(data, at)
        at += 4
        if pid == _SENTINEL:
            return found, at
        if at + size > len(data):
            break
        if len(found) == MOST_PARAMETERS:
            raise ValueError("a list has too many parameters")
        found.append(Parameter(pid, data[at : at + size], order))
        at += size + (-size % 4)
    raise ValueError("a list of parameters is incomplete")
