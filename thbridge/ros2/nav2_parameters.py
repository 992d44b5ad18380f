"""Parameters of the Nav2 nodes of a robot, under Nav2's names, and of the session's own node.

Each parameter of a robot's software is a parameter of exactly one node. A parameter that Nav2 does not have is named by
its path, for example `move_base.planner_frequency`. Parameters of Nav2 without a counterpart are missing.

The plugins `FollowPath` and `GridBased` are the local and the global planner that the robot has at the start. The other
planners' parameters are named by their paths.
"""

import dataclasses
import json
from collections.abc import Iterable, Mapping
from functools import lru_cache
from types import NoneType
from typing import cast

from sim.parameters import CostmapParameters, DeclaredParameter, ObservationSource, RobotParameters, declared_parameters
from sim.robot.costmap.view import CostmapName
from thbridge.ros.names import CALLER, MAP_FRAME, RobotNames
from thbridge.ros.parameters import Tree, value_at
from thbridge.ros2 import nav2_names
from thbridge.ros2.follow_waypoints import STOP_ON_FAILURE
from thbridge.ros2.parameters import NodeParameter, ParameterKind, ParameterNode, Value, fixed, kind_among

COSTMAPS: tuple[CostmapName, CostmapName] = ("global_costmap", "local_costmap")
LIFECYCLE_MANAGERS: Mapping[str, tuple[str, ...]] = {
    "lifecycle_manager_localization": ("map_server", "amcl"),
    "lifecycle_manager_navigation": (
        "controller_server",
        "planner_server",
        "behavior_server",
        "bt_navigator",
        "waypoint_follower",
    ),
}
"""Nodes that each lifecycle manager of a robot manages."""
NAV2_NODES = (
    "map_server",
    "amcl",
    "lifecycle_manager_localization",
    *LIFECYCLE_MANAGERS["lifecycle_manager_navigation"],
    "lifecycle_manager_navigation",
    *COSTMAPS,
)
"""Nodes of each robot. A costmap has a namespace of its own."""

GOAL_CHECKER = "general_goal_checker"
PROGRESS_CHECKER = "progress_checker"
CONTROLLER = "FollowPath"
PLANNER = "GridBased"
SCAN = "scan"

_DWB, _NAVFN = "dwa_local_planner/DWAPlannerROS", "navfn/NavfnROS"
_PLUGINS: Mapping[str, str] = {_DWB: "dwb_core::DWBLocalPlanner", _NAVFN: "nav2_navfn_planner::NavfnPlanner"}
"""Nav2's plugins that correspond to planners. Other planners keep their names."""
_CRITICS = ("Oscillation", "BaseObstacle", "GoalAlign", "PathAlign", "PathDist", "GoalDist")
_LAYERS: Mapping[str, str] = {
    "static_layer": "nav2_costmap_2d::StaticLayer",
    "obstacle_layer": "nav2_costmap_2d::ObstacleLayer",
    "inflation_layer": "nav2_costmap_2d::InflationLayer",
}
_NOT_IN_NAV2 = (
    "static_layer.track_unknown_space",
    "obstacle_layer.track_unknown_space",
    "obstacle_layer.explained_distance",
    "obstacle_layer.clear_between_beams",
)
_SERVERS: Mapping[str, str] = {
    "NavfnROS": "planner_server",
    "GlobalPlanner": "planner_server",
    "move_base.base_global_planner": "planner_server",
    "move_base.make_plan_add_unreachable_goal": "planner_server",
    "TrajectoryPlannerROS": "controller_server",
    "DWAPlannerROS": "controller_server",
    "move_base.base_local_planner": "controller_server",
    "move_base.controller_frequency": "controller_server",
    "move_base.controller_patience": "controller_server",
    "move_base.oscillation_timeout": "controller_server",
    "move_base.oscillation_distance": "controller_server",
    "move_base.shutdown_costmaps": "controller_server",
    "move_base.clearing_rotation_allowed": "behavior_server",
    "move_base.conservative_reset_dist": "behavior_server",
    "move_base.recovery_behaviors": "behavior_server",
    "move_base": "bt_navigator",
}
"""Nodes by path. The longest beginning of a path decides; all other parameters belong to amcl, or to a costmap."""


