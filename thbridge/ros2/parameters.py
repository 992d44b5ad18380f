"""Parameters of ROS 2 nodes: their types, listing, and the checks of new values, as in rclcpp.

Source: ros2/rclcpp, node_parameters.cpp and parameter_service.cpp; rcl_interfaces, msg/ParameterType.msg.

Differs: a value that is equal to the present value is no change, so that clients can load a dump of all parameters.
"""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import TypeAlias, cast

from sim.parameters import ParameterRejection, RobotParameters
from sim.parameters.reconfiguration import with_values
from thbridge.ros.parameters import value_at

Value: TypeAlias = bool | int | float | str | tuple[bool | int | float | str, ...] | None
OwnValue: TypeAlias = bool | int | float | str
"""Value of a parameter that may change, in `RobotParameters`. A footprint is a text."""

SEPARATOR = "."
RECURSIVE = 0
"""Depth of a list with all parameters, however deep."""
MAX_CHANGES = 200
"""Maximum number of parameters in one request to set parameters."""


class ParameterKind(IntEnum):
    """Type of a parameter's value, with the numbers and names of rcl_interfaces/msg/ParameterType."""

    NOT_SET = 0
    BOOL = 1
    INTEGER = 2
    DOUBLE = 3
    STRING = 4
    BYTE_ARRAY = 5
    BOOL_ARRAY = 6
    INTEGER_ARRAY = 7
    DOUBLE_ARRAY = 8
    STRING_ARRAY = 9


@dataclass(frozen=True, slots=True)
class NodeParameter:
    """Parameter of a node.

    Attributes:
        name: its name, for example "FollowPath.max_vel_x".
        kind: type of its values. It never changes.
        description: its meaning, with the unit.
        value: its value if it is fixed.
        path: path of a value in `RobotParameters` that may change. Empty if the value is fixed.
        minimum: minimum value. If None, there is no limit.
        maximum: maximum value. If None, there is no limit.
        choices: allowed words; if empty, any word.
        factor: value of a double in Nav2's unit, divided by its value in `RobotParameters`.
    """

    name: str
    kind: ParameterKind
    description: str
    value: Value = None
    path: str = ""
    minimum: float | None = None
    maximum: float | None = None
    choices: tuple[str, ...] = ()
    factor: float = 1.0

    @property
    def read_only(self) -> bool:
        """True if the value cannot change while the session runs."""
        return not self.path

    def reported(self, software: RobotParameters) -> Value:
        """Return the value in a robot's software. Null becomes 0, because values of these types have no null."""
        if not self.path:
            return self.value
        value = value_at(software, self.path)
        if self.kind is ParameterKind.DOUBLE:
            return float(cast("float | None", value) or 0.0) * self.factor
        if self.kind is ParameterKind.STRING:
            return value if isinstance(value, str) else json.dumps(value)
        return 0 if value is None else cast(int, value)


def fixed(name: str, value: Value, description: str) -> NodeParameter:
    """Return a read-only parameter."""
    return NodeParameter(name, kind_of(value), description, value)


def kind_among(types: Sequence[object]) -> ParameterKind:
    """Return the type of a parameter whose values have these types in Python. Other values are texts."""
    for known, kind in (
        (float, ParameterKind.DOUBLE),
        (bool, ParameterKind.BOOL),
        (int, ParameterKind.INTEGER),
    ):
        if known in types:
            return kind
    return ParameterKind.STRING


_ARRAYS = {
    ParameterKind.BOOL: ParameterKind.BOOL_ARRAY,
    ParameterKind.INTEGER: ParameterKind.INTEGER_ARRAY,
    ParameterKind.DOUBLE: ParameterKind.DOUBLE_ARRAY,
}


def kind_of(value: Value) -> ParameterKind:
    """Return the type of a parameter with this value."""
    if isinstance(value, tuple):
        kinds = {kind_of(each) for each in value}
        return _ARRAYS.get(kinds.pop() if len(kinds) == 1 else ParameterKind.STRING, ParameterKind.STRING_ARRAY)
    return kind_among((type(value),))


@dataclass(frozen=True, slots=True, eq=False)
class ParameterNode:
    """Node with its parameters.

    Attributes:
        namespace: its namespace, for example "/robot1".
        name: its name, for example "amcl".
        robot: index of its robot. None for the node of the session, whose parameters are all fixed.
        parameters: its parameters by name, in the order of their names.
    """

    namespace: str
    name: str
    robot: int | None
    parameters: Mapping[str, NodeParameter]

    def reported(self, software: RobotParameters) -> dict[str, Value]:
        """Return the values of all parameters that may change, by name."""
        return {name: each.reported(software) for name, each in self.parameters.items() if each.path}


