"""Change of parameters while a robot runs, like ROS's dynamic_reconfigure.

Parameters that may change are declared with `live` instead of `param`. These are the parameters in ROS's .cfg files,
some parameters that ROS does not have or cannot change, and the true noise of the sensors. The path of a parameter
consists of its keys, joined by dots. It starts at a robot's software (`local_costmap.inflation_layer.inflation_radius`)
or at the true world (`world.laser.range_noise`).
"""

import dataclasses
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Literal, TypeVar, cast, get_args, get_type_hints

from sim.parameters.declaration import is_section
from sim.parameters.robot import MIN_MAX_PAIRS, RobotParameters
from sim.parameters.world import WorldParameters

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

P = TypeVar("P", RobotParameters, WorldParameters)

WORLD_PREFIX = "world."
"""Prefix of the paths of `WorldParameters`."""

RejectionReason = Literal["unknown", "fixed", "kind", "range"]


@dataclass(frozen=True, slots=True)
class ParameterRejection:
    """Rejection of a new value. The parameter keeps its present value.

    Attributes:
        path: path of the parameter.
        reason: code of the cause: the parameter does not exist ("unknown"), cannot change while the robot runs
            ("fixed"), or the value has the wrong type ("kind") or is out of range ("range").
        sentence: the cause for people, with a remedy if one exists.
    """

    path: str
    reason: RejectionReason
    sentence: str


@dataclass(frozen=True, slots=True)
class DeclaredParameter:
    """Declaration of a parameter.

    Attributes:
        path: path of the parameter, see the module.
        types: types of its values. They include `NoneType` if the parameter may be None.
        default: default of the class.
        help: its meaning in one sentence.
        unit: SI unit; empty for a pure number.
        minimum: minimum value. If None, there is no limit.
        maximum: maximum value. If None, there is no limit.
        choices: allowed words; if empty, any word.
        live: True if the parameter may change while a robot runs.
    """

    path: str
    types: tuple[object, ...]
    default: object
    help: str
    unit: str
    minimum: float | None
    maximum: float | None
    choices: tuple[str, ...]
    live: bool


def live_parameters(into: "type[DataclassInstance]" = RobotParameters, path: str = "") -> Iterator[DeclaredParameter]:
    """Yield all parameters that may change while a robot runs, in the order of declaration.

    Args:
        into: class that declares the parameters.
        path: path of this class if it is a section of another class.
    """
    return (parameter for parameter in declared_parameters(into, path) if parameter.live)


def declared_parameters(
    into: "type[DataclassInstance]" = RobotParameters, path: str = ""
) -> Iterator[DeclaredParameter]:
    """Yield all parameters, also those that are fixed while a robot runs, in the order of declaration.

    Args:
        into: class that declares the parameters.
        path: path of this class if it is a section of another class.
    """
    hints = get_type_hints(into)
    for field in dataclasses.fields(into):
        place, hint = f"{path}.{field.name}" if path else field.name, cast(object, hints[field.name])
        if isinstance(hint, type) and dataclasses.is_dataclass(hint):
            yield from declared_parameters(hint, place)
        elif "unit" in field.metadata:  # Other fields are not declared as parameters.
            known = field.metadata
            yield DeclaredParameter(
                place,
                _types(hint),
                cast(object, field.default),
                cast(str, known["help"]),
                cast(str, known["unit"]),
                cast("float | None", known["minimum"]),
                cast("float | None", known["maximum"]),
                cast(tuple[str, ...], known["choices"]),
                is_live(field),
            )


def _types(hint: object) -> tuple[object, ...]:
    return get_args(hint) if type(None) in get_args(hint) else (hint,)


def reconfigurable() -> Iterator[str]:
    """Return the paths of the parameters of a robot's software that may change while it runs, in declared order."""
    return (parameter.path for parameter in live_parameters())


def is_live(field: "dataclasses.Field[object]") -> bool:
    """Return True if a parameter may change while a robot runs."""
    return bool(field.metadata.get("live"))


def reconfigured(parameters: P, path: str, value: object) -> P | ParameterRejection:
    """Return the parameters with one new value, or the reason why this value is rejected.

    Args:
        parameters: the present parameters.
        path: path of the parameter to change.
        value: new value. A footprint may also be a text in ROS's form: `[[x, y], ...]`.
    """
    below = path.removeprefix(WORLD_PREFIX) if isinstance(parameters, WorldParameters) else path
    changed = _changed(parameters, below.split("."), path, value)
    if isinstance(changed, ParameterRejection | WorldParameters):
        return changed
    for section, low, high in MIN_MAX_PAIRS:
        least, greatest = (_value_at(changed, f"{section}.{name}") for name in (low, high))
        if cast(float, least) > cast(float, greatest):
            sentence = f"{section}.{low} would be {least}, above {section}.{high}, which would be {greatest}"
            return ParameterRejection(path, "range", sentence)
    return changed


