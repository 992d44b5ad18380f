"""Names of the study's parameters on ROS's parameter server.

Parameters of `amcl` are `/robot1/amcl/...`. Parameters of move_base, including its costmaps and planners, are
`/robot1/move_base/...`. All other parameters of the study are `/thbridge/...`.
"""

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from enum import Enum
from pathlib import PurePath
from typing import TYPE_CHECKING, TypeAlias, cast

from sim.parameters import RobotParameters
from thbridge.ros.names import MAP, MAP_FRAME, RobotNames

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

ParameterValue: TypeAlias = "bool | int | float | str | list[ParameterValue] | dict[str, ParameterValue]"
Tree: TypeAlias = dict[str, ParameterValue]

NODES = ("amcl", "ekf", "ukf", "fake_localization")
"""Sections that are separate nodes in ROS."""
MOVE_BASE = "move_base"
DEFAULT_RECOVERY = ("conservative_reset", "rotate_recovery", "aggressive_reset", "rotate_recovery")
"""move_base's default recovery behaviors (move_base.cpp, loadDefaultRecoveryBehaviors)."""


_LAYERS = {
    "static_layer": "costmap_2d::StaticLayer",
    "obstacle_layer": "costmap_2d::ObstacleLayer",
    "inflation_layer": "costmap_2d::InflationLayer",
}
"""Layers that ROS's costmaps also have, in ROS's order, with the classes of their plugins."""
_RECOVERIES = {
    "conservative_reset": "clear_costmap_recovery/ClearCostmapRecovery",
    "rotate_recovery": "rotate_recovery/RotateRecovery",
    "aggressive_reset": "clear_costmap_recovery/ClearCostmapRecovery",
}
_DRIVES_AHEAD: Mapping[str, Tree] = {
    "TrajectoryPlannerROS": {"holonomic_robot": False},
    "DWAPlannerROS": {"max_vel_y": 0.0, "min_vel_y": 0.0, "vy_samples": 1},
}
"""With these parameters, ROS's planners assume that a robot cannot drive sideways. By their defaults, it can."""
_LOWEST = -1.0
"""Minimum height of used laser readings, meters above the base. It is negative, because rounding must not exclude the
plane of the floor."""


def robot_tree(software: RobotParameters, named: RobotNames, body: Sequence[Sequence[float]]) -> Tree:
    """Return the parameters in a robot's namespace, in the form that ROS's own amcl and move_base read.

    In addition to the study's parameters, they contain frames, topics and plugins. Real nodes that replace our nodes
    in the robot's namespace need these.

    Args:
        software: parameters of the robot.
        named: names of the robot.
        body: corners of its true body, meters in its base frame. Costmaps without another footprint use them.
    """
    whole = tree_of(software)
    nodes: Tree = {name: cast(Tree, whole[name]) for name in NODES}
    frames: Tree = {"global_frame_id": MAP_FRAME, "odom_frame_id": named.odom, "base_frame_id": named.base_footprint}
    nodes["amcl"] = {**cast(Tree, whole["amcl"]), **frames}
    nodes["fake_localization"] = {**cast(Tree, whole["fake_localization"]), **frames}
    inside = {
        field.name: cast(Tree, whole[field.name]) | _DRIVES_AHEAD.get(field.name, {})
        for field in dataclasses.fields(software)
        if field.name not in (*NODES, MOVE_BASE) and isinstance(whole[field.name], dict)
    }
    for name, rolling in (("global_costmap", False), ("local_costmap", True)):
        inside[name] = _costmap(inside[name], named, body, rolling)
    plain = {name: value for name, value in whole.items() if not isinstance(value, dict)}
    return {**plain, **nodes, MOVE_BASE: {**_navigator(cast(Tree, whole[MOVE_BASE])), **inside}}


