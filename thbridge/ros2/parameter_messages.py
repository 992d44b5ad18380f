"""Requests and responses of the services of a node's parameters, and parameter events, as bytes.

Like rclcpp, the services answer with an empty list if a name in the request is unknown. All functions that read a
request raise ValueError for bytes that are not a request.

Source: rcl_interfaces, srv and msg; ros2/rclcpp, parameter_service.cpp.
"""

import sys
from collections.abc import Iterable, Mapping, Sequence
from typing import Protocol, cast

import numpy as np

from thbridge.ros2.action_messages import time_of
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.parameters import GivenParameter, NodeParameter, ParameterKind, Value, listed

LIST, DESCRIBE, TYPES, GET, SET, SET_TOGETHER = (
    "list_parameters",
    "describe_parameters",
    "get_parameter_types",
    "get_parameters",
    "set_parameters",
    "set_parameters_atomically",
)
"""Names of the services of each node."""
SERVICE_TYPES: Mapping[str, str] = {
    LIST: "rcl_interfaces/srv/ListParameters",
    DESCRIBE: "rcl_interfaces/srv/DescribeParameters",
    TYPES: "rcl_interfaces/srv/GetParameterTypes",
    GET: "rcl_interfaces/srv/GetParameters",
    SET: "rcl_interfaces/srv/SetParameters",
    SET_TOGETHER: "rcl_interfaces/srv/SetParametersAtomically",
}
EVENT = "rcl_interfaces/msg/ParameterEvent"
MAX_NAMES = 10_000
"""Maximum number of names in a request. An answer to more names is empty."""

_FIELDS: Mapping[ParameterKind, str] = {kind: f"{kind.name.lower()}_value" for kind in ParameterKind if kind}
"""Fields of rcl_interfaces/msg/ParameterValue."""
_KINDS: Mapping[int, ParameterKind] = {kind.value: kind for kind in ParameterKind}


class _Names(Protocol):
    names: list[str]


class _ListRequest(Protocol):
    prefixes: list[str]
    depth: int


class _ReadValue(Protocol):
    type: int


class _ReadParameter(Protocol):
    name: str
    value: _ReadValue


class _Parameters(Protocol):
    parameters: list[_ReadParameter]


def answer_list(types: Distribution, parameters: Mapping[str, NodeParameter], request: bytes) -> bytes:
    """Answer a request to list parameters."""
    name = SERVICE_TYPES[LIST]
    asked = cast(_ListRequest, types.decode(f"{name}_Request", request))
    prefixes = asked.prefixes if len(asked.prefixes) <= MAX_NAMES else [""]
    names, found = listed(parameters, prefixes, asked.depth)
    result = types.make("rcl_interfaces/msg/ListParametersResult", names=names, prefixes=found)
    return _response(types, name, result=result)


def answer_descriptions(types: Distribution, parameters: Mapping[str, NodeParameter], request: bytes) -> bytes:
    """Answer a request for descriptors."""
    name = SERVICE_TYPES[DESCRIBE]
    wanted = _wanted(types, name, parameters, request)
    return _response(types, name, descriptors=[_descriptor(types, each) for each in wanted])


def answer_types(types: Distribution, parameters: Mapping[str, NodeParameter], request: bytes) -> bytes:
    """Answer a request for the types of parameters."""
    name = SERVICE_TYPES[TYPES]
    wanted = _wanted(types, name, parameters, request)
    return _response(types, name, types=bytes(each.kind for each in wanted))


def answer_values(
    types: Distribution, parameters: Mapping[str, NodeParameter], present: Mapping[str, Value], request: bytes
) -> bytes:
    """Answer a request for the values of parameters.

    Args:
        types: types of the messages.
        parameters: all parameters of the node.
        present: values of the parameters that may change.
        request: the request.
    """
    name = SERVICE_TYPES[GET]
    wanted = _wanted(types, name, parameters, request)
    values = [parameter_value(types, each.kind, present.get(each.name, each.value)) for each in wanted]
    return _response(types, name, values=values)


def given_parameters(types: Distribution, service: str, request: bytes) -> list[GivenParameter]:
    """Return the parameters in a request to set parameters; `service` is `SET` or `SET_TOGETHER`."""
    asked = cast(_Parameters, types.decode(f"{SERVICE_TYPES[service]}_Request", request))
    return [_given(each) for each in asked.parameters]


