"""Types of one ROS 2 distribution: their hashes, their messages as bytes (CDR), and conversion from and to ROS 1.

CDR is XCDR version 1, little endian, with its header of 4 bytes. Values are message objects of the library rosbags.
"""

import struct
from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.interfaces.typing import FieldDesc
from rosbags.serde.errors import SerdeError
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.base import normalize_fieldname
from rosbags.typesys.msg import normalize_msgtype

from thbridge.ros.messages import types as ros1_types
from thbridge.ros2.hashes import FullDescription, describe, rihs01
from thbridge.ros2.interface_texts import DEFAULTS, JAZZY_TEXTS, KILTED_TEXTS
from thbridge.ros2.interfaces import MessageDefinition, messages_in, parsed, written
from thbridge.ros2.message_copies import MessageCopy
from thbridge.ros2.supports import ActionSupport, MessageSupport, ServiceSupport

DISTRIBUTIONS = {"jazzy": (Stores.ROS2_JAZZY, JAZZY_TEXTS), "kilted": (Stores.ROS2_KILTED, KILTED_TEXTS)}
"""Types of rosbags and further definitions of each distribution, by its name."""

_MALFORMED = (SerdeError, ValueError, LookupError, ArithmeticError, MemoryError, AssertionError, struct.error)
"""Errors that rosbags raises for bytes that are not a message of the type."""


IMPLICIT = "implicit"
"""Encoding of the source of a type that follows from a service or action."""


class TypeSource(NamedTuple):
    """Source text of a type (type_description_interfaces/msg/TypeSource).

    Attributes:
        type_name: for example "nav_msgs/msg/Odometry".
        encoding: "msg", "srv" or "action"; or "implicit", without a text, for a part of a service or action.
        raw_file_contents: the text.
    """

    type_name: str
    encoding: str
    raw_file_contents: str


