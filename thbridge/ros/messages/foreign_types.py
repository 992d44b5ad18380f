"""Message types that bags of other programs define. They are parsed within limits.

A definition of some kilobytes can describe billions of fields, and rosbags creates classes from what it parses.
"""

import math
import re
from collections.abc import Mapping

from rosbags.interfaces.typing import Typesdict
from rosbags.typesys import Stores, TypesysError, get_types_from_msg, get_typestore
from rosbags.typesys.msg import normalize_msgtype
from rosbags.typesys.store import Typestore

LONGEST_TEXT = 1 << 20
"""Maximum length of a definition in characters, including comments and the types within it."""
MOST_LINES = 10_000
"""Maximum number of lines of a definition."""
MOST_FIELDS = 10_000
"""Maximum number of fields of a type. Fields of types within it count at each occurrence."""
DEEPEST_TYPE = 32
"""Maximum depth of nested types."""
LARGEST_MESSAGE = 1 << 26
"""Maximum total size in bytes of the arrays of fixed length in a message."""

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,127}(/msg|/action)?/[A-Za-z][A-Za-z0-9_]{0,127}")
_TIMES = {"builtin_interfaces/msg/Time": 8, "builtin_interfaces/msg/Duration": 8}
_SIZES = {
    "bool": 1, "byte": 1, "char": 1, "int8": 1, "uint8": 1, "int16": 2, "uint16": 2, "int32": 4, "uint32": 4,
    "int64": 8, "uint64": 8, "float32": 4, "float64": 8, "string": 4,
}  # fmt: skip
_STUMBLES = (TypesysError, ValueError, LookupError, AssertionError, RecursionError)
"""Errors that rosbags' parser raises for texts that are not definitions."""


def check_type_name(msgtype: str) -> None:
    """Raise ValueError unless this is a valid name of a message type: a package, a slash, and a word."""
    if _NAME.fullmatch(msgtype) is None:
        raise ValueError(f"{msgtype[:80]!r} is not the name of a type")


def types_in(msgtype: str, text: str) -> Typesdict:
    """Return the types that a full definition defines, by rosbags' names.

    Args:
        msgtype: for example "nav_msgs/Odometry".
        text: the full text, as in bags.

    Raises:
        ValueError: the name or the text is invalid, or beyond the limits above. The message is a clause.
    """
    check_type_name(msgtype)
    if len(text) > LONGEST_TEXT:
        raise ValueError(f"its definition has more than {LONGEST_TEXT} characters")
    if text.count("\n") > MOST_LINES:
        raise ValueError(f"its definition has more than {MOST_LINES} lines")
    try:
        types = get_types_from_msg(text, normalize_msgtype(msgtype))
    except _STUMBLES:
        raise ValueError("its definition cannot be parsed") from None
    for name, (constants, _) in types.items():
        check_type_name(name)
        if any(isinstance(value, float) and not math.isfinite(value) for _, _, value in constants):
            raise ValueError("its definition has a constant that is not finite")
    _check_size(types, normalize_msgtype(msgtype))
    return types


def store_of(types: Typesdict) -> Typestore:
    """Return a store with only these types. Raises ValueError if the names of their fields collide."""
    store = get_typestore(Stores.EMPTY)
    register(store, types)
    return store


def register(store: Typestore, types: Typesdict) -> None:
    """Add types to a store.

    Raises ValueError if it has other types of these names, or if names of their fields collide.
    """
    try:
        store.register(types)
    except _STUMBLES:
        raise ValueError("the names in its definition collide") from None


def _check_size(types: Typesdict, name: str) -> None:
    """Raise ValueError if a type contains itself, or is too deep or too large."""
    fields: dict[str, int] = {}
    sizes: dict[str, int] = {}
    depths: dict[str, int] = {}

    def measure(name: str, above: tuple[str, ...]) -> None:
        if name in above:
            raise ValueError(f"{name.replace('/msg/', '/')} contains itself")
        if name not in types or (name in fields and depths[name] + len(above) <= DEEPEST_TYPE):
            return
        described = [each for _, each in types[name][1]]
        within = {inner for each in described if (inner := _named(each)) is not None}
        if len(above) < DEEPEST_TYPE:
            for inner in sorted(within):
                measure(inner, (*above, name))
        depths[name] = 1 + max((depths.get(inner, 0) for inner in within), default=0)
        if depths[name] + len(above) > DEEPEST_TYPE:
            raise ValueError(f"its definition nests types more than {DEEPEST_TYPE} levels deep")
        fields[name] = sum(fields.get(_named(each) or "", 1) or 1 for each in described)  # of integers
        sizes[name] = sum(_size(each, sizes) for each in described)  # of integers
        if fields[name] > MOST_FIELDS:
            raise ValueError(f"it has more than {MOST_FIELDS} fields")
        if sizes[name] > LARGEST_MESSAGE:
            raise ValueError(f"its arrays of fixed length make every message larger than {LARGEST_MESSAGE} bytes")

    measure(name, ())
    for other in types:
        measure(other, ())


def _named(described: object) -> str | None:
    """Return the message type of a field or of an array's elements. Return None for a built-in type."""
    match described:
        case (2, str(name)):
            return name
        case (3 | 4, (element, _)):
            return _named(element)
    return None


def _size(described: object, sizes: Mapping[str, int]) -> int:
    """Return the minimum size of a field in bytes. A message without fields counts as 1, because it takes time."""
    match described:
        case (1, (str(base), _)):
            return _SIZES.get(base, 1)
        case (2, str(name)):
            return _TIMES.get(name) or sizes.get(name) or 1
        case (3, (element, int(count))):
            return count * _size(element, sizes)
    return 4
