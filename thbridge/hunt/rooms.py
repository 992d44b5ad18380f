"""Room numbers: the one place that converts between the wire's counting and people's."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, order=True)
class Room:
    """A place a robot can stand in: the corridor or a room. Ordered as people count.

    People count the corridor as 0 and the rooms from 1, and so do the rows and columns of the cost matrix. The text
    protocol counts rooms from 0 and has no number for the corridor. Make a room with `of_people` or `of_wire`, never by
    adding one.

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
        """Return the room of a number as people count; 0 is the corridor. Raises ValueError below 0."""
        return cls(number)

    @classmethod
    def of_wire(cls, number: int) -> "Room":
        """Return the room of a number of the text protocol; 0 is room 1. Raises ValueError below 0."""
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
        if self.is_corridor:
            raise ValueError("the corridor has no number on the wire")
        return self.people - 1

    def __str__(self) -> str:
        return "the corridor" if self.is_corridor else f"room {self.people}"


CORRIDOR = Room(0)


def all_rooms(count: int) -> tuple[Room, ...]:
    """Return the rooms 1 to `count`, without the corridor."""
    return tuple(Room(number) for number in range(1, count + 1))
