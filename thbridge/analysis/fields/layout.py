"""Layout of a message type, compiled from its definition: blocks of fixed size, strings, and arrays.

A block is copied as a whole, and numpy decodes it later. So the time for a message does not grow with the number of
its fields.

Source: ROS wiki, msg (serialization: little-endian; strings and arrays of variable length begin with a uint32, their
length).
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeAlias, cast

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.typesys.msg import denormalize_msgtype, normalize_msgtype

from thbridge.ros.messages.foreign_types import check_type_name, types_in

TIME = "time"
DURATION = "duration"
TEXT = "string"
BYTES = "bytes"

Array: TypeAlias = "np.ndarray[tuple[int, ...], np.dtype[np.generic[object]]]"
"""Array of numbers of any type."""

DTYPES: Mapping[str, str] = {
    "bool": "?",
    "byte": "<i1",
    "char": "<u1",
    "int8": "<i1",
    "uint8": "<u1",
    "octet": "<u1",
    "int16": "<i2",
    "uint16": "<u2",
    "int32": "<i4",
    "uint32": "<u4",
    "int64": "<i8",
    "uint64": "<u8",
    "float32": "<f4",
    "float64": "<f8",
}
"""Numpy types of ROS's number types."""

_MOMENTS = {"builtin_interfaces/msg/Time": TIME, "builtin_interfaces/msg/Duration": DURATION}
_MOMENT_DTYPES = {
    TIME: np.dtype([("sec", "<u4"), ("nsec", "<u4")]),
    DURATION: np.dtype([("sec", "<i4"), ("nsec", "<i4")]),
}
_LINE = "=" * 80 + "\n"
_SEPARATOR = re.compile(r"^={80}\n", re.MULTILINE)
_DEEPEST = 40
"""Maximum depth of nested messages; a definition that contains itself is deeper."""


@dataclass(frozen=True, slots=True)
class FieldStep:
    """Field on the path to a value: the message type that has the field, and the field's name."""

    msgtype: str
    field: str


Path = tuple[FieldStep, ...]


@dataclass(frozen=True, slots=True)
class FixedValue:
    """Number, time or array of fixed size.

    Attributes:
        path: path in the message.
        kind: "float64", "time", ...
        count: length of the array; None for a single value.
    """

    path: Path
    kind: str
    count: int | None


@dataclass(frozen=True, slots=True)
class FixedBlock:
    """Successive values of fixed size.

    Attributes:
        leaves: the values.
        dtype: structured numpy type; its field i is leaf i.
    """

    leaves: tuple[FixedValue, ...]
    dtype: "np.dtype[np.void]"


@dataclass(frozen=True, slots=True)
class StringField:
    """A string."""

    path: Path


@dataclass(frozen=True, slots=True)
class NumberArray:
    """Array of numbers with variable length; for `kind` uint8, an array of bytes."""

    path: Path
    kind: str


@dataclass(frozen=True, slots=True)
class StringArray:
    """Array of strings; `count` is its length, or None if the length is variable."""

    path: Path
    count: int | None


@dataclass(frozen=True, slots=True)
class MessageArray:
    """Array of messages; `count` is its length, or None if the length is variable."""

    path: Path
    count: int | None
    record: "MessageLayout"


LayoutPart = FixedBlock | StringField | NumberArray | StringArray | MessageArray


@dataclass(frozen=True, slots=True)
class MessageLayout:
    """Parts of a message in the order of their bytes; nested messages are flattened.

    Attributes:
        msgtype: for example "nav_msgs/Odometry".
        parts: the parts in order.
    """

    msgtype: str
    parts: tuple[LayoutPart, ...]

    def items(self) -> tuple[MessageArray, ...]:
        """Arrays of messages in the layout."""
        return tuple(part for part in self.parts if isinstance(part, MessageArray))