def nav2_nodes(external_amcl: bool, external_navigation: bool) -> tuple[str, ...]:
    """Return the nodes of a robot that are part of the session.

    Args:
        external_amcl: True if another program localizes the robots.
        external_navigation: True if another program plans and drives for the robots.
    """
    of_session = ["map_server"]
    if not external_amcl:
        of_session += NAV2_NODES[1:3]
    if not external_navigation:
        of_session += NAV2_NODES[3:]
    return tuple(of_session)


def robot_nodes(robot: int, software: RobotParameters, resolution: float) -> tuple[ParameterNode, ...]:
    """Return the nodes of a robot, in the order of `NAV2_NODES`.

    Args:
        robot: index of the robot in the team.
        software: its parameters at the start.
        resolution: size of a cell of the map and of the costmaps, meters.
    """
    named = RobotNames.of(robot)
    shared = _shared(software)
    own = _of_this_robot(named, software, resolution)
    return tuple(
        ParameterNode(
            named.topic(name) if name in COSTMAPS else named.namespace,
            name,
            robot,
            _by_name((*_EVERY_NODE, *shared.get(name, ()), *own.get(name, ()))),
        )
        for name in NAV2_NODES
    )


def session_node(rest: Tree) -> ParameterNode:
    """Return the node of the session. Its parameters are those of the study that belong to no robot's software."""
    namespace, _, name = CALLER.rpartition("/")
    return ParameterNode(namespace or "/", name, None, _by_name((*_EVERY_NODE, *_leaves("", rest))))


def _by_name(parameters: Iterable[NodeParameter]) -> dict[str, NodeParameter]:
    return {each.name: each for each in sorted(parameters, key=lambda each: each.name)}


_EVERY_NODE = (
    fixed("use_sim_time", True, "use the time of the topic /clock"),
    fixed("start_type_description_service", True, "offer the service get_type_description"),
)


@lru_cache(maxsize=64)
def _shared(software: RobotParameters) -> Mapping[str, tuple[NodeParameter, ...]]:
    """Return the parameters that robots with the same software share, by node."""
    found: dict[str, list[NodeParameter]] = {name: [] for name in NAV2_NODES}
    for declared in declared_parameters():
        value = value_at(software, declared.path)
        if value is None and not declared.live:
            continue  # The parameter of another section applies.
        node = _node_of(declared.path)
        for name, factor in _names(declared.path, software):
            found[node].append(_parameter(declared, name, factor, value))
    return {node: tuple(parameters) for node, parameters in found.items()}


def _node_of(path: str) -> str:
    parts = path.split(".")
    for length in range(len(parts), 0, -1):
        if (server := _SERVERS.get(".".join(parts[:length]))) is not None:
            return server
    return parts[0] if parts[0] in COSTMAPS else "amcl"


def _names(path: str, software: RobotParameters) -> list[tuple[str, float]]:
    """Return the names of a parameter in Nav2, with the factors of their units. Without a name, return the path."""
    section, _, rest = path.partition(".")
    base = software.move_base
    match section:
        case "amcl":
            return _renamed(path, rest, nav2_names.AMCL)
        case "global_costmap" | "local_costmap":
            return _costmap_names(path, rest, cast(CostmapParameters, getattr(software, section)))
        case "NavfnROS" | "GlobalPlanner" if base.base_global_planner.endswith(section):
            known = {} if rest == "use_dijkstra" else nav2_names.NAVFN
            return _renamed(path, rest, known, f"{PLANNER}.")
        case "DWAPlannerROS" if base.base_local_planner.endswith(section):
            if rest in nav2_names.HALVED.values():
                return [(name, 2.0) for name, _ in _renamed(path, rest, nav2_names.HALVED, f"{CONTROLLER}.")]
            return _checked(rest) or _renamed(path, rest, nav2_names.DWB, f"{CONTROLLER}.")
        case "TrajectoryPlannerROS" if base.base_local_planner.endswith(section):
            return _checked(rest) or _renamed(path, rest, nav2_names.TRAJECTORY, f"{CONTROLLER}.")
        case "move_base" if rest == "controller_frequency":
            return [(rest, 1.0)]
        case "move_base":
            return _renamed(path, rest, nav2_names.PROGRESS_CHECKER, f"{PROGRESS_CHECKER}.")
        case _:
            return [(path, 1.0)]


