"""What happened and was said, line by line: the lists beside the map, and the marks on the timeline."""

import json
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TypeGuard, get_args

from thbridge.hunt.events import Commander
from thbridge.hunt.rules import robot_name
from thbridge.ros import names
from thbridge.ros.messages import types, unpack
from thbridge.ros.messages.records import GameEvent, LogLevel
from ui.model.scene import RoomState
from ui.model.watching.messages import WatchedMessage
from ui.model.watching.scene import Entry, EntryKind

MAX_ENTRIES = 50_000
"""Entries of one list; beyond them the oldest go."""
TYPES = frozenset({types.GAME_EVENT, types.UTTERANCE, types.INPUT, types.LOG})
"""Types of which every message is an entry."""
LINES = frozenset({names.SEND_ROBOTS, names.SUCCESS})
"""Topics of raw lines of the protocol."""

IMPORTANT = frozenset(
    {
        "started",
        "departed",
        "arrived",
        "failed",
        "commanded",
        "asked-back",
        "identified",
        "ended",
        "collision",
        "died",
        "revived",
        "carried",
    }
)
"""Events that get a mark on the timeline."""

_IN_WORDS = {"asked-back": "the participant asks for it"}
"""What events say of which nothing but the robot is told."""


def is_logged(topic: str, msgtype: str) -> bool:
    """Whether the messages of a topic are entries."""
    return msgtype in TYPES or topic in LINES


@dataclass(frozen=True, slots=True)
class RoomStatus:
    """How the game left a room: its state, the robot that is on its way or was there, what is known to be in it."""

    state: RoomState = "unvisited"
    robot: int | None = None
    found: str = ""


@dataclass(frozen=True, slots=True)
class _GameStatus:
    """How the game stands: its rooms by number, and by robot who else than the participant commands it."""

    rooms: dict[int, RoomStatus]
    commanders: dict[int, str]