class Distribution:
    """Types of a distribution. Use `of`, because types take some milliseconds each at their first use.

    Names are "nav_msgs/msg/Odometry", "nav_msgs/srv/GetMap", "nav_msgs/srv/GetMap_Request",
    "nav2_msgs/action/NavigateToPose", "nav2_msgs/action/NavigateToPose_SendGoal_Request" and so on. All methods raise
    KeyError for unknown names.

    Args:
        name: "jazzy" or "kilted".
    """

    def __init__(self, name: str) -> None:
        stored, texts = DISTRIBUTIONS[name]
        self.name = name
        self._store = get_typestore(stored)
        self._texts = {part: text for whole in texts for part, text in messages_in(whole, texts[whole]).items()}
        self._definitions: dict[str, MessageDefinition] = {}
        self._hashes: dict[str, str] = {}
        self._registered: set[str] = set()

    @staticmethod
    @cache
    def of(name: str) -> "Distribution":
        """Return the distribution of this name."""
        return Distribution(name)

    def message(self, name: str) -> MessageSupport:
        """Return the name and hash of a message type."""
        return MessageSupport(name, self._hash(name))

    def service(self, name: str) -> ServiceSupport:
        """Return the names and hashes of a service type."""
        return ServiceSupport(name, self._hash(name), self.message(f"{name}_Request"), self.message(f"{name}_Response"))

    def action(self, name: str) -> ActionSupport:
        """Return the names and hashes of an action type."""
        return ActionSupport(
            name,
            self._hash(name),
            self.service(f"{name}_SendGoal"),
            self.service(f"{name}_GetResult"),
            self.service("action_msgs/srv/CancelGoal"),
            self.message(f"{name}_FeedbackMessage"),
            self.message("action_msgs/msg/GoalStatusArray"),
        )

    def description(self, name: str) -> FullDescription:
        """Return the description of a message, service or action type."""
        return describe(name, self.definition)

    def sources(self, name: str) -> list[TypeSource]:
        """Return the definition of a type, then those of all types within it. They have no comments."""
        within = self.description(name)["referenced_type_descriptions"]
        return [self._source(each) for each in (name, *(described["type_name"] for described in within))]

    def knows(self, name: str) -> bool:
        """Return True if this is one of the distribution's further definitions; see `DISTRIBUTIONS`."""
        return name in self._texts

    def constant(self, name: str, constant: str) -> bool | int | float | str:
        """Return the value of a constant of a message type."""
        return {each: value for each, _, value in self.definition(name).constants}[constant]

    def make(self, name: str, /, **fields: object) -> object:
        """Return a message. Fields that are not given have their default values.

        Numbers of a sequence may be given as any sequence of numbers, or as bytes.
        """
        self._register(name)
        definition = self.definition(name)
        values = [
            _as_field(kind, fields.pop(field)) if field in fields else self._default(definition, field, kind)
            for field, kind in definition.fields
        ]
        if fields:
            raise TypeError(f"{name} has no fields {', '.join(fields)}")
        return self._store.types[name](*values)  # type: ignore[arg-type]

    def encode(self, name: str, value: object) -> bytes:
        """Return a message as bytes."""
        self._register(name)
        return bytes(self._store.serialize_cdr(value, name, little_endian=True))

    def encoded(self, name: str, /, **fields: object) -> bytes:
        """Return a message with these fields as bytes; see `make`."""
        return self.encode(name, self.make(name, **fields))

    def decode(self, name: str, data: bytes) -> object:
        """Return the message in these bytes, which may be untrusted.

        Raises:
            ValueError: the bytes are not a message of this type.
        """
        self._register(name)
        try:
            return self._store.deserialize_cdr(data, name)
        except _MALFORMED as error:
            raise ValueError(f"not a message of type {name}: {error}") from None

    def from_ros1(self, ros1_type: str, name: str) -> Callable[[bytes], bytes]:
        """Return a function that converts messages of ROS 1 to messages of this distribution.

        Fields with the same name correspond. Other fields are 0 or empty.

        Args:
            ros1_type: for example "nav_msgs/Odometry".
            name: for example "nav_msgs/msg/Odometry".
        """
        return self._converter(ros1_type, name, to_ros1=False)

    def to_ros1(self, name: str, ros1_type: str) -> Callable[[bytes], bytes]:
        """Return a function that converts messages of this distribution to messages of ROS 1.

        The function raises ValueError for bytes that are not a message.
        """
        return self._converter(ros1_type, name, to_ros1=True)

    def _converter(self, ros1_type: str, name: str, *, to_ros1: bool) -> Callable[[bytes], bytes]:
        self._register(name)
        ours, theirs = (self._store.fielddefs, name), (ros1_types.typestore().fielddefs, normalize_msgtype(ros1_type))
        source, target = (ours, theirs) if to_ros1 else (theirs, ours)
        return MessageCopy(*source, *target, to_cdr=not to_ros1)

    def _hash(self, name: str) -> str:
        if name not in self._hashes:
            self._hashes[name] = rihs01(self.description(name))
        return self._hashes[name]

    def definition(self, name: str) -> MessageDefinition:
        """Return the fields, constants and default values of a message, service or action type."""
        if name not in self._definitions:
            if name in self._texts:
                self._definitions[name] = parsed(name, self._texts[name])
            else:
                constants, fields = self._store.fielddefs[name]
                self._definitions[name] = MessageDefinition(list(constants), fields, DEFAULTS.get(name, {}))
        return self._definitions[name]

    def _source(self, name: str) -> TypeSource:
        if name in DISTRIBUTIONS[self.name][1]:
            return TypeSource(name, name.split("/")[1], DISTRIBUTIONS[self.name][1][name])
        if name in self._texts:
            return TypeSource(name, IMPLICIT, "")
        return TypeSource(name, "msg", written(self.definition(name)))

    def _register(self, name: str) -> None:
        """Create the classes of a message type and of all types within it."""
        if name in self._registered:
            return
        description = self.description(name)
        within = [each["type_name"] for each in description["referenced_type_descriptions"]]
        missing = [each for each in (name, *within) if each not in self._store.fielddefs]
        if missing:
            definitions = {each: self.definition(each) for each in missing}
            self._store.register({each: (d.constants, d.fields) for each, d in definitions.items()})  # type: ignore[misc]
        self._registered.update((name, *within))

    def _default(self, definition: MessageDefinition, field: str, kind: FieldDesc) -> object:
        if field in definition.defaults:
            return _as_field(kind, definition.defaults[field])
        if kind[0] == Nodetype.NAME:
            return self.make(kind[1])
        if kind[0] == Nodetype.BASE:
            return _zero(kind[1][0])
        element, size = kind[1]
        count = size if kind[0] == Nodetype.ARRAY else 0
        if element[0] == Nodetype.NAME:
            return [self.make(element[1]) for _ in range(count)]
        return [""] * count if element[1][0] == "string" else np.zeros(count, _dtype(element[1][0]))


def _as_field(kind: FieldDesc, value: object) -> object:
    """Return the value of a field. Numbers of a sequence become an array."""
    if kind[0] in (Nodetype.BASE, Nodetype.NAME):
        return value
    element, _ = kind[1]
    if element[0] == Nodetype.NAME or element[1][0] == "string":
        return value
    dtype = _dtype(element[1][0])
    if isinstance(value, bytes):
        return np.frombuffer(value, dtype)
    return np.asarray(value, dtype)


def _zero(builtin: str) -> bool | int | float | str:
    if builtin in ("bool", "string"):
        return "" if builtin == "string" else False
    return 0.0 if builtin.startswith("float") else 0


def _dtype(builtin: str) -> str:
    return "uint8" if builtin in ("byte", "char") else builtin


def field_name(name: str) -> str:
    """Return the name of a field's attribute. Keywords of Python get an underscore at their end."""
    return normalize_fieldname(name)
