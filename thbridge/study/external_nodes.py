"""Nodes of a ROS graph that replace the nodes of simulated robots."""

from enum import StrEnum


class ExternalNodes(StrEnum):
    """ROS nodes that replace ours: move_base alone, or amcl as well. An external amcl is of no use to our own
    move_base."""

    NONE = "none"
    MOVE_BASE = "move_base"
    BOTH = "both"

    @property
    def amcl(self) -> bool:
        """True if another amcl replaces ours."""
        return self is ExternalNodes.BOTH

    @property
    def move_base(self) -> bool:
        """True if another move_base replaces ours."""
        return self is not ExternalNodes.NONE
