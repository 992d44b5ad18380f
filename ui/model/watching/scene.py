"""Session at one moment, as a researcher sees it: the true state, the robots' beliefs, and everything that moves
robots.

Everything is in the map frame, meters and radians, unless stated otherwise.
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
        selected: robot that is shown with all its particles and its costmaps.
        clouds: particles.
        scans: end points of laser beams.
        global_costmap: global costmap of the selected robot.
        local_costmap: local costmap of the selected robot.
        plans: global and local plans.
        paths: paths so far: true, estimated, and by odometry.
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
        robot: its index; in sessions of thbridge, the index in the team.
        name: name for people: "robot 1", or the robot's namespace in a foreign bag.
        truth: its true pose; None if it is not published.
        estimate: its estimated pose: odometry with the localizer's last correction applied.
        error: distance between `truth` and `estimate` in meters; None if one of them is missing.
        ellipse: ellipse with 95 % of its belief, from the last message of its localizer.
        deviation: standard deviation of the position, meters.
        odometry_path: (k, 2) its path by wheel odometry, placed so that it ends at the estimate.
        truth_path: (k, 2) its true path; a row of NaN where a person moved the robot by hand.
        estimate_path: (k, 2) its estimated path; a row of NaN where its localizer found the robot elsewhere.
        cloud: (n, 3) particles, x, y, theta; a subset unless the robot is selected.
        scan: (m, 2) end points of the beams that hit something, seen from the estimate at the time of the scan.
        global_costmap: 0 free, 99 inscribed, 100 lethal, -1 unknown, others between.
        local_costmap: same values as `global_costmap`.
        plan: (p, 2) the whole path to the goal.
        local_plan: (q, 2) the next part of the path, from the local planner.
        footprint: (v, 2) corners of its body at its estimated pose.
        goal: pose of its goal; None at rest.
        energy: energy left, in units of the game, or in percent if a bag has nothing else.
        speed: by its odometry, m/s.
        state: its activity, in words; empty if it is not published.
        trouble: True if the state needs attention.
        dead: True if its software sends nothing more, but its true pose is still published.
        commander: the other party that commands it, in words; empty if the participant commands it.
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
    """Obstacle that is not on the map: its name, and the (v, 2) corners of its closed outline."""

    name: str
    outline: FloatArray


@dataclass(frozen=True, slots=True)
class PendingTurn:
    """Robot's turn in a dialogue in which a person must choose the move.

    Attributes:
        dialogue: number of the dialogue.
        turn: place of the move in it, from 0.
        robot: index of the robot, from 0.
        scenario: for example "select-room".
        room: the room that the dialogue is about, or None.
        sentences: the legal moves, in their order.
    """

    dialogue: int
    turn: int
    robot: int
    scenario: str
    room: int | None
    sentences: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class PendingAdvice:
    """Request for advice ("don't know") of a participant that a person must answer.

    Attributes:
        robot: index of the robot that was asked, from 0.
        costs: energy by the number of the room, from 1.
        suggestion: number of the room that the robot would suggest. If None, it has no suggestion.
    """

    robot: int
    costs: tuple[tuple[int, float], ...]
    suggestion: int | None


@dataclass(frozen=True, slots=True)
class Wizard:
    """Robots for which a person speaks (Wizard of Oz), and the turns that wait for that person."""

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
        rooms: rooms of the map if it is known, otherwise empty.
        wizard: robots for which a person speaks.
    """

    stamp_ns: int
    grid: OccupancyGrid | None
    robots: tuple[RobotScene, ...]
    things: tuple[ThingScene, ...]
    rooms: tuple[RoomMark, ...]
    wizard: Wizard


EntryKind = Literal["event", "said", "line", "input", "log"]
"""Lists next to the map: the game's events, the dialogue, the protocol's lines, inputs from outside, and the ROS
log."""


@dataclass(frozen=True, slots=True)
class Entry:
    """Line of a list.

    Attributes:
        stamp_ns: its time, nanoseconds of ROS time.
        kind: the list.
        what: kind of an event or scenario of a dialogue in words, topic of a line, kind of an input, or level of a log
            line.
        who: the author, for people; empty if there is none.
        robot: index of the robot concerned, or None.
        room: number of the room, from 1, or None.
        text: text for people.
        important: True for an entry with a mark on the timeline.
    """

    stamp_ns: int
    kind: EntryKind
    what: str
    who: str
    robot: int | None
    room: int | None
    text: str
    important: bool = False
