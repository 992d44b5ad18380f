"""Parameters of localization by the true pose, with the names of fake_localization."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from sim.parameters.declaration import param


@dataclass(frozen=True, slots=True)
class FakeLocalizationParameters:
    """Localization by the true pose. Parameters are named as in fake_localization. The map frame may have an offset."""

    ros_only: ClassVar[Mapping[str, str]] = {
        "odom_frame_id": "name of the odometry frame in tf",
        "base_frame_id": "name of the robot frame in tf",
        "global_frame_id": "name of the map frame in tf",
        "transform_tolerance": "time by which transforms are postdated",
    }

    delta_x: float = param(0.0, "x of the map's origin in the simulator's frame", "m")
    delta_y: float = param(0.0, "y of the map's origin in the simulator's frame", "m")
    delta_yaw: float = param(
        0.0, "heading of the map, subtracted from the heading in the simulator's frame", "rad", -6.2832, 6.2832
    )
