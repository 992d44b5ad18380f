"""Content of the player's page: everything that it shows of a recording, as values for JSON."""

from dataclasses import dataclass
from enum import StrEnum

from ui.web.page.floor import FloorShapes
from ui.web.player.curves import PlayedCurve


class EntryMark(StrEnum):
    """Mark of an entry on the timeline."""

    SAID = "said"
    FOUND = "found"
    DECIDED = "decided"
    DRIVEN = "driven"
    FAILED = "failed"
    OTHER = "other"


@dataclass(frozen=True, slots=True)
class PlayedEntry:
    """Event or utterance in the transcript.

    Attributes:
        at: seconds.
        mark: its mark on the timeline.
        speaker: "robot" or "participant" for an utterance; empty for an event.
        robot: index of the robot in the page, or None.
        who: speaker of an utterance, in words; empty for an event.
        text: text for people.
        points: points won or lost, or None.
    """

    at: float
    mark: EntryMark
    speaker: str
    robot: int | None
    who: str
    text: str
    points: int | None = None


@dataclass(frozen=True, slots=True)
class RoomChange:
    """Change of a room: seconds, number of the room, its new state in the game, and the points of its treasure."""

    at: float
    room: int
    state: str
    points: int | None = None


@dataclass(frozen=True, slots=True)
class RobotPhase:
    """Activity of a robot from a time on: seconds, its name in words, and True if the robot needs attention."""

    at: float
    text: str
    trouble: bool = False


@dataclass(frozen=True, slots=True)
class RobotDrive:
    """Drive of a robot to a goal.

    Attributes:
        start: seconds.
        end: seconds.
        arrived: True if the robot reached the goal.
        label: number of the room; empty if it is unknown.
        text: description for people.
    """

    start: float
    end: float
    arrived: bool
    label: str
    text: str


@dataclass(frozen=True, slots=True)
class PlayedRobot:
    """Robot of a game; curves are None if the recording does not have them.

    Attributes:
        name: name for people.
        pose: x, y (millimeters), heading (thousandths of a radian) of the pose on the map: the true one if it is
            known, otherwise the estimated one, otherwise that of odometry.
        belief: the estimated pose in the same form, if `pose` is the true one.
        energy: energy left, tenths of a unit.
        error: distance (millimeters) and angle (hundredths of a degree) between true and estimated pose.
        deviation: two standard deviations that the localizer reports, in the units of `error`.
        drives: drives to goals, in order.
        phases: activities, in order.
    """

    name: str
    pose: PlayedCurve | None
    belief: PlayedCurve | None
    energy: PlayedCurve | None
    error: PlayedCurve | None
    deviation: PlayedCurve | None
    drives: tuple[RobotDrive, ...]
    phases: tuple[RobotPhase, ...]


@dataclass(frozen=True, slots=True)
class PlayedGame:
    """Game of a recording.

    Attributes:
        title: name of the game; empty if the recording has only one.
        duration: seconds.
        summary: label and value of the facts at the top of the page.
        robots: the robots, in the order of the report.
        entries: events and utterances, in the order of time.
        rooms: changes of rooms, in the order of time.
        score: score, and number of visited rooms.
        room_count: number of rooms; 0 if there was no game.
        missing: sentences about data that the recording does not have.
    """

    title: str
    duration: float
    summary: tuple[tuple[str, str], ...]
    robots: tuple[PlayedRobot, ...]
    entries: tuple[PlayedEntry, ...]
    rooms: tuple[RoomChange, ...]
    score: PlayedCurve | None
    room_count: int
    missing: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class PlayedRecording:
    """Recording with all its games.

    Attributes:
        language: language of the words.
        words: words of the page that its script needs, by key.
        floor: the map; None if neither the recording nor the study has one.
        obstacles: x, y, x, y, ... of the corners of each obstacle that does not move, centimeters.
        games: the games.
    """

    language: str
    words: dict[str, str]
    floor: FloorShapes | None
    obstacles: tuple[tuple[int, ...], ...]
    games: tuple[PlayedGame, ...]
