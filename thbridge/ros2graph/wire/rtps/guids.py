"""Ids of participants and their endpoints. A GUID has 16 bytes: 12 for the participant, and 4 for the endpoint.

Source: DDSI-RTPS 2.3, sections 9.3.1 and 8.5.4.
"""

from typing import TypeAlias

Guid: TypeAlias = bytes
"""Prefix of the participant (12 bytes) and id of the entity (4 bytes)."""

PREFIX_SIZE = 12
UNKNOWN_PREFIX = bytes(PREFIX_SIZE)

UNKNOWN = bytes(4)
"""Id for "all matched endpoints of the participant"."""
PARTICIPANT = b"\x00\x00\x01\xc1"
SPDP_WRITER = b"\x00\x01\x00\xc2"
SPDP_READER = b"\x00\x01\x00\xc7"
PUBLICATIONS_WRITER = b"\x00\x00\x03\xc2"
PUBLICATIONS_READER = b"\x00\x00\x03\xc7"
SUBSCRIPTIONS_WRITER = b"\x00\x00\x04\xc2"
SUBSCRIPTIONS_READER = b"\x00\x00\x04\xc7"

_WRITER_KIND, _READER_KIND = 0x03, 0x04
"""Kinds of endpoints of topics without keys. All topics of ROS are such topics."""
_WRITERS, _READERS = {0x02, 0x03, 0xC2, 0xC3}, {0x04, 0x07, 0xC4, 0xC7}


def writer_id(number: int) -> bytes:
    """Return the id of a program's writer, by its number from 1."""
    return number.to_bytes(3, "big") + bytes([_WRITER_KIND])


def reader_id(number: int) -> bytes:
    """Return the id of a program's reader, by its number from 1."""
    return number.to_bytes(3, "big") + bytes([_READER_KIND])


def is_writer(guid: Guid) -> bool:
    """Return True if the endpoint is a writer."""
    return guid[-1] in _WRITERS


def is_reader(guid: Guid) -> bool:
    """Return True if the endpoint is a reader."""
    return guid[-1] in _READERS
