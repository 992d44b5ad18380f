"""What the mouse does on the map: look around, or work with a tool."""

import math
from dataclasses import dataclass
from enum import StrEnum

from ui.model.watching.tools import LEAST_SIZE


class MapTool(StrEnum):
    """What a press on the map begins."""

    LOOK = "look"
    GOAL = "goal"
    POSE = "pose"
    CARRY = "carry"
    OBSTACLE = "obstacle"


CLICK_DISTANCE = 0.1
"""Metres of dragging below which a press was a click."""
DEFAULT_SIZE = 0.5
"""Metres across an obstacle that is put by a click."""


@dataclass(frozen=True, slots=True)
class Gesture:
    """From where the button was pressed to where the pointer is; map frame, metres."""

    tool: MapTool
    x: float
    y: float
    to_x: float
    to_y: float

    @property
    def length(self) -> float:
        """How far it was dragged."""
        return math.hypot(self.to_x - self.x, self.to_y - self.y)

    @property
    def is_click(self) -> bool:
        """Whether it was hardly dragged at all."""
        return self.length < CLICK_DISTANCE

    @property
    def heading(self) -> float:
        """The direction it was dragged in."""
        return math.atan2(self.to_y - self.y, self.to_x - self.x)

    @property
    def size(self) -> float:
        """Metres across an obstacle that is dragged out from its middle."""
        return DEFAULT_SIZE if self.is_click else max(2.0 * self.length, LEAST_SIZE)


@dataclass(frozen=True, slots=True)
class ToolHelp:
    """How a tool is called and used.

    Attributes:
        label: on its button.
        key: that takes it up.
        how: told in the status bar while it is in hand.
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