def _checked(name: str) -> list[tuple[str, float]]:
    """Return the name of a local planner's parameter that belongs to the goal checker in Nav2, if it does."""
    return _renamed("", name, nav2_names.GOAL_CHECKER, f"{GOAL_CHECKER}.") if name in _GOALS else []


_GOALS = frozenset(nav2_names.GOAL_CHECKER.values())


def _renamed(path: str, own: str, names: Mapping[str, str], prefix: str = "") -> list[tuple[str, float]]:
    return [(f"{prefix}{name}", 1.0) for name, known in names.items() if known == own] or [(path, 1.0)]


def _costmap_names(path: str, rest: str, costmap: CostmapParameters) -> list[tuple[str, float]]:
    layer, _, name = rest.rpartition(".")
    if layer == nav2_names.STATIC_LAYER and name in nav2_names.OF_THE_MAP:
        return [(name, 1.0)]
    if layer == "robots_layer" or rest in _NOT_IN_NAV2:
        return [(path, 1.0)]
    if layer == "obstacle_layer" and name in nav2_names.SOURCE.values():
        # In Nav2, each source has its own range. A source without a range uses this one.
        sources = costmap.obstacle_layer.observation_sources
        without = [each.name for each in sources if getattr(each, name) is None]
        known = next(nav2 for nav2, ours in nav2_names.SOURCE.items() if ours == name)
        return [(f"{layer}.{source}.{known}", 1.0) for source in without] or [(path, 1.0)]
    return [(rest, 1.0)]


def _parameter(declared: DeclaredParameter, name: str, factor: float, value: object) -> NodeParameter:
    """Return the parameter with its meaning and bounds."""
    description = declared.help + (f" [{declared.unit}]" if declared.unit else "")
    if NoneType in declared.types and declared.live:
        description += " (null is sent as 0)"
    if name != declared.path:
        description += f" ({declared.path})"
    kind = kind_among(declared.types)
    if not declared.live:
        given = float(cast(float, value)) if kind is ParameterKind.DOUBLE else _value(value)
        return dataclasses.replace(fixed(name, given, description), choices=declared.choices)
    low, high = declared.minimum, declared.maximum
    return NodeParameter(
        name,
        kind,
        description,
        path=declared.path,
        minimum=None if low is None else low * factor,
        maximum=None if high is None else high * factor,
        choices=declared.choices,
        factor=factor,
    )


def _value(value: object) -> Value:
    """Return a value of the study as the value of a parameter. Lists of sections become the sections' names."""
    if isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, list):
        items = cast("list[object]", value)
        if all(isinstance(each, dict) and "name" in each for each in items):
            return tuple(str(cast("dict[str, object]", each)["name"]) for each in items)
        if all(type(each) is type(items[0]) and isinstance(each, bool | int | float | str) for each in items):
            return tuple(cast("list[str]", items))
    return json.dumps(value)


def _leaves(prefix: str, tree: Tree) -> Iterable[NodeParameter]:
    for name, value in tree.items():
        if isinstance(value, dict):
            yield from _leaves(f"{prefix}{name}.", value)
        else:
            yield fixed(f"{prefix}{name}", _value(value), "value of the study")


