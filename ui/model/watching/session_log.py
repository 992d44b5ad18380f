"""Log of a session: lists of events, sentences, lines and inputs next to the map, and marks on the timeline."""

from bisect import bisect_right
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import get_args

import msgspec

from sim.common.robot_numbers import robot_name
from thbridge.analysis.report.ways_made import WaysMade
from thbridge.hunt.codec import from_json
from thbridge.hunt.event_words import event_in_words, kind_in_words
from thbridge.hunt.events import Commander, PersonSaid, TeamEntry
from thbridge.hunt.rooms import RoomNames
from thbridge.hunt.seats import Seat
from thbridge.hunt.team_words import entry_in_words, seat_of_entry
from thbridge.hunt.treasures import name_in_words
from thbridge.json_text import json_of
from thbridge.ros import names
from thbridge.ros.messages import types, unpack
from thbridge.ros.messages.records import LogLevel
from thbridge.ros.messages.session_records import GameEvent
from ui.model.shared.points import gained
from ui.model.shared.scene import RoomState, decided
from ui.model.watching.dialogue_log import DialogueCourse, DialogueLog
from ui.model.watching.messages import WatchedMessage
from ui.model.watching.scene import Entry, EntryKind
from ui.model.watching.seat_log import SeatLog

MAX_ENTRIES = 50_000
"""Maximum number of entries in a list; when there are more, the oldest are dropped."""
TYPES = frozenset({types.GAME_EVENT, types.UTTERANCE, types.INPUT, types.LOG})
"""Types of messages that each become an entry of a list."""
LINES = frozenset({names.SEND_ROBOTS, names.SUCCESS})
"""Topics with raw lines of the text protocol."""
_FURTHER = frozenset({types.DIALOGUE_MOVE, types.DIALOGUE_STATE, types.SEAT_NOTICE})
"""Types of messages that the log uses without adding an entry to a list."""

IMPORTANT = frozenset(
    {
        "started",
        "departed",
        "arrived",
        "failed",
        "commanded",
        "askedback",
        "identified",
        "ended",
        "collision",
        "died",
        "revived",
        "carried",
    }
)
"""Kinds of events that get a mark on the timeline."""


def is_logged(topic: str, msgtype: str) -> bool:
    """Return True if the log uses the messages of a topic."""
    return msgtype in TYPES | _FURTHER or topic in LINES or topic in {names.ROOMS, names.DIAGNOSTICS}


@dataclass(frozen=True, slots=True)
class RoomStatus:
    """Room at a certain time.

    Attributes:
        state: state of the room in the game.
        robot: index of the robot that drives to the room or has visited it.
        found: the treasure hidden in the room.
        answer: the name that the participant gave the treasure, and the points.
        answer_shorter: shorter versions of `answer`.
    """

    state: RoomState = "unvisited"
    robot: int | None = None
    found: str = ""
    answer: str = ""
    answer_shorter: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class _GameStatus:
    """State of the game at a certain time.

    It has the rooms by number, the commanders of robots that the one participant does not command, by index of the
    robot, and the time at which the game began.
    """

    rooms: dict[int, RoomStatus]
    commanders: dict[int, str]
    started_ns: int | None = None


