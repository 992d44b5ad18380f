"""Parameters of layered costmaps, with the names of costmap_2d."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from sim.parameters.declaration import live, param

_LAYERS = "list of layers; here always static, obstacle, robots and inflation; their keys `enabled` switch them off"
_VOXELS = "setting of the voxel layer; lasers here scan a single plane"


@dataclass(frozen=True, slots=True)
class StaticParameters:
    """The walls of the map (costmap_2d's StaticLayer)."""

    ros_only: ClassVar[Mapping[str, str]] = {
        "map_topic": "topic of the map",
        "first_map_only": "ignore maps after the first one",
        "subscribe_to_updates": "subscribe to changes of the map",
    }

    enabled: bool = live(True, "use the walls of the map")
    track_unknown_space: bool = param(True, "treat unknown cells of the map as unknown; if false, as free")
    lethal_cost_threshold: int = param(100, "map cells with at least this value are obstacles", "", 0, 100)
    unknown_cost_value: int = param(-1, "value of unknown cells in the map", "", -128, 255)
    trinary_costmap: bool = param(
        True, "treat cells below the threshold as free; if false, their costs are proportional to their values"
    )
    use_maximum: bool = param(False, "let the map only raise costs, never lower them")


@dataclass(frozen=True, slots=True)
class ObservationSource:
    """One entry of observation_sources. In ROS each entry is a sensor. Here all entries use the same laser."""

    ros_only: ClassVar[Mapping[str, str]] = {
        "topic": "topic of the readings",
        "sensor_frame": "frame of the sensor; here always the laser's pose on the robot",
        "data_type": "type of the messages",
        "observation_persistence": "time for which readings are kept; here each reading is used once",
        "expected_update_rate": "interval after which missing readings are an error",
        "min_obstacle_height": "ignore points below this height; lasers here scan a single plane",
        "max_obstacle_height": "ignore points above this height; lasers here scan a single plane",
    }

    name: str = param("scan", "name in observation_sources")
    marking: bool = param(True, "let readings mark obstacles")
    clearing: bool = param(False, "let readings clear the space in front of them")
    inf_is_valid: bool = param(False, "let beams that hit nothing clear as well")
    obstacle_range: float | None = param(
        None, "maximum range at which readings mark obstacles; null: the layer's value", "m", 0, 50
    )
    raytrace_range: float | None = param(
        None, "maximum range at which readings clear space; null: the layer's value", "m", 0, 50
    )


@dataclass(frozen=True, slots=True)
class ObstacleParameters:
    """Marking and clearing by the laser (costmap_2d's ObstacleLayer)."""

    ros_only: ClassVar[Mapping[str, str]] = {
        "transform_tolerance": "maximum age of transforms",
        "max_obstacle_height": "ignore points above this height; lasers here scan a single plane",
        "min_obstacle_height": "ignore points below this height; lasers here scan a single plane",
        "origin_z": _VOXELS,
        "z_resolution": _VOXELS,
        "z_voxels": _VOXELS,
        "unknown_threshold": _VOXELS,
        "mark_threshold": _VOXELS,
        "publish_voxel_map": _VOXELS,
    }
    sections_named_in: ClassVar[str] = "observation_sources"
    not_in_ros: ClassVar[frozenset[str]] = frozenset({"explained_distance", "clear_between_beams"})

    enabled: bool = live(True, "use the obstacles that the laser sees")
    footprint_clearing_enabled: bool = live(True, "clear the cells under the robot's footprint")
    combination_method: int = live(
        1, "0: laser obstacles replace the map's costs, 1: they can only raise them, 2 to 99: no effect", "", 0, 99
    )
    track_unknown_space: bool | None = param(
        None, "treat cells not yet seen as unknown; if false, as free; null: the costmap's value"
    )
    obstacle_range: float = live(2.5, "maximum range at which readings mark obstacles", "m", 0, 50)
    raytrace_range: float = live(3.0, "maximum range at which readings clear space", "m", 0, 50)
    observation_sources: tuple[ObservationSource, ...] = param(
        (), "names of observation sources, separated by blanks; each has a section of that name"
    )
    explained_distance: float = param(
        0.0,
        "readings within this distance of a mapped wall or another robot mark no obstacle (not in ROS; 0: all mark)",
        "m",
        0,
        2,
    )
    clear_between_beams: bool = param(
        False, "also clear cells between two neighboring beams if both beams end behind these cells (not in ROS)"
    )


@dataclass(frozen=True, slots=True)
class RobotsParameters:
    """The other robots at the poses that they report (the GridLayer of the 2016 study; not in ROS)."""

    enabled: bool = param(True, "use the other robots as obstacles")
    under_way: bool = param(True, "include robots that have an itinerary; if false, include only resting robots")
    path_length: float = param(0.0, "distance ahead of other robots up to which their paths have costs", "m", 0, 50)
    path_cost: int = param(128, "cost of cells on the paths of other robots", "", 0, 252)


@dataclass(frozen=True, slots=True)
class InflationParameters:
    """Costs around obstacles (costmap_2d's InflationLayer)."""

    enabled: bool = live(True, "add costs around obstacles")
    inflation_radius: float = live(
        0.55, "distance from obstacles up to which cells have costs, rounded up to whole cells", "m", 0, 50
    )
    cost_scaling_factor: float = live(10.0, "exponential decay of costs with distance", "1/m", 0, 100)
    inflate_unknown: bool = live(False, "add costs to unknown cells as well")


_COSTMAP_ROS_ONLY: Mapping[str, str] = {
    "plugins": _LAYERS,
    "map_type": _LAYERS,
    "global_frame": "frame of the costmap; here the map frame",
    "robot_base_frame": "frame of the robot",
    "transform_tolerance": "maximum age of transforms",
    "always_send_full_costmap": "publish the whole costmap every time",
    "footprint_topic": "topic from which footprints are read",
    "published_footprint_topic": "topic on which the footprint is published",
    "rolling_window": "move the costmap with the robot; here only the local costmap moves",
    "resolution": "size of a cell; here as in the map",
    "origin_x": "origin of the costmap; here that of the map, or a corner of the window around the robot",
    "origin_y": "origin of the costmap; here that of the map, or a corner of the window around the robot",
    "inscribed_radius": "read by move_base only; here computed from the footprint",
    "circumscribed_radius": "read by move_base only; here computed from the footprint",
    "max_obstacle_height": "ignore points above this height; lasers here scan a single plane",
    "min_obstacle_height": "ignore points below this height; lasers here scan a single plane",
    "map_topic": "topic of the map",
    "origin_z": _VOXELS,
    "z_resolution": _VOXELS,
    "z_voxels": _VOXELS,
    "unknown_threshold": _VOXELS,
    "mark_threshold": _VOXELS,
    "publish_voxel_map": _VOXELS,
}


@dataclass(frozen=True, slots=True)
class CostmapParameters:
    """Parameters of either costmap of a robot."""

    # Parameters of the costmap that costmap_2d passes on to its layers.
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

    footprint: tuple[tuple[float, float], ...] = live(
        (), "corners of the robot; if empty, a circle of robot_radius", "m"
    )
    robot_radius: float | None = live(
        0.46, "radius of a robot without a footprint; null: use the corners of its true body", "m", 0, 10
    )
    footprint_padding: float = live(0.01, "padding added to every corner of the footprint", "m", 0, 10)
    track_unknown_space: bool = param(False, "treat cells without any information as unknown; if false, as free")
    update_frequency: float = live(
        5.0,
        "update rate; in the global costmap only scans clear at this rate: they mark at once, plans update the costs",
        "Hz",
        0.1,
        50,
    )
    publish_frequency: float = live(0.0, "rate at which the costmap is published; 0: never", "Hz", 0, 50)
    static_layer: StaticParameters = param(StaticParameters(), "layer of the map's walls")
    obstacle_layer: ObstacleParameters = param(ObstacleParameters(), "layer of obstacles seen by the laser")
    robots_layer: RobotsParameters = param(RobotsParameters(), "layer of the other robots")
    inflation_layer: InflationParameters = param(InflationParameters(), "layer of costs around obstacles")


@dataclass(frozen=True, slots=True)
class GlobalCostmapParameters(CostmapParameters):
    """The costmap that covers the map and is used for plans."""

    ros_only: ClassVar[Mapping[str, str]] = {
        **_COSTMAP_ROS_ONLY,
        "width": "size of the costmap; here as large as the map",
        "height": "size of the costmap; here as large as the map",
    }


@dataclass(frozen=True, slots=True)
class LocalCostmapParameters(CostmapParameters):
    """The costmap that moves with the robot and is used for velocity commands."""

    ros_only: ClassVar[Mapping[str, str]] = _COSTMAP_ROS_ONLY

    width: float = live(10.0, "extent along the map's x axis", "m", 1, 100)
    height: float = live(10.0, "extent along the map's y axis", "m", 1, 100)
