"""Notices between the game's own programs; see docs/design.md.

A notice contains a state instead of a change, so repeating a notice has no effect.
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
from thbridge.text_protocol.wire.notice_format import NoticeDecoder, NoticeValue

KEEPER = "Game"
"""Name of the keeper at the text server."""
LARGEST_TEXTS = 1_000_000
"""Largest size of a language's decompressed texts, in bytes."""


class RobotsReady(NoticeValue, frozen=True, tag="RobotsReady"):
    """SimR to keeper: information that the robots are ready.

    Attributes:
        map: name of the map.
        robots: number of robots.
        costs: energy of moves between places, by number (0 is the corridor, rooms start at 1). None if there is no
            move.
        from_starts: energy from each robot's start to each place. If empty, use `costs`.
    """

    map: str
    robots: int
    costs: tuple[tuple[float | None, ...], ...]
    from_starts: tuple[tuple[float | None, ...], ...] = ()


@dataclass(frozen=True, slots=True)
class MoveOrder:
    """An order to drive to a room: number of the move in the game, and number of the room from 1."""

    move: int
    room: int


class Orders(NoticeValue, frozen=True, tag="Orders"):
    """Keeper to SimR: the move and the energy of each robot.

    Attributes:
        game: number of the game. At the start of a new game, every robot is at its start pose.
        moves: one entry per robot. None for a robot that must stand still.
        energy: one entry per robot.
        at: present room of each robot, from 1, or 0 for the corridor. For a moving robot, the start of its move.
        poses: last known x, y, theta of every robot, for a SimR that was restarted during a game.
        taken: robots with a commander other than the participant. Text lines of 2016 have no effect on them.
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
        arrived: False if the move failed.
        sentence: reason for the failure, for people; empty after an arrival.
        share: driven share of the path, 0 to 1.
    """

    move: int
    arrived: bool
    sentence: str
    share: float


class TeamStatus(NoticeValue, frozen=True, tag="Status"):
    """SimR to keeper: pose and condition of each robot, and the result of its last move.

    Attributes:
        game: number of SimR's present game; 0 before the first orders.
        poses: x, y, theta of every robot.
        results: one entry per robot. None during a move and before the first move.
        conditions: one entry per robot.
        researchers: one entry per robot: the name of the intervening researcher, or None. Empty if the program
            does not report researchers.
    """

    game: int
    poses: tuple[tuple[float, float, float], ...]
    results: tuple[MoveResult | None, ...]
    conditions: tuple[Condition, ...]
    researchers: tuple[str | None, ...] = ()


class MoveCosts(NoticeValue, frozen=True, tag="MoveCosts"):
    """SimR to keeper: the costs of moves from the robots' present positions.

    Attributes:
        game: number of the game, as in `TeamStatus`.
        costs: one entry per robot: the energy to each place, by number as in `RobotsReady`. None if there is no move.
            The entry of a robot with unknown costs is empty.
    """

    game: int
    costs: tuple[tuple[float | None, ...], ...]


class HiderReady(NoticeValue, frozen=True, tag="HiderReady"):
    """Hider to keeper: information that Hider is ready. If the game has no treasures, the keeper sends a
    `HideRequest`.
    """


class HideRequest(NoticeValue, frozen=True, tag="HidePlease"):
    """Keeper to Hider: request to hide the treasures of this game."""

    game: int
    rooms: int


class HideTreasures(NoticeValue, frozen=True, tag="HideTreasures"):
    """Hider to keeper: the treasure of each room, in order, with the fields of journals (`hunt.codec`)."""

    game: int
    treasures: tuple[Mapping[str, str | int | None], ...]


class LegacyReply(NoticeValue, frozen=True, tag="Reply"):
    """Keeper to Hider: request to send this line of 2016 to the participant. The keeper has decided on its text."""

    command: str
    text: str


class ParticipantReady(NoticeValue, frozen=True, omit_defaults=True, tag="ParticipantReady"):
    """Participant to keeper: information that the program is ready for views.

    Attributes:
        run: id of this run of the program. Another run may be for another person. Empty if unknown.
        simulated: True if a program takes a seat of a game, and not a person.
    """

    run: str = ""
    simulated: bool = False


class ParticipantFault(NoticeValue, frozen=True, tag="Failed"):
    """Participant to keeper, only for the recording: a plug-in failed, and a built-in participant decided.

    Attributes:
        fault: the error.
    """

    fault: str


class Subscribe(NoticeValue, frozen=True, tag="Subscribe"):
    """Participant to SimR: subscription to pose telemetry for some seconds."""


Activity = Literal["resting", "planning", "driving", "waiting", "clearing", "silent"]
"""Activity of a robot. "waiting": it lets another robot pass. "clearing": it tries to get free."""


