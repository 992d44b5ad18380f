"""Definitions of types that a bag defines incompletely or not at all.

Some programs omit definitions from bags, or write a placeholder. Definitions are found by md5 sum, or by name if
messages fit them. The md5 sum is computed from all fields, so it identifies a type exactly.
"""

import re
import struct
from enum import StrEnum
from functools import cache
from typing import NamedTuple

from rosbags.serde.errors import SerdeError
from rosbags.typesys import TypesysError
from rosbags.typesys.msg import normalize_msgtype

from thbridge.ros.messages.types import Definition, md5_of, plain_definition, qualified, typestore

EMPTY_MD5 = "d41d8cd98f00b204e9800998ecf8427e"
"""Md5 sum of types without fields."""
_PART = re.compile(r"^={40,}[ \t]*\r?\nMSG:[ \t]*(\S+)[ \t]*\r?$", re.MULTILINE)
_MD5 = re.compile(r"[0-9a-f]{32}")


class DefinitionSource(StrEnum):
    """Origin of a definition."""

    BAG = "bag"
    MD5 = "md5"
    NAME = "name"


class IdentifiedType(NamedTuple):
    """Definition of a type, and origin of this definition."""

    definition: str
    source: DefinitionSource


def missing_types(msgtype: str, md5: str, text: str) -> tuple[str, ...]:
    """Return the types that a full text does not define. If the type itself has no field there, it comes first."""
    own, *others = _PART.split(text)
    parts = {msgtype: own, **dict(zip(others[::2], others[1::2], strict=True))}
    missing = [] if md5 == EMPTY_MD5 or any(_kinds(own)) else [msgtype]
    for name, part in parts.items():
        missing += (inner for kind in _kinds(part) if (inner := qualified(kind, name)) and inner not in parts)
    return tuple(dict.fromkeys(missing))


def _kinds(text: str) -> list[str]:
    """Return the types of the fields and constants in the text of one type."""
    lines = (line.partition("#")[0].split() for line in text.splitlines())
    return [words[0] for words in lines if words]


@cache
def identified(msgtype: str, md5: str, text: str) -> IdentifiedType | None:
    """Return the definition of a type from the data of its connection. Return None if these data are not enough.

    A complete text is used unchanged. Otherwise the result is the type's known definition, or the text completed by
    known definitions of missing types. It must have the md5 sum.

    Args:
        msgtype: for example "nav_msgs/Odometry".
        md5: md5 sum in the connection.
        text: definition in the connection.
    """
    missing = missing_types(msgtype, md5, text)
    if not missing:
        return IdentifiedType(text, DefinitionSource.BAG)
    known = known_definition(msgtype)
    if known is not None and known.md5 == md5:
        return IdentifiedType(known.text, DefinitionSource.MD5)
    parts = [known_definition(name) for name in missing]
    if msgtype not in missing and is_md5(md5):
        added = (f"{'=' * 80}\nMSG: {name}\n{part.text}" for name, part in zip(missing, parts, strict=True) if part)
        filled = "\n".join((text.rstrip("\n"), *added))
        if md5_of(msgtype, filled) == md5:
            return IdentifiedType(filled, DefinitionSource.MD5)
    return None


def is_md5(text: str) -> bool:
    """Return True for an md5 sum. Some programs omit it, or write "*" for any md5 sum."""
    return _MD5.fullmatch(text) is not None


@cache
def known_definition(msgtype: str) -> Definition | None:
    """Return the definition of a type of thbridge or ROS Noetic. Return None for any other type."""
    try:
        return plain_definition(msgtype)
    except KeyError:
        return None


def by_name(msgtype: str, data: bytes) -> IdentifiedType | None:
    """Return the known definition of a type by its name. If the bytes of a message do not fit it, return None."""
    known = known_definition(msgtype)
    return IdentifiedType(known.text, DefinitionSource.NAME) if known is not None and fits(msgtype, data) else None


def fits(msgtype: str, data: bytes) -> bool:
    """Return True if the bytes are exactly one message of a type of thbridge or ROS Noetic."""
    name = normalize_msgtype(msgtype)
    try:
        return bytes(typestore().serialize_ros1(typestore().deserialize_ros1(data, name), name)) == data
    except (SerdeError, TypesysError, AssertionError, LookupError, ValueError, MemoryError, struct.error):
        return False
