"""Session at one moment, as a researcher sees it: the true state, and the beliefs, plans and goals of robots.

Unless stated otherwise, values are in the map frame, in meters and radians.
"""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.numerics.float_array import FloatArray
from thbridge.roles.shared.notices import Ellipse
from ui.model.shared.scene import RoomMark

NO_POINTS: FloatArray = np.empty((0, 2))
NO_POSES: FloatArray = np.empty((0, 3))


@dataclass(frozen=True, slots=True)
class ShownLayers:
    """Layers to show on the map. Messages of other layers are not decoded, and the scene does not contain them.

    Attributes:
        selected: index of the robot that is shown with all particles and with costmaps.
        clouds: particles.
        scans: end points of laser beams.
        global_costmap: global costmap of the selected robot.
        local_costmap: local costmap of the selected robot.
        plans: global and local plans.
        paths: driven paths: true, estimated, and according to odometry.
    """

    selected: int | None = 0
    clouds: bool = True
    scans: bool = True
    global_costmap: bool = False
    local_costmap: bool = False
    plans: bool = True
    paths: bool = True


@dataclass(frozen=True, slots=True, eq=False)
class RobotScene:
    """Robot at one moment.

    Attributes:
        robot: index of the robot; in sessions of thbridge, the index in the team.
        name: name for people: "robot 1", or, in bags of other programs, the robot's namespace.
        truth: true pose; None if it is not published.
        estimate: estimated pose: odometry with the localizer's last correction.
        error: distance between `truth` and `estimate` in meters; None if either is missing.
        ellipse: ellipse that contains the robot with 95 % probability, from the last message of the localizer.
        deviation: standard deviation of the position, meters.
        odometry_path: (k, 2) path according to wheel odometry, shifted so that the path ends at the estimate.
        truth_path: (k, 2) true path; a row of NaN where a person moved the robot by hand.
        estimate_path: (k, 2) estimated path; a row of NaN where the localizer corrected the pose by a jump.
        cloud: (n, 3) particles, x, y, theta; only some of them unless the robot is selected.
        scan: (m, 2) end points of the beams that hit something, seen from the estimate at the time of the scan.
        global_costmap: cost of each cell: 0 free, 1 to 98 inflated, 99 inscribed, 100 lethal, -1 unknown.
        local_costmap: same values as `global_costmap`.
        plan: (p, 2) the whole path to the goal.
        local_plan: (q, 2) the next part of the path, from the local planner.
        footprint: (v, 2) corners of the robot's body at the estimated pose.
        goal: pose of the goal; None if the robot is at rest.
        energy: remaining energy in units of the game; in percent if a bag has no other value.
        speed: speed according to odometry, m/s.
        state: the robot's activity, in words; empty if it is not published.
        trouble: True if the state needs attention.
        dead: True if the robot's software has stopped sending, but the true pose is published.
        commander: the robot's commander, in words; empty if the participant commands the robot.
    """

    robot: int
    name: str
    truth: Pose2 | None = None
    estimate: Pose2 | None = None
    error: float | None = None
    ellipse: Ellipse | None = None
    deviation: float | None = None
    odometry_path: FloatArray = field(default_factory=lambda: NO_POINTS)
    truth_path: FloatArray = field(default_factory=lambda: NO_POINTS)
    estimate_path: FloatArray = field(default_factory=lambda: NO_POINTS)
    cloud: FloatArray = field(default_factory=lambda: NO_POSES)
    scan: FloatArray = field(default_factory=lambda: NO_POINTS)
    global_costmap: OccupancyGrid | None = None
    local_costmap: OccupancyGrid | None = None
    plan: FloatArray = field(default_factory=lambda: NO_POINTS)
    local_plan: FloatArray = field(default_factory=lambda: NO_POINTS)
    footprint: FloatArray = field(default_factory=lambda: NO_POINTS)
    goal: Pose2 | None = None
    energy: float | None = None
    speed: float | None = None
    state: str = ""
    trouble: bool = False
    dead: bool = False
    commander: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class ThingScene:
    """Obstacle that is not on the map: the name, and the (v, 2) corners of the closed outline."""

    name: str
    outline: FloatArray


@dataclass(frozen=True, slots=True)
class PendingTurn:
    """Turn of a robot in a dialogue, for which a person must choose the move.

    Attributes:
        dialogue: number of the dialogue.
        turn: number of the move in the dialogue, from 0.
        robot: index of the robot, from 0.
        scenario: subject of the dialogue, for example "select-room".
        room: the room that the dialogue is about, or None.
        sentences: sentences of the legal moves, in the order of the moves.
    """

    dialogue: int
    turn: int
    robot: int
    scenario: str
    room: int | None
    sentences: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class PendingAdvice:
    """Participant's request for advice ("don't know"), which a person must answer for the robot.

    Attributes:
        robot: index of the robot that was asked, from 0.
        costs: energy of a move to each room, by number of the room, from 1.
        suggestion: number of the room that the robot would suggest. If None, the robot has no suggestion.
    """

    robot: int
    costs: tuple[tuple[int, float], ...]
    suggestion: int | None


@dataclass(frozen=True, slots=True)
class Wizard:
    """Robots for which a person speaks (Wizard of Oz), and turns that this person must decide."""

    puppets: tuple[int, ...] = ()
    turns: tuple[PendingTurn, ...] = ()
    advice: tuple[PendingAdvice, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """Session at one moment.

    Attributes:
        stamp_ns: the moment, nanoseconds of ROS time.
        grid: the map; None if it is not published.
        robots: robots in the order of their numbers.
        things: obstacles that are not on the map.
        rooms: rooms of the map; empty if the map is unknown.
        wizard: robots for which a person speaks.
    """

    stamp_ns: int
    grid: OccupancyGrid | None
    robots: tuple[RobotScene, ...]
    things: tuple[ThingScene, ...]
    rooms: tuple[RoomMark, ...]
    wizard: Wizard


EntryKind = Literal["event", "said", "line", "input", "log"]
"""Lists next to the map: events of the game, sentences of dialogues, lines of the text protocol, inputs, ROS log."""


@dataclass(frozen=True, slots=True)
class Entry:
    """Entry of a list.

    Attributes:
        stamp_ns: time of the entry, nanoseconds of ROS time.
        kind: the list that has the entry.
        what: kind of the entry in words: kind of the event or input, scenario of the dialogue, topic of the line, or
            level of the log message.
        who: author in words for people; empty if there is none.
        robot: index of the robot that the entry is about, or None.
        room: number of the room, from 1, or None.
        text: content in words for people.
        important: True if the entry has a mark on the timeline.
    """

    stamp_ns: int
    kind: EntryKind
    what: str
    who: str
    robot: int | None
    room: int | None
    text: str
    important: bool = False
