"""The kinds of robots that a study may have."""

from enum import StrEnum


class RobotsFrom(StrEnum):
    """Source of the robots."""

    SIM = "sim"
    ROS = "ros"