@dataclass(frozen=True, slots=True)
class RobotMotion:
    """Activity and progress of a robot.

    Attributes:
        doing: activity of the robot.
        waits_for: the robot that this robot lets pass, or None.
        progress: driven share of the path, 0 to 1; 0 at rest.
        remaining: remaining length of the path, meters; 0 at rest.
        makes_way_for: the robot with the right of way, if this robot waits for it, drives aside or drives around it.
    """

    doing: Activity = "resting"
    waits_for: int | None = None
    progress: float = 0.0
    remaining: float = 0.0
    makes_way_for: int | None = None


@dataclass(frozen=True, slots=True)
class Ellipse:
    """Ellipse with 95 % of the probability of a robot's position.

    Attributes:
        major: longer half axis, meters.
        minor: shorter half axis, meters.
        angle: angle of the longer half axis, radians.
    """

    major: float
    minor: float
    angle: float


class PoseTelemetry(NoticeValue, frozen=True, tag="Whereabouts"):
    """SimR to subscribers: estimated poses of the robots, and further data that the study shows. It is sent often.

    Attributes:
        tick: tick of the simulation. There are 50 ticks per second.
        poses: estimated x, y, theta of every robot, map frame. Empty for participants who do not see the map.
        motions: one entry per robot.
        ellipses: one entry per robot, if the study shows the uncertainty of poses.
        truth: true x, y, theta of every robot, if the study shows true poses.
    """

    tick: int
    poses: tuple[tuple[float, float, float], ...]
    motions: tuple[RobotMotion, ...] = ()
    ellipses: tuple[Ellipse, ...] | None = None
    truth: tuple[tuple[float, float, float], ...] | None = None


class PlannedPaths(NoticeValue, frozen=True, tag="Ways"):
    """SimR to subscribers: the robots' planned paths, after each change, if the study shows paths.

    Attributes:
        tick: tick of the simulation.
        ways: x, y of points on each robot's planned path, map frame. Empty if the robot has no path.
    """

    tick: int
    ways: tuple[tuple[tuple[float, float], ...], ...]


@dataclass(frozen=True, slots=True)
class RoomOutline:
    """A room on the map.

    Attributes:
        room: number of the room, from 1.
        name: name for people.
        region: x, y of the corners of the room's floor, map frame, meters.
        goal: x, y, theta of the robots' goal pose in the room.
    """

    room: int
    name: str
    region: tuple[tuple[float, float], ...]
    goal: tuple[float, float, float]


class FloorPlan(NoticeValue, frozen=True, tag="House"):
    """Keeper to participant: the floor plan of the game's map. It never changes.

    Attributes:
        map: name of the map.
        resolution: meters per cell.
        origin: x, y, theta of the lower left corner of the cells, map frame.
        width: number of cells in a row.
        height: number of rows.
        cells: one byte per cell (0 free, 1 wall, 2 unknown), row 0 at the origin, compressed with zlib, in base 64.
        rooms: outlines of the rooms, in order.
        footprint: x, y of the corners of a robot's body in its own frame, meters.
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
    """Keeper to participant: all texts of the game's language. They never change.

    Attributes:
        language: name of the language.
        packed: the texts as JSON, compressed with zlib, in base 64.
    """

    language: str
    packed: str

    @classmethod
    def of(cls, texts: Texts) -> Self:
        """Return the notice with the texts of a language."""
        return cls(texts.language, base64.b64encode(zlib.compress(msgspec.json.encode(texts), 9)).decode("ascii"))

    def texts(self) -> Texts | None:
        """Return the texts, or None if they are malformed."""
        try:
            unpacker = zlib.decompressobj()
            unpacked = unpacker.decompress(base64.b64decode(self.packed, validate=True), LARGEST_TEXTS)
            return msgspec.json.decode(unpacked, type=Texts)
        except (ValueError, zlib.error, msgspec.MsgspecError):
            return None


class PicturePiece(NoticeValue, frozen=True, tag="Picture"):
    """Keeper to participant: a piece of the picture from a room.

    Attributes:
        game: number of the game.
        room: number of the room, from 1.
        piece: number of the piece, from 0.
        pieces: number of all pieces.
        data: bytes of this piece of the image file, in base 64.
    """

    game: int
    room: int
    piece: int
    pieces: int
    data: str


class ConsentQuery(NoticeValue, frozen=True, tag="MayRecord"):
    """SimR to keeper: question about permission to record the participant. The keeper answers now and after every
    change.
    """


class RecordingPermission(NoticeValue, frozen=True, tag="Recordable"):
    """Keeper to SimR: the answer to `ConsentQuery`.

    Attributes:
        granted: True if the participant has agreed to take part, the study does not ask for consent, or their program
            cannot ask.
    """

    granted: bool


class TeamRejection(NoticeValue, frozen=True, tag="Unfit"):
    """Keeper to SimR: these robots do not match the open game. SimR then ends."""

    sentence: str


SimrNotice: TypeAlias = Orders | Subscribe | TeamRejection | RecordingPermission
"""A notice to SimR."""

SIMR_NOTICES = NoticeDecoder[SimrNotice](SimrNotice)

HiderNotice: TypeAlias = HideRequest | LegacyReply
"""A notice to Hider."""

HIDER_NOTICES = NoticeDecoder[HiderNotice](HiderNotice)
