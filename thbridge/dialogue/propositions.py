"""Propositions of the hunt: what robots and people may believe, and argue about; written as in Sklar and Azhar 2015."""

from dataclasses import dataclass

from thbridge.argumentation.propositions import Literal, Proposition
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
class LessThan(Proposition):
    """A sum of energies is below another energy."""

    terms: tuple[float, ...]
    limit: float

    @property
    def is_true(self) -> bool:
        """True when the numbers say so."""
        return sum(self.terms) < self.limit

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


def _room(room: Room) -> str:
    return f"Room{room.people}"
