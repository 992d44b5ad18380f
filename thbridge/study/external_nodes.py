"""Nodes of a ROS graph that replace the nodes of simulated robots."""

from enum import StrEnum


class ExternalNodes(StrEnum):
    """External ROS nodes that replace the robots' own software: none, move_base, or both move_base and amcl.

    An external amcl cannot be combined with our own move_base.
    """

    NONE = "none"
    MOVE_BASE = "move_base"
    BOTH = "both"

    def has(self, node: str) -> bool:
        """Return True if another program runs this node of the robots: amcl or move_base."""
        return (node == "amcl" and self.amcl) or (node == "move_base" and self.move_base)

    @property
    def amcl(self) -> bool:
        """True if an external amcl replaces the robots' own localization."""
        return self is ExternalNodes.BOTH

    @property
    def move_base(self) -> bool:
        """True if an external move_base replaces the robots' own navigation."""
        return self is not ExternalNodes.NONE
