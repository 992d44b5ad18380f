"""Tools of the mouse on the map: look around, or act on robots and obstacles."""

import math
from dataclasses import dataclass
from enum import StrEnum

from ui.model.watching.tools import LEAST_SIZE


class MapTool(StrEnum):
    """A tool, which decides what a press on the map begins."""

    LOOK = "look"
    GOAL = "goal"
    POSE = "pose"
    CARRY = "carry"
    OBSTACLE = "obstacle"


CLICK_DISTANCE = 0.1
"""Meters of dragging below which a press is a click."""
DEFAULT_SIZE = 0.5
"""Meters across an obstacle that is added by a click."""


@dataclass(frozen=True, slots=True)
class Gesture:
    """A stroke from where the button was pressed to where the pointer is; map frame, meters."""

    tool: MapTool
    x: float
    y: float
    to_x: float
    to_y: float

    @property
    def length(self) -> float:
        """Distance of the drag, meters."""
        return math.hypot(self.to_x - self.x, self.to_y - self.y)

    @property
    def is_click(self) -> bool:
        """True when it was hardly dragged at all."""
        return self.length < CLICK_DISTANCE

    @property
    def heading(self) -> float:
        """Direction of the drag, radians."""
        return math.atan2(self.to_y - self.y, self.to_x - self.x)

    @property
    def size(self) -> float:
        """Meters across an obstacle that is dragged out from its middle."""
        return DEFAULT_SIZE if self.is_click else max(2.0 * self.length, LEAST_SIZE)


@dataclass(frozen=True, slots=True)
class ToolHelp:
    """Name and usage of a tool.

    Attributes:
        label: on its button.
        key: selects it.
        how: instructions in the status bar while it is selected.
    """

    label: str
    key: str
    how: str


TOOLS = {
    MapTool.LOOK: ToolHelp("Move", "M", "Drag to move the map, turn the wheel to zoom, click a robot to select it."),
    MapTool.GOAL: ToolHelp("Goal", "G", "Press where {robot} shall go, drag to where it shall face, and let go."),
    MapTool.POSE: ToolHelp("Pose", "P", "Press where {robot} shall believe it is, drag to where it faces, and let go."),
    MapTool.CARRY: ToolHelp("Kidnap", "K", "Drag a robot to another place; it is not told."),
    MapTool.OBSTACLE: ToolHelp("Obstacle", "O", "Drag out an obstacle from its middle; click one to take it away."),
}