def _costmap(own: Tree, named: RobotNames, body: Sequence[Sequence[float]], rolling: bool) -> Tree:
    """Return a costmap's parameters in the form that costmap_2d reads."""
    tree: Tree = {
        **own,
        "plugins": [{"name": name, "type": kind} for name, kind in _LAYERS.items() if cast(Tree, own[name])["enabled"]],
        "global_frame": MAP_FRAME,
        "robot_base_frame": named.base_footprint,
        "rolling_window": rolling,
    }
    tree["static_layer"] = {**cast(Tree, own["static_layer"]), "map_topic": MAP}
    layer = dict(cast(Tree, own["obstacle_layer"]))
    layer["min_obstacle_height"] = _LOWEST
    for source in cast(str, layer["observation_sources"]).split():
        given = dict(cast(Tree, layer[source]))
        del given["name"]
        seen: Tree = {"topic": named.topic("scan"), "data_type": "LaserScan", "min_obstacle_height": _LOWEST}
        layer[source] = {**given, **seen}
    tree["obstacle_layer"] = layer
    if not tree["footprint"]:
        # costmap_2d fails if a footprint is an empty list.
        del tree["footprint"]
        if "robot_radius" not in tree:
            tree["footprint"] = [[float(x), float(y)] for x, y in body]
    return tree


def _navigator(own: Tree) -> Tree:
    """Return move_base's own parameters, without those of its costmaps and planners."""
    tree = dict(own)
    names = [cast(str, cast(Tree, each)["name"]) for each in cast("list[ParameterValue]", own["recovery_behaviors"])]
    if tuple(names) == DEFAULT_RECOVERY:
        # move_base has these behaviors by default, and refuses a list with a repeated name.
        del tree["recovery_behaviors"]
        return tree
    listed: list[ParameterValue] = []
    for number, name in enumerate(names):
        again = names[:number].count(name)
        listed.append({"name": f"{name}_{again + 1}" if again else name, "type": _RECOVERIES.get(name, name)})
    tree["recovery_behaviors"] = listed
    return tree


def tree_of(section: "DataclassInstance") -> Tree:
    """Return a section as a tree of parameters. Null values are omitted, because ROS's parameter server has no null."""
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
    raise TypeError(f"{value!r} cannot be a parameter of ROS")


def leaves(key: str, value: object) -> Iterator[tuple[str, object]]:
    """Yield each parameter at or below a key, with its full name."""
    if not isinstance(value, dict):
        yield key, value
        return
    for name, inner in cast(dict[str, object], value).items():
        yield from leaves(f"{key}/{name}", inner)


def has(software: RobotParameters, path: str) -> bool:
    """Return True if a path leads to a parameter. Return False if it leads to a section or does not exist."""
    section: object = software
    for name in path.split("."):
        if not dataclasses.is_dataclass(section) or name not in {field.name for field in dataclasses.fields(section)}:
            return False
        section = cast(object, getattr(section, name))
    return not dataclasses.is_dataclass(section)


def value_at(software: RobotParameters, path: str) -> "ParameterValue | None":
    """Return the value of the parameter at a path, such as "amcl.min_particles". Return None for null."""
    section: object = software
    for name in path.split("."):
        section = cast(object, getattr(section, name))
    return None if section is None else _value(section)


def path_of(robot: RobotNames, key: str) -> str | None:
    """Return the path in `RobotParameters` of a parameter of this robot, such as "amcl.min_particles".

    Return None for other keys.

    Args:
        robot: names of the robot.
        key: full name of the parameter, such as "/robot1/amcl/min_particles".
    """
    below = key.removeprefix(f"{robot.namespace}/")
    names = below.split("/")
    if below == key or not all(names):
        return None
    if names[0] == MOVE_BASE and len(names) > 1 and names[1] in {f.name for f in dataclasses.fields(RobotParameters)}:
        del names[0]
    return ".".join(names)


def name_of(robot: RobotNames, path: str) -> str:
    """Return the full name of the parameter at a path. This is the inverse of `path_of`."""
    head = path.partition(".")[0]
    node = "" if head in (*NODES, MOVE_BASE) or "." not in path else f"{MOVE_BASE}/"
    return f"{robot.namespace}/{node}{path.replace('.', '/')}"
