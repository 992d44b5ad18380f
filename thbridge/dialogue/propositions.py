"""Propositions of the hunt: what robots and people may believe, and argue about; written as in Sklar and Azhar 2015."""

from dataclasses import dataclass
from math import fsum

from sim.common.robot_numbers import number_of
from thbridge.dialogue.argumentation.propositions import Literal, Proposition
from thbridge.hunt.costs import energy_text
from thbridge.hunt.rooms import Room


@dataclass(frozen=True, slots=True)
class Selected(Proposition):
    """A room is one of those to look into."""

    room: Room

    def __str__(self) -> str:
        return f"selected({_room(self.room)})"


@dataclass(frozen=True, slots=True)
class VisitOrder(Proposition):
    """A room is the nth to be visited; at each place there is one room, and each room has one place."""

    place: int
    room: Room

    def excludes(self, other: Proposition) -> bool:
        """Return True for another room at this place, and for this room at another place."""
        return isinstance(other, VisitOrder) and (self.place == other.place) != (self.room == other.room)

    def __str__(self) -> str:
        return f"order({self.place}, {_room(self.room)})"


@dataclass(frozen=True, slots=True)
class RoomSequence(Proposition):
    """Rooms are visited in this order: for each one at which place it comes.

    Attributes:
        rooms: at least two, the first one first.
    """

    rooms: tuple[Room, ...]

    @property
    def parts(self) -> tuple[Literal, ...]:
        """The place of each room; the opposite denies each of them (Sklar and Azhar 2015)."""
        return tuple(Literal(VisitOrder(place, room)) for place, room in enumerate(self.rooms, start=1))

    def __str__(self) -> str:
        return f"tour({', '.join(map(_room, self.rooms))})"


@dataclass(frozen=True, slots=True)
class EnergyLevel(Proposition):
    """The robot has so much energy left."""

    energy: float

    def excludes(self, other: Proposition) -> bool:
        """Return True for another level."""
        return isinstance(other, EnergyLevel) and self != other

    def __str__(self) -> str:
        return f"current_energy_level({energy_text(self.energy)})"


@dataclass(frozen=True, slots=True)
class EnergyCost(Proposition):
    """Going from a place to a room costs so much energy."""

    start: Room
    goal: Room
    energy: float

    def excludes(self, other: Proposition) -> bool:
        """Return True for another cost of the same way."""
        same = isinstance(other, EnergyCost) and (self.start, self.goal) == (other.start, other.goal)
        return same and self != other

    def __str__(self) -> str:
        return f"energy_cost({_room(self.start)}, {_room(self.goal)}, {energy_text(self.energy)})"


@dataclass(frozen=True, slots=True)
class CostsMore(Proposition):
    """Going from a place to a room costs more than so much energy."""

    start: Room
    goal: Room
    energy: float

    def __str__(self) -> str:
        return f"costs_more({_room(self.start)}, {_room(self.goal)}, {energy_text(self.energy)})"


@dataclass(frozen=True, slots=True)
class LessThan(Proposition):
    """A sum of energies is below another energy."""

    terms: tuple[float, ...]
    limit: float

    @property
    def is_true(self) -> bool:
        """True when the numbers say so."""
        return fsum(self.terms) < self.limit

    def __str__(self) -> str:
        return f"less_than({' + '.join(map(energy_text, self.terms))}, {energy_text(self.limit)})"


@dataclass(frozen=True, slots=True)
class ColourFound(Proposition):
    """A robot has seen a colour in a picture."""

    image: str
    colour: str

    def __str__(self) -> str:
        return f"color_found({self.image}, {self.colour})"


@dataclass(frozen=True, slots=True)
class InImage(Proposition):
    """Something is to be seen in a picture."""

    thing: str
    image: str

    def __str__(self) -> str:
        return f"in_image({self.thing}, {self.image})"


@dataclass(frozen=True, slots=True)
class TreasureIn(Proposition):
    """A treasure is in a room; another one is not."""

    name: str
    room: Room

    def excludes(self, other: Proposition) -> bool:
        """Return True for another treasure in this room."""
        return isinstance(other, TreasureIn) and self.room == other.room and self.name != other.name

    def __str__(self) -> str:
        return f"treasure_in({self.name}, {_room(self.room)})"


@dataclass(frozen=True, slots=True)
class Wanted(Proposition):
    """The speaker wants it so, without a further reason."""

    what: Literal

    @property
    def is_wish(self) -> bool:
        """True."""
        return True

    def __str__(self) -> str:
        return f"wanted({self.what})"


