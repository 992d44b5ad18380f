"""What is drawn on a map, as values: a map view draws these and knows nothing else."""

from dataclasses import dataclass
from typing import Literal

from sim.common.geometry import FloatArray, Pose2

RoomState = Literal["unvisited", "reserved", "visited"]


@dataclass(frozen=True, slots=True)
class RoomMark:
    """A room as it is drawn now.

    Attributes:
        room: its number as people count, from 1.
        name: what people call it.
        region: (n, 2) corners of its floor, map frame, metres.
        state: told apart by a sign and a pattern, not by colour alone.
        choosable: a click on it would be a choice just now.
        considered: the participant looks at it, by mouse or keyboard.
        found: what is known of the treasure in it, in a word or two; empty when nothing is.
        robot: who visited it, or is under way to it; index in the team.
    """

    room: int
    name: str
    region: FloatArray
    state: RoomState
    choosable: bool = False
    considered: bool = False
    found: str = ""
    robot: int | None = None


@dataclass(frozen=True, slots=True)
class EllipseMark:
    """An uncertainty: half axes in metres, the longer one turned by `angle` from the map's x axis."""

    major: float
    minor: float
    angle: float


@dataclass(frozen=True, slots=True, eq=False)
class RobotMark:
    """A robot as it is drawn in one frame. All in the map frame, metres and radians.

    Attributes:
        robot: index in the team; its colour follows from it.
        label: its name on the map, short.
        pose: where it believes it is.
        footprint: (n, 2) corners of its body in its own frame.
        selected: the one that the participant commands.
        trouble: it is lost, silent or has no energy left; drawn so that it shows without colour.
        trail: (k, 2) where it has been, oldest first.
        way: (m, 2) where it means to go, its own place first.
        ellipse: how sure it is of its place, where that is shown.
        truth: where it really is, where that is shown.
        taken: who else than the participant commands it, in words; empty when nobody does.
    """

    robot: int
    label: str
    pose: Pose2
    footprint: FloatArray
    selected: bool
    trouble: bool
    trail: FloatArray
    path: FloatArray
    ellipse: EllipseMark | None = None
    truth: Pose2 | None = None
    commander: str = ""