class SessionLog:
    """Log of a session's messages; they must be added in order of time.

    Attributes:
        room_names: names of the rooms, from the messages received so far.
        ways_made: periods in which robots gave way to others, seconds of ROS time.
        seats: the seats of the game.
    """

    def __init__(self) -> None:
        self.room_names = RoomNames()
        self.ways_made = WaysMade()
        self.seats = SeatLog()
        self._dialogues = DialogueLog()
        self._entries: dict[EntryKind, list[Entry]] = {kind: [] for kind in get_args(EntryKind)}
        self._dropped: dict[EntryKind, int] = dict.fromkeys(self._entries, 0)
        self._stamps: list[int] = []
        self._statuses = [_GameStatus({}, {})]
        self._carried: defaultdict[int, list[int]] = defaultdict(list)

    def entries(self, kind: EntryKind) -> Sequence[Entry]:
        """Return the entries of a list, oldest first.

        New entries are added at the end. A long list loses its oldest entries; `dropped` returns their number.
        """
        return self._entries[kind]

    def dropped(self, kind: EntryKind) -> int:
        """Return the number of oldest entries that a list has lost."""
        return self._dropped[kind]

    def marks(self) -> Iterator[Entry]:
        """Return the events with marks on the timeline, oldest first."""
        return (entry for entry in self._entries["event"] if entry.important)

    def rooms(self, until_ns: int) -> dict[int, RoomStatus]:
        """Return the states of the rooms at a time, by number of the room; rooms without events are omitted."""
        return self._at(until_ns).rooms

    def commanders(self, until_ns: int) -> dict[int, str]:
        """Return the commanders of robots at a time, in words, by index of the robot.

        Robots that the participant commands are omitted.
        """
        return self._at(until_ns).commanders

    def game_start(self, until_ns: int) -> int | None:
        """Return the time at which the game played at `until_ns` began, in ns; None before the first game."""
        return self._at(until_ns).started_ns

    def carried(self, robot: int) -> Sequence[int]:
        """Return the stamps at which a person moved a robot by hand, oldest first."""
        return self._carried[robot]

    def dialogue(self, robot: int, until_ns: int) -> DialogueCourse:
        """Return the latest dialogue of a robot at a time; empty if the robot has not argued in the current game."""
        return self._dialogues.course(robot, self.game_start(until_ns) or 0, until_ns)

    def _at(self, until_ns: int) -> _GameStatus:
        return self._statuses[bisect_right(self._stamps, until_ns)]

    def take(self, message: WatchedMessage) -> None:
        """Process a message; unreadable messages, and messages of other types, have no effect."""
        try:
            entry = self._entry(message)
        except ValueError:
            return
        if entry is None:
            return
        kept = self._entries[entry.kind]
        kept.append(entry)
        if len(kept) > MAX_ENTRIES:
            surplus = MAX_ENTRIES // 10
            del kept[:surplus]
            self._dropped[entry.kind] += surplus

    def _entry(self, message: WatchedMessage) -> Entry | None:
        stamp = message.stamp_ns
        match message.msgtype:
            case types.GAME_EVENT:
                event = unpack.game_event(message.data)
                if message.topic == names.TEAM:
                    return self._team_entry(stamp, event)
                fields = _fields(event.json)
                self._follow(stamp, event, fields)
                who = "" if event.robot is None else robot_name(event.robot)
                what, text = kind_in_words(event.kind), event_in_words(event.kind, fields)
                return Entry(stamp, "event", what, who, event.robot, event.room, text, event.kind in IMPORTANT)
            case types.UTTERANCE:
                utterance = unpack.utterance(message.data)
                person = utterance.seat or "participant"
                speaker = robot_name(utterance.robot) if utterance.speaker == "robot" else person
                speaker += " (wizard)" if utterance.is_by_wizard else ""
                text = utterance.text or utterance.move
                what = utterance.scenario.replace("-", " ")
                return Entry(stamp, "said", what, speaker, utterance.robot, utterance.room, text)
            case types.INPUT:
                given = unpack.outside_input(message.data)
                return Entry(stamp, "input", given.kind, given.sender, None, None, given.line)
            case types.LOG:
                line = unpack.log(message.data)
                grave = line.level >= LogLevel.ERROR
                return Entry(stamp, "log", line.level.name.lower(), line.name, None, None, line.text, grave)
            case types.SEAT_NOTICE:
                self.seats.show(stamp, unpack.seat_notice(message.data))
            case types.DIALOGUE_MOVE:
                self._dialogues.take_move(stamp, unpack.dialogue_move(message.data))
            case types.DIALOGUE_STATE:
                self._dialogues.take_state(stamp, unpack.dialogue_state(message.data))
            case types.MARKER_ARRAY if message.topic == names.ROOMS:
                self.room_names = RoomNames.of(unpack.room_labels(message.data).items())
            case types.DIAGNOSTIC_ARRAY:
                self.ways_made.take(stamp / 1e9, unpack.diagnostic_array(message.data))
            case types.STRING if message.topic in LINES:
                return Entry(stamp, "line", message.topic, "", None, None, unpack.string(message.data).rstrip("\r\n"))
        return None

    def _team_entry(self, stamp: int, event: GameEvent) -> Entry | None:
        """Return the entry for a text or a vote of a participant."""
        entry = from_json(event.json)
        if not isinstance(entry, TeamEntry):
            return None
        self.seats.take(stamp, entry)
        list_of: EntryKind = "said" if isinstance(entry, PersonSaid) else "event"
        text = entry_in_words(entry, self.room_names)
        return Entry(stamp, list_of, kind_in_words(event.kind), seat_of_entry(entry), event.robot, event.room, text)

    def _follow(self, stamp: int, event: GameEvent, fields: dict[str, object]) -> None:
        """Apply an event to the states of rooms and robots."""
        before = self._statuses[-1]
        rooms, commanders, started = before.rooms, before.commanders, before.started_ns
        room_before = rooms.get(event.room or 0, RoomStatus())
        match event:
            case GameEvent("started"):
                rooms, commanders, started = {}, _first_commanders(fields), stamp
                self.seats.begin(stamp, fields)
            case GameEvent("hidden"):
                treasures = fields.get("treasures")
                if isinstance(treasures, list):
                    found = {room: _name(treasure) for room, treasure in enumerate(treasures, start=1)}
                    rooms = {**rooms, **{room: RoomStatus(found=name) for room, name in found.items()}}
            case GameEvent("departed", int(robot), int(room)):
                rooms = {**rooms, room: replace(room_before, state="reserved", robot=robot)}
            case GameEvent("arrived", int(robot), int(room)):
                rooms = {**rooms, room: replace(room_before, state="visited", robot=robot)}
            case GameEvent("failed", _, int(room)):
                rooms = {**rooms, room: replace(room_before, state="unvisited", robot=None)}
            case GameEvent("identified", _, int(room)):
                answer, *shorter = _answers(fields)
                decided_room = replace(room_before, state=_decided(fields), answer=answer, answer_shorter=(*shorter,))
                rooms = {**rooms, room: decided_room}
            case GameEvent("left", _, int(room)):
                rooms = {**rooms, room: replace(room_before, answer="left unnamed")}
            case GameEvent("takenup", _, int(room)):
                rooms = {**rooms, room: replace(room_before, answer="")}
            case GameEvent("commanded", int(robot)):
                others = {other: words for other, words in commanders.items() if other != robot}
                commander = _commander(fields)
                self.seats.command(stamp, robot, fields)
                commanders = {**others, robot: commander} if commander else others
            case GameEvent("carried", int(robot)):
                self._carried[robot].append(stamp)
                return
            case _:
                return
        if not self._stamps or stamp >= self._stamps[-1]:
            self._stamps.append(stamp)
            self._statuses.append(_GameStatus(rooms, commanders, started))


