"""Messages of dynamic_reconfigure servers and their clients, for a robot's live parameters.

In ROS, each node, costmap, layer and planner with live parameters is a server with its own name. Here, each section of
`RobotParameters` with live parameters is a server. Descriptions are from the parameters' declarations.

Source: ros/dynamic_reconfigure, server.h, config_tools.h and encoding.py; its messages Config and ConfigDescription.

Differences from ROS: all levels are 0, because no part has to be restarted. `restore_defaults` is missing. A parameter
that accepts only certain words is an enum, although ROS accepts any text.
"""

import json
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from struct import Struct
from types import NoneType
from typing import Literal, cast, get_args

from sim.parameters import DeclaredParameter, RobotParameters, live_parameters
from thbridge.ros.clients import InvalidMessage
from thbridge.ros.messages.cursor import INT32, UINT8, Cursor
from thbridge.ros.messages.pack.fields import UINT32, string
from thbridge.ros.names import RobotNames
from thbridge.ros.parameters import name_of, value_at

ParameterType = Literal["bool", "int", "str", "double"]
Value = bool | int | str | float

_KINDS: tuple[ParameterType, ...] = get_args(ParameterType)
"""Types in the order in which a Config lists them."""

_FLOAT64 = Struct("<d")
_GROUP = "Default"
_GROUP_IDS = INT32.pack(0) * 2
"""Ids of the group and of its parent. All parameters are in the default group."""
_GROUP_STATE = string(_GROUP) + UINT8.pack(True) + _GROUP_IDS
_NO_LEVEL = UINT32.pack(0)

_NUMBERED: Mapping[str, Mapping[str, int]] = {
    "combination_method": {"Overwrite": 0, "Maximum": 1, "Nothing": 99},
    "orientation_mode": {
        "None": 0,
        "Forward": 1,
        "Interpolate": 2,
        "ForwardThenInterpolate": 3,
        "Backward": 4,
        "Leftward": 5,
        "Rightward": 6,
    },
}
"""Parameters whose numbers have names in ROS's .cfg files."""


@dataclass(frozen=True, slots=True)
class DescribedParameter:
    """Live parameter in the form of dynamic_reconfigure's descriptions.

    Attributes:
        name: its name within its section.
        path: its path in `RobotParameters`, such as "amcl.kld_err".
        kind: ROS's name of its type.
        description: its meaning for people, with the unit.
        edit_method: its choices, as the text of a Python dictionary, which clients evaluate. Empty if any value is
            allowed.
        minimum: minimum value. Empty for text.
        maximum: maximum value. Empty for text.
        default: the default value.
    """

    name: str
    path: str
    kind: ParameterType
    description: str
    edit_method: str
    minimum: Value
    maximum: Value
    default: Value

    def clamped(self, value: Value) -> Value:
        """Return the nearest value within the bounds, like dynamic_reconfigure's servers. NaN remains NaN."""
        if isinstance(value, str):
            return value
        return min(max(value, cast(float, self.minimum)), cast(float, self.maximum))

    def reported(self, software: RobotParameters) -> Value:
        """Return the value of the parameter in a robot's software. Null becomes 0, because messages have no null."""
        value = value_at(software, self.path)
        if self.kind == "double":
            return float(cast("float | None", value) or 0.0)
        return value if isinstance(value, bool | int | str) else json.dumps(value)


@dataclass(frozen=True, slots=True)
class ReconfigureServer:
    """Live parameters of one server.

    Attributes:
        path: its path in `RobotParameters`, such as "amcl" or "local_costmap.inflation_layer".
        parameters: the parameters in the order of their declarations.
    """

    path: str
    parameters: tuple[DescribedParameter, ...]

    def name(self, robot: RobotNames) -> str:
        """Return the server's name, such as "/robot1/move_base/local_costmap/inflation_layer"."""
        return name_of(robot, self.parameters[0].path).rpartition("/")[0]


@cache
def reconfigure_servers() -> tuple[ReconfigureServer, ...]:
    """Return all servers of a robot."""
    found: dict[str, list[DescribedParameter]] = {}
    for declared in live_parameters():
        found.setdefault(declared.path.rpartition(".")[0], []).append(described(declared))
    return tuple(ReconfigureServer(path, tuple(parameters)) for path, parameters in found.items())


def described(declared: DeclaredParameter) -> DescribedParameter:
    """Return the description of a live parameter."""
    name = declared.path.rpartition(".")[2]
    kind = _kind(declared.types)
    minimum, maximum = _bounds(kind, declared.minimum, declared.maximum)
    return DescribedParameter(
        name,
        declared.path,
        kind,
        declared.help
        + (f" [{declared.unit}]" if declared.unit else "")
        + (" (null is sent as 0)" if NoneType in declared.types else ""),
        _edit_method(kind, declared.help, _choices(name, declared.choices)),
        minimum,
        maximum,
        declared.default if isinstance(declared.default, bool | int | float | str) else json.dumps(declared.default),
    )


