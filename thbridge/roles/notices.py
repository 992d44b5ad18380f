"""The notices by which the game's own programs keep each other up to date; see docs/design.md.

Each is a level: it says how things are, and saying it twice does no harm.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, TypeVar

import msgspec

from thbridge.hunt.events import Condition
from thbridge.hunt.treasures import TreasureKind
from thbridge.wire.notice import JsonValue, Notice, notice
from thbridge.wire.text import TextMessage

KEEPER = "Game"
"""The name under which the keeper of the game is reached."""

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class RobotsReady:
    """SimR is there.

    Attributes:
        map: its name.
        robots: how many.
        costs: energy from place to place as people count them, None where there is no move.
    """

    map: str
    robots: int
    costs: tuple[tuple[float | None, ...], ...]


@dataclass(frozen=True, slots=True)
class MoveOrder:
    """A robot shall be under way. `move` numbers the moves of one game; `room` is as people count."""

    move: int
    room: int


@dataclass(frozen=True, slots=True)
class Orders:
    """Keeper to SimR: what each robot shall do, and what energy it has.

    Attributes:
        game: number of the game; a new one begins with every robot at its start.
        moves: one entry a robot.
        energy: one entry a robot.
        at: the room each stands in as people count, 0 the corridor; where it set out from while it moves.
        poses: x, y, theta of every robot as last heard, for a SimR that comes back into a game.
        taken: robots that somebody else than the participant commands; no line of text drives them beside the game.
    """

    game: int
    moves: tuple[MoveOrder | None, ...]
    energy: tuple[float, ...]
    at: tuple[int, ...]
    poses: tuple[tuple[float, float, float], ...] | None
    taken: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class MoveResult:
    """How the move of this number ended.

    Attributes:
        move: the order's.
        arrived: or else it was given up.
        sentence: why it was given up, for people; empty on arrival.
        share: of the way that was driven, 0 to 1.
    """

    move: int
    arrived: bool
    sentence: str
    share: float


@dataclass(frozen=True, slots=True)
class Status:
    """SimR to keeper: where the robots are, how they are, and how each one's last move ended.

    Attributes:
        game: the one that SimR knows of; 0 before the first orders.
        poses: x, y, theta of every robot.
        results: one entry a robot; None while under way or before its first move.
        conditions: one entry a robot.
        researchers: one entry a robot, the name of who intervenes just now at the robots' controls, or None; empty
            from programs that do not tell.
    """

    game: int
    poses: tuple[tuple[float, float, float], ...]
    results: tuple[MoveResult | None, ...]
    conditions: tuple[Condition, ...]
    researchers: tuple[str | None, ...] = ()


@dataclass(frozen=True, slots=True)
class HiderReady:
    """Hider is there; the keeper answers with `HidePlease` when its game has no treasures yet."""


@dataclass(frozen=True, slots=True)
class HidePlease:
    """Keeper to Hider: hide treasures for this game."""

    game: int
    rooms: int


@dataclass(frozen=True, slots=True)
class HideTreasures:
    """Hider to keeper: what lies where, room 1 first."""

    game: int
    treasures: tuple[TreasureKind, ...]


@dataclass(frozen=True, slots=True)
class Reply:
    """Keeper to Hider: say these words of the 2016 dialect to the participant (the keeper has judged them)."""

    command: str
    text: str


@dataclass(frozen=True, slots=True)
class ParticipantReady:
    """A participant's program is there and wants views."""


@dataclass(frozen=True, slots=True)
class Subscribe:
    """Somebody wants to be told where the robots are, for the next few seconds."""


Activity = Literal["resting", "planning", "driving", "waiting", "clearing", "silent"]
"""What a robot does just now: "waiting" lets another one pass, "clearing" tries to get free."""


