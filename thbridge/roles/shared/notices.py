"""Notices with which the game's own programs keep each other up to date; see docs/design.md.

Each contains a state and not a change, so a notice that is sent twice does no harm.
"""

import base64
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, Self, TypeAlias

import msgspec

from thbridge.dialogue.wording.texts import Texts
from thbridge.hunt.events import Condition
from thbridge.hunt.rooms import RoomNames
from thbridge.text_protocol.wire.notice import NoticeDecoder, NoticeValue

KEEPER = "Game"
"""Name of the keeper at the text server."""
LARGEST_TEXTS = 1_000_000
"""Largest size of a language's texts, unpacked, in bytes."""


class RobotsReady(NoticeValue, frozen=True, tag="RobotsReady"):
    """SimR to keeper: the robots are ready.

    Attributes:
        map: name of the map.
        robots: size of the team.
        costs: energy from place to place, by number: 0 for the corridor, rooms from 1; None where there is no move.
        from_starts: energy from the start of each robot to each place; if empty, `costs` applies there.
    """

    map: str
    robots: int
    costs: tuple[tuple[float | None, ...], ...]
    from_starts: tuple[tuple[float | None, ...], ...] = ()


@dataclass(frozen=True, slots=True)
class MoveOrder:
    """An order to drive to a room. `move` numbers the moves of one game; `room` counts from 1."""

    move: int
    room: int


class Orders(NoticeValue, frozen=True, tag="Orders"):
    """Keeper to SimR: the move and the energy of each robot.

    Attributes:
        game: number of the game; a new game begins with every robot at its start.
        moves: one entry per robot; None for a robot that has to stand still.
        energy: one entry per robot.
        at: room in which each robot stands, from 1, or 0 for the corridor; for a moving robot, where it started.
        poses: last known x, y, theta of every robot, for a SimR that is restarted during a game.
        taken: robots that are not commanded by the participant; text lines of 2016 do not drive them.
    """

    game: int
    moves: tuple[MoveOrder | None, ...]
    energy: tuple[float, ...]
    at: tuple[int, ...]
    poses: tuple[tuple[float, float, float], ...] | None
    taken: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class MoveResult:
    """Result of a move.

    Attributes:
        move: number of the order.
        arrived: False when the move was given up.
        sentence: reason for giving up, for people; empty on arrival.
        share: driven share of the path, 0 to 1.
    """

    move: int
    arrived: bool
    sentence: str
    share: float


class TeamStatus(NoticeValue, frozen=True, tag="Status"):
    """SimR to keeper: pose and condition of each robot, and the result of its last move.

    Attributes:
        game: number of the game that SimR plays; 0 before the first orders.
        poses: x, y, theta of every robot.
        results: one entry per robot; None during a move and before the first.
        conditions: one entry per robot.
        researchers: one entry per robot: the name of the researcher who intervenes now, or None. Empty from programs
            that do not report researchers.
    """

    game: int
    poses: tuple[tuple[float, float, float], ...]
    results: tuple[MoveResult | None, ...]
    conditions: tuple[Condition, ...]
    researchers: tuple[str | None, ...] = ()


class MoveCosts(NoticeValue, frozen=True, tag="MoveCosts"):
    """SimR to keeper: the costs of moves from where the robots stand.

    Attributes:
        game: as in `TeamStatus`.
        costs: one entry per robot: the energy to each place, by number as in `RobotsReady`, None where there is no
            move. The entry of a robot with unknown costs is empty.
    """

    game: int
    costs: tuple[tuple[float | None, ...], ...]


class HiderReady(NoticeValue, frozen=True, tag="HiderReady"):
    """Hider to keeper: Hider is ready; the keeper answers with `HideRequest` if its game has no treasures yet."""


class HideRequest(NoticeValue, frozen=True, tag="HidePlease"):
    """Keeper to Hider: hide treasures for this game."""

    game: int
    rooms: int


class HideTreasures(NoticeValue, frozen=True, tag="HideTreasures"):
    """Hider to keeper: the treasure of each room, room 1 first, in the form that journals use (`hunt.codec`)."""

    game: int
    treasures: tuple[Mapping[str, str | int | None], ...]


class LegacyReply(NoticeValue, frozen=True, tag="Reply"):
    """Keeper to Hider: send this line of the 2016 dialect, on which the keeper has decided, to the participant."""

    command: str
    text: str


class ParticipantReady(NoticeValue, frozen=True, omit_defaults=True, tag="ParticipantReady"):
    """Participant to keeper: the program is ready for views.

    Attributes:
        run: mark of this run of the program; another run may be another person's. Empty if unknown.
    """

    run: str = ""


class ParticipantFault(NoticeValue, frozen=True, tag="Failed"):
    """Participant to keeper, for the record: a plug-in failed, and a built-in participant decided.

    Attributes:
        fault: the error.
    """

    fault: str


class Subscribe(NoticeValue, frozen=True, tag="Subscribe"):
    """Participant to SimR: subscribe to pose telemetry for the next few seconds."""


Activity = Literal["resting", "planning", "driving", "waiting", "clearing", "silent"]
"""Activity of a robot: "waiting" means that it lets another robot pass, "clearing" that it tries to get free."""


