"""Marks that a map view draws, as values; the view knows nothing else."""

from dataclasses import dataclass
from typing import Literal

from sim.common.geometry import Pose2
from sim.numerics.float_array import FloatArray
from thbridge.roles.shared.notices import Ellipse

RoomState = Literal["unvisited", "reserved", "visited", "won", "lost"]
"""State of a room as it is drawn; a visited room is won or lost once its treasure brought or cost points."""

VISITED: tuple[RoomState, ...] = ("visited", "won", "lost")
"""States of rooms that a robot has reached."""


def decided(points: int) -> RoomState:
    """Return the state of a room whose treasure was named for these points."""
    return "won" if points > 0 else "lost" if points < 0 else "visited"


@dataclass(frozen=True, slots=True)
class RoomMark:
    """Room as it is drawn now.

    Attributes:
        room: its number as people count, from 1.
        name: name for people.
        region: (n, 2) corners of its floor, map frame, meters.
        state: told apart by a sign and a pattern, not by color alone.
        choosable: True when a click on it would be a choice just now.
        considered: True when the participant looks at it, by mouse or keyboard.
        found: its treasure as far as it is known, in a word or two; empty when nothing is known.
        found_shorter: the same in fewer and fewer words.
        robot: index of the robot that visited it or drives to it.
        answer: what the participant said of its treasure, and the points, where `found` is not that already.
        answer_shorter: the same in fewer words.
    """

    room: int
    name: str
    region: FloatArray
    state: RoomState
    choosable: bool = False
    considered: bool = False
    found: str = ""
    found_shorter: tuple[str, ...] = ()
    robot: int | None = None
    answer: str = ""
    answer_shorter: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class RobotMark:
    """Robot as it is drawn in one frame. All in the map frame, meters and radians.

    Attributes:
        robot: index in the team; its color follows from it.
        label: its name on the map, short.
        pose: its estimated pose.
        footprint: (n, 2) corners of its body in its own frame.
        selected: True for the robot that the participant commands.
        trouble: True when it is lost, silent or has no energy left; drawn so that it shows without color.
        trail: (k, 2) past places, oldest first.
        path: (m, 2) planned path, its own place first.
        ellipse: uncertainty of its place, where that is shown.
        truth: its true pose, where that is shown.
        commander: the other party that commands it, in words; empty where the participant does.
    """

    robot: int
    label: str
    pose: Pose2
    footprint: FloatArray
    selected: bool
    trouble: bool
    trail: FloatArray
    path: FloatArray
    ellipse: Ellipse | None = None
    truth: Pose2 | None = None
    commander: str = ""