def _of_this_robot(
    named: RobotNames, software: RobotParameters, resolution: float
) -> Mapping[str, tuple[NodeParameter, ...]]:
    """Return the names of frames, topics and plugins of a robot's nodes, by node."""
    frames = (
        fixed("global_frame", MAP_FRAME, "frame of the map"),
        fixed("robot_base_frame", named.base_footprint, "frame of the robot"),
    )
    local, global_ = software.move_base.base_local_planner, software.move_base.base_global_planner
    critics = (fixed(f"{CONTROLLER}.critics", _CRITICS, "parts of the score of a trajectory"),)
    return {
        "map_server": (
            fixed("frame_id", MAP_FRAME, "frame of the map"),
            fixed("topic_name", named.topic("map"), "topic of the map"),
        ),
        "amcl": (
            fixed("global_frame_id", MAP_FRAME, "frame of the map"),
            fixed("odom_frame_id", named.odom, "frame of the wheel odometry"),
            fixed("base_frame_id", named.base_footprint, "frame of the robot"),
            fixed("tf_broadcast", True, "publish the transform from the map to the odometry frame"),
            fixed("scan_topic", named.topic(SCAN), "topic of laser scans"),
            fixed("map_topic", named.topic("map"), "topic of the map"),
        ),
        "controller_server": (
            fixed("controller_plugins", (CONTROLLER,), "names of the local planners"),
            fixed(f"{CONTROLLER}.plugin", _PLUGINS.get(local, local), "the local planner at the start"),
            fixed("goal_checker_plugins", (GOAL_CHECKER,), "names of the goal checkers"),
            fixed(f"{GOAL_CHECKER}.plugin", "nav2_controller::SimpleGoalChecker", "the goal checker"),
            fixed("progress_checker_plugins", (PROGRESS_CHECKER,), "names of the progress checkers"),
            fixed(f"{PROGRESS_CHECKER}.plugin", "nav2_controller::SimpleProgressChecker", "the progress checker"),
            *(critics if local == _DWB else ()),
        ),
        "planner_server": (
            fixed("planner_plugins", (PLANNER,), "names of the global planners"),
            fixed(f"{PLANNER}.plugin", _PLUGINS.get(global_, global_), "the global planner at the start"),
        ),
        "behavior_server": frames,
        "bt_navigator": (*frames, fixed("navigators", ("navigate_to_pose",), "names of the navigators")),
        "waypoint_follower": (
            fixed("stop_on_failure", STOP_ON_FAILURE, "end a task at the first waypoint that is not reached"),
        ),
        **{
            name: (
                fixed("autostart", True, "activate the nodes at the start"),
                fixed("bond_timeout", 0.0, "timeout of the connections to the nodes; 0: there are none [s]"),
                fixed("node_names", managed, "nodes that are managed"),
            )
            for name, managed in LIFECYCLE_MANAGERS.items()
        },
        **{
            name: (
                *frames,
                fixed("resolution", resolution, "size of a cell, as in the map [m]"),
                fixed("rolling_window", name == "local_costmap", "move the costmap with the robot"),
                fixed("plugins", tuple(_LAYERS), "names of the layers"),
                *(fixed(f"{layer}.plugin", plugin, "class of the layer") for layer, plugin in _LAYERS.items()),
                *_sources(named, cast(CostmapParameters, getattr(software, name))),
            )
            for name in COSTMAPS
        },
    }


def _sources(named: RobotNames, costmap: CostmapParameters) -> Iterable[NodeParameter]:
    """Yield the parameters of the observation sources of a costmap."""
    sources = costmap.obstacle_layer.observation_sources
    yield fixed(
        "obstacle_layer.observation_sources",
        " ".join(each.name for each in sources),
        "names of the observation sources, separated by blanks",
    )
    names = {ours: nav2 for nav2, ours in nav2_names.SOURCE.items()}
    for source in sources:
        place = f"obstacle_layer.{source.name}"
        yield fixed(f"{place}.topic", named.topic(SCAN), "topic of the readings")
        yield fixed(f"{place}.data_type", "LaserScan", "type of the readings")
        for field in dataclasses.fields(ObservationSource):
            value = cast(Value, getattr(source, field.name))
            if field.name != "name" and value is not None:
                yield fixed(f"{place}.{names.get(field.name, field.name)}", value, cast(str, field.metadata["help"]))