@lru_cache(maxsize=256)
def layout_of(msgtype: str, definition: str) -> MessageLayout:
    """Return the layout of a type.

    Args:
        msgtype: for example "nav_msgs/Odometry".
        definition: full text, as in bags.

    Raises:
        ValueError: the text cannot be parsed, lacks a type, or has a type that contains itself.
    """
    check_type_name(msgtype)
    full, empty = _without_empty_types(msgtype, definition)
    try:
        types = types_in(msgtype, full) if full else {}
    except ValueError as error:
        raise ValueError(f"{msgtype}: {error}") from None
    compiler = _Compiler({**types, **{normalize_msgtype(name): ((), ()) for name in empty}})
    compiler.add(normalize_msgtype(msgtype), ())
    return MessageLayout(msgtype, compiler.parts())


def _without_empty_types(msgtype: str, definition: str) -> tuple[str, list[str]]:
    """Return the definition without types that have no fields, which rosbags cannot parse, and their names."""
    own, *others = _SEPARATOR.split(definition)
    kept, empty = [own], []
    for part in others:
        title, _, fields = part.partition("\n")
        name = title.removeprefix("MSG:").strip()
        if _has_fields(fields):
            kept.append(part)
        else:
            empty.append(name)
    if not _has_fields(own):
        return "", [msgtype]
    return _LINE.join(kept), empty


def _has_fields(definition: str) -> bool:
    return any(line.partition("#")[0].strip() for line in definition.splitlines())


# Field description of rosbags: the kind of node, then its contents.
_Field = tuple[str, tuple[Nodetype, object]]


class _Compiler:
    """Collector of the parts of one message type."""

    def __init__(self, types: Mapping[str, tuple[object, Sequence[_Field]]]) -> None:
        self._types = types
        self._parts: list[LayoutPart] = []
        self._leaves: list[FixedValue] = []

    def parts(self) -> tuple[LayoutPart, ...]:
        self._close_run()
        return tuple(self._parts)

    def add(self, name: str, path: Path) -> None:
        if len(path) > _DEEPEST:
            raise ValueError(f"{denormalize_msgtype(name)} contains itself")
        if name not in self._types:
            raise ValueError(f"the definition of {denormalize_msgtype(name)} is missing")
        for field, (node, inner) in self._types[name][1]:
            here = (*path, FieldStep(denormalize_msgtype(name), field))
            if node is Nodetype.BASE:
                self._single(_base(inner), here)
            elif node is Nodetype.NAME:
                self._named(str(inner), here)
            else:
                self._array(inner, node is Nodetype.ARRAY, here)

    def _single(self, kind: str, path: Path) -> None:
        if kind == TEXT:
            self._append(StringField(path))
        else:
            self._leaves.append(FixedValue(path, kind, None))

    def _named(self, name: str, path: Path) -> None:
        if name in _MOMENTS:
            self._leaves.append(FixedValue(path, _MOMENTS[name], None))
        else:
            self.add(name, path)

    def _array(self, inner: object, fixed: bool, path: Path) -> None:
        (element, of), length = cast("tuple[tuple[Nodetype, object], int]", inner)
        count = length if fixed else None
        if element is Nodetype.NAME:
            element_type = str(of)
            within = _Compiler(self._types)
            if element_type in _MOMENTS:
                within._named(element_type, path)  # a time has no fields, so its array keeps its name
            else:
                within.add(element_type, ())
            self._append(MessageArray(path, count, MessageLayout(denormalize_msgtype(element_type), within.parts())))
        elif (kind := _base(of)) == TEXT:
            self._append(StringArray(path, count))
        elif count is not None:
            self._leaves.append(FixedValue(path, kind, count))
        else:
            self._append(NumberArray(path, kind))

    def _append(self, part: LayoutPart) -> None:
        self._close_run()
        self._parts.append(part)

    def _close_run(self) -> None:
        if self._leaves:
            self._parts.append(FixedBlock(tuple(self._leaves), _dtype(self._leaves)))
            self._leaves = []


def _base(node: object) -> str:
    """Return the name of a simple type; for strings, rosbags has a tuple of name and length limit."""
    name = node[0] if isinstance(node, tuple) else node
    return str(name)


def _dtype(leaves: Sequence[FixedValue]) -> "np.dtype[np.void]":
    fields = []
    for index, leaf in enumerate(leaves):
        single = _MOMENT_DTYPES.get(leaf.kind) or np.dtype(DTYPES[leaf.kind])
        fields.append((str(index), single if leaf.count is None else np.dtype((single, (leaf.count,)))))
    return np.dtype(fields)
