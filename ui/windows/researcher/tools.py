"""What the mouse does on the map: look around, or work with a tool."""

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import Literal


class Tool(StrEnum):
    """What a press on the map begins."""

    LOOK = "look"
    GOAL = "goal"
    POSE = "pose"
    CARRY = "carry"
    OBSTACLE = "obstacle"


Shape = Literal["circle", "box"]
"""Of an obstacle."""

STILL = 0.1
"""Metres of dragging below which a press was a click."""


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
    def heading(self) -> float | None:
        """The direction it was dragged in; None for a click."""
        return math.atan2(self.to_y - self.y, self.to_x - self.x) if self.length >= STILL else None


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
    Tool.OBSTACLE: ToolHelp("Obstacle", "O", "Press and drag out an obstacle; click one to take it away."),
}
