"""Definitions of messages, services and actions of ROS 2: their fields, constants and default values.

A service consists of three messages, and an action of four messages and two services. Their names and fields follow
from the name of the service or action.

Source: design.ros2.org, articles 110 (interface definition) and 111 (legacy interface definition); rosidl_parser,
definition.py.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias, cast

from rosbags.interfaces import Nodetype
from rosbags.interfaces.typing import BaseDesc, Basename, FieldDesc, NameDesc

ConstantValue: TypeAlias = bool | int | float | str
DefaultValue: TypeAlias = ConstantValue | tuple[ConstantValue, ...]

_NUMBERS = frozenset(f"{kind}{size}" for kind in ("int", "uint") for size in (8, 16, 32, 64)) | {"byte", "char"}
_BUILTINS = _NUMBERS | {"bool", "float32", "float64", "string", "wstring"}
_FIELD = re.compile(
    r"(?P<kind>[A-Za-z]\w*(?:/\w+){0,2})(?:<=(?P<limit>\d+))?"
    r"(?P<array>\[(?P<bounded><=)?(?P<size>\d*)\])?\s+(?P<name>\w+)\s*(?P<equals>=?)\s*(?P<value>.*)"
)
_NO_FIELD = "uint8 structure_needs_at_least_one_member"
"""Field of a message that has no other field. It is one byte on the wire."""


@dataclass(frozen=True, slots=True)
class MessageDefinition:
    """Definition of a message type, in the form of rosbags.

    Attributes:
        constants: name, type and value of each constant.
        fields: name and type of each field.
        defaults: values of fields that are not zero by default, or whose default the definition gives.
    """

    constants: list[tuple[str, str, ConstantValue]]
    fields: list[tuple[str, FieldDesc]]
    defaults: Mapping[str, DefaultValue]


def messages_in(name: str, text: str) -> dict[str, str]:
    """Return the definition texts of all messages that an interface consists of, by name.

    Services and actions themselves are also in the result, because type descriptions treat them as messages.

    Args:
        name: for example "nav_msgs/srv/GetMap".
        text: content of its .msg, .srv or .action file.
    """
    kind = name.split("/")[1]
    parts = re.split(r"^---[ \t]*$", text, flags=re.MULTILINE)
    if kind == "srv":
        request, response = parts
        return _service(name, request, response)
    if kind == "action":
        goal, result, feedback = parts
        id_field = "unique_identifier_msgs/UUID goal_id\n"
        return {
            f"{name}_Goal": goal,
            f"{name}_Result": result,
            f"{name}_Feedback": feedback,
            **_service(
                f"{name}_SendGoal", f"{id_field}{name}_Goal goal", "bool accepted\nbuiltin_interfaces/Time stamp"
            ),
            **_service(f"{name}_GetResult", id_field, f"int8 status\n{name}_Result result"),
            f"{name}_FeedbackMessage": f"{id_field}{name}_Feedback feedback",
            name: f"{name}_Goal goal\n{name}_Result result\n{name}_Feedback feedback\n"
            f"{name}_SendGoal send_goal_service\n{name}_GetResult get_result_service\n"
            f"{name}_FeedbackMessage feedback_message",
        }
    return {name: text}


def _service(name: str, request: str, response: str) -> dict[str, str]:
    return {
        f"{name}_Request": request,
        f"{name}_Response": response,
        f"{name}_Event": f"service_msgs/ServiceEventInfo info\n{name}_Request[<=1] request\n"
        f"{name}_Response[<=1] response",
        name: f"{name}_Request request_message\n{name}_Response response_message\n{name}_Event event_message",
    }


def parsed(name: str, text: str) -> MessageDefinition:
    """Return the definition of a message from its text.

    Args:
        name: for example "nav_msgs/msg/Odometry". Types without a package belong to the package of this message.
        text: content of its .msg file.

    Raises:
        ValueError: a line is not a field or constant.
    """
    package = name.partition("/")[0]
    constants: list[tuple[str, str, ConstantValue]] = []
    fields: list[tuple[str, FieldDesc]] = []
    defaults: dict[str, DefaultValue] = {}
    for line in text.splitlines():
        statement = line.partition("#")[0].strip()
        if statement:
            _add(statement, package, constants, fields, defaults)
    if not fields:
        _add(_NO_FIELD, package, constants, fields, defaults)
    return MessageDefinition(constants, fields, defaults)


def written(definition: MessageDefinition) -> str:
    """Return the text of a definition, from which `parsed` reads the same definition."""
    lines = [f"{kind} {name}={value}" for name, kind, value in definition.constants]
    for name, kind in definition.fields:
        default = definition.defaults.get(name, "")
        lines.append(f"{_written_type(kind)} {name} {default}".strip())
    return "".join(f"{line}\n" for line in lines if line != _NO_FIELD)


def _written_type(kind: FieldDesc) -> str:
    match kind:
        case (Nodetype.NAME, str(name)):
            return name.replace("/msg/", "/")
        case (Nodetype.BASE, (str(name), int(limit))):
            return f"{name}<={limit}" if limit else name
        case (Nodetype.ARRAY, (element, int(size))):
            return f"{_written_type(element)}[{size}]"
        case (_, (element, int(size))):
            return f"{_written_type(element)}[{f'<={size}' if size else ''}]"
    raise ValueError(kind)


def _add(
    statement: str,
    package: str,
    constants: list[tuple[str, str, ConstantValue]],
    fields: list[tuple[str, FieldDesc]],
    defaults: dict[str, DefaultValue],
) -> None:
    """Add a line of a definition to its constants or fields."""
    match = _FIELD.fullmatch(statement)
    if match is None:
        raise ValueError(f"{statement[:80]!r} is not a field or constant")
    kind, name, value = match["kind"], match["name"], match["value"]
    if match["equals"]:
        constants.append((name, kind, _value(kind, value)))
        return
    element: BaseDesc | NameDesc
    if kind in _BUILTINS:
        element = (Nodetype.BASE, (cast("Basename", kind), int(match["limit"] or 0)))
        if value.startswith("["):
            defaults[name] = tuple(_value(kind, each.strip()) for each in value.strip("[]").split(","))
        elif value:
            defaults[name] = _value(kind, value)
    else:
        element = (Nodetype.NAME, _qualified(kind, package))
    if match["array"] is None:
        fields.append((name, element))
    else:
        is_sequence = match["bounded"] or not match["size"]
        fields.append(
            (name, (Nodetype.SEQUENCE if is_sequence else Nodetype.ARRAY, (element, int(match["size"] or 0))))
        )


def _qualified(kind: str, package: str) -> str:
    match kind.split("/"):
        case [name]:
            return f"{package}/msg/{name}"
        case [other, name]:
            return f"{other}/msg/{name}"
    return kind


def _value(kind: str, text: str) -> ConstantValue:
    """Return the value of a constant or default."""
    if kind == "bool":
        return text.lower() in ("true", "1")
    if kind in _NUMBERS:
        return int(text, 0)
    if kind.endswith("string"):
        quote = text[:1]
        return text[1:-1].replace(f"\\{quote}", quote) if quote in ('"', "'") else text
    return float(text)
