"""ROS's defaults: the values that nodes of ROS noetic use if a parameter is not set.

These are the defaults of the fields in the parameter classes. A study starts with other values (see `robot`). Fields
that ROS does not have (`not_in_ros`) have no such default.
"""

import dataclasses
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Never, TypeVar, cast

from sim.parameters.declaration import is_section

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

T = TypeVar("T", bound="DataclassInstance")


def not_in_ros(section: type) -> frozenset[str]:
    """Return the names of those fields of a class that ROS does not have."""
    return cast(frozenset[str], getattr(section, "not_in_ros", frozenset()))


def with_ros_defaults(section: T) -> T:
    """Return a section with ROS's default for each parameter that ROS has, also in all sections inside it."""
    changes: dict[str, object] = {}
    for field in dataclasses.fields(section):
        own = cast(object, getattr(section, field.name))
        if field.name in not_in_ros(type(section)):
            continue
        changes[field.name] = with_ros_defaults(own) if is_section(own) else cast(object, field.default)
    return dataclasses.replace(section, **cast(Mapping[str, Never], changes))


def parameters_of(section: "DataclassInstance", prefix: str = "") -> Iterator[tuple[str, object]]:
    """Yield path (e.g. `obstacle_layer.obstacle_range`) and value of each parameter of a section that ROS also has."""
    for field in dataclasses.fields(section):
        own = cast(object, getattr(section, field.name))
        if field.name in not_in_ros(type(section)):
            continue
        if is_section(own):
            yield from parameters_of(own, f"{prefix}{field.name}.")
        else:
            yield prefix + field.name, own
