"""Reader of the values that rules check, for messages of any type, using the definition in the bag.

Only headers, frames, quaternions and similar values are decoded. All other data are skipped, so that a million messages
take a few seconds.
"""

import math
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from struct import Struct
from typing import Protocol

import numpy as np
from rosbags.typesys.msg import normalize_msgtype

from sim.numerics.float_array import FloatArray
from thbridge.ros.messages.foreign_types import store_of, types_in

Quaternion = tuple[float, float, float, float]
"""x, y, z, w."""

_SIZES = {
    "bool": 1, "byte": 1, "char": 1, "int8": 1, "uint8": 1, "int16": 2, "uint16": 2, "int32": 4, "uint32": 4,
    "int64": 8, "uint64": 8, "float32": 4, "float64": 8,
}  # fmt: skip
_FORMS = {
    "int8": "<b", "uint8": "<B", "int16": "<h", "uint16": "<H", "int32": "<i", "uint32": "<I",
    "int64": "<q", "uint64": "<Q", "float32": "<f", "float64": "<d",
}  # fmt: skip
_TIMES = ("builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration")
_HEADER = "std_msgs/msg/Header"
_QUATERNION = "geometry_msgs/msg/Quaternion"
_VECTORS = ("geometry_msgs/msg/Point", "geometry_msgs/msg/Vector3")
_COUNT = Struct("<I")
_HEAD = Struct("<IIII")
_THREE = Struct("<3d")
_FOUR = Struct("<4d")

LEAST = ":least"
"""Suffix of the name that requests the least element of an array."""

Fields = Mapping[str, Sequence[tuple[str, object]]]
"""Fields of each type, with rosbags' names of types and rosbags' description of each field's type."""


class UnreadableMessage(ValueError):  # noqa: N818 - the name describes the fault of a message
    """The bytes are not a message of the type; the text gives the reason as a clause."""


@dataclass(slots=True)
class Reading:
    """Values that rules check in one message.

    Attributes:
        headers: stamp in nanoseconds and frame of every std_msgs/Header, outermost first.
        children: fields `child_frame_id`, in the message's order.
        quaternions: all quaternions; in an array, only the quaternion whose length differs most from 1.
        finite: True if all points and vectors are finite.
        covariances: for each field `covariance`, True if it is not all zero.
        numbers: requested numbers, by dotted name; for arrays the length, and with `LEAST` the least finite element.
        longest: length of the longest array.
    """

    headers: list[tuple[int, str]] = field(default_factory=list)
    children: list[str] = field(default_factory=list)
    quaternions: list[Quaternion] = field(default_factory=list)
    finite: bool = True
    covariances: list[bool] = field(default_factory=list)
    numbers: dict[str, float] = field(default_factory=dict)
    longest: int = 0


class _Step(Protocol):
    """Function that reads or skips fields, from the offset of the first field. It returns the offset after the last."""

    def __call__(self, data: bytes, at: int, into: Reading) -> int: ...


