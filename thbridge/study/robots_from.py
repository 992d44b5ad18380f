"""Sources of robots that a study may use."""

from enum import StrEnum


class RobotsFrom(StrEnum):
    """Source of the robots."""

    SIM = "sim"
    ROS = "ros"