def _kind(types: tuple[object, ...]) -> ParameterType:
    if float in types:
        return "double"
    if bool in types:
        return "bool"
    return "int" if int in types else "str"


def _bounds(kind: ParameterType, least: float | None, greatest: float | None) -> tuple[Value, Value]:
    match kind:
        case "bool":
            return False, True
        case "str":
            return "", ""
        case "int":
            return -(2**31) if least is None else int(least), 2**31 - 1 if greatest is None else int(greatest)
        case "double":
            return -math.inf if least is None else float(least), math.inf if greatest is None else float(greatest)


def _choices(name: str, words: tuple[str, ...]) -> Mapping[str, Value]:
    return _NUMBERED.get(name, {word: word for word in words})


def _edit_method(kind: ParameterType, help_: str, choices: Mapping[str, Value]) -> str:
    if not choices:
        return ""
    enum = [{"name": name, "type": kind, "value": value, "description": ""} for name, value in choices.items()]
    return repr({"enum_description": help_, "enum": enum})


# Messages of a server


def description(section: ReconfigureServer) -> bytes:
    """Encode dynamic_reconfigure/ConfigDescription."""
    parameters = b"".join(
        string(each.name) + string(each.kind) + _NO_LEVEL + string(each.description) + string(each.edit_method)
        for each in section.parameters
    )
    group = string(_GROUP) + string("") + UINT32.pack(len(section.parameters)) + parameters + _GROUP_IDS
    return b"".join(
        (
            UINT32.pack(1),
            group,
            values_config((each, each.maximum) for each in section.parameters),
            values_config((each, each.minimum) for each in section.parameters),
            values_config((each, each.default) for each in section.parameters),
        )
    )


def config(section: ReconfigureServer, software: RobotParameters) -> bytes:
    """Encode dynamic_reconfigure/Config with the current values. The response of Reconfigure is the same."""
    return values_config((each, each.reported(software)) for each in section.parameters)


def values_config(values: Iterable[tuple[DescribedParameter, Value]]) -> bytes:
    """Encode dynamic_reconfigure/Config with these values."""
    rows: dict[ParameterType, list[bytes]] = {kind: [] for kind in _KINDS}
    for parameter, value in values:
        rows[parameter.kind].append(string(parameter.name) + _WRITE[parameter.kind](value))
    lists = (UINT32.pack(len(of_kind)) + b"".join(of_kind) for of_kind in rows.values())
    return b"".join(lists) + UINT32.pack(1) + _GROUP_STATE


_WRITE: Mapping[ParameterType, Callable[[Value], bytes]] = {
    "bool": lambda value: UINT8.pack(bool(value)),
    "int": lambda value: INT32.pack(int(value)),
    "str": lambda value: string(str(value)),
    "double": lambda value: _FLOAT64.pack(float(value)),
}


# Requests of a client


def requested_changes(
    section: ReconfigureServer, software: RobotParameters, data: bytes
) -> tuple[tuple[str, Value], ...] | InvalidMessage:
    """Return the changes in a request of dynamic_reconfigure/Reconfigure: paths, and values within their bounds.

    A value that is equal to the value in `config` is not a change, because clients send all values back.

    Args:
        section: the server.
        software: the current parameters.
        data: the request's bytes.
    """
    requested = requested_values(section, data)
    if isinstance(requested, InvalidMessage):
        return requested
    return tuple((each.path, value) for each, value in requested if value != each.reported(software))


def requested_values(
    section: ReconfigureServer, data: bytes
) -> tuple[tuple[DescribedParameter, Value], ...] | InvalidMessage:
    """Return the values in a request of dynamic_reconfigure/Reconfigure, within their bounds.

    As in ROS, these are ignored: unknown names, names with another type, and the states of groups.
    """
    try:
        given = _given(Cursor(data))
    except ValueError as error:
        return InvalidMessage(str(error))
    return tuple(
        (each, each.clamped(given[each.kind, each.name]))
        for each in section.parameters
        if (each.kind, each.name) in given
    )


def _given(cursor: Cursor) -> Mapping[tuple[ParameterType, str], Value]:
    given: dict[tuple[ParameterType, str], Value] = {}
    for kind in _KINDS:
        for _ in range(cursor.integer(UINT32)):  # A forged count ends soon: each item needs some bytes.
            name = cursor.string()
            given[kind, name] = _READ[kind](cursor)
    return given


_READ: Mapping[ParameterType, Callable[[Cursor], Value]] = {
    "bool": lambda cursor: bool(cursor.integer(UINT8)),
    "int": lambda cursor: cursor.integer(INT32),
    "str": Cursor.string,
    "double": lambda cursor: float(cursor.reals(1)[0]),
}
