"""Values that describe all marks that a map view draws."""

from dataclasses import dataclass
from typing import Literal

from sim.common.geometry import Pose2
from sim.numerics.float_array import FloatArray
from thbridge.roles.shared.notices import Ellipse

RoomState = Literal["unvisited", "reserved", "visited", "won", "lost"]
"""State of a room on the map. A room is won if its treasure brought points, and lost if the treasure cost points."""

VISITED: tuple[RoomState, ...] = ("visited", "won", "lost")
"""States of rooms that a robot has visited."""


def decided(points: int) -> RoomState:
    """Return the state of a room after its treasure was named, which brought or cost these points."""
    return "won" if points > 0 else "lost" if points < 0 else "visited"


@dataclass(frozen=True, slots=True)
class RoomMark:
    """Marks of a room on the map when it is drawn.

    Attributes:
        room: number of the room, from 1.
        name: name for people.
        region: (n, 2) corners of the room's floor, map frame, meters.
        state: state of the room, shown by a sign and a pattern in addition to the color.
        choosable: True if a click would choose the room at the moment.
        considered: True if the participant looks at the room, by mouse or keyboard.
        found: known properties of the treasure, in one or two words; empty if no property is known.
        found_shorter: shorter versions of `found`, in the order of decreasing length.
        robot: index of the robot that visited the room or drives to it.
        answer: name that the participant gave the treasure, and the points; empty if `found` contains them.
        answer_shorter: shorter versions of `answer`.
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
    """Mark of a robot at the moment of drawing, in the map frame, in meters and radians.

    Attributes:
        robot: index in the team, which determines the color.
        label: short name on the map.
        pose: estimated pose.
        footprint: (n, 2) corners of the robot's body in the robot's frame.
        selected: True for the robot that the participant commands.
        trouble: True if the robot is lost, does not answer or has no energy; a sign also shows this without color.
        trail: (k, 2) past places, oldest first.
        path: (m, 2) planned path from the robot's place.
        ellipse: uncertainty of the robot's place, if shown.
        truth: true pose, if shown.
        commander: the robot's commander, in words; empty if the participant commands the robot.
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
