"""Copies of messages from ROS 1's serialization to CDR and back, without decoding them.

Most messages of a topic have the same shape: their strings and arrays have the same lengths. The first message of a
shape gives a plan, which lists the slices of the input and the constant bytes between them. Later messages of the shape
need one join of these slices. So bytes of strings and numbers are copied unchanged, including NaN and invalid UTF-8.

Source: wiki.ros.org/msg (ROS 1's serialization); DDS-XTypes 1.3, 7.4 (CDR version 1, plain, little-endian).
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import starmap
from operator import itemgetter
from struct import Struct
from typing import TypeAlias, cast

from rosbags.interfaces.typing import Typesdict

from thbridge.ros2.copied_fields import (
    CopiedArray,
    CopiedBlock,
    CopiedField,
    CopiedLevel,
    CopiedStructure,
    CopiedText,
    copied_field,
)

CDR_HEAD = b"\x00\x01\x00\x00"
"""First bytes of a message in CDR: plain, little-endian, no options."""
MOST_PLANS = 64
"""Plans that are kept for one type."""
LONGEST_PLAN = 2000
"""Slices of the longest plan that is kept. A path of 500 poses needs about this number."""

_U32 = Struct("<I")

_Span: TypeAlias = tuple[int, int]
"""Start and end of bytes in a message."""
_Place: TypeAlias = "_Span | int | list[_Place] | None"
"""Place of a field in a message, the value of a level, or None for a field that the source does not have."""


class MessageCopy:
    """Function that copies messages of one type from one serialization to the other.

    Fields with equal names correspond, also if only upper and lower case differ. Fields that only the target has are 0
    or empty. Fields that only the source has are omitted.

    Args:
        source: types of the source.
        source_type: for example "nav_msgs/msg/Odometry".
        target: types of the target.
        target_type: name of the same type there.
        to_cdr: True for messages of ROS 1 that become CDR; False for the other direction.

    Raises:
        ValueError: fields with equal names have different types, or a type is not supported.
        KeyError: a type is not defined.
    """

    def __init__(self, source: Typesdict, source_type: str, target: Typesdict, target_type: str, to_cdr: bool) -> None:
        self._to_cdr = to_cdr
        self._plans: dict[int, list[_Plan]] = {}
        self._kept = 0
        self._field = copied_field(source, source_type, target, target_type, to_cdr=to_cdr)

    def __call__(self, data: bytes) -> bytes:
        """Return the message in the other serialization. Raises ValueError: it does not fit its type."""
        for plan in self._plans.get(len(data), ()):
            if plan.lengths(data) == plan.expected:
                pieces = plan.pieces.copy()
                pieces[1::2] = plan.slices(data)
                return b"".join(pieces)
        return self._copied(data)

    def _copied(self, data: bytes) -> bytes:
        """Copy a message, and keep its plan."""
        reader = _Reader(data, not self._to_cdr)
        value = reader.read(self._field)
        reader.finish()
        writer = _Writer(self._to_cdr)
        writer.write(self._field, value)
        plan = _Plan.of(reader.lengths, writer)
        if len(plan.pieces) <= LONGEST_PLAN:
            if self._kept == MOST_PLANS:
                self._plans.clear()
                self._kept = 0
            self._kept += 1
            self._plans.setdefault(len(data), []).append(plan)
        pieces = plan.pieces.copy()
        pieces[1::2] = plan.slices(data)
        return b"".join(pieces)


@dataclass(frozen=True, slots=True)
class _Plan:
    """Plan for messages of one shape.

    Attributes:
        lengths: function that returns the lengths in a message.
        expected: the lengths of this shape.
        slices: function that returns the copied slices of a message.
        pieces: constant bytes and, at odd places, room for the slices.
    """

    lengths: Callable[[bytes], tuple[bytes, ...]]
    expected: tuple[bytes, ...]
    slices: Callable[[bytes], tuple[bytes, ...]]
    pieces: list[bytes]

    @classmethod
    def of(cls, lengths: list[tuple[_Span, bytes]], writer: "_Writer") -> "_Plan":
        pieces = [b""] * 5
        for constant in writer.constants[:-1]:
            pieces[-1] = bytes(constant)
            pieces += [b"", b""]
        pieces[-1] = bytes(writer.constants[-1])
        expected = (b"", b"", *(known for _, known in lengths))
        return cls(_picker(place for place, _ in lengths), expected, _picker(writer.spans), pieces)


def _picker(spans: Iterable[_Span]) -> Callable[[bytes], tuple[bytes, ...]]:
    """Return a function that returns two empty slices of its argument, and the slices of these spans.

    With the two empty slices, the result is always a tuple.
    """
    return itemgetter(slice(0, 0), slice(0, 0), *starmap(slice, spans))


class _Reader:
    """Reader that finds the places of a message's fields.

    Attributes:
        lengths: the places and values of all lengths so far.
    """

    def __init__(self, data: bytes, is_cdr: bool) -> None:
        self._data, self._is_cdr = data, is_cdr
        self._at = self._origin = 0
        self.lengths: list[tuple[_Span, bytes]] = []
        if is_cdr:
            if data[:2] != CDR_HEAD[:2]:
                raise ValueError("the message is not plain CDR in little-endian order")
            self._at = self._origin = len(CDR_HEAD)

    def read(self, field: CopiedField) -> _Place:
        """Return the place of a field; for structures and arrays of other than blocks, a list of places."""
        match field:
            case CopiedBlock(size, align):
                return self._take(size, align)
            case CopiedText():
                size = self._length()
                start, end = self._take(size, 1)
                if self._is_cdr:
                    if not size or self._data[end - 1]:
                        raise ValueError("a string does not end with a zero")
                    self.lengths.append(((end - 1, end), b"\x00"))
                    end -= 1
                return start, end
            case CopiedLevel():
                start, end = self._take(1, 1)
                self.lengths.append(((start, end), self._data[start:end]))
                return self._data[start]
            case CopiedArray(element, count):
                count = self._length() if count is None else count
                if isinstance(element, CopiedBlock):
                    return self._take(count * element.size, element.align) if count else (0, 0)
                if count > len(self._data) - self._at:
                    raise ValueError("an array is longer than its message")
                return [self.read(element) for _ in range(count)]
            case CopiedStructure(source, _):
                return [self.read(each) for each in source]

    def finish(self) -> None:
        """Check that the message ends here. CDR may be padded to a multiple of 4."""
        left = len(self._data) - self._at
        if left > (3 if self._is_cdr else 0):
            raise ValueError(f"{left} bytes follow the last field")

    def _take(self, size: int, align: int) -> tuple[int, int]:
        if self._is_cdr:
            self._at += -(self._at - self._origin) % align
        start, self._at = self._at, self._at + size
        if self._at > len(self._data):
            raise ValueError("the message ends too early")
        return start, self._at

    def _length(self) -> int:
        start, end = self._take(4, 4)
        self.lengths.append(((start, end), self._data[start:end]))
        return int(_U32.unpack_from(self._data, start)[0])


class _Writer:
    """Writer that lists the pieces of the copied message.

    Attributes:
        constants: constant bytes before, between and after the spans.
        spans: start and end of each copied part of the source.
    """

    def __init__(self, is_cdr: bool) -> None:
        self._is_cdr = is_cdr
        self.constants = [bytearray(CDR_HEAD if is_cdr else b"")]
        self.spans: list[tuple[int, int]] = []
        self._size = 0

    def write(self, field: CopiedField, place: _Place) -> None:
        """Write a field from its place in the source."""
        match field:
            case CopiedBlock(size, align):
                self._copy(cast(_Span | None, place), size, align)
            case CopiedText():
                start, end = cast(_Span, place or (0, 0))
                self._constant(_U32.pack(end - start + self._is_cdr), 4)
                self._copy((start, end), end - start, 1)
                if self._is_cdr:
                    self._constant(b"\x00", 1)
            case CopiedLevel(levels):
                level = cast(int, place or 0)
                self._constant(bytes((levels.get(level, level),)), 1)
            case CopiedArray(CopiedBlock(size, align), fixed):
                start, end = cast(_Span, place or (0, size * (fixed or 0)))
                if fixed is None:
                    self._constant(_U32.pack((end - start) // size), 4)
                if start < end:
                    self._copy((start, end) if place else None, end - start, align)
            case CopiedArray(element, fixed):
                places = cast(list[_Place], place or [None] * (fixed or 0))
                if fixed is None:
                    self._constant(_U32.pack(len(places)), 4)
                for each in places:
                    self.write(element, each)
            case CopiedStructure(_, target):
                for part, source in target:
                    self.write(part, None if place is None or source < 0 else cast(list[_Place], place)[source])

    def _copy(self, span: tuple[int, int] | None, size: int, align: int) -> None:
        if span is None:
            self._constant(bytes(size), align)
            return
        self._align(align)
        self._size += size
        if self.spans and not self.constants[-1] and self.spans[-1][1] == span[0]:
            self.spans[-1] = self.spans[-1][0], span[1]
        elif size:
            self.spans.append(span)
            self.constants.append(bytearray())

    def _constant(self, data: bytes, align: int) -> None:
        self._align(align)
        self._size += len(data)
        self.constants[-1] += data

    def _align(self, align: int) -> None:
        if self._is_cdr:
            padding = -self._size % align
            self._size += padding
            self.constants[-1] += bytes(padding)