class MessageReader:
    """Reader of messages of one type.

    Args:
        msgtype: for example "nav_msgs/Odometry".
        text: full definition of the type.
        numbers: dotted names of the numbers and arrays to read.

    Raises:
        ValueError: the text cannot be parsed, or lacks a type that it names.
    """

    def __init__(self, msgtype: str, text: str, numbers: Sequence[str] = ()) -> None:
        name = normalize_msgtype(msgtype)
        self._types = fields_of(msgtype, text)
        self._numbers = frozenset(numbers)
        self._steps = self._message(name, "", ())

    def read(self, data: bytes) -> Reading:
        """Read a message. Raise UnreadableMessage if the bytes are too few or too many for the type."""
        into = Reading()
        at = 0
        try:
            for step in self._steps:
                at = step(data, at, into)
        except struct.error:
            raise UnreadableMessage("it ends too early") from None
        if at != len(data):
            raise UnreadableMessage("it ends too early" if at > len(data) else f"{len(data) - at} bytes are left over")
        return into

    def _message(self, name: str, path: str, above: tuple[str, ...]) -> list[_Step]:
        if name in _TIMES:
            return [_Skip(8)]
        if name == _HEADER and [field_name for field_name, _ in self._types[name]] == ["seq", "stamp", "frame_id"]:
            return [_read_header]
        if name in above:
            raise ValueError(f"{name} contains itself")
        if name == _QUATERNION:
            return [_read_quaternion]
        # A magnetic field or an acceleration that was not measured may be NaN; a position must not.
        if name in _VECTORS and not any(outer.startswith("sensor_msgs/") for outer in above):
            return [_read_vector]
        steps: list[_Step] = []
        for field_name, described in self._types[name]:
            for step in self._field(field_name, described, f"{path}{field_name}", (*above, name)):
                if steps and isinstance(step, _Skip) and isinstance(steps[-1], _Skip):
                    steps[-1] = _Skip(steps[-1].size + step.size)
                else:
                    steps.append(step)
        return steps

    def _field(self, name: str, described: object, path: str, above: tuple[str, ...]) -> list[_Step]:
        match described:
            case (1, ("string", _)):
                return [_read_child if name == "child_frame_id" else _read_string]
            case (1, (str(base), _)):
                if base not in _SIZES:
                    raise ValueError(f"ROS 1 has no {base}")
                if path in self._numbers and base in _FORMS:
                    return [_Number(path, Struct(_FORMS[base]))]
                return [_Skip(_SIZES[base])]
            case (2, str(inner)):
                return self._message(inner, f"{path}.", above)
            case (3, (element, int(count))):
                if name == "covariance" and element == (1, ("float64", 0)):
                    return [_Covariance(8 * count)]
                return [self._array(element, count, path, above)]
            case (4, (element, _)):
                return [self._array(element, None, path, above)]
        raise ValueError(f"{path} has an unknown kind")

    def _array(self, element: object, count: int | None, path: str, above: tuple[str, ...]) -> _Step:
        steps = self._field("", element, f"{path}[]", above)
        asked = path if path in self._numbers else None
        if path + LEAST in self._numbers and element == (1, ("float32", 0)):
            return _Least(4, count, asked, path + LEAST)
        if all(isinstance(step, _Skip) for step in steps):
            return _Block(sum(step.size for step in steps if isinstance(step, _Skip)), count, asked)
        if (places := _places(steps)) is not None:
            return _Records(*places, count, asked)
        return _Loop(tuple(steps), count, asked)


def fields_of(msgtype: str, text: str) -> Fields:
    """Return the fields of a type and of all types within it.

    Raises:
        ValueError: the text cannot be parsed, or lacks a type that it names.
    """
    types = types_in(msgtype, text)
    store_of(types)  # this call also checks the names
    fields: dict[str, Sequence[tuple[str, object]]] = {name: described for name, (_, described) in types.items()}
    missing = missing_types(fields)
    if missing:
        raise ValueError(f"the definition lacks {', '.join(missing)}")
    return fields


def missing_types(fields: Fields) -> list[str]:
    """Return the types that are used but not defined, with ROS 1 names."""
    named = (_inner(described) for members in fields.values() for _, described in members)
    lacking = {name for name in named if name is not None and name not in fields and name not in _TIMES}
    return sorted(name.replace("/msg/", "/") for name in lacking)


def _inner(described: object) -> str | None:
    match described:
        case (2, str(name)):
            return name
        case (3 | 4, (element, _)):
            return _inner(element)
    return None


@dataclass(frozen=True, slots=True)
class _Skip:
    size: int

    def __call__(self, data: bytes, at: int, into: Reading) -> int:
        return at + self.size


def _read_header(data: bytes, at: int, into: Reading) -> int:
    _, seconds, nanoseconds, length = _HEAD.unpack_from(data, at)
    end = at + 16 + length
    into.headers.append((seconds * 1_000_000_000 + nanoseconds, data[at + 16 : end].decode(errors="replace")))
    return int(end)


def _read_string(data: bytes, at: int, into: Reading) -> int:
    return at + 4 + int(_COUNT.unpack_from(data, at)[0])


def _read_child(data: bytes, at: int, into: Reading) -> int:
    end = _read_string(data, at, into)
    into.children.append(data[at + 4 : end].decode(errors="replace"))
    return end


def _read_quaternion(data: bytes, at: int, into: Reading) -> int:
    into.quaternions.append(_FOUR.unpack_from(data, at))
    return at + 32


