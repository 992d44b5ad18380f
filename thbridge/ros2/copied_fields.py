"""Fields of messages that are copied from one serialization to the other, and how they differ.

Fields with equal names correspond, also if only upper and lower case differ.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

from rosbags.interfaces.typing import FieldDesc, Typesdict

LOG_OF_ROS1, LOG_OF_ROS2 = "rosgraph_msgs/msg/Log", "rcl_interfaces/msg/Log"
_SIZES = {
    "bool": 1, "byte": 1, "char": 1, "octet": 1, "int8": 1, "uint8": 1, "int16": 2, "uint16": 2, "int32": 4,
    "uint32": 4, "float32": 4, "int64": 8, "uint64": 8, "float64": 8,
}  # fmt: skip
_SAME = {"byte": "uint8", "char": "uint8", "octet": "uint8"}
_LEVELS = {1: 10, 2: 20, 4: 30, 8: 40, 16: 50}
"""Levels of rosgraph_msgs/Log and of rcl_interfaces/Log: DEBUG, INFO, WARN, ERROR, FATAL."""


@dataclass(frozen=True, slots=True)
class CopiedBlock:
    """Bytes that are equal in both serializations: a number, or a structure of numbers without padding."""

    size: int
    align: int


@dataclass(frozen=True, slots=True)
class CopiedText:
    """String."""


@dataclass(frozen=True, slots=True)
class CopiedLevel:
    """Level of a log message, which has other numbers in ROS 2."""

    levels: Mapping[int, int]


@dataclass(frozen=True, slots=True)
class CopiedArray:
    """Array of a fixed length, or with its length before it if `count` is None."""

    element: "CopiedField"
    count: int | None


@dataclass(frozen=True, slots=True)
class CopiedStructure:
    """Structure.

    Attributes:
        source: fields of the source in their order, including fields that only the source has.
        target: fields of the target in their order. Their position in `source`, or -1 if only the target has them.
    """

    source: tuple["CopiedField", ...]
    target: tuple[tuple["CopiedField", int], ...]


CopiedField: TypeAlias = CopiedBlock | CopiedText | CopiedLevel | CopiedArray | CopiedStructure


def copied_field(
    source: Typesdict, source_type: str, target: Typesdict, target_type: str, *, to_cdr: bool
) -> CopiedField:
    """Return the structure of messages of a type; see `MessageCopy` for the arguments and exceptions."""
    source, target = (_of_ros1(source), target) if to_cdr else (source, _of_ros1(target))
    if {source_type, target_type} == {LOG_OF_ROS1, LOG_OF_ROS2}:
        return _log_field(source, target, to_cdr)
    return _structure(source, source_type, target, target_type)


def _of_ros1(types: Typesdict) -> Typesdict:
    """Return types of ROS 1 as they are sent. In rosbags, empty messages have a byte, which only ROS 2 sends."""
    return {
        name: (constants, [field for field in fields if field[0] != "structure_needs_at_least_one_member"])
        for name, (constants, fields) in types.items()
    }


def _structure(source: Typesdict, source_type: str, target: Typesdict, target_type: str) -> CopiedField:
    """Return a structure: a block if it consists of numbers without padding, the same in both."""
    ours, theirs = _fields(source, source_type), _fields(target, target_type)
    # ROS 2 spells some names in lower case: sensor_msgs/CameraInfo has the field `K` in ROS 1, and `k` in ROS 2.
    unmatched = {name.lower(): name for name in theirs if name not in ours}
    ours = {name if name in theirs else unmatched.get(name.lower(), name): kind for name, kind in ours.items()}
    numbers = {name: number for number, name in enumerate(ours)}
    both = {name: _field(source, described, target, theirs[name]) for name, described in ours.items() if name in theirs}
    if list(ours) == list(theirs):
        block = _block(tuple(both.values()))
        if block is not None:
            return block
    return CopiedStructure(
        tuple(both.get(name) or _field(source, described, source, described) for name, described in ours.items()),
        tuple(
            (both.get(name) or _field(target, described, target, described), numbers.get(name, -1))
            for name, described in theirs.items()
        ),
    )


def _fields(types: Typesdict, name: str) -> dict[str, FieldDesc]:
    return dict(types[name][1])


def _block(fields: tuple[CopiedField, ...]) -> CopiedBlock | None:
    """Return fields as one block, if they are blocks, and CDR puts no padding between or after them."""
    size, align = 0, 1
    for field in fields:
        match field:
            case CopiedBlock(length, of_field):
                pass
            case CopiedArray(CopiedBlock(of_one, of_field), count) if count:
                length = count * of_one
            case _:
                return None
        if size % of_field:
            return None
        size, align = size + length, max(align, of_field)
    return CopiedBlock(size, align) if size and not size % align else None


def _field(source: Typesdict, ours: object, target: Typesdict, theirs: object) -> CopiedField:
    """Return a field, from its descriptions in rosbags' form."""
    match ours, theirs:
        case (1, (str(one), _)), (1, (str(other), _)) if _SAME.get(one, one) == _SAME.get(other, other):
            return CopiedText() if one == "string" else CopiedBlock(_SIZES[one], _SIZES[one])
        case (2, str(one)), (2, str(other)):
            return _structure(source, one, target, other)
        case (3, (ours_in, int(count))), (3, (theirs_in, int(number))) if count == number:
            return CopiedArray(_field(source, ours_in, target, theirs_in), count)
        case (4, (ours_in, _)), (4, (theirs_in, _)):
            return CopiedArray(_field(source, ours_in, target, theirs_in), None)
    raise ValueError(f"a field is {_described(ours)} in one type and {_described(theirs)} in the other")


def _described(field: object) -> str:
    """Return the type of a field as a phrase."""
    match field:
        case (1, (str(name), _)) | (2, str(name)):
            return name
        case (3, (element, count)):
            return f"{_described(element)}[{count}]"
        case (4, (element, _)):
            return f"{_described(element)}[]"
    return "unknown"


def _log_field(source: Typesdict, target: Typesdict, to_cdr: bool) -> CopiedField:
    """Return the structure of a log message: in ROS 2, it has only the stamp of the header, and other levels."""
    ros1, ros2 = (source, target) if to_cdr else (target, source)
    levels = _LEVELS if to_cdr else {theirs: ours for ours, theirs in _LEVELS.items()}
    of_ros2: dict[str, CopiedField] = {
        name: CopiedLevel(levels) if name == "level" else _field(ros2, described, ros2, described)
        for name, described in _fields(ros2, LOG_OF_ROS2).items()
    }
    fields = _fields(ros1, LOG_OF_ROS1)
    inside = _fields(ros1, "std_msgs/msg/Header")
    of_header = tuple(_field(ros1, described, ros1, described) for described in inside.values())
    topics = _field(ros1, fields["topics"], ros1, fields["topics"])
    rest = tuple(name for name in fields if name not in {"header", "topics"})
    flat_ros1 = (*of_header, *(of_ros2[name] for name in rest), topics)
    names_ros1 = (*(f"header.{name}" for name in inside), *rest, "topics")
    order = {name: number for number, name in enumerate(names_ros1)} | {"stamp": names_ros1.index("header.stamp")}
    if to_cdr:
        return CopiedStructure(flat_ros1, tuple((field, order[name]) for name, field in of_ros2.items()))
    back = {order[name]: number for number, name in enumerate(of_ros2)}
    return CopiedStructure(
        tuple(of_ros2.values()), tuple((field, back.get(at, -1)) for at, field in enumerate(flat_ros1))
    )
