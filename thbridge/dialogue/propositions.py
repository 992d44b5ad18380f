"""Propositions of the hunt: possible beliefs and subjects of arguments, written as in Sklar and Azhar 2015."""

from dataclasses import dataclass, fields
from math import fsum
from typing import ClassVar, cast

from sim.common.robot_numbers import number_of
from thbridge.dialogue.argumentation.propositions import Literal, Proposition
from thbridge.hunt.costs import energy_text
from thbridge.hunt.rooms import Room


@dataclass(frozen=True, slots=True)
class HuntProposition(Proposition):
    """A proposition of the hunt: a predicate with values, which are written in the order of the fields.

    Attributes:
        predicate: name of the predicate.
        unique_by: fields that identify a thing with only one value. If None, several values can hold.
    """

    predicate: ClassVar[str]
    unique_by: ClassVar[tuple[str, ...] | None] = None

    def excludes(self, other: Proposition) -> bool:
        """Return True for a different value of the same thing."""
        if self.unique_by is None or type(other) is not type(self) or self == other:
            return False
        return all(getattr(self, name) == getattr(other, name) for name in self.unique_by)

    def __str__(self) -> str:
        values = (_written(field.name, cast(object, getattr(self, field.name))) for field in fields(self))
        return f"{self.predicate}({', '.join(values)})"


def _written(name: str, value: object) -> str:
    match value:
        case Room():
            return f"Room{value.people}"
        case float():
            return energy_text(value)
        case int() if name == "robot":
            return f"Robot{number_of(value)}"
        case tuple():
            between = {"rooms": ", ", "terms": " + ", "names": " or "}[name]
            return between.join(_written("", each) for each in cast(tuple[object, ...], value))
        case _:
            return str(value)


@dataclass(frozen=True, slots=True)
class Selected(HuntProposition):
    """A room is to be searched."""

    predicate: ClassVar[str] = "selected"
    room: Room


@dataclass(frozen=True, slots=True)
class VisitOrder(HuntProposition):
    """A room is the nth room to visit; each position has one room, and each room has one position."""

    predicate: ClassVar[str] = "order"
    place: int
    room: Room

    def excludes(self, other: Proposition) -> bool:
        """Return True for another room at this position, and for this room at another position."""
        return isinstance(other, VisitOrder) and (self.place == other.place) != (self.room == other.room)


@dataclass(frozen=True, slots=True)
class RoomSequence(HuntProposition):
    """Rooms are visited in this order, each at its position.

    Attributes:
        rooms: at least two rooms, in order.
    """

    predicate: ClassVar[str] = "tour"
    rooms: tuple[Room, ...]

    @property
    def parts(self) -> tuple[Literal, ...]:
        """The position of each room. The opposite of a tour denies each position (Sklar and Azhar 2015)."""
        return tuple(Literal(VisitOrder(place, room)) for place, room in enumerate(self.rooms, start=1))


@dataclass(frozen=True, slots=True)
class EnergyLevel(HuntProposition):
    """The robot has this amount of energy left."""

    predicate: ClassVar[str] = "current_energy_level"
    unique_by: ClassVar[tuple[str, ...] | None] = ()
    energy: float


@dataclass(frozen=True, slots=True)
class EnergyCost(HuntProposition):
    """Going from a place to a room costs this amount of energy."""

    predicate: ClassVar[str] = "energy_cost"
    unique_by: ClassVar[tuple[str, ...] | None] = ("start", "goal")
    start: Room
    goal: Room
    energy: float


@dataclass(frozen=True, slots=True)
class CostsMore(HuntProposition):
    """Going from a place to a room costs more than this amount of energy."""

    predicate: ClassVar[str] = "costs_more"
    start: Room
    goal: Room
    energy: float


@dataclass(frozen=True, slots=True)
class LessThan(HuntProposition):
    """A sum of energies is below another energy."""

    predicate: ClassVar[str] = "less_than"
    terms: tuple[float, ...]
    limit: float

    @property
    def is_true(self) -> bool:
        """True if the sum of the terms is below the limit."""
        return fsum(self.terms) < self.limit


@dataclass(frozen=True, slots=True)
class ColourFound(HuntProposition):
    """A robot has seen a color in a picture."""

    predicate: ClassVar[str] = "color_found"
    image: str
    colour: str


