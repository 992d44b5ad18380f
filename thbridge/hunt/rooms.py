"""Rooms: their names, their numbers for people and in the text protocol, and the conversion of these numbers."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import total_ordering
from typing import Self


@total_ordering
class Room:
    """A place for robots: the corridor or a room. Rooms are ordered by their number for people.

    For people, the corridor is 0, and rooms have numbers from 1. Rows and columns of the cost matrix have the same
    numbers. In the text protocol, rooms have numbers from 0, and the corridor has no number. Only `of_wire` and `wire`
    convert these numbers. The class is no dataclass, because msgspec would write an object into JSON instead of a
    number.

    Args:
        people: the number for people. The corridor is 0.

    Raises:
        ValueError: the number is negative.
    """

    __slots__ = ("people",)

    def __init__(self, people: int) -> None:
        if people < 0:
            raise ValueError(f"there is no room {people}: rooms have numbers from 1, and the corridor is 0")
        self.people = people

    @classmethod
    def of_wire(cls, number: int) -> "Room":
        """Return the room for a number in the text protocol. Number 0 is room 1. Raises ValueError if negative."""
        if number < 0:
            raise ValueError(f"there is no room {number} in the text protocol: rooms have numbers from 0 there")
        return cls(number + 1)

    @property
    def is_corridor(self) -> bool:
        """True for the corridor. Robots start in the corridor. It has no treasure."""
        return self.people == 0

    @property
    def wire(self) -> int:
        """Number in the text protocol. Raises ValueError for the corridor, which has no number."""
        if self.people == 0:
            raise ValueError("the corridor has no number in the text protocol")
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
    """Names of a map's rooms. People see them next to the numbers.

    Attributes:
        named: names of rooms, by the room's number. Rooms without their own name are not included.
    """

    named: Mapping[int, str] = field(default_factory=dict)

    @classmethod
    def of(cls, names: Iterable[tuple[int, str]]) -> Self:
        """Return the names of rooms. Ignore a name that only repeats the number, such as "Room 3"."""
        return cls({room: name for room, name in names if _says_more(name, room)})

    def name(self, room: int | None) -> str:
        """Return the room's own name, or an empty text if it has no name."""
        return "" if room is None else self.named.get(room, "")

    def numbered(self, room: int) -> str:
        """Return the number, and the name if there is one: "3 (Kitchen)"."""
        return f"{room} ({self.named[room]})" if room in self.named else str(room)

    def titled(self, room: int) -> str:
        """Return the words for the room in a sentence: "room 3 (Kitchen)", "room 4", "the corridor"."""
        return str(CORRIDOR) if room == CORRIDOR.people else f"room {self.numbered(room)}"


def _says_more(name: str, room: int) -> bool:
    return " ".join(name.casefold().split()) not in {"", str(room), f"room {room}"}