def with_values(parameters: P, values: Sequence[tuple[str, object]]) -> P | ParameterRejection:
    """Return the parameters with all these values, or the reason why a value is rejected.

    The order of values does not matter. For example, a new minimum above the old maximum is set after the new maximum.
    """
    left = tuple(values)
    while left:
        waiting: list[tuple[str, object]] = []
        rejected: list[ParameterRejection] = []
        for path, value in left:
            changed = reconfigured(parameters, path, value)
            if isinstance(changed, ParameterRejection):
                waiting.append((path, value))
                rejected.append(changed)
            else:
                parameters = changed
        if len(waiting) == len(left):
            return rejected[0]
        left = tuple(waiting)
    return parameters


def fixed_differences(before: P, after: P) -> tuple[str, ...]:
    """Return the paths of parameters that differ, without those that may change while a robot runs."""
    return tuple(_differences(before, after, ""))


def _differences(before: "DataclassInstance", after: "DataclassInstance", path: str) -> Iterator[str]:
    for field in dataclasses.fields(before):
        place = f"{path}.{field.name}" if path else field.name
        one, other = cast(object, getattr(before, field.name)), cast(object, getattr(after, field.name))
        if one == other or is_live(field):
            continue
        if is_section(one) and is_section(other):
            yield from _differences(one, other, place)
        else:
            yield place


def _value_at(section: object, path: str) -> object:
    for name in path.split("."):
        section = cast(object, getattr(section, name))
    return section


@cache
def _hints(section: type) -> Mapping[str, object]:
    """Return the types of the fields of a class. Collecting them takes a millisecond."""
    return get_type_hints(section)


_Section = TypeVar("_Section", bound="DataclassInstance")


def _changed(section: _Section, names: list[str], path: str, value: object) -> _Section | ParameterRejection:
    """Return the section with the value set at the path `names` inside the section."""
    name, *inner = names
    fields = {field.name: field for field in dataclasses.fields(section)}
    if name not in fields:
        return ParameterRejection(path, "unknown", f"there is no parameter {path}")
    own = cast(object, getattr(section, name))
    if inner:
        if not is_section(own):
            return ParameterRejection(path, "unknown", f"there is no parameter {path}")
        inside = _changed(own, inner, path, value)
        return inside if isinstance(inside, ParameterRejection) else dataclasses.replace(section, **{name: inside})
    if not is_live(fields[name]):
        return ParameterRejection(path, "fixed", f"{path} cannot change while the robot runs")
    if isinstance(value, str) and value == own:
        return section  # Names of installed parts are not among the choices, but the present name is allowed.
    new = _fit(_hints(type(section))[name], fields[name].metadata, path, value)
    return new if isinstance(new, ParameterRejection) else dataclasses.replace(section, **{name: new})


def _fit(hint: object, metadata: Mapping[str, object], path: str, value: object) -> object:
    """Return the value, converted to the type of the field, or the reason why it does not fit."""
    kinds = _types(hint)
    choices = cast(tuple[str, ...], metadata["choices"])
    if value is None and type(None) in kinds:
        return None
    if bool in kinds:
        return (
            value
            if isinstance(value, bool)
            else ParameterRejection(path, "kind", f"{path} is true or false, not {value!r}")
        )
    if str in kinds:
        if not isinstance(value, str):
            return ParameterRejection(path, "kind", f"{path} is text, not {value!r}")
        if choices and value not in choices:
            return ParameterRejection(path, "range", f"{path} is {' or '.join(choices)}, not {value!r}")
        return value
    if int in kinds or float in kinds:
        number = _number(value, whole=int in kinds)
        if number is None:
            kind = "a whole number" if int in kinds else "a number"
            return ParameterRejection(path, "kind", f"{path} is {kind}, not {value!r}")
        return _in_range(metadata, path, number)
    corners = _corners(value)
    if corners is None:
        return ParameterRejection(path, "kind", f"{path} is three or more corners, [[x, y], ...], or [], not {value!r}")
    return corners


def _number(value: object, whole: bool) -> float | int | None:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    if whole:
        return value if isinstance(value, int) else None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if math.isfinite(number) else None


def _in_range(metadata: Mapping[str, object], path: str, number: float | int) -> object:
    least, greatest = cast("float | None", metadata["minimum"]), cast("float | None", metadata["maximum"])
    unit = f" {metadata['unit']}" if metadata["unit"] else ""
    if least is not None and number < least:
        return ParameterRejection(path, "range", f"{path} is at least {least:.10g}{unit}, not {number:.10g}")
    if greatest is not None and number > greatest:
        return ParameterRejection(path, "range", f"{path} is at most {greatest:.10g}{unit}, not {number:.10g}")
    return number


def _corners(value: object) -> tuple[tuple[float, float], ...] | None:
    """Return a value as a polygon, or None if it is not a polygon."""
    if isinstance(value, str):
        try:
            value = cast(object, json.loads(value or "[]"))
        except (ValueError, RecursionError):  # Untrusted clients may send deeply nested brackets.
            return None
    if not isinstance(value, list | tuple) or 0 < len(value) < 3:
        return None
    corners: list[tuple[float, float]] = []
    for corner in cast(tuple[object, ...], value):
        if not isinstance(corner, list | tuple) or len(corner) != 2:
            return None
        x, y = (_number(coordinate, whole=False) for coordinate in cast(tuple[object, ...], corner))
        if x is None or y is None:
            return None
        corners.append((x, y))
    return tuple(corners)