@dataclass(frozen=True, slots=True)
class InImage(HuntProposition):
    """Something is visible in a picture."""

    predicate: ClassVar[str] = "in_image"
    thing: str
    image: str


@dataclass(frozen=True, slots=True)
class TreasureIn(HuntProposition):
    """One treasure, and no other, is in a room."""

    predicate: ClassVar[str] = "treasure_in"
    unique_by: ClassVar[tuple[str, ...] | None] = ("room",)
    name: str
    room: Room


@dataclass(frozen=True, slots=True)
class Wanted(HuntProposition):
    """The speaker wants a literal to hold, without a further reason."""

    predicate: ClassVar[str] = "wanted"
    what: Literal

    @property
    def is_wish(self) -> bool:
        """Always True."""
        return True


@dataclass(frozen=True, slots=True)
class Visited(HuntProposition):
    """A room has been searched."""

    predicate: ClassVar[str] = "visited"
    room: Room


@dataclass(frozen=True, slots=True)
class TooFar(HuntProposition):
    """A room is too far for the energy left."""

    predicate: ClassVar[str] = "too_far"
    room: Room


@dataclass(frozen=True, slots=True)
class NextRoom(HuntProposition):
    """A robot goes to a room next. It goes to only one room, and no other robot goes there.

    Attributes:
        robot: index in the team, from 0.
        room: the room.
    """

    predicate: ClassVar[str] = "next"
    robot: int
    room: Room

    def excludes(self, other: Proposition) -> bool:
        """Return True for another room of this robot, and for this room of another robot."""
        return isinstance(other, NextRoom) and (self.robot == other.robot) != (self.room == other.room)


@dataclass(frozen=True, slots=True)
class TeamPlan(HuntProposition):
    """Best result of the team if a robot goes to a room next: a number of rooms, for a total amount of energy.

    If two such results are compared, both are proven to be the best.

    Attributes:
        robot: index in the team, from 0.
        room: its next room.
        rooms: number of rooms that the team reaches.
        energy: total energy of all moves of the team.
    """

    predicate: ClassVar[str] = "plan"
    unique_by: ClassVar[tuple[str, ...] | None] = ("robot", "room")
    robot: int
    room: Room
    rooms: int
    energy: float


@dataclass(frozen=True, slots=True)
class FewerRooms(HuntProposition):
    """A number of rooms is below another number of rooms."""

    predicate: ClassVar[str] = "fewer_rooms"
    fewer: int
    more: int

    @property
    def is_true(self) -> bool:
        """True if the first number is below the second number."""
        return self.fewer < self.more


@dataclass(frozen=True, slots=True)
class DearerPlan(HuntProposition):
    """Choosing `room` over `instead` costs the team `energy` more energy, for equally many rooms."""

    predicate: ClassVar[str] = "dearer_plan"
    room: Room
    instead: Room
    energy: float


@dataclass(frozen=True, slots=True)
class ShorterPlan(HuntProposition):
    """If `room` is chosen instead of `instead`, the team can reach `rooms` fewer rooms."""

    predicate: ClassVar[str] = "shorter_plan"
    room: Room
    instead: Room
    rooms: int


@dataclass(frozen=True, slots=True)
class LeftBehind(HuntProposition):
    """Another robot has no room to go to, and stays where it is, if this robot goes to a room next.

    Attributes:
        robot: index of the other robot in the team.
        place: place where the other robot stands.
        room: this robot's next room.
    """

    predicate: ClassVar[str] = "left_behind"
    robot: int
    place: Room
    room: Room


@dataclass(frozen=True, slots=True)
class CostOfOther(HuntProposition):
    """Going to a room would cost another robot this amount of energy, by its own report.

    Attributes:
        robot: index in the team, from 0.
        room: the room.
        energy: energy of its move there.
    """

    predicate: ClassVar[str] = "energy_cost_of"
    unique_by: ClassVar[tuple[str, ...] | None] = ("robot", "room")
    robot: int
    room: Room
    energy: float


@dataclass(frozen=True, slots=True)
class UnderWay(HuntProposition):
    """Another robot is on its way to a room, or has agreed to go there.

    Attributes:
        robot: index in the team, from 0.
        room: the room.
    """

    predicate: ClassVar[str] = "under_way"
    robot: int
    room: Room


