"""A session at one moment, as a researcher sees it: the truth beside what robots believe, and all that moves them.

Everything is in the map frame, meters and radians, unless it says otherwise.
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
    """Layers to be shown on the map; the messages of the others are not decoded, and are missing in the scene.

    Attributes:
        selected: the robot whose cloud is whole, and whose costmaps are shown.
        clouds: particles.
        scans: end points of laser beams.
        global_costmap: of the selected robot.
        local_costmap: likewise.
        plans: global and local ones.
        paths: paths so far, by truth, estimate and odometry.
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
    """A robot at one moment.

    Attributes:
        robot: its index; in sessions of ours, of the team.
        name: for people: "robot 1", or the namespace of a robot in a bag that is not ours.
        truth: its true pose; None where it is not published.
        estimate: its estimated pose: odometry under the localizer's last correction.
        error: meters between the two; None where one is missing.
        ellipse: 95 % of its belief, by the last message of its localizer.
        deviation: standard deviation of the position, meters.
        odometry_path: (k, 2) its path by wheel odometry so far, placed so that it ends at the estimate.
        truth_path: (k, 2) its true path so far; a row of NaN where it was carried away.
        estimate_path: (k, 2) its estimated path so far; a row of NaN where its localizer found it elsewhere.
        cloud: (n, 3) particles, x, y, theta; a selection of them where the robot is not selected.
        scan: (m, 2) end points of the beams that met something, as seen from the estimate at that time.
        global_costmap: 0 free, 99 inscribed, 100 lethal, -1 unknown, others between.
        local_costmap: likewise.
        plan: (p, 2) the whole path to the goal.
        local_plan: (q, 2) the next moments.
        footprint: (v, 2) corners of its body at its estimated pose.
        goal: pose of its goal; None at rest.
        energy: energy left, in the game's units, or percent where a bag knows only that.
        speed: by its odometry, m/s.
        state: its activity, in words; empty where it is not published.
        trouble: True when the state is one to worry about.
        dead: True when its software has fallen silent, while its truth is still published.
        commander: the other party that commands it, in words; empty where the participant does.
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
    """An obstacle that is not on the map: its name, and the (v, 2) corners of its closed outline."""

    name: str
    outline: FloatArray


@dataclass(frozen=True, slots=True)
class PendingTurn:
    """A robot's turn in a dialogue that waits for a person.

    Attributes:
        dialogue: its number.
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
    """A participant's "don't know" that waits for a person.

    Attributes:
        robot: index of the robot that is asked, from 0.
        costs: energy by room, as people count rooms.
        suggestion: the room that the robot itself would suggest; None: none.
    """

    robot: int
    costs: tuple[tuple[int, float], ...]
    suggestion: int | None


@dataclass(frozen=True, slots=True)
class Wizard:
    """Robots that a person speaks for (Wizard of Oz), and the turns that wait for that person."""

    puppets: tuple[int, ...] = ()
    turns: tuple[PendingTurn, ...] = ()
    advice: tuple[PendingAdvice, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """A session at one moment.

    Attributes:
        stamp_ns: the moment, nanoseconds of ROS time.
        grid: the map; None where none is published.
        robots: in the order of their numbers.
        things: obstacles that are not on the map.
        rooms: those of the map where it is known, else none.
        wizard: robots that a person speaks for.
    """

    stamp_ns: int
    grid: OccupancyGrid | None
    robots: tuple[RobotScene, ...]
    things: tuple[ThingScene, ...]
    rooms: tuple[RoomMark, ...]
    wizard: Wizard


EntryKind = Literal["event", "said", "line", "input", "log"]
"""The lists: the game's events, the dialogue, the protocol's lines, inputs from outside, the log of ROS."""


@dataclass(frozen=True, slots=True)
class Entry:
    """A line of a list.

    Attributes:
        stamp_ns: its time, nanoseconds of ROS time.
        kind: the list.
        what: an event's kind or a dialogue's scenario in words, a line's topic, an input's kind, a log line's level.
        who: its author, for people; empty where there is none.
        robot: index of the robot that it concerns, or None.
        room: as people count, or None.
        text: for people.
        important: True for an entry that gets a mark on the timeline.
    """

    stamp_ns: int
    kind: EntryKind
    what: str
    who: str
    robot: int | None
    room: int | None
    text: str
    important: bool = False
