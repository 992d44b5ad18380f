"""What can happen in a game. A game is nothing but its events, in order."""

from dataclasses import dataclass
from enum import StrEnum

from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.rooms import Room
from thbridge.hunt.treasures import TreasureKind


class EndReason(StrEnum):
    """Why a game is over."""

    ALL_VISITED = "all-visited"
    NO_MOVE_LEFT = "no-move-left"
    GIVEN_UP = "given-up"


class Condition(StrEnum):
    """How a robot is, as far as the robots' program can tell.

    A robot that is lost does not know where it is; one that is silent does not answer any more, so nobody can tell
    whether it is dead.
    """

    WELL = "well"
    LOST = "lost"
    SILENT = "silent"


class Commander(StrEnum):
    """Who says where a robot goes: the participant, unless somebody else has taken it over.

    A ground station keeps a robot until it gives it back. A researcher, or a program at the robots' controls, has it
    for as long as a goal of theirs or their hand-driving lasts, whoever had it before.
    """

    PARTICIPANT = "participant"
    GROUND_STATION = "ground station"
    RESEARCHER = "researcher"


@dataclass(frozen=True, slots=True)
class Started:
    """A new game: its rules and its numbers. Every robot stands in the corridor.

    Attributes:
        seed: what all chance of this game is keyed by.
        game: number of the game, from 1, unique within a journal folder.
        robots: size of the team; robots are numbered from 0 as on the wire.
        energy: what each robot starts with.
        picture_cost: energy of the first picture in a room.
        identify_cost: energy of identifying.
        wrong_share: share of a treasure's points that a wrong name costs; 1 is the rule of 2016.
        costs: energy of every move; also says how many rooms there are.

    Raises:
        ValueError: a team without robots, or a negative number.
    """

    seed: int
    game: int
    robots: int
    energy: float
    picture_cost: float
    identify_cost: float
    wrong_share: float
    costs: CostMatrix

    def __post_init__(self) -> None:
        if self.robots < 1:
            raise ValueError("a team has at least one robot")
        # Written as a negation so that NaN is refused too.
        if not min(self.energy, self.picture_cost, self.identify_cost, self.wrong_share) >= 0.0:
            raise ValueError("energy, costs and the share of a wrong answer are numbers that are not negative")


@dataclass(frozen=True, slots=True)
class Hidden:
    """The treasures were laid out, one per room, room 1 first. Never shown to the participant."""

    treasures: tuple[TreasureKind, ...]


@dataclass(frozen=True, slots=True)
class Agreed:
    """The participant agreed to take part in the study. It is said again in each later game of the same keeper."""


@dataclass(frozen=True, slots=True)
class Departed:
    """A robot set out for a room, which is reserved from now on; its energy is paid in advance."""

    robot: int
    room: Room
    cost: float


@dataclass(frozen=True, slots=True)
class Arrived:
    """A robot stands in a room, which counts as visited from now on."""

    robot: int
    room: Room


@dataclass(frozen=True, slots=True)
class Failed:
    """A robot gave up its way to a room, or was told to; the room is free again.

    Attributes:
        robot: which.
        room: where it was going.
        reason: what the navigator or the person said, for people.
        refund: energy given back.
        at: where it stands now, which is what its next move is counted from.
    """

    robot: int
    room: Room
    reason: str
    refund: float
    at: Room


@dataclass(frozen=True, slots=True)
class Reported:
    """A robot is in another condition than before."""

    robot: int
    condition: Condition


@dataclass(frozen=True, slots=True)
class Commanded:
    """A robot has another commander than before.

    Attributes:
        robot: which.
        by: who commands it from now on.
        name: who exactly, for example "ground station 255", or the name of a ROS node; empty for the participant.
    """

    robot: int
    by: Commander
    name: str


@dataclass(frozen=True, slots=True)
class AskedBack:
    """The participant asks whoever commands a robot to give it back; that is theirs to do."""

    robot: int


@dataclass(frozen=True, slots=True)
class Sensed:
    """What the robot in a room perceives of the treasure there."""

    room: Room
    colour: str
    footprint: str


@dataclass(frozen=True, slots=True)
class Pictured:
    """A picture was taken: image is a file name without directory. Cost 0 when it was shown again."""

    room: Room
    robot: int
    image: str
    cost: float


@dataclass(frozen=True, slots=True)
class Identified:
    """The treasure in a room was named; points are negative when the name was wrong.

    Attributes:
        room: None if an old program told only the points.
        robot: who stood there; None if nobody did as far as the game knows.
        name: what the participant said it is; None if an old program told only the points.
        points: added to the score.
        cost: energy paid by the robot.
    """

    room: Room | None
    robot: int | None
    name: str | None
    points: int
    cost: float


@dataclass(frozen=True, slots=True)
class Left:
    """The participant gave up the treasure in a room."""

    room: Room


@dataclass(frozen=True, slots=True)
class Ended:
    """The game is over, with this score."""

    reason: EndReason
    score: int


Event = (
    Started
    | Hidden
    | Agreed
    | Departed
    | Arrived
    | Failed
    | Reported
    | Commanded
    | AskedBack
    | Sensed
    | Pictured
    | Identified
    | Left
    | Ended
)
