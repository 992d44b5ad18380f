"""Parameters of the study under the names that they have on ROS's parameter server.

What `amcl` has of a robot is `/robot1/amcl/...`; all that lives in move_base (costmaps, planners) is
`/robot1/move_base/...`, move_base's own at its top; the rest of the study is `/thbridge/...`.
"""

import dataclasses
from collections.abc import Iterator, Mapping
from enum import Enum
from pathlib import PurePath
from typing import TYPE_CHECKING, TypeAlias, cast

from sim.parameters import RobotParameters
from thbridge.ros.names import RobotNames

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

ParameterValue: TypeAlias = "bool | int | float | str | list[ParameterValue] | dict[str, ParameterValue]"
Tree: TypeAlias = dict[str, ParameterValue]

NODES = ("amcl", "ekf", "fake_localization")
"""Sections that are nodes of their own in ROS."""
MOVE_BASE = "move_base"


def robot_tree(software: RobotParameters) -> Tree:
    """All that stands under a robot's namespace: its software, by node."""
    whole = tree_of(software)
    nodes: Tree = {name: whole[name] for name in NODES}
    own = cast(Tree, whole[MOVE_BASE])
    inside = {
        field.name: whole[field.name]
        for field in dataclasses.fields(software)
        if field.name not in (*NODES, MOVE_BASE) and isinstance(whole[field.name], dict)
    }
    plain = {name: value for name, value in whole.items() if not isinstance(value, dict)}
    return {**plain, **nodes, MOVE_BASE: {**own, **inside}}


def tree_of(section: "DataclassInstance") -> Tree:
    """A section as a tree of parameters; what has no value (null) is left out, as ROS has no word for it."""
    tree: Tree = {}
    listed = cast(str | None, getattr(type(section), "sections_named_in", None))
    for field in dataclasses.fields(section):
        value = cast(object, getattr(section, field.name))
        if value is None:
            continue
        if field.name == listed:
            sections = cast(tuple["DataclassInstance", ...], value)
            named = {cast(str, getattr(each, "name")): tree_of(each) for each in sections}  # noqa: B009 - any class
            tree[field.name] = " ".join(named)
            tree.update(named)
        else:
            tree[field.name] = _value(value)
    return tree


def _value(value: object) -> ParameterValue:
    if isinstance(value, Enum):
        return str(value.value)
    if isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, PurePath):
        return str(value)
    if isinstance(value, tuple | list):
        return [_value(item) for item in cast(tuple[object, ...], value)]
    if isinstance(value, Mapping):
        return {str(key): _value(item) for key, item in cast(Mapping[object, object], value).items()}
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return tree_of(value)
    raise TypeError(f"no parameter can be made of {value!r}")


def leaves(key: str, value: object) -> Iterator[tuple[str, object]]:
    """Every single parameter at or below a key, by its full name."""
    if not isinstance(value, dict):
        yield key, value
        return
    for name, inner in cast(dict[str, object], value).items():
        yield from leaves(f"{key}/{name}", inner)


def has(software: RobotParameters, path: str) -> bool:
    """Whether this is the place of a parameter, and not of a section or of nothing."""
    section: object = software
    for name in path.split("."):
        if not dataclasses.is_dataclass(section) or name not in {field.name for field in dataclasses.fields(section)}:
            return False
        section = cast(object, getattr(section, name))
    return not dataclasses.is_dataclass(section)


def value_at(software: RobotParameters, path: str) -> "ParameterValue | None":
    """The value at a place of the software ("amcl.min_particles"); None where it has none."""
    section: object = software
    for name in path.split("."):
        section = cast(object, getattr(section, name))
    return None if section is None else _value(section)


def path_of(robot: RobotNames, key: str) -> str | None:
    """The place in `RobotParameters` ("amcl.min_particles") of a parameter of this robot; None if it is not one.

    Args:
        robot: whose namespace.
        key: the parameter's full name, "/robot1/amcl/min_particles".
    """
    below = key.removeprefix(f"{robot.namespace}/")
    names = below.split("/")
    if below == key or not all(names):
        return None
    if names[0] == MOVE_BASE and len(names) > 1 and names[1] in {f.name for f in dataclasses.fields(RobotParameters)}:
        del names[0]
    return ".".join(names)


def name_of(robot: RobotNames, path: str) -> str:
    """The full name of a parameter: the inverse of `path_of`."""
    head = path.partition(".")[0]
    node = "" if head in (*NODES, MOVE_BASE) or "." not in path else f"{MOVE_BASE}/"
    return f"{robot.namespace}/{node}{path.replace('.', '/')}"
