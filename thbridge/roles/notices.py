"""The notices by which the game's own programs keep each other up to date; see docs/design.md.

Each is a level: it says how things are, and saying it twice does no harm.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeVar

import msgspec

from thbridge.hunt.events import Condition
from thbridge.hunt.treasures import TreasureKind
from thbridge.wire.notice import JsonValue, Notice, notice
from thbridge.wire.text import Message

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
class Order:
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
    """

    game: int
    moves: tuple[Order | None, ...]
    energy: tuple[float, ...]
    at: tuple[int, ...]
    poses: tuple[tuple[float, float, float], ...] | None


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
    """

    game: int
    poses: tuple[tuple[float, float, float], ...]
    results: tuple[MoveResult | None, ...]
    conditions: tuple[Condition, ...]


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


@dataclass(frozen=True, slots=True)
class Whereabouts:
    """SimR to subscribers: where the robots believe they are (x, y, theta), never the truth."""

    tick: int
    poses: tuple[tuple[float, float, float], ...]


@dataclass(frozen=True, slots=True)
class Unfit:
    """Keeper to SimR: these robots do not fit the game that is under way."""

    sentence: str


Level = (
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
    | Unfit
)


def tell(sender: str, receiver: str, value: Level) -> Message:
    """The message that carries a level; its kind is the name of the class."""
    fields: Mapping[str, JsonValue] = msgspec.to_builtins(value)
    return notice(sender, receiver, type(value).__name__, **fields)


def heard(notice: Notice, kind: type[T]) -> T | None:
    """The level in a notice if it is of this kind and well formed, else None."""
    if notice.kind != kind.__name__:
        return None
    try:
        return msgspec.convert(notice.fields, kind)
    except msgspec.ValidationError:
        return None
