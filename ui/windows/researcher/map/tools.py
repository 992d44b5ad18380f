"""What the mouse does on the map: look around, or work with a tool."""

import math
from dataclasses import dataclass
from enum import StrEnum

from ui.model.watching.tools import LEAST_SIZE


class Tool(StrEnum):
    """What a press on the map begins."""

    LOOK = "look"
    GOAL = "goal"
    POSE = "pose"
    CARRY = "carry"
    OBSTACLE = "obstacle"


STILL = 0.1
"""Metres of dragging below which a press was a click."""
USUAL = 0.5
"""Metres across an obstacle that is put by a click."""


@dataclass(frozen=True, slots=True)
class Gesture:
    """From where the button was pressed to where the pointer is; map frame, metres."""

    tool: Tool
    x: float
    y: float
    to_x: float
    to_y: float

    @property
    def length(self) -> float:
        """How far it was dragged."""
        return math.hypot(self.to_x - self.x, self.to_y - self.y)

    @property
    def click(self) -> bool:
        """Whether it was hardly dragged at all."""
        return self.length < STILL

    @property
    def heading(self) -> float:
        """The direction it was dragged in."""
        return math.atan2(self.to_y - self.y, self.to_x - self.x)

    @property
    def size(self) -> float:
        """Metres across an obstacle that is dragged out from its middle."""
        return USUAL if self.click else max(2.0 * self.length, LEAST_SIZE)


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
    Tool.LOOK: ToolHelp("Move", "M", "Drag to move the map, turn the wheel to zoom, click a robot to select it."),
    Tool.GOAL: ToolHelp("Goal", "G", "Press where {robot} shall go, drag to where it shall face, and let go."),
    Tool.POSE: ToolHelp("Pose", "P", "Press where {robot} shall believe it is, drag to where it faces, and let go."),
    Tool.CARRY: ToolHelp("Kidnap", "K", "Drag a robot to another place; it is not told."),
    Tool.OBSTACLE: ToolHelp("Obstacle", "O", "Drag out an obstacle from its middle; click one to take it away."),
}