def _read_vector(data: bytes, at: int, into: Reading) -> int:
    x, y, z = _THREE.unpack_from(data, at)
    if not math.isfinite(x + y + z):
        into.finite = False
    return at + 24


@dataclass(frozen=True, slots=True)
class _Covariance:
    size: int

    def __call__(self, data: bytes, at: int, into: Reading) -> int:
        end = at + self.size
        # A covariance that was not filled in consists of zero bytes.
        into.covariances.append(any(data[at:end]))
        return end


@dataclass(frozen=True, slots=True)
class _Number:
    name: str
    form: Struct

    def __call__(self, data: bytes, at: int, into: Reading) -> int:
        (into.numbers[self.name],) = self.form.unpack_from(data, at)
        return at + self.form.size


def _counted(data: bytes, at: int, count: int | None, asked: str | None, into: Reading) -> tuple[int, int]:
    """Return the length of an array, and the offset of its elements; store the length in the reading."""
    if count is None:
        (count,) = _COUNT.unpack_from(data, at)
        at += 4
    if asked is not None:
        into.numbers[asked] = count
    into.longest = max(into.longest, count)
    return count, at


@dataclass(frozen=True, slots=True)
class _Block:
    """Array of elements of one size, which is skipped."""

    size: int
    count: int | None
    asked: str | None

    def __call__(self, data: bytes, at: int, into: Reading) -> int:
        count, at = _counted(data, at, self.count, self.asked, into)
        return at + count * self.size


@dataclass(frozen=True, slots=True)
class _Least:
    """Array of float32; only its least finite element is read."""

    size: int
    count: int | None
    asked: str | None
    name: str

    def __call__(self, data: bytes, at: int, into: Reading) -> int:
        count, at = _counted(data, at, self.count, self.asked, into)
        end = at + count * self.size
        if end > len(data):
            raise UnreadableMessage("it ends too early")
        elements = np.frombuffer(data, dtype="<f4", count=count, offset=at)
        into.numbers[self.name] = float(np.min(elements, where=np.isfinite(elements), initial=np.inf))
        return end


@dataclass(frozen=True, slots=True)
class _Records:
    """Array of elements of one size, with vectors and quaternions at fixed offsets."""

    size: int
    vectors: tuple[int, ...]
    quaternions: tuple[int, ...]
    count: int | None
    asked: str | None

    def __call__(self, data: bytes, at: int, into: Reading) -> int:
        count, at = _counted(data, at, self.count, self.asked, into)
        end = at + count * self.size
        if end > len(data):
            raise UnreadableMessage("it ends too early")
        if count:
            for place in self.vectors:
                if not np.isfinite(self._column(data, at, place, count, 3)).all():
                    into.finite = False
            for place in self.quaternions:
                rows = self._column(data, at, place, count, 4)
                off = np.abs(np.einsum("ij,ij->i", rows, rows) - 1.0)
                x, y, z, w = rows[int(np.argmax(np.where(np.isnan(off), np.inf, off)))].tolist()
                into.quaternions.append((x, y, z, w))
        return end

    def _column(self, data: bytes, at: int, place: int, count: int, width: int) -> FloatArray:
        return np.ndarray((count, width), dtype="<f8", buffer=data, offset=at + place, strides=(self.size, 8))


def _places(steps: Sequence[_Step]) -> tuple[int, tuple[int, ...], tuple[int, ...]] | None:
    """Return the size of an element, and the offsets of its vectors and quaternions; None if its size varies."""
    at = 0
    vectors, quaternions = [], []
    for step in steps:
        if isinstance(step, _Skip):
            at += step.size
        elif step is _read_vector:
            vectors.append(at)
            at += 24
        elif step is _read_quaternion:
            quaternions.append(at)
            at += 32
        else:
            return None
    return at, tuple(vectors), tuple(quaternions)


@dataclass(frozen=True, slots=True)
class _Loop:
    """Array of elements of different sizes."""

    steps: tuple[_Step, ...]
    count: int | None
    asked: str | None

    def __call__(self, data: bytes, at: int, into: Reading) -> int:
        count, at = _counted(data, at, self.count, self.asked, into)
        # Each element has at least one byte, so an invalid count is found at once.
        if at + count > len(data):
            raise UnreadableMessage("it ends too early")
        for _ in range(count):
            for step in self.steps:
                at = step(data, at, into)
        return at
