"""Mouse tools on the map: look around, or act on robots and obstacles."""

import math
from dataclasses import dataclass
from enum import StrEnum

from ui.model.watching.tools import LEAST_SIZE


class MapTool(StrEnum):
    """Tool that decides the effect of the left mouse button on the map."""

    LOOK = "look"
    GOAL = "goal"
    POSE = "pose"
    CARRY = "carry"
    OBSTACLE = "obstacle"


CLICK_DISTANCE = 0.1
"""A drag that is shorter than this counts as a click, meters."""
DEFAULT_SIZE = 0.5
"""Diameter or side of an obstacle that a click adds, meters."""


@dataclass(frozen=True, slots=True)
class Gesture:
    """Stroke on the map, from the press of the button to the current place of the pointer; map frame, meters."""

    tool: MapTool
    x: float
    y: float
    to_x: float
    to_y: float

    @property
    def length(self) -> float:
        """Length of the drag, meters."""
        return math.hypot(self.to_x - self.x, self.to_y - self.y)

    @property
    def is_click(self) -> bool:
        """True if the pointer was moved by less than `CLICK_DISTANCE`."""
        return self.length < CLICK_DISTANCE

    @property
    def heading(self) -> float:
        """Direction of the drag, radians."""
        return math.atan2(self.to_y - self.y, self.to_x - self.x)

    @property
    def size(self) -> float:
        """Size of an obstacle, drawn from its middle: diameter or side, meters."""
        return DEFAULT_SIZE if self.is_click else max(2.0 * self.length, LEAST_SIZE)


@dataclass(frozen=True, slots=True)
class ToolHelp:
    """Name and usage of a tool.

    Attributes:
        label: text on the button.
        key: shortcut that selects the tool.
        how: instructions that are shown while the tool is selected.
    """

    label: str
    key: str
    how: str


TOOLS = {
    MapTool.LOOK: ToolHelp("Move", "M", "Drag to move the map, turn the wheel to zoom, click a robot to select it."),
    MapTool.GOAL: ToolHelp(
        "Goal", "G", "Press the mouse button at the goal of {robot}, drag in the direction of the goal, and release."
    ),
    MapTool.POSE: ToolHelp(
        "Pose", "P", "Press the mouse button at the new pose estimate of {robot}, drag in its direction, and release."
    ),
    MapTool.CARRY: ToolHelp("Kidnap", "K", "Drag a robot to another place. The robot's software is not informed."),
    MapTool.OBSTACLE: ToolHelp(
        "Obstacle", "O", "Drag from the middle of a new obstacle to its edge. Click an obstacle to remove it."
    ),
}
