"""Data of a recording, or of one game in it. Times are seconds since its first message."""

import re
from dataclasses import dataclass, field

import numpy as np

from sim.common.grid import OccupancyGrid
from sim.common.robot_numbers import index_of, robot_name
from sim.numerics.float_array import FloatArray
from thbridge.analysis.report.dialogues import RecordedDialogues
from thbridge.hunt.rooms import RoomNames
from thbridge.ros.messages.session_records import ScoreRecord, SessionRecord

_OURS = re.compile(r"robot([1-9][0-9]*)")
NEVER: FloatArray = np.empty(0)
"""No times."""


def index_in(name: str) -> int | None:
    """The index of a robot in its team, by its name for programs; None for one that is not of our robots' form."""
    number = _OURS.fullmatch(name)
    return index_of(int(number[1])) if number else None


def label_of(name: str) -> str:
    """A robot's name for people: "robot 1" for "robot1"; one that is not of our robots' form stays as it is."""
    robot = index_in(name)
    return name if robot is None else robot_name(robot)


@dataclass(frozen=True, slots=True)
class GoalAttempt:
    """A robot's drive to one goal.

    Attributes:
        start: seconds.
        end: seconds; the session's end if it was still driving.
        outcome: "arrived", "no path", "cancelled" or "under way".
        reason: the reason of the outcome, for people; may be empty.
    """

    start: float
    end: float
    outcome: str
    reason: str


@dataclass(frozen=True, slots=True)
class WayMade:
    """A time in which a robot made way for another one that had the right of way.

    Attributes:
        start: seconds.
        end: seconds; the session's end if it still did.
        robot: the other one, for programs: "robot1".
    """

    start: float
    end: float
    robot: str


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """The data of one robot.

    Attributes:
        name: for programs: "robot1", from its namespace.
        truth: (n, 4) time, x, y, theta of its true pose in the map.
        estimate: (m, 4) time, x, y, theta of its estimated pose in the map.
        errors: (m, 3) time, distance (m) and absolute angle (rad) between the two; empty when either is missing.
        energy: (k, 2) time, energy left, in the game's units, or in percent where the bag has only that.
        attempts: its drives to goals, in order.
        distance: meters driven; from the truth if there is one, else from the estimate, else from odometry.
        odometry: (o, 4) time, x, y, theta in the frame of odometry.
        speeds: (o, 3) time, m/s, rad/s of odometry messages; empty when odometry is only in tf.
        commands: (c, 3) time, m/s, rad/s that were commanded.
        deviations: (d, 3) time, standard deviations of position (m) and heading (rad) that the localizer reports.
        sources: sentences on the topics that were used, for people.
        carried: (p,) times at which it was picked up and set elsewhere.
        relocated: (q,) times at which its localizer found it elsewhere, or its odometry was reset.
        ways_made: the times in which it made way for others, in order.
        reset: (r,) times at which its odometry was reset.
        faults: sentences on poses that are no motion of a robot.
    """

    name: str
    truth: FloatArray
    estimate: FloatArray
    errors: FloatArray
    energy: FloatArray
    attempts: tuple[GoalAttempt, ...]
    distance: float
    odometry: FloatArray
    speeds: FloatArray
    commands: FloatArray
    deviations: FloatArray
    sources: tuple[str, ...]
    carried: FloatArray
    relocated: FloatArray
    ways_made: tuple[WayMade, ...] = ()
    reset: FloatArray = field(default_factory=lambda: NEVER)
    faults: tuple[str, ...] = ()

    @property
    def label(self) -> str:
        """The name for people."""
        return label_of(self.name)


@dataclass(frozen=True, slots=True, eq=False)
class ObstacleTrack:
    """A thing that stood or moved on the map.

    Attributes:
        name: its name.
        outline: (v, 2) corners of its first outline, closed; map frame, meters.
        path: (n, 2) centers of its outlines in order of time; one point if it stood.
    """

    name: str
    outline: FloatArray
    path: FloatArray


@dataclass(frozen=True, slots=True)
class TimelineEntry:
    """An event of the game, or an utterance.

    Attributes:
        time: seconds.
        kind: an event's kind in words, or "said" for an utterance.
        who: label of a robot, "participant to" one, or empty.
        room: the room's number, or None.
        text: a text for people.
        points: points won or lost; None for events without points.
    """

    time: float
    kind: str
    who: str
    room: int | None
    text: str
    points: int | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Report:
    """The report of a recording, or of one game in it.

    Attributes:
        duration: seconds.
        session: the session record; None in bags of others.
        grid: the map, or None.
        tracks: data of each robot, by name.
        things: the things, in the order of their appearance.
        timeline: events and utterances, in order of time.
        score: the last score, or None.
        inputs: number of inputs of people that were recorded.
        missing: sentences on data that are missing, and why.
        game: number of the game; None where no game begins in what was read.
        rooms: names of the map's rooms.
        begins: seconds from the recording's first message to the beginning of this game, from which its times count.
        dialogues: those in which robots argued.
        left_out: sentences on values that no figure can show; they are among `missing`, too.
    """

    duration: float
    session: SessionRecord | None
    grid: OccupancyGrid | None
    tracks: tuple[Track, ...]
    things: tuple[ObstacleTrack, ...]
    timeline: tuple[TimelineEntry, ...]
    score: ScoreRecord | None
    inputs: int
    missing: tuple[str, ...]
    game: int | None = None
    begins: float = 0.0
    rooms: RoomNames = field(default_factory=RoomNames)
    dialogues: RecordedDialogues = field(default_factory=RecordedDialogues)
    left_out: tuple[str, ...] = ()