@dataclass(frozen=True, slots=True)
class NoWay(HuntProposition):
    """The robot finds no path to a room."""

    predicate: ClassVar[str] = "no_way"
    room: Room


@dataclass(frozen=True, slots=True)
class InTheWay(HuntProposition):
    """Something that is not on the map blocks the path to a room, for example a closed door or a fire."""

    predicate: ClassVar[str] = "in_the_way"
    room: Room


@dataclass(frozen=True, slots=True)
class TakesPicture(HuntProposition):
    """The robot in a room takes a picture of the treasure there."""

    predicate: ClassVar[str] = "picture"
    room: Room


@dataclass(frozen=True, slots=True)
class NamesTreasure(HuntProposition):
    """The treasure in a room is named now."""

    predicate: ClassVar[str] = "name"
    room: Room


@dataclass(frozen=True, slots=True)
class NamesTreasureAs(HuntProposition):
    """The treasure in a room is named now, with this name.

    Attributes:
        room: room of the treasure.
        name: name of the treasure.
    """

    predicate: ClassVar[str] = "name_as"
    unique_by: ClassVar[tuple[str, ...] | None] = ("room",)
    room: Room
    name: str


@dataclass(frozen=True, slots=True)
class PropertyFound(HuntProposition):
    """A property of the treasure in a room was found.

    Attributes:
        room: room of the treasure.
        value: value of the property, as part of a sentence: `round and large`, `made of wood`.
    """

    predicate: ClassVar[str] = "found"
    room: Room
    value: str


@dataclass(frozen=True, slots=True)
class PropertyListed(HuntProposition):
    """The list of treasures, which all sides know, contains a treasure with this name and this property.

    Attributes:
        name: name of the treasure.
        value: value of the property, as part of a sentence.
    """

    predicate: ClassVar[str] = "listed"
    name: str
    value: str


@dataclass(frozen=True, slots=True)
class SeenInPicture(HuntProposition):
    """A person sees this treasure in the picture of the treasure in a room.

    Attributes:
        room: room of the treasure.
        name: name of the treasure.
    """

    predicate: ClassVar[str] = "seen"
    unique_by: ClassVar[tuple[str, ...] | None] = ("room",)
    room: Room
    name: str


@dataclass(frozen=True, slots=True)
class CouldBe(HuntProposition):
    """Everything known about the treasure in a room fits several names.

    Attributes:
        room: the room.
        names: at least two names, in alphabetical order.
    """

    predicate: ClassVar[str] = "could_be"
    room: Room
    names: tuple[str, ...]

    def excludes(self, other: Proposition) -> bool:
        """Return True if `other` gives the same treasure other names, or only one name."""
        return isinstance(other, CouldBe | Settled) and self.room == other.room and self != other


@dataclass(frozen=True, slots=True)
class Settled(HuntProposition):
    """Everything known about the treasure in a room fits only one name."""

    predicate: ClassVar[str] = "settled"
    room: Room
    name: str

    def excludes(self, other: Proposition) -> bool:
        """Return True if `other` gives the same treasure another name, or several names."""
        return isinstance(other, CouldBe | Settled) and self.room == other.room and self != other


@dataclass(frozen=True, slots=True)
class PictureTaken(HuntProposition):
    """There is already a picture of the treasure in a room."""

    predicate: ClassVar[str] = "picture_taken"
    room: Room


@dataclass(frozen=True, slots=True)
class PictureCost(HuntProposition):
    """Taking a picture costs this amount of energy."""

    predicate: ClassVar[str] = "picture_cost"
    energy: float


@dataclass(frozen=True, slots=True)
class NamingCost(HuntProposition):
    """Naming a treasure costs this amount of energy."""

    predicate: ClassVar[str] = "naming_cost"
    energy: float


@dataclass(frozen=True, slots=True)
class Objected(HuntProposition):
    """The participant of a seat that reads along objects to the proposal of a dialogue, for this reason."""

    predicate: ClassVar[str] = "objected"
    seat: str
    reason: str


@dataclass(frozen=True, slots=True)
class Decided(HuntProposition):
    """The participant of a seat has decided for the proposal of a dialogue, in spite of objections."""

    predicate: ClassVar[str] = "decided"
    seat: str
