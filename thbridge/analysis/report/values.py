"""A session as a reader wants to see it. Times are seconds since the recording's first message."""

from dataclasses import dataclass

from sim.common.geometry import FloatArray
from sim.common.grid import OccupancyGrid
from thbridge.ros.messages.records import ScoreRecord, SessionRecord


@dataclass(frozen=True, slots=True)
class GoalAttempt:
    """A robot's way to one goal.

    Attributes:
        start: seconds.
        end: seconds; the session's end while it was under way.
        outcome: "arrived", "no path", "cancelled" or "under way".
        reason: why it ended so, for people; may be empty.
    """

    start: float
    end: float
    outcome: str
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """One robot.

    Attributes:
        name: "robot1"; of its namespace.
        truth: (n, 4) time, x, y, theta in the map.
        estimate: (m, 4) likewise, what it believed.
        errors: (m, 3) time, metres, radians (not negative) between the two; empty when either is missing.
        energy: (k, 2) time, energy left, in the game's units, or percent where the bag knows only that.
        legs: its goals in order.
        distance: metres driven; from the truth if there is one, else from what it believed, else from odometry.
        odometry: (o, 4) time, x, y, theta in the frame of odometry.
        speeds: (o, 3) time, m/s, rad/s as odometry says; NaN where only tf does.
        commands: (c, 3) time, m/s, rad/s that it was told to drive.
        deviations: (d, 3) time, standard deviations of position (m) and heading (rad) that the localiser admits.
        sources: which topics all this is from, for people.
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


@dataclass(frozen=True, slots=True, eq=False)
class ObstacleTrack:
    """Something that stood or walked in the way.

    Attributes:
        name: what people call it.
        outline: (v, 2) closed, where it was seen first; map frame.
        path: (n, 2) the middles of its outlines in order of time; one point if it stood.
    """

    name: str
    outline: FloatArray
    path: FloatArray


@dataclass(frozen=True, slots=True)
class TimelineEntry:
    """Something that happened or was said.

    Attributes:
        time: seconds.
        kind: an event's kind, or "said".
        who: "robot1", "participant", or empty.
        room: as people count, or None.
        text: for people.
        points: what it brought or cost, None when that is not its matter.
    """

    time: float
    kind: str
    who: str
    room: int | None
    text: str
    points: int | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Report:
    """A session as a reader wants to see it.

    Attributes:
        duration: seconds.
        session: what it was run with; None in foreign bags.
        grid: the map, or None.
        tracks: one a robot, by name.
        things: in the order of their appearance.
        moments: in order of time.
        score: the last one told, or None.
        inputs: how many inputs of people were recorded.
        missing: sentences on what could not be shown, and why.
    """

    duration: float
    session: SessionRecord | None
    grid: OccupancyGrid | None
    tracks: tuple[Track, ...]
    things: tuple[ObstacleTrack, ...]
    moments: tuple[TimelineEntry, ...]
    score: ScoreRecord | None
    inputs: int
    missing: tuple[str, ...]
