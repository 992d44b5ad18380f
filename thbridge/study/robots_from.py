"""Sources of robots that a study may use."""

from enum import StrEnum


class RobotsFrom(StrEnum):
    """Source of the robots."""

    SIM = "sim"
    ROS = "ros"
    ROS2 = "ros2"

    @property
    def is_real(self) -> bool:
        """True for real robots."""
        return self is not RobotsFrom.SIM
