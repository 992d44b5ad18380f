"""Data of a recording, or of one game in it. Times are seconds since the first message."""

import re
from dataclasses import dataclass, field

import numpy as np

from sim.common.grid import OccupancyGrid
from sim.common.robot_numbers import index_of, robot_name
from sim.numerics.float_array import FloatArray
from thbridge.analysis.report.dialogues import RecordedDialogues
from thbridge.hunt.events import TeamEntry
from thbridge.hunt.rooms import RoomNames
from thbridge.ros.messages.session_records import GameEvent, ScoreRecord, SessionRecord, UtteranceRecord

_OURS = re.compile(r"robot([1-9][0-9]*)")
NEVER: FloatArray = np.empty(0)
"""Empty array of times."""


def index_in(name: str) -> int | None:
    """Return the index of a robot in its team, given the robot's name for programs; None for names of another form."""
    number = _OURS.fullmatch(name)
    return index_of(int(number[1])) if number else None


def label_of(name: str) -> str:
    """Return a robot's name for people: "robot 1" for "robot1"; a name of another form is unchanged."""
    robot = index_in(name)
    return name if robot is None else robot_name(robot)


@dataclass(frozen=True, slots=True)
class GoalAttempt:
    """Drive of a robot to one goal.

    Attributes:
        start: start time, seconds.
        end: end time, seconds; the end of the session if the robot was still driving.
        outcome: "arrived", "no path", "cancelled" or "under way".
        reason: reason for the outcome, for people; may be empty.
    """

    start: float
    end: float
    outcome: str
    reason: str


@dataclass(frozen=True, slots=True)
class WayMade:
    """Time in which a robot made way for another robot that had the right of way.

    Attributes:
        start: start time, seconds.
        end: end time, seconds; the end of the session if the robot was still making way.
        robot: name of the other robot for programs: "robot1".
    """

    start: float
    end: float
    robot: str


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """Data of one robot.

    Attributes:
        name: name for programs: "robot1", from its namespace.
        truth: (n, 4) time, x, y, theta of the true pose in the map.
        estimate: (m, 4) time, x, y, theta of the estimated pose in the map.
        errors: (m, 3) time, distance (m) and absolute angle (rad) between truth and estimate; empty if one is missing.
        energy: (k, 2) time, energy left, in the game's units, or in percent if the bag has only percentages.
        attempts: drives to goals, in order.
        distance: distance driven, meters: from the truth if known, otherwise the estimate, otherwise odometry.
        odometry: (o, 4) time, x, y, theta in the frame of odometry.
        speeds: (o, 3) time, m/s, rad/s from odometry messages; empty if odometry is only in tf.
        commands: (c, 3) time, m/s, rad/s of commanded speeds.
        deviations: (d, 3) time, standard deviations of position (m) and heading (rad) that the localizer reports.
        sources: sentences about the topics that were used, for people.
        `carried`: (p,) times at which the robot was picked up and moved.
        relocated: (q,) times at which the localizer found the robot elsewhere, or the odometry was reset.
        ways_made: times in which the robot made way for other robots, in order.
        reset: (r,) times at which the robot's odometry was reset.
        faults: sentences about poses that cannot be the motion of a robot.
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
        """Name for people."""
        return label_of(self.name)


@dataclass(frozen=True, slots=True, eq=False)
class ObstacleTrack:
    """Obstacle that stood or moved on the map.

    Attributes:
        name: name of the obstacle.
        outline: (v, 2) corners of the first outline, closed; map frame, meters.
        path: (n, 2) centers of the outlines in the order of time; one point for an obstacle that did not move.
    """

    name: str
    outline: FloatArray
    path: FloatArray


@dataclass(frozen=True, slots=True)
class TimelineEntry:
    """Event of the game, or utterance.

    Attributes:
        time: seconds.
        kind: kind of the event in words, or "said" for an utterance.
        who: label of a robot, "participant to" and a robot's label, or empty. In a game with several seats, a seat
            instead of "participant".
        room: number of the room, or None.
        text: text for people.
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
    """Report of a recording, or of one game in it.

    Attributes:
        duration: seconds.
        session: session record; None if thbridge did not record it.
        grid: map, or None.
        tracks: data of each robot, by name.
        things: obstacles, in the order of their appearance.
        timeline: events and utterances, in the order of time.
        score: last score, or None.
        inputs: number of recorded inputs of people.
        missing: sentences about missing data, with the reasons.
        game: number of the game; None if no game begins in the messages.
        rooms: names of the map's rooms.
        begins: seconds from the recording's first message to the beginning of this game. Times of the game count from
            its beginning.
        dialogues: argumentation dialogues.
        left_out: sentences about values that no figure can show; they are also in `missing`.
        events: events of the game as they were recorded, with their times, s.
        utterances: utterances as they were recorded, with their times, s.
        scores: all scores as they were recorded, with their times, s.
        team: texts, votes and objections of the participants of several seats, with their times, s.
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
    events: tuple[tuple[float, GameEvent], ...] = ()
    utterances: tuple[tuple[float, UtteranceRecord], ...] = ()
    scores: tuple[tuple[float, ScoreRecord], ...] = ()
    team: tuple[tuple[float, TeamEntry], ...] = ()
