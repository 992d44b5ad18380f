"""Type descriptions and their hashes, RIHS01. Endpoints match only if they declare the same hash.

Source: REP 2016; type_description_interfaces/msg/FieldType; rosidl_generator_type_description, __init__.py.
"""

import json
from collections.abc import Callable
from hashlib import sha256
from typing import TypedDict

from rosbags.interfaces import Nodetype
from rosbags.interfaces.typing import FieldDesc

from thbridge.ros2.interfaces import MessageDefinition

_TYPE_IDS = {
    "int8": 2, "uint8": 3, "int16": 4, "uint16": 5, "int32": 6, "uint32": 7, "int64": 8, "uint64": 9,
    "float32": 10, "float64": 11, "char": 3, "bool": 15, "byte": 16, "string": 17, "wstring": 18,
}  # fmt: skip
"""Numbers of built-in types. rosidl reads `char` as uint8."""
_NESTED_TYPE = 1
_BOUND = 4
"""Difference between the numbers of a string with a bound and a string."""
_ARRAY, _BOUNDED_SEQUENCE, _SEQUENCE = 48, 96, 144
"""Offsets that are added to the number of the element's type."""


class FieldTypeDescription(TypedDict):
    """Description of the type of a field (type_description_interfaces/msg/FieldType)."""

    type_id: int
    capacity: int
    string_capacity: int
    nested_type_name: str


class FieldDescription(TypedDict):
    """Description of a field (type_description_interfaces/msg/Field)."""

    name: str
    type: FieldTypeDescription
    default_value: str


class StructDescription(TypedDict):
    """Description of one type (type_description_interfaces/msg/IndividualTypeDescription)."""

    type_name: str
    fields: list[FieldDescription]


class FullDescription(TypedDict):
    """Description of a type and all types within it (type_description_interfaces/msg/TypeDescription)."""

    type_description: StructDescription
    referenced_type_descriptions: list[StructDescription]


def describe(name: str, definition_of: Callable[[str], MessageDefinition]) -> FullDescription:
    """Return the description of a type.

    Args:
        name: for example "nav_msgs/msg/Odometry".
        definition_of: returns the definition of each type. It raises KeyError for unknown types.
    """
    described: dict[str, StructDescription] = {}
    waiting = [name]
    while waiting:
        current = waiting.pop()
        if current not in described:
            described[current] = _struct(current, definition_of(current))
            waiting += [
                within for field in described[current]["fields"] if (within := field["type"]["nested_type_name"])
            ]
    own = described.pop(name)
    return {
        "type_description": own,
        "referenced_type_descriptions": [described[within] for within in sorted(described)],
    }


def rihs01(description: FullDescription) -> str:
    """Return the hash of a description, for example "RIHS01_3cc9...". Default values do not change it."""
    hashed = {
        "type_description": _without_defaults(description["type_description"]),
        "referenced_type_descriptions": [
            _without_defaults(each) for each in description["referenced_type_descriptions"]
        ],
    }
    return f"RIHS01_{sha256(json.dumps(hashed).encode()).hexdigest()}"


def _without_defaults(struct: StructDescription) -> dict[str, object]:
    fields = [{"name": field["name"], "type": field["type"]} for field in struct["fields"]]
    return {"type_name": struct["type_name"], "fields": fields}


def _struct(name: str, definition: MessageDefinition) -> StructDescription:
    fields: list[FieldDescription] = []
    for field, kind in definition.fields:
        default = str(definition.defaults[field]) if field in definition.defaults else ""
        fields.append({"name": field, "type": _field_type(kind), "default_value": default})
    return {"type_name": name, "fields": fields}


def _field_type(kind: FieldDesc) -> FieldTypeDescription:
    offset = capacity = limit = 0
    nested = ""
    if kind[0] == Nodetype.ARRAY or kind[0] == Nodetype.SEQUENCE:
        element, capacity = kind[1]
        offset = _ARRAY if kind[0] == Nodetype.ARRAY else _BOUNDED_SEQUENCE if capacity else _SEQUENCE
    else:
        element = kind
    if element[0] == Nodetype.NAME:
        number, nested = _NESTED_TYPE, element[1]
    else:
        builtin, limit = element[1]
        number = _TYPE_IDS[builtin] + (_BOUND if limit else 0)
    return {"type_id": offset + number, "capacity": capacity, "string_capacity": limit, "nested_type_name": nested}
