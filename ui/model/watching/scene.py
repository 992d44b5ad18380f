"""A session at one moment, as a researcher sees it: the truth beside what robots believe, and all that moves them.

Everything is in the map frame, metres and radians, unless it says otherwise.
"""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from sim.common.geometry import FloatArray, Pose2
from sim.common.grid import OccupancyGrid
from ui.model.scene import EllipseMark, RoomMark

NO_POINTS: FloatArray = np.empty((0, 2))
NO_POSES: FloatArray = np.empty((0, 3))


def _no_points() -> FloatArray:
    return NO_POINTS


def _no_poses() -> FloatArray:
    return NO_POSES


@dataclass(frozen=True, slots=True)
class ShownLayers:
    """What is wanted on the map; what is not wanted is not unpacked, and missing in the scene.

    Attributes:
        selected: the robot whose cloud is whole, and whose costmaps are shown.
        clouds: particles.
        scans: end points of laser beams.
        global_costmap: of the selected robot.
        local_costmap: likewise.
        plans: global and local ones.
        paths: where robots were, and believed to be.
        footprints: where robots believe their bodies to be.
        thinned: particles shown of a robot that is not selected.
    """

    selected: int | None = 0
    clouds: bool = True
    scans: bool = True
    global_costmap: bool = False
    local_costmap: bool = False
    plans: bool = True
    paths: bool = True
    footprints: bool = True
    thinned: int = 60


@dataclass(frozen=True, slots=True, eq=False)
class RobotScene:
    """A robot at one moment.

    Attributes:
        robot: its index; in sessions of ours, of the team.
        name: for people: "robot 1", or the namespace of a robot in a bag that is not ours.
        truth: where it is; None where nobody says.
        estimate: where it believes it is, its odometry under the localiser's last correction.
        error: metres between the two; None where one is missing.
        heading_error: radians between the two, not negative.
        ellipse: 95 % of its belief, as its localiser said last; about `belief`.
        belief: the pose that its localiser said last.
        deviation: standard deviation of the position, metres.
        heading_deviation: of the heading, radians.
        odometry_path: (k, 2) what its wheels counted so far, laid where it believes it is now.
        truth_path: (k, 2) where it was so far.
        estimate_path: (k, 2) where it believed to be so far.
        cloud: (n, 3) particles, x, y, theta.
        particles: how many there are; `cloud` may be a selection of them.
        scan: (m, 2) end points of the beams that met something, as seen from where it believed to be then.
        global_costmap: 0 free, 99 inscribed, 100 lethal, -1 unknown, others between.
        local_costmap: likewise.
        plan: (p, 2) the whole way.
        local_plan: (q, 2) the next moments.
        footprint: (v, 2) corners of its body where it believes it to be.
        goal: where it is to go; None at rest.
        energy: what is left, in the game's units, or percent where a bag knows only that.
        speed: by its odometry, m/s.
        turning: likewise, rad/s.
        state: what it does, in words; empty where nobody says.
        trouble: the state is one to worry about.
        dead: its software has fallen silent, while the truth of it is told on.
        commander: who else than the participant commands it, in words; empty when nobody does.
    """

    robot: int
    name: str
    truth: Pose2 | None = None
    estimate: Pose2 | None = None
    error: float | None = None
    heading_error: float | None = None
    ellipse: EllipseMark | None = None
    belief: Pose2 | None = None
    deviation: float | None = None
    heading_deviation: float | None = None
    odometry_path: FloatArray = field(default_factory=_no_points)
    truth_path: FloatArray = field(default_factory=_no_points)
    estimate_path: FloatArray = field(default_factory=_no_points)
    cloud: FloatArray = field(default_factory=_no_poses)
    particles: int = 0
    scan: FloatArray = field(default_factory=_no_points)
    global_costmap: OccupancyGrid | None = None
    local_costmap: OccupancyGrid | None = None
    plan: FloatArray = field(default_factory=_no_points)
    local_plan: FloatArray = field(default_factory=_no_points)
    footprint: FloatArray = field(default_factory=_no_points)
    goal: Pose2 | None = None
    energy: float | None = None
    speed: float | None = None
    turning: float | None = None
    state: str = ""
    trouble: bool = False
    dead: bool = False
    commander: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class ThingScene:
    """A thing in the way: its name, and the (v, 2) corners of its closed outline."""

    name: str
    outline: FloatArray


@dataclass(frozen=True, slots=True)
class PendingTurn:
    """A robot's turn in a dialogue that waits for a person.

    Attributes:
        dialogue: its number.
        turn: place of the move in it, from 0.
        robot: which, from 0.
        scenario: for example "select-room".
        room: that it is about, or None.
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
        robot: which is asked, from 0.
        costs: energy by room, as people count rooms.
        suggestion: what the robot itself would say; None: nothing.
    """

    robot: int
    costs: tuple[tuple[int, float], ...]
    suggestion: int | None


@dataclass(frozen=True, slots=True)
class Wizard:
    """For which robots a person speaks, and what waits for that person."""

    puppets: tuple[int, ...] = ()
    turns: tuple[PendingTurn, ...] = ()
    advice: tuple[PendingAdvice, ...] = ()


@dataclass(frozen=True, slots=True)
class GameScene:
    """The game at one moment: points, rooms visited, rooms there are."""

    score: int
    visited: int
    rooms: int


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """A session at one moment.

    Attributes:
        stamp_ns: the moment, nanoseconds of ROS time.
        time: seconds since the session's or the recording's beginning.
        grid: the map; None where nobody published one.
        robots: in the order of their numbers.
        things: in the way.
        rooms: those of the map where it is known, else none.
        game: None where there is none.
        wizard: who speaks for robots.
        unreadable: sentences on topics that cannot be read.
    """

    stamp_ns: int
    time: float
    grid: OccupancyGrid | None
    robots: tuple[RobotScene, ...]
    things: tuple[ThingScene, ...]
    rooms: tuple[RoomMark, ...]
    game: GameScene | None
    wizard: Wizard
    unreadable: tuple[str, ...]


EntryKind = Literal["event", "said", "line", "input", "log"]
"""What lists there are: the game's events, the dialogue, the protocol's lines, what came from outside, the log."""


@dataclass(frozen=True, slots=True)
class Entry:
    """A line of a list.

    Attributes:
        stamp_ns: when, nanoseconds of ROS time.
        kind: of which list.
        what: an event's kind, a dialogue's scenario, a line's topic, an input's kind, a log line's level.
        who: for people; empty where it is nobody's.
        robot: index of the robot that it concerns, or None.
        room: as people count, or None.
        text: for people.
        important: worth a mark on the timeline.
    """

    stamp_ns: int
    kind: EntryKind
    what: str
    who: str
    robot: int | None
    room: int | None
    text: str
    important: bool = False
