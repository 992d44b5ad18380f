"""The study's parameters under their names on ROS's parameter server.

Parameters of `amcl` are `/robot1/amcl/...`; those of move_base and of all that runs inside it (costmaps, planners) are
`/robot1/move_base/...`; the rest of the study is `/thbridge/...`.
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
"""Sections that are separate nodes in ROS."""
MOVE_BASE = "move_base"


def robot_tree(software: RobotParameters) -> Tree:
    """The parameters under a robot's namespace: its software, by node."""
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
    """A section as a tree of parameters. Values of null are left out: ROS's parameter server has no null."""
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
    """Yield every single parameter at or below a key, with its full name."""
    if not isinstance(value, dict):
        yield key, value
        return
    for name, inner in cast(dict[str, object], value).items():
        yield from leaves(f"{key}/{name}", inner)


def has(software: RobotParameters, path: str) -> bool:
    """True when a path names a parameter, not a section and not nothing."""
    section: object = software
    for name in path.split("."):
        if not dataclasses.is_dataclass(section) or name not in {field.name for field in dataclasses.fields(section)}:
            return False
        section = cast(object, getattr(section, name))
    return not dataclasses.is_dataclass(section)


def value_at(software: RobotParameters, path: str) -> "ParameterValue | None":
    """The value of the parameter at a path ("amcl.min_particles"); None where it is null."""
    section: object = software
    for name in path.split("."):
        section = cast(object, getattr(section, name))
    return None if section is None else _value(section)


def path_of(robot: RobotNames, key: str) -> str | None:
    """The path in `RobotParameters` ("amcl.min_particles") of a parameter of this robot; None for other keys.

    Args:
        robot: the robot's names.
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
