"""Layered costmaps, under costmap_2d's names."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from sim.parameters.declaration import live, param

_LAYERS = "which layers there are: here static, obstacle, robots, inflation, each with its `enabled`"
_VOXELS = "the voxel layer; lasers here see in one plane"


@dataclass(frozen=True, slots=True)
class StaticParameters:
    """The walls of the map (costmap_2d's StaticLayer)."""

    ros_only: ClassVar[Mapping[str, str]] = {
        "map_topic": "where the map comes from",
        "first_map_only": "a map that is published anew is not taken",
        "subscribe_to_updates": "where the map's changes come from",
    }

    enabled: bool = live(True, "whether the map's walls count")
    track_unknown_space: bool = param(True, "unknown cells of the map are unknown, else free")
    lethal_cost_threshold: int = param(100, "cells of the map with this value or more are obstacles", "", 0, 100)
    unknown_cost_value: int = param(-1, "the value of the map's unknown cells", "", -128, 255)
    trinary_costmap: bool = param(True, "values below the threshold are free, else in proportion")
    use_maximum: bool = param(False, "the map only raises costs, never lowers them")


@dataclass(frozen=True, slots=True)
class ObservationSource:
    """One use of the laser by the obstacle layer; ROS has one for each sensor, here the one laser stands for all."""

    ros_only: ClassVar[Mapping[str, str]] = {
        "topic": "where readings come from",
        "sensor_frame": "where the sensor sits: here the laser's own place",
        "data_type": "the kind of message",
        "observation_persistence": "how long readings are kept: here every one is used once",
        "expected_update_rate": "when missing readings are an error",
        "min_obstacle_height": "lower points are not seen; lasers here see in one plane",
        "max_obstacle_height": "higher points are not seen; lasers here see in one plane",
    }

    name: str = param("scan", "what it is called in observation_sources")
    marking: bool = param(True, "readings mark obstacles")
    clearing: bool = param(False, "readings clear the space before them")
    inf_is_valid: bool = param(False, "beams that hit nothing clear too")
    obstacle_range: float | None = param(None, "farther readings do not mark; null: the layer's", "m", 0, 50)
    raytrace_range: float | None = param(None, "farther space is not cleared; null: the layer's", "m", 0, 50)


@dataclass(frozen=True, slots=True)
class ObstacleParameters:
    """Marking and clearing by the laser (costmap_2d's ObstacleLayer)."""

    ros_only: ClassVar[Mapping[str, str]] = {
        "transform_tolerance": "how old transforms may be",
        "max_obstacle_height": "higher points do not mark; lasers here see in one plane",
        "min_obstacle_height": "lower points do not mark; lasers here see in one plane",
        "origin_z": _VOXELS,
        "z_resolution": _VOXELS,
        "z_voxels": _VOXELS,
        "unknown_threshold": _VOXELS,
        "mark_threshold": _VOXELS,
        "publish_voxel_map": _VOXELS,
    }
    sections_named_in: ClassVar[str] = "observation_sources"
    not_in_ros: ClassVar[frozenset[str]] = frozenset({"explained_distance", "clear_between_beams"})

    enabled: bool = live(True, "whether what the laser sees counts")
    footprint_clearing_enabled: bool = live(True, "the robot's own place is free")
    combination_method: int = live(
        1, "0: what the laser saw replaces the map, 1: it raises the map's costs, else nothing", "", 0, 99
    )
    track_unknown_space: bool | None = param(None, "cells not seen yet are unknown, else free; null: the costmap's")
    obstacle_range: float = live(2.5, "farther readings do not mark", "m", 0, 50)
    raytrace_range: float = live(3.0, "farther space is not cleared", "m", 0, 50)
    observation_sources: tuple[ObservationSource, ...] = param(
        (), "names of the uses of the laser, with blanks between; each has a section under its name"
    )
    explained_distance: float = param(
        0.0,
        "readings this near to a wall of the map, or to another robot, do not mark (not ROS's; 0: all do)",
        "m",
        0,
        2,
    )
    clear_between_beams: bool = param(False, "cells between two beams that both see past them clear too (not ROS's)")


@dataclass(frozen=True, slots=True)
class RobotsParameters:
    """The other robots, where they say that they are (the GridLayer of the 2016 study; not ROS's)."""

    enabled: bool = param(True, "whether the other robots count")
    under_way: bool = param(True, "robots that mean to drive count too, not only those that rest")
    path_length: float = param(0.0, "how far along their paths the others make costs", "m", 0, 50)
    path_cost: int = param(128, "the cost of cells on these paths", "", 0, 252)


@dataclass(frozen=True, slots=True)
class InflationParameters:
    """Costs around obstacles (costmap_2d's InflationLayer)."""

    enabled: bool = live(True, "whether obstacles make costs around them")
    inflation_radius: float = live(0.55, "costs reach this far from an obstacle, rounded up to whole cells", "m", 0, 50)
    cost_scaling_factor: float = live(10.0, "how fast the costs fall with the distance", "1/m", 0, 100)
    inflate_unknown: bool = live(False, "unknown cells take costs too")


_COSTMAP_ROS_ONLY: Mapping[str, str] = {
    "plugins": _LAYERS,
    "map_type": _LAYERS,
    "global_frame": "the frame it is kept in: here the map's",
    "robot_base_frame": "the frame of the robot",
    "transform_tolerance": "how old transforms may be",
    "always_send_full_costmap": "how it is published",
    "footprint_topic": "where footprints come from",
    "published_footprint_topic": "where the footprint is published",
    "rolling_window": "whether it moves along: here the global costmap covers the map, the local one moves along",
    "resolution": "side of a cell: here the map's",
    "origin_x": "where it begins: here where the map does, or around the robot",
    "origin_y": "where it begins: here where the map does, or around the robot",
    "inscribed_radius": "read by move_base alone: here it follows from the footprint",
    "circumscribed_radius": "read by move_base alone: here it follows from the footprint",
    "max_obstacle_height": "higher points do not mark; lasers here see in one plane",
    "min_obstacle_height": "lower points do not mark; lasers here see in one plane",
    "map_topic": "where the map comes from",
    "origin_z": _VOXELS,
    "z_resolution": _VOXELS,
    "z_voxels": _VOXELS,
    "unknown_threshold": _VOXELS,
    "mark_threshold": _VOXELS,
    "publish_voxel_map": _VOXELS,
}


@dataclass(frozen=True, slots=True)
class CostmapParameters:
    """Parameters that both costmaps of a robot have in common."""

    # Names that costmap_2d hands down to its layers.
    passed_on: ClassVar[Mapping[str, str]] = {
        "static_map": "static_layer.enabled",
        "track_unknown_space": "static_layer.track_unknown_space",
        "unknown_cost_value": "static_layer.unknown_cost_value",
        "lethal_cost_threshold": "static_layer.lethal_cost_threshold",
        "obstacle_range": "obstacle_layer.obstacle_range",
        "raytrace_range": "obstacle_layer.raytrace_range",
        "observation_sources": "obstacle_layer.observation_sources",
        "cost_scaling_factor": "inflation_layer.cost_scaling_factor",
        "inflation_radius": "inflation_layer.inflation_radius",
    }
    not_in_ros: ClassVar[frozenset[str]] = frozenset({"robots_layer"})

    footprint: tuple[tuple[float, float], ...] = live((), "corners of the robot; none: a circle of robot_radius", "m")
    robot_radius: float | None = live(
        0.46, "radius of a robot whose corners are not given; null: corners of its true body", "m", 0, 10
    )
    footprint_padding: float = live(0.01, "added to every corner of the footprint", "m", 0, 10)
    track_unknown_space: bool = param(False, "cells of which nothing is known are unknown, else free")
    update_frequency: float = live(
        5.0,
        "updates per second; of the global costmap, how often scans clear: they mark at once, costs follow for plans",
        "Hz",
        0.1,
        50,
    )
    publish_frequency: float = live(0.0, "how often it is shown, in a recording or live; 0: never", "Hz", 0, 50)
    static_layer: StaticParameters = param(StaticParameters(), "the walls of the map")
    obstacle_layer: ObstacleParameters = param(ObstacleParameters(), "marking and clearing by the laser")
    robots_layer: RobotsParameters = param(RobotsParameters(), "the other robots")
    inflation_layer: InflationParameters = param(InflationParameters(), "costs around obstacles")


@dataclass(frozen=True, slots=True)
class GlobalCostmapParameters(CostmapParameters):
    """The costmap that covers the map, for plans."""

    ros_only: ClassVar[Mapping[str, str]] = {
        **_COSTMAP_ROS_ONLY,
        "width": "its size: here the map's",
        "height": "its size: here the map's",
    }


@dataclass(frozen=True, slots=True)
class LocalCostmapParameters(CostmapParameters):
    """The costmap that moves along with the robot, for commands."""

    ros_only: ClassVar[Mapping[str, str]] = _COSTMAP_ROS_ONLY

    width: float = live(10.0, "its extent along the map's x axis", "m", 1, 100)
    height: float = live(10.0, "its extent along the map's y axis", "m", 1, 100)