@dataclass(frozen=True, slots=True)
class RobotMotion:
    """How one robot is on its way.

    Attributes:
        doing: what it does.
        waits_for: the robot that it lets pass.
        progress: share of the way that is driven, 0 to 1; 0 at rest.
        remaining: metres still to drive; 0 at rest.
    """

    doing: Activity = "resting"
    waits_for: int | None = None
    progress: float = 0.0
    remaining: float = 0.0


@dataclass(frozen=True, slots=True)
class Ellipse:
    """Where a robot may be as well: 95 % of its belief, half axes in metres, the longer one turned by `angle`."""

    major: float
    minor: float
    angle: float


@dataclass(frozen=True, slots=True)
class Whereabouts:
    """SimR to subscribers: where the robots believe they are, and what else the study shows; many times a second.

    Attributes:
        tick: of the simulation, 50 to the second.
        poses: x, y, theta of every robot as it believes, map frame.
        motions: one entry a robot.
        ellipses: one entry a robot, if the study shows how sure robots are of their places.
        truth: x, y, theta of every robot as it is, only if the study shows that.
    """

    tick: int
    poses: tuple[tuple[float, float, float], ...]
    motions: tuple[RobotMotion, ...] = ()
    ellipses: tuple[Ellipse, ...] | None = None
    truth: tuple[tuple[float, float, float], ...] | None = None


@dataclass(frozen=True, slots=True)
class Ways:
    """SimR to subscribers: the ways that lie ahead of the robots, if the study shows them; whenever they change.

    Attributes:
        tick: of the simulation.
        ways: x, y of each robot's plan in the map frame, thinned; empty without one.
    """

    tick: int
    ways: tuple[tuple[tuple[float, float], ...], ...]


@dataclass(frozen=True, slots=True)
class RoomOutline:
    """A room on the map.

    Attributes:
        room: its number as people count, from 1.
        name: what people call it.
        region: x, y of the corners of its floor, map frame, metres.
        goal: x, y, theta of where robots stand in it.
    """

    room: int
    name: str
    region: tuple[tuple[float, float], ...]
    goal: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class House:
    """Keeper to participant: the house in which all this happens; it never changes.

    Attributes:
        map: its name.
        resolution: metres a cell.
        origin: x, y, theta of the lower left corner of the cells, map frame.
        width: cells in a row.
        height: rows.
        cells: one byte a cell, 0 free, 1 wall, 2 unknown, row 0 at the origin; packed by zlib, in base 64.
        rooms: room 1 first.
        footprint: x, y of the corners of a robot's body, its own frame, metres.
    """

    map: str
    resolution: float
    origin: tuple[float, float, float]
    width: int
    height: int
    cells: str
    rooms: tuple[RoomOutline, ...]
    footprint: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class Picture:
    """Keeper to participant: a piece of the picture that was taken in a room.

    Attributes:
        game: in which it was taken.
        room: where, as people count.
        piece: number of the piece, from 0.
        pieces: how many there are.
        data: the bytes of this piece of the image file, in base 64.
    """

    game: int
    room: int
    piece: int
    pieces: int
    data: str


@dataclass(frozen=True, slots=True)
class Unfit:
    """Keeper to SimR: these robots do not fit the game that is under way."""

    sentence: str


StateNotice = (
    RobotsReady
    | Orders
    | Status
    | HiderReady
    | HidePlease
    | HideTreasures
    | Reply
    | ParticipantReady
    | Subscribe
    | Whereabouts
    | Ways
    | House
    | Picture
    | Unfit
)


def encode_notice(sender: str, receiver: str, value: StateNotice) -> TextMessage:
    """The message that carries a level; its kind is the name of the class."""
    fields: Mapping[str, JsonValue] = msgspec.to_builtins(value)
    return notice(sender, receiver, type(value).__name__, **fields)


def decode_notice(notice: Notice, kind: type[T]) -> T | None:
    """The level in a notice if it is of this kind and well formed, else None."""
    if notice.kind != kind.__name__:
        return None
    try:
        return msgspec.convert(notice.fields, kind)
    except msgspec.ValidationError:
        return None
