"""Marks that a map view draws, as values; the view has no other data."""

from dataclasses import dataclass
from typing import Literal

from sim.common.geometry import Pose2
from sim.numerics.float_array import FloatArray
from thbridge.roles.shared.notices import Ellipse

RoomState = Literal["unvisited", "reserved", "visited", "won", "lost"]
"""State of a room on the map; a visited room is won or lost after its treasure brought or cost points."""

VISITED: tuple[RoomState, ...] = ("visited", "won", "lost")
"""States of rooms that a robot has visited."""


def decided(points: int) -> RoomState:
    """Return the state of a room whose treasure was named for these points."""
    return "won" if points > 0 else "lost" if points < 0 else "visited"


@dataclass(frozen=True, slots=True)
class RoomMark:
    """Room at the moment of drawing.

    Attributes:
        room: its number as people count, from 1.
        name: name for people.
        region: (n, 2) corners of its floor, map frame, meters.
        state: shown by a sign and a pattern, not by color alone.
        choosable: True if a click on it would choose it at the moment.
        considered: True if the participant looks at it, by mouse or keyboard.
        found: the known properties of its treasure, in one or two words; empty if nothing is known.
        found_shorter: shorter versions of `found`, in the order of decreasing length.
        robot: index of the robot that visited it or drives to it.
        answer: the name that the participant gave its treasure, and the points, unless `found` already contains them.
        answer_shorter: `answer` in fewer words.
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
    """Robot at the moment of drawing, in the map frame, meters and radians.

    Attributes:
        robot: index in the team, which determines its color.
        label: its short name on the map.
        pose: its estimated pose.
        footprint: (n, 2) corners of its body in its own frame.
        selected: True for the robot that the participant commands.
        trouble: True if it is lost, does not answer or has no energy left; this is also visible without color.
        trail: (k, 2) past places, oldest first.
        path: (m, 2) planned path, its own place first.
        ellipse: uncertainty of its place, if shown.
        truth: its true pose, if shown.
        commander: the other party that commands it, in words; empty if the participant commands it.
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