class SessionLog:
    """Grows with the messages that are taken, in order of time."""

    def __init__(self) -> None:
        self._entries: dict[EntryKind, list[Entry]] = {kind: [] for kind in get_args(EntryKind)}
        self._dropped: dict[EntryKind, int] = dict.fromkeys(self._entries, 0)
        self._stamps: list[int] = []
        self._statuses = [_GameStatus({}, {})]

    def entries(self, kind: EntryKind) -> Sequence[Entry]:
        """A list, oldest first. It grows at its end, and when it is long it loses what is oldest: see `dropped`."""
        return self._entries[kind]

    def dropped(self, kind: EntryKind) -> int:
        """How many entries a list has lost at its beginning."""
        return self._dropped[kind]

    def count(self, kind: EntryKind, until_ns: int) -> int:
        """How many entries of a list there were at a time."""
        return bisect_right(self._entries[kind], until_ns, key=lambda entry: entry.stamp_ns)

    def marks(self) -> Iterator[Entry]:
        """The events that matter, oldest first."""
        return (entry for entry in self._entries["event"] if entry.important)

    def rooms(self, until_ns: int) -> dict[int, RoomStatus]:
        """What the game made of its rooms up to a time, by number; rooms that it never spoke of are missing."""
        return self._at(until_ns).rooms

    def commanders(self, until_ns: int) -> dict[int, str]:
        """Who commands robots at a time, in words, by index; those that the participant commands are missing."""
        return self._at(until_ns).commanders

    def _at(self, until_ns: int) -> _GameStatus:
        return self._statuses[bisect_right(self._stamps, until_ns)]

    def take(self, said: WatchedMessage) -> None:
        """Take a message; one that cannot be read, or tells no story, changes nothing."""
        try:
            entry = self._entry(said)
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

    def _entry(self, said: WatchedMessage) -> Entry | None:
        stamp = said.stamp_ns
        match said.msgtype:
            case types.GAME_EVENT:
                event = unpack.game_event(said.data)
                fields = _fields(event.json)
                self._follow(stamp, event, fields)
                who = "" if event.robot is None else robot_name(event.robot)
                text = _told(fields) or _IN_WORDS.get(event.kind, "")
                return Entry(stamp, "event", event.kind, who, event.robot, event.room, text, event.kind in IMPORTANT)
            case types.UTTERANCE:
                spoken = unpack.utterance(said.data)
                speaker = robot_name(spoken.robot) if spoken.speaker == "robot" else "participant"
                speaker += " (spoken for)" if spoken.author == "wizard" else ""
                text = spoken.text or spoken.move
                return Entry(stamp, "said", spoken.scenario, speaker, spoken.robot, spoken.room, text)
            case types.INPUT:
                given = unpack.outside_input(said.data)
                return Entry(stamp, "input", given.kind, given.sender, None, None, given.line)
            case types.LOG:
                line = unpack.log(said.data)
                grave = line.level >= LogLevel.ERROR
                return Entry(stamp, "log", line.level.name.lower(), line.name, None, None, line.text, grave)
            case types.STRING if said.topic in LINES:
                return Entry(stamp, "line", said.topic, "", None, None, unpack.string(said.data).rstrip("\r\n"))
        return None

    def _follow(self, stamp: int, event: GameEvent, fields: dict[str, object]) -> None:
        """See what an event makes of rooms and robots."""
        before = self._statuses[-1]
        rooms, commanders = before.rooms, before.commanders
        match event:
            case GameEvent("started"):
                rooms, commanders = {}, {}
            case GameEvent("hidden"):
                treasures = fields.get("treasures")
                if isinstance(treasures, list):
                    found = {room: _name(treasure) for room, treasure in enumerate(treasures, start=1)}
                    rooms = {**rooms, **{room: RoomStatus(found=name) for room, name in found.items()}}
            case GameEvent("departed", int(robot), int(room)):
                rooms = {**rooms, room: RoomStatus("reserved", robot, _found(rooms, room))}
            case GameEvent("arrived", int(robot), int(room)):
                rooms = {**rooms, room: RoomStatus("visited", robot, _found(rooms, room))}
            case GameEvent("failed", _, int(room)):
                rooms = {**rooms, room: RoomStatus(found=_found(rooms, room))}
            case GameEvent("commanded", int(robot)):
                others = {other: words for other, words in commanders.items() if other != robot}
                commander = _commander(fields)
                commanders = {**others, robot: commander} if commander else others
            case _:
                return
        if not self._stamps or stamp >= self._stamps[-1]:
            self._stamps.append(stamp)
            self._statuses.append(_GameStatus(rooms, commanders))


def _commander(fields: dict[str, object]) -> str:
    """Who commands a robot, in words; empty for the participant."""
    by, name = fields.get("by"), fields.get("name")
    if by == Commander.RESEARCHER:
        return f"researcher {name}" if name else "a researcher"
    return str(name or by or "") if by != Commander.PARTICIPANT else ""


def _found(rooms: dict[int, RoomStatus], room: int) -> str:
    return rooms[room].found if room in rooms else ""


def _name(treasure: object) -> str:
    return str(treasure.get("name", "")) if isinstance(treasure, dict) else ""


def _fields(text: str) -> dict[str, object]:
    read: object = json.loads(text)
    return {str(name): value for name, value in read.items()} if isinstance(read, dict) else {}


def _told(fields: dict[str, object]) -> str:
    """An event for people, from the plain values in its JSON."""
    told = (
        f"{name.replace('_', ' ')} {value.rstrip('.') if isinstance(value, str) else f'{value:g}'}"
        for name, value in fields.items()
        if name not in _SAID_ELSEWHERE and _is_plain(value)
    )
    return ", ".join(told)


def _is_plain(value: object) -> TypeGuard[str | int | float]:
    return isinstance(value, str | int | float) and not isinstance(value, bool) and value != ""


_SAID_ELSEWHERE = frozenset({"v", "event", "robot", "room"})