@dataclass(frozen=True, slots=True)
class Visited(Proposition):
    """A room has been looked into."""

    room: Room

    def __str__(self) -> str:
        return f"visited({_room(self.room)})"


@dataclass(frozen=True, slots=True)
class TooFar(Proposition):
    """A room is too far for the energy left."""

    room: Room

    def __str__(self) -> str:
        return f"too_far({_room(self.room)})"


@dataclass(frozen=True, slots=True)
class NextRoom(Proposition):
    """A robot goes to a room next; it goes to one, and no other robot goes there.

    Attributes:
        robot: index in the team, from 0.
        room: the room.
    """

    robot: int
    room: Room

    def excludes(self, other: Proposition) -> bool:
        """Return True for another room of this robot, and for this room of another robot."""
        return isinstance(other, NextRoom) and (self.robot == other.robot) != (self.room == other.room)

    def __str__(self) -> str:
        return f"next({_robot(self.robot)}, {_room(self.room)})"


@dataclass(frozen=True, slots=True)
class TeamPlan(Proposition):
    """Best that the team reaches when a robot goes to a room next: so many rooms, for so much energy in all.

    Where two are compared, each is the best that the team can do.

    Attributes:
        robot: index in the team, from 0.
        room: its next room.
        rooms: number of rooms that the team reaches.
        energy: for all moves of the team.
    """

    robot: int
    room: Room
    rooms: int
    energy: float

    def excludes(self, other: Proposition) -> bool:
        """Return True for another value of the same next room."""
        same = isinstance(other, TeamPlan) and (self.robot, self.room) == (other.robot, other.room)
        return same and self != other

    def __str__(self) -> str:
        return f"plan({_robot(self.robot)}, {_room(self.room)}, {self.rooms}, {energy_text(self.energy)})"


@dataclass(frozen=True, slots=True)
class FewerRooms(Proposition):
    """A number of rooms is below another one."""

    fewer: int
    more: int

    @property
    def is_true(self) -> bool:
        """True when the numbers say so."""
        return self.fewer < self.more

    def __str__(self) -> str:
        return f"fewer_rooms({self.fewer}, {self.more})"


@dataclass(frozen=True, slots=True)
class DearerPlan(Proposition):
    """Going to a room next instead of another one costs the team so much more energy, for as many rooms."""

    room: Room
    instead: Room
    energy: float

    def __str__(self) -> str:
        return f"dearer_plan({_room(self.room)}, {_room(self.instead)}, {energy_text(self.energy)})"


@dataclass(frozen=True, slots=True)
class ShorterPlan(Proposition):
    """Going to a room next instead of another one lets the team reach so many rooms less."""

    room: Room
    instead: Room
    rooms: int

    def __str__(self) -> str:
        return f"shorter_plan({_room(self.room)}, {_room(self.instead)}, {self.rooms})"


@dataclass(frozen=True, slots=True)
class LeftBehind(Proposition):
    """Another robot has no room to go to, and stays where it is, when this one goes to a room next.

    Attributes:
        robot: the other one, as index in the team.
        place: where it stands.
        room: this robot's next room.
    """

    robot: int
    place: Room
    room: Room

    def __str__(self) -> str:
        return f"left_behind({_robot(self.robot)}, {_room(self.place)}, {_room(self.room)})"


@dataclass(frozen=True, slots=True)
class CostOfOther(Proposition):
    """Going to a room would cost another robot so much energy, as that one says.

    Attributes:
        robot: index in the team, from 0.
        room: the room.
        energy: of its way there.
    """

    robot: int
    room: Room
    energy: float

    def excludes(self, other: Proposition) -> bool:
        """Return True for another cost of the same way."""
        same = isinstance(other, CostOfOther) and (self.robot, self.room) == (other.robot, other.room)
        return same and self != other

    def __str__(self) -> str:
        return f"energy_cost_of({_robot(self.robot)}, {_room(self.room)}, {energy_text(self.energy)})"


@dataclass(frozen=True, slots=True)
class UnderWay(Proposition):
    """Another robot is on its way to a room, or has agreed to go there.

    Attributes:
        robot: index in the team, from 0.
        room: the room.
    """

    robot: int
    room: Room

    def __str__(self) -> str:
        return f"under_way({_robot(self.robot)}, {_room(self.room)})"


