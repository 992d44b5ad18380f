"""Room numbers: the one place where the wire's counting and people's counting meet."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, order=True)
class Room:
    """A place a robot can stand in: the corridor or a room. Ordered as people count.

    People say 0 for the corridor and 1, 2, ... for the rooms, and so do the rows and columns of the cost matrix. The
    text protocol says 0 for room 1 and has no word for the corridor. Build a room from either side with `of_people` or
    `of_wire`, never by adding one.

    Attributes:
        people: the number people use, 0 is the corridor; never negative.

    Raises:
        ValueError: the number is negative.
    """

    people: int

    def __post_init__(self) -> None:
        if self.people < 0:
            raise ValueError(f"there is no room {self.people}: rooms count from 1, the corridor is 0")

    @classmethod
    def of_people(cls, number: int) -> "Room":
        """The room people call `number`; 0 is the corridor. Raises ValueError below 0."""
        return cls(number)

    @classmethod
    def of_wire(cls, number: int) -> "Room":
        """The room the text protocol calls `number`; 0 is room 1. Raises ValueError below 0."""
        if number < 0:
            raise ValueError(f"there is no room {number} on the wire: rooms count from 0 there")
        return cls(number + 1)

    @property
    def is_corridor(self) -> bool:
        """Whether this is the corridor, where robots start and no treasure lies."""
        return self.people == 0

    @property
    def wire(self) -> int:
        """The number the text protocol uses. Raises ValueError for the corridor, which has none."""
        if self.is_corridor:
            raise ValueError("the corridor has no number on the wire")
        return self.people - 1

    def __str__(self) -> str:
        return "the corridor" if self.is_corridor else f"room {self.people}"


CORRIDOR = Room(0)


def all_rooms(count: int) -> tuple[Room, ...]:
    """Rooms 1 to `count`, without the corridor."""
    return tuple(Room(number) for number in range(1, count + 1))
