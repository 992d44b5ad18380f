"""Rooms: their numbers in the text protocol and for people, the only conversion between these, and their names."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import total_ordering
from typing import Self


@total_ordering
class Room:
    """A place where a robot can stand: the corridor or a room. Rooms are ordered by their number for people.

    For people, the corridor is 0 and the rooms count from 1; the rows and columns of the cost matrix are the same. The
    text protocol counts rooms from 0 and has no number for the corridor. Only `of_wire` and `wire` convert between the
    two. This is no dataclass, because msgspec would write one as an object, and JSON has the bare number.

    Args:
        people: the number for people; 0 is the corridor.

    Raises:
        ValueError: the number is negative.
    """

    __slots__ = ("people",)

    def __init__(self, people: int) -> None:
        if people < 0:
            raise ValueError(f"there is no room {people}: rooms count from 1, the corridor is 0")
        self.people = people

    @classmethod
    def of_wire(cls, number: int) -> "Room":
        """Return the room of a number in the text protocol; 0 is room 1. Raises ValueError below 0."""
        if number < 0:
            raise ValueError(f"there is no room {number} on the wire: rooms count from 0 there")
        return cls(number + 1)

    @property
    def is_corridor(self) -> bool:
        """True for the corridor, where robots start and no treasure lies."""
        return self.people == 0

    @property
    def wire(self) -> int:
        """Number in the text protocol. Raises ValueError for the corridor, which has none."""
        if self.people == 0:
            raise ValueError("the corridor has no number on the wire")
        return self.people - 1

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Room) and self.people == other.people

    def __lt__(self, other: Self) -> bool:
        return self.people < other.people

    def __hash__(self) -> int:
        return hash((self.people,))

    def __repr__(self) -> str:
        return f"Room({self.people})"

    def __str__(self) -> str:
        return "the corridor" if self.is_corridor else f"room {self.people}"


CORRIDOR = Room(0)


def all_rooms(count: int) -> tuple[Room, ...]:
    """Return the rooms 1 to `count`, without the corridor."""
    return tuple(Room(number) for number in range(1, count + 1))


@dataclass(frozen=True, slots=True)
class RoomNames:
    """Names of a map's rooms, which people read next to the numbers.

    Attributes:
        named: by number, the name of each room that has a name of its own.
    """

    named: Mapping[int, str] = field(default_factory=dict)

    @classmethod
    def of(cls, names: Iterable[tuple[int, str]]) -> Self:
        """Keep the names with more information than the number; "Room 3" has none."""
        return cls({room: name for room, name in names if _says_more(name, room)})

    def name(self, room: int | None) -> str:
        """Return the room's own name; empty if it has none."""
        return "" if room is None else self.named.get(room, "")

    def numbered(self, room: int) -> str:
        """Return the number with the name, if any: "3 (Kitchen)"."""
        return f"{room} ({self.named[room]})" if room in self.named else str(room)

    def titled(self, room: int) -> str:
        """Return the room for use within a sentence: "room 3 (Kitchen)", "room 4", "the corridor"."""
        return str(CORRIDOR) if room == CORRIDOR.people else f"room {self.numbered(room)}"


def _says_more(name: str, room: int) -> bool:
    return " ".join(name.casefold().split()) not in {"", str(room), f"room {room}"}