@dataclass(frozen=True, slots=True)
class RobotMotion:
    """Activity and progress of one robot.

    Attributes:
        doing: its activity.
        waits_for: the robot that it lets pass.
        progress: driven share of the path, 0 to 1; 0 at rest.
        remaining: meters still to drive; 0 at rest.
        makes_way_for: the robot with the right of way, while this robot waits for it, drives aside or drives around it.
    """

    doing: Activity = "resting"
    waits_for: int | None = None
    progress: float = 0.0
    remaining: float = 0.0
    makes_way_for: int | None = None


@dataclass(frozen=True, slots=True)
class Ellipse:
    """Ellipse with 95 % of the probability of a robot's position: half axes in meters; the longer one is at `angle`."""

    major: float
    minor: float
    angle: float


class PoseTelemetry(NoticeValue, frozen=True, tag="Whereabouts"):
    """SimR to subscribers: estimated poses of the robots, and everything else that the study shows; sent often.

    Attributes:
        tick: tick of the simulation, 50 per second.
        poses: estimated x, y, theta of every robot, map frame.
        motions: one entry per robot.
        ellipses: one entry per robot, if the study shows the uncertainty of poses.
        truth: true x, y, theta of every robot, only if the study shows that.
    """

    tick: int
    poses: tuple[tuple[float, float, float], ...]
    motions: tuple[RobotMotion, ...] = ()
    ellipses: tuple[Ellipse, ...] | None = None
    truth: tuple[tuple[float, float, float], ...] | None = None


class PlannedPaths(NoticeValue, frozen=True, tag="Ways"):
    """SimR to subscribers: the planned paths ahead of the robots, if the study shows them; whenever they change.

    Attributes:
        tick: tick of the simulation.
        ways: x, y of each robot's planned path in the map frame, thinned; empty if the robot has no path.
    """

    tick: int
    ways: tuple[tuple[tuple[float, float], ...], ...]


@dataclass(frozen=True, slots=True)
class RoomOutline:
    """A room on the map.

    Attributes:
        room: its number, from 1.
        name: name for people.
        region: x, y of the corners of its floor, map frame, meters.
        goal: x, y, theta of the robots' goal pose in it.
    """

    room: int
    name: str
    region: tuple[tuple[float, float], ...]
    goal: tuple[float, float, float]


class FloorPlan(NoticeValue, frozen=True, tag="House"):
    """Keeper to participant: the floor plan of the game's map; it never changes.

    Attributes:
        map: its name.
        resolution: meters per cell.
        origin: x, y, theta of the lower left corner of the cells, map frame.
        width: cells in a row.
        height: rows.
        cells: one byte per cell, 0 free, 1 wall, 2 unknown, row 0 at the origin; packed with zlib, in base 64.
        rooms: room 1 first.
        footprint: x, y of the corners of a robot's body, its own frame, meters.
    """

    map: str
    resolution: float
    origin: tuple[float, float, float]
    width: int
    height: int
    cells: str
    rooms: tuple[RoomOutline, ...]
    footprint: tuple[tuple[float, float], ...]

    @property
    def room_names(self) -> RoomNames:
        """Names of the rooms."""
        return RoomNames.of((outline.room, outline.name) for outline in self.rooms)


class GameTexts(NoticeValue, frozen=True, tag="Texts"):
    """Keeper to participant: all texts of the game's language; they never change.

    Attributes:
        language: name of the language.
        packed: the texts as JSON, packed with zlib, in base 64.
    """

    language: str
    packed: str

    @classmethod
    def of(cls, texts: Texts) -> Self:
        """Pack the texts of a language."""
        return cls(texts.language, base64.b64encode(zlib.compress(msgspec.json.encode(texts), 9)).decode("ascii"))

    def texts(self) -> Texts | None:
        """Return the texts; None if they are malformed."""
        try:
            unpacker = zlib.decompressobj()
            unpacked = unpacker.decompress(base64.b64decode(self.packed, validate=True), LARGEST_TEXTS)
            return msgspec.json.decode(unpacked, type=Texts)
        except (ValueError, zlib.error, msgspec.MsgspecError):
            return None


class PicturePiece(NoticeValue, frozen=True, tag="Picture"):
    """Keeper to participant: a piece of the picture that was taken in a room.

    Attributes:
        game: number of the game.
        room: its number, from 1.
        piece: number of the piece, from 0.
        pieces: number of all pieces.
        data: the bytes of this piece of the image file, in base 64.
    """

    game: int
    room: int
    piece: int
    pieces: int
    data: str


class ConsentQuery(NoticeValue, frozen=True, tag="MayRecord"):
    """SimR to keeper: asks if the participant may be recorded, now and after every change."""


class RecordingPermission(NoticeValue, frozen=True, tag="Recordable"):
    """Keeper to SimR, in answer to `ConsentQuery`.

    Attributes:
        granted: True if the participant has agreed to take part, the study does not ask, or their program cannot ask.
    """

    granted: bool


class TeamRejection(NoticeValue, frozen=True, tag="Unfit"):
    """Keeper to SimR: these robots do not fit the game in progress; SimR ends."""

    sentence: str


SimrNotice: TypeAlias = Orders | Subscribe | TeamRejection | RecordingPermission
"""A notice to SimR."""

SIMR_NOTICES = NoticeDecoder[SimrNotice](SimrNotice)

HiderNotice: TypeAlias = HideRequest | LegacyReply
"""A notice to Hider."""

HIDER_NOTICES = NoticeDecoder[HiderNotice](HiderNotice)