def _first_commanders(fields: dict[str, object]) -> dict[int, str]:
    """Return the seats that command robots at the start of a game, by index of the robot."""
    try:
        seats = msgspec.convert(fields.get("seats", ()), tuple[Seat, ...])
    except msgspec.ValidationError:
        return {}
    return {robot: seat.name for seat in seats for robot in seat.robots}


def _commander(fields: dict[str, object]) -> str:
    """Return the commander in an event, in words: for a participant, their seat; empty for the one participant."""
    by, name = fields.get("by"), fields.get("name")
    if by == Commander.RESEARCHER:
        return f"researcher {name}" if name else "a researcher"
    return str(name or ("" if by == Commander.PARTICIPANT else by) or "")


def _name(treasure: object) -> str:
    return name_in_words(str(treasure.get("name", ""))) if isinstance(treasure, dict) else ""


def _answers(fields: dict[str, object]) -> tuple[str, ...]:
    """Return the points and the name of a named treasure in words, and a shorter version with only the points."""
    name, points = name_in_words(str(fields.get("name") or "")), fields.get("points")
    won = gained(points) if isinstance(points, int) else ""
    return (f"{won} for {name}", won) if won and name else (won or name,)


def _decided(fields: dict[str, object]) -> RoomState:
    """Return the state of a room after its treasure was named."""
    points = fields.get("points")
    return decided(points) if isinstance(points, int) else "visited"


def _fields(text: str) -> dict[str, object]:
    read: object = json_of(text)
    return {str(name): value for name, value in read.items()} if isinstance(read, dict) else {}
