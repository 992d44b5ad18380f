"""Fields in which two messages of the same type differ."""

import struct
from collections.abc import Iterator
from dataclasses import dataclass, fields, is_dataclass
from itertools import islice, zip_longest

import numpy as np
from rosbags.serde.errors import SerdeError
from rosbags.typesys.msg import normalize_msgtype

from thbridge.ros.messages.types import typestore

MOST = 20
"""Maximum number of differing fields that are reported for a message."""
_BEFORE, _EXCERPT = 12, 40
"""Length of excerpts of long texts: number of characters before the first difference, and total number."""


@dataclass(frozen=True, slots=True)
class FieldDifference:
    """Field in which two messages differ.

    Attributes:
        field: path of the field, for example "pose.pose.position.x" or "ranges[17]".
        was: its value in the first message, as text. "nothing" means that the list is shorter.
        now: its value in the other message, as text.
    """

    field: str
    was: str
    now: str


def differences(msgtype: str, was: bytes, now: bytes) -> tuple[FieldDifference, ...]:
    """Return the first fields that differ, at most `MOST`, in the order of the type's definition.

    Args:
        msgtype: a type that sessions publish, for example "nav_msgs/Odometry".
        was: the first message.
        now: the other message.

    Raises:
        ValueError: one of the messages cannot be read as a message of this type.
    """
    store, name = typestore(), normalize_msgtype(msgtype)
    try:
        before, after = (store.deserialize_ros1(data, name) for data in (was, now))
    except (SerdeError, UnicodeDecodeError, struct.error) as error:
        raise ValueError(f"it cannot be read as a {msgtype}: {error}") from None
    return tuple(islice(_between("", before, after), MOST))


def _between(path: str, was: object, now: object) -> Iterator[FieldDifference]:
    if isinstance(was, (list, np.ndarray)) and isinstance(now, (list, np.ndarray)):
        for index, (before, after) in enumerate(zip_longest(was, now)):
            yield from _between(f"{path}[{index}]", before, after)
    elif is_dataclass(was) and is_dataclass(now):
        for field in fields(was):
            if not field.name.startswith("__"):
                inner = f"{path}.{field.name}" if path else field.name
                yield from _between(inner, getattr(was, field.name), getattr(now, field.name))
    elif isinstance(was, str) and isinstance(now, str) and was != now:
        same = next(
            (index for index, pair in enumerate(zip(was, now, strict=False)) if len(set(pair)) > 1),
            min(len(was), len(now)),
        )
        start = max(same - _BEFORE, 0)
        yield FieldDifference(path, *(repr(text[start : start + _EXCERPT]) for text in (was, now)))
    elif _text(was) != _text(now):
        yield FieldDifference(path, _text(was), _text(now))


def _text(value: object) -> str:
    """Return a value as text with all digits. So values that differ by one bit have different texts."""
    if value is None:
        return "nothing"
    return repr(value.item()) if isinstance(value, np.generic) else repr(value)
