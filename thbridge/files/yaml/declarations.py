"""Declarations in classes of parameters: ranges, choices, units and old names of their fields.

Most fields are declared with `sim.parameters.param`. Other fields of dataclasses are accepted, too.
"""

import dataclasses
import math
from collections.abc import Iterator, Mapping, Sequence
from enum import StrEnum
from pathlib import Path
from typing import Literal, cast, get_args, get_origin, get_type_hints

from thbridge.files.plugins import names_in

Metadata = Mapping[str, object]


def renamed_of(section: type) -> Mapping[str, str]:
    """Return the old names that a class of parameters still accepts, each with its present name."""
    return cast(Mapping[str, str], getattr(section, "renamed", {}))


def ros_only_of(section: type) -> Mapping[str, str]:
    """Return the names that a class accepts only because ROS has them, each with its meaning there."""
    return cast(Mapping[str, str], getattr(section, "ros_only", {}))


def model_of(field: "dataclasses.Field[object] | None") -> str | None:
    """Return the name of the field from which this field's entries get their defaults, or None."""
    return None if field is None else cast("str | None", field.metadata.get("like"))


def sections_named_in(section: type) -> str:
    """Return the name of the field that lists further sections. It is empty if the class has no such field."""
    return cast(str, getattr(section, "sections_named_in", ""))


def required(field: "dataclasses.Field[object]") -> bool:
    """Return True if files must have the field, because it has no default."""
    return field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING


def bounds(metadata: Metadata) -> tuple[float, float]:
    """Return the least and the greatest number allowed in a field; without a limit, they are infinite."""
    minimum = cast("float | None", metadata.get("minimum"))
    maximum = cast("float | None", metadata.get("maximum"))
    return (-math.inf if minimum is None else minimum), (math.inf if maximum is None else maximum)


def metadata_of_items(metadata: Metadata, hints: Sequence[object]) -> Sequence[Metadata]:
    """Return the metadata of each item of a list.

    A unit such as "m, m, rad" has one unit for each item; any other unit is for all items.

    Args:
        metadata: metadata of the list.
        hints: type of each item. A list of lists passes on all of its metadata, even if it has one unit per item.
    """
    units = str(metadata.get("unit", "")).split(", ")
    if len(units) == 1 or len(units) != len(hints) or any(get_origin(hint) is tuple for hint in hints):
        return [metadata] * len(hints)
    return [{**metadata, "unit": unit} for unit in units]


def choices_of(hint: object, metadata: Metadata) -> tuple[str, ...]:
    """Return the words allowed in a field; empty if all words are allowed."""
    if get_origin(hint) is Literal:
        return cast(tuple[str, ...], get_args(hint))
    if isinstance(hint, type) and issubclass(hint, StrEnum):
        return tuple(member.value for member in hint)
    return cast(tuple[str, ...], metadata.get("choices", ()))


def with_plugins(metadata: Metadata) -> Metadata:
    """Return the metadata of a field, with its choices extended by the installed plug-ins.

    The search for plug-ins takes some milliseconds, so callers use this only if they need all names.
    """
    group = metadata.get("plugins")
    if not group:
        return metadata
    built_in = cast(tuple[str, ...], metadata["choices"])
    return {**metadata, "choices": (*built_in, *(name for name in names_in(str(group)) if name not in built_in))}


def allowed(hint: object, metadata: Metadata) -> str:
    """Return a field's choices, or its range and unit: `amcl, ekf or truth`, `0 to 20 m/s`, `at least 1`; or ""."""
    choices = choices_of(hint, metadata)
    if choices:
        return " or ".join([", ".join(choices[:-1]), choices[-1]] if choices[1:] else choices)
    minimum, maximum = bounds(metadata)
    if math.isfinite(minimum) and math.isfinite(maximum):
        words = f"{minimum:.10g} to {maximum:.10g}"
    elif math.isfinite(minimum):
        words = f"at least {minimum:.10g}"
    elif math.isfinite(maximum):
        words = f"at most {maximum:.10g}"
    else:
        words = ""
    return f"{words} {metadata.get('unit', '')}".strip()


_KINDS: Mapping[object, str] = {
    bool: "true or false",
    int: "a whole number",
    float: "a number",
    str: "text",
    Path: "a path",
}


def wanted(hint: object, metadata: Metadata) -> str:
    """Return a request to write a valid value into a field."""
    words = allowed(hint, metadata)
    if choices_of(hint, metadata):
        return f"Write {words}"
    kind = _KINDS.get(hint, "a list" if get_origin(hint) is tuple else "a section")
    return f"Write {kind}, {words}" if words else f"Write {kind}"


def keys_of(into: type) -> str:
    """Return a sentence with the keys of a section."""
    return f"Its keys are {', '.join(field.name for field in dataclasses.fields(into))}"


def paths(into: type, key: str = "") -> Iterator[str]:
    """Yield the key paths of a dataclass and of the dataclasses inside it."""
    for name, hint in get_type_hints(into).items():
        place = f"{key}.{name}" if key else name
        yield place
        if isinstance(hint, type) and dataclasses.is_dataclass(hint):
            yield from paths(hint, place)