@dataclass(frozen=True, slots=True)
class NoWay(Proposition):
    """The robot finds no way to a room."""

    room: Room

    def __str__(self) -> str:
        return f"no_way({_room(self.room)})"


@dataclass(frozen=True, slots=True)
class InTheWay(Proposition):
    """Something that no map shows is in the way to a room: a door that is shut, a fire."""

    room: Room

    def __str__(self) -> str:
        return f"in_the_way({_room(self.room)})"


@dataclass(frozen=True, slots=True)
class TakesPicture(Proposition):
    """The robot in a room takes a picture of the treasure there."""

    room: Room

    def __str__(self) -> str:
        return f"picture({_room(self.room)})"


@dataclass(frozen=True, slots=True)
class NamesTreasure(Proposition):
    """The treasure in a room is named now."""

    room: Room

    def __str__(self) -> str:
        return f"name({_room(self.room)})"


@dataclass(frozen=True, slots=True)
class NamesTreasureAs(Proposition):
    """The treasure in a room is named now, by this name.

    Attributes:
        room: where it is.
        name: of the treasure.
    """

    room: Room
    name: str

    def excludes(self, other: Proposition) -> bool:
        """Return True for another name of this treasure."""
        return isinstance(other, NamesTreasureAs) and self.room == other.room and self != other

    def __str__(self) -> str:
        return f"name_as({_room(self.room)}, {self.name})"


@dataclass(frozen=True, slots=True)
class PropertyFound(Proposition):
    """The treasure in a room was found to have a property.

    Attributes:
        room: where it is.
        value: of the property, as part of a sentence: `round and large`, `made of wood`.
    """

    room: Room
    value: str

    def __str__(self) -> str:
        return f"found({_room(self.room)}, {self.value})"


@dataclass(frozen=True, slots=True)
class PropertyListed(Proposition):
    """The list of treasures, which everybody knows, has it that a treasure of this name has a property.

    Attributes:
        name: of the treasure.
        value: of the property, as part of a sentence.
    """

    name: str
    value: str

    def __str__(self) -> str:
        return f"listed({self.name}, {self.value})"


@dataclass(frozen=True, slots=True)
class SeenInPicture(Proposition):
    """A person sees this treasure in the picture of the one in a room.

    Attributes:
        room: where it is.
        name: of the treasure.
    """

    room: Room
    name: str

    def excludes(self, other: Proposition) -> bool:
        """Return True for another treasure in this picture."""
        return isinstance(other, SeenInPicture) and self.room == other.room and self != other

    def __str__(self) -> str:
        return f"seen({_room(self.room)}, {self.name})"


@dataclass(frozen=True, slots=True)
class CouldBe(Proposition):
    """All that is known of the treasure in a room fits several names.

    Attributes:
        room: the room.
        names: at least two, in alphabetical order.
    """

    room: Room
    names: tuple[str, ...]

    def excludes(self, other: Proposition) -> bool:
        """Return True for other names, or a single one, of the same treasure."""
        return isinstance(other, CouldBe | Settled) and self.room == other.room and self != other

    def __str__(self) -> str:
        return f"could_be({_room(self.room)}, {' or '.join(self.names)})"


@dataclass(frozen=True, slots=True)
class Settled(Proposition):
    """All that is known of the treasure in a room fits one name only."""

    room: Room
    name: str

    def excludes(self, other: Proposition) -> bool:
        """Return True for another name, or several ones, of the same treasure."""
        return isinstance(other, CouldBe | Settled) and self.room == other.room and self != other

    def __str__(self) -> str:
        return f"settled({_room(self.room)}, {self.name})"


@dataclass(frozen=True, slots=True)
class PictureTaken(Proposition):
    """There is a picture of the treasure in a room already."""

    room: Room

    def __str__(self) -> str:
        return f"picture_taken({_room(self.room)})"


@dataclass(frozen=True, slots=True)
class PictureCost(Proposition):
    """Taking a picture costs so much energy."""

    energy: float

    def __str__(self) -> str:
        return f"picture_cost({energy_text(self.energy)})"


@dataclass(frozen=True, slots=True)
class NamingCost(Proposition):
    """Naming a treasure costs so much energy."""

    energy: float

    def __str__(self) -> str:
        return f"naming_cost({energy_text(self.energy)})"


def _room(room: Room) -> str:
    return f"Room{room.people}"


def _robot(robot: int) -> str:
    return f"Robot{number_of(robot)}"
