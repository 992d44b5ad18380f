"""How a message lies in its bytes, worked out from its definition: runs of fixed size, texts, and arrays of any length.

A run is copied whole and read by numpy afterwards, so that the cost of a message does not grow with its fields.

Source: ROS wiki, msg (serialization: little-endian, arrays of variable length and strings behind a uint32 of their
length).
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias, cast

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.typesys import TypesysError, get_types_from_msg
from rosbags.typesys.msg import denormalize_msgtype, normalize_msgtype

TIME = "time"
DURATION = "duration"
TEXT = "string"
BYTES = "bytes"

Array: TypeAlias = "np.ndarray[tuple[int, ...], np.dtype[np.generic[object]]]"
"""Numbers of whatever size."""

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
"""ROS's numbers as numpy has them."""

_MOMENTS = {"builtin_interfaces/msg/Time": TIME, "builtin_interfaces/msg/Duration": DURATION}
_MOMENT_DTYPES = {
    TIME: np.dtype([("sec", "<u4"), ("nsec", "<u4")]),
    DURATION: np.dtype([("sec", "<i4"), ("nsec", "<i4")]),
}
_LINE = "=" * 80 + "\n"
_SEPARATOR = re.compile(r"^={80}\n", re.MULTILINE)
_DEEPEST = 40
"""Messages within messages; a definition that contains itself has no end."""


@dataclass(frozen=True, slots=True)
class FieldStep:
    """One field on the way down to a value: the type that has it, and its name."""

    msgtype: str
    field: str


Path = tuple[FieldStep, ...]


@dataclass(frozen=True, slots=True)
class FixedValue:
    """A value of fixed size.

    Attributes:
        path: from the record down to it.
        kind: "float64", "time", ...
        count: how many of them, None for a single one.
    """

    path: Path
    kind: str
    count: int | None


@dataclass(frozen=True, slots=True)
class FixedBlock:
    """Values of fixed size, one behind the other.

    Attributes:
        leaves: what they are.
        dtype: their numpy structure; field i is leaf i.
    """

    leaves: tuple[FixedValue, ...]
    dtype: "np.dtype[np.void]"


@dataclass(frozen=True, slots=True)
class StringField:
    """A string."""

    path: Path


@dataclass(frozen=True, slots=True)
class NumberArray:
    """An array of numbers, of any length; `kind` uint8 is bytes."""

    path: Path
    kind: str


@dataclass(frozen=True, slots=True)
class StringArray:
    """An array of strings; `count` is its length, None when each message says it."""

    path: Path
    count: int | None


@dataclass(frozen=True, slots=True)
class MessageArray:
    """An array of messages; `count` is its length, None when each message says it."""

    path: Path
    count: int | None
    record: "MessageLayout"


LayoutPart = FixedBlock | StringField | NumberArray | StringArray | MessageArray


@dataclass(frozen=True, slots=True)
class MessageLayout:
    """A message's parts in the order of their bytes; those of messages within it are among them.

    Attributes:
        msgtype: for example "nav_msgs/Odometry".
        parts: in order.
    """

    msgtype: str
    parts: tuple[LayoutPart, ...]

    def items(self) -> tuple[MessageArray, ...]:
        """Its arrays of messages."""
        return tuple(part for part in self.parts if isinstance(part, MessageArray))


def layout_of(msgtype: str, definition: str) -> MessageLayout:
    """The layout of a type.

    Args:
        msgtype: for example "nav_msgs/Odometry".
        definition: the full text, as bags carry it.

    Raises:
        ValueError: the text cannot be read, lacks a type, or has one that contains itself.
    """
    full, empty = _without_empty_types(msgtype, definition)
    try:
        types = get_types_from_msg(full, normalize_msgtype(msgtype)) if full else {}
    except TypesysError as error:
        raise ValueError(f"the definition of {msgtype} cannot be read: {error}") from None
    compiler = _Compiler({**types, **{normalize_msgtype(name): ((), ()) for name in empty}})
    compiler.add(normalize_msgtype(msgtype), ())
    return MessageLayout(msgtype, compiler.parts())


def _without_empty_types(msgtype: str, definition: str) -> tuple[str, list[str]]:
    """The definition without types that have no fields, which rosbags' parser does not take, and their names."""
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


# rosbags' tree of a field: a kind, then what it is made of.
_Field = tuple[str, tuple[Nodetype, object]]


class _Compiler:
    """Puts the parts of one record together."""

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
                within._named(element_type, path)  # has no fields to be named after
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
    """The name of a plain type; rosbags keeps a bound of its length beside it."""
    name = node[0] if isinstance(node, tuple) else node
    return str(name)


def _dtype(leaves: Sequence[FixedValue]) -> "np.dtype[np.void]":
    fields = []
    for index, leaf in enumerate(leaves):
        single = _MOMENT_DTYPES.get(leaf.kind) or np.dtype(DTYPES[leaf.kind])
        fields.append((str(index), single if leaf.count is None else np.dtype((single, (leaf.count,)))))
    return np.dtype(fields)
