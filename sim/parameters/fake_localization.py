"""Localization by the truth, under fake_localization's names."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from sim.parameters.declaration import param


@dataclass(frozen=True, slots=True)
class FakeLocalizationParameters:
    """Localization by the truth, under fake_localization's names: a map frame that lies beside the simulator's."""

    ros_only: ClassVar[Mapping[str, str]] = {
        "odom_frame_id": "the name of the odometry's frame in tf",
        "base_frame_id": "the name of the robot's frame in tf",
        "global_frame_id": "the name of the map's frame in tf",
        "transform_tolerance": "how far transforms are stamped into the future",
    }

    delta_x: float = param(0.0, "where the map's origin lies in the simulator's frame", "m")
    delta_y: float = param(0.0, "where the map's origin lies in the simulator's frame", "m")
    delta_yaw: float = param(0.0, "the map's heading, subtracted from that of the simulator", "rad", -6.2832, 6.2832)