def listed(names: Iterable[str], prefixes: Sequence[str], depth: int) -> tuple[list[str], list[str]]:
    """Return the parameters below some prefixes, and the prefixes of these parameters.

    Args:
        names: names of all parameters.
        prefixes: wanted prefixes, or names. If empty, all parameters are wanted.
        depth: maximum number of parts in a name below its prefix, or `RECURSIVE`.
    """

    def within(name: str) -> bool:
        return depth == RECURSIVE or name.count(SEPARATOR) < depth

    def matches(name: str) -> bool:
        if not prefixes:
            return within(name)
        return name in exact or any(name.startswith(prefix) and within(name.removeprefix(prefix)) for prefix in dotted)

    exact = frozenset(prefixes)
    dotted = [f"{prefix}{SEPARATOR}" for prefix in exact]
    found = [name for name in names if matches(name)]
    return found, list(dict.fromkeys(name.rpartition(SEPARATOR)[0] for name in found if SEPARATOR in name))


@dataclass(frozen=True, slots=True)
class GivenParameter:
    """Parameter in a request.

    Attributes:
        name: its name.
        kind: type of the value. An unknown number of a type is `NOT_SET`.
        value: the new value.
    """

    name: str
    kind: ParameterKind
    value: Value


@dataclass(frozen=True, slots=True)
class ParameterChanges:
    """Result of a request to set parameters.

    Attributes:
        refusals: for each parameter of the request, the reason why it keeps its value, or an empty text. A request
            that sets all parameters together has only one reason.
        values: new values by path in `RobotParameters`, in the order in which they apply.
        software: parameters of the robot after the changes.
    """

    refusals: tuple[str, ...]
    values: tuple[tuple[str, OwnValue], ...]
    software: RobotParameters


def set_each(node: ParameterNode, software: RobotParameters, given: Sequence[GivenParameter]) -> ParameterChanges:
    """Set parameters one after the other. A refusal does not affect the others."""
    refusals: list[str] = []
    values: list[tuple[str, OwnValue]] = []
    for parameter in given:
        one = set_together(node, software, [parameter]) if len(given) <= MAX_CHANGES else _too_many(software)
        refusals += one.refusals
        values += one.values
        software = one.software
    return ParameterChanges(tuple(refusals), tuple(values), software)


def set_together(node: ParameterNode, software: RobotParameters, given: Sequence[GivenParameter]) -> ParameterChanges:
    """Set all these parameters, or none."""
    if len(given) > MAX_CHANGES:
        return _too_many(software)
    if not given:
        return _refused(software, "the list of parameters is empty")
    for parameter in given:
        if refusal := refusal_of(node, parameter):
            return _refused(software, refusal)
    values: dict[str, tuple[str, OwnValue]] = {}
    for parameter in given:
        declared = node.parameters[parameter.name]
        values.pop(declared.path, None)
        if parameter.value != declared.reported(software):
            own = cast(OwnValue, parameter.value)
            scaled = cast(float, own) / declared.factor if declared.factor != 1.0 else own
            values[declared.path] = parameter.name, scaled
    changes = tuple((path, value) for path, (_, value) in values.items())
    after = with_values(software, changes)
    if isinstance(after, ParameterRejection):
        name = values[after.path][0]
        return _refused(software, after.sentence if name == after.path else f"{name}: {after.sentence}")
    return ParameterChanges(("",), changes, after)


def refusal_of(node: ParameterNode, given: GivenParameter) -> str:
    """Return the reason why a node refuses a value, or an empty text. Other parameters of the node have no effect."""
    name = given.name
    declared = node.parameters.get(name)
    if declared is None:
        return f"parameter '{name}' cannot be set because it was not declared"
    if declared.read_only:
        return f"parameter '{name}' cannot be set because it is read-only"
    if given.kind is not declared.kind:
        wanted, got = declared.kind.name.lower(), given.kind.name.lower()
        return f"parameter '{name}' has the type {wanted}, so it cannot be set to a value of the type {got}"
    if declared.kind in (ParameterKind.DOUBLE, ParameterKind.INTEGER):
        number = cast(float, given.value)
        if math.isnan(number):
            return f"{name} is a number, not nan"
        if declared.minimum is not None and number < declared.minimum:
            return f"{name} is at least {declared.minimum:.10g}, not {number:.10g}"
        if declared.maximum is not None and number > declared.maximum:
            return f"{name} is at most {declared.maximum:.10g}, not {number:.10g}"
    return ""


def _refused(software: RobotParameters, reason: str) -> ParameterChanges:
    return ParameterChanges((reason,), (), software)


def _too_many(software: RobotParameters) -> ParameterChanges:
    return _refused(software, f"a request sets at most {MAX_CHANGES} parameters")
