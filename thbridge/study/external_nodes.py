"""Nodes of a ROS graph that others run in place of those of simulated robots."""

from enum import StrEnum


class ExternalNodes(StrEnum):
    """The nodes of ROS that simulated robots leave to others: amcl has no use for who drives by our own move_base."""

    NONE = "none"
    MOVE_BASE = "move_base"
    BOTH = "both"

    @property
    def amcl(self) -> bool:
        """True where amcl is another's."""
        return self is ExternalNodes.BOTH

    @property
    def move_base(self) -> bool:
        """True where move_base is another's."""
        return self is not ExternalNodes.NONE