def set_answer(types: Distribution, service: str, refusals: Sequence[str]) -> bytes:
    """Return the response to a request to set parameters; empty texts are successes."""
    results = [
        types.make("rcl_interfaces/msg/SetParametersResult", successful=not refusal, reason=refusal)
        for refusal in refusals
    ]
    if service == SET:
        return _response(types, SERVICE_TYPES[SET], results=results)
    return _response(types, SERVICE_TYPES[SET_TOGETHER], result=results[0])


def event(
    types: Distribution,
    nanoseconds: int,
    node: str,
    new: Iterable[tuple[NodeParameter, Value]] = (),
    changed: Iterable[tuple[NodeParameter, Value]] = (),
) -> bytes:
    """Return a parameter event.

    Args:
        types: types of the messages.
        nanoseconds: time of the event.
        node: full name of the node.
        new: declared parameters, with their values.
        changed: changed parameters, with their new values.
    """
    return types.encoded(
        EVENT,
        stamp=time_of(types, nanoseconds),
        node=node,
        new_parameters=[_parameter(types, each, value) for each, value in new],
        changed_parameters=[_parameter(types, each, value) for each, value in changed],
    )


def parameter_value(types: Distribution, kind: ParameterKind, value: Value) -> object:
    """Return rcl_interfaces/msg/ParameterValue."""
    name = "rcl_interfaces/msg/ParameterValue"
    if kind is ParameterKind.NOT_SET:
        return types.make(name)
    content = list(value) if isinstance(value, tuple) else value
    return types.make(name, type=int(kind), **{_FIELDS[kind]: content})


def _wanted(
    types: Distribution, service: str, parameters: Mapping[str, NodeParameter], request: bytes
) -> list[NodeParameter]:
    """Return the parameters with the names in a request. Return no parameter if a name is unknown."""
    names = cast(_Names, types.decode(f"{service}_Request", request)).names
    if len(names) > MAX_NAMES or not all(name in parameters for name in names):
        return []
    return [parameters[name] for name in names]


def _descriptor(types: Distribution, parameter: NodeParameter) -> object:
    """Return rcl_interfaces/msg/ParameterDescriptor. A missing bound is the greatest number of its type."""
    ranges: dict[str, object] = {}
    low, high = parameter.minimum, parameter.maximum
    if low is not None or high is not None:
        if parameter.kind is ParameterKind.DOUBLE:
            bounds = types.make(
                "rcl_interfaces/msg/FloatingPointRange",
                from_value=-sys.float_info.max if low is None else float(low),
                to_value=sys.float_info.max if high is None else float(high),
            )
            ranges["floating_point_range"] = [bounds]
        else:
            bounds = types.make(
                "rcl_interfaces/msg/IntegerRange",
                from_value=-(2**63) if low is None else int(low),
                to_value=2**63 - 1 if high is None else int(high),
                step=1,
            )
            ranges["integer_range"] = [bounds]
    return types.make(
        "rcl_interfaces/msg/ParameterDescriptor",
        name=parameter.name,
        type=int(parameter.kind),
        description=parameter.description,
        additional_constraints=f"one of: {', '.join(parameter.choices)}" if parameter.choices else "",
        read_only=parameter.read_only,
        **ranges,
    )


def _parameter(types: Distribution, parameter: NodeParameter, value: Value) -> object:
    content = parameter_value(types, parameter.kind, value)
    return types.make("rcl_interfaces/msg/Parameter", name=parameter.name, value=content)


def _given(parameter: _ReadParameter) -> GivenParameter:
    kind = _KINDS.get(parameter.value.type, ParameterKind.NOT_SET)
    content = getattr(parameter.value, _FIELDS[kind]) if kind else None
    if isinstance(content, list | np.ndarray):
        content = tuple(cast("list[str]", content if isinstance(content, list) else content.tolist()))
    return GivenParameter(parameter.name, kind, cast(Value, content))


def _response(types: Distribution, service: str, /, **fields: object) -> bytes:
    return types.encoded(f"{service}_Response", **fields)
