"""Predicates: propositions by name, as in wordings, each with the reserved words for its values."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

from thbridge.dialogue.argumentation.propositions import Proposition
from thbridge.dialogue.propositions import (
    ColourFound,
    CostOfOther,
    CostsMore,
    CouldBe,
    DearerPlan,
    EnergyCost,
    EnergyLevel,
    FewerRooms,
    InImage,
    InTheWay,
    LeftBehind,
    LessThan,
    NamesTreasure,
    NamesTreasureAs,
    NamingCost,
    NextRoom,
    NoWay,
    PictureCost,
    PictureTaken,
    PropertyFound,
    PropertyListed,
    RoomSequence,
    SeenInPicture,
    Selected,
    Settled,
    ShorterPlan,
    TakesPicture,
    TeamPlan,
    TooFar,
    TreasureIn,
    UnderWay,
    Visited,
    VisitOrder,
    Wanted,
)


class ValueKind(StrEnum):
    """Kind of a value; a language has a form for each kind."""

    ROOM = "room"
    """`£room£`, and with a preposition `£to_room£`, `£from_room£`, `£in_room£`."""
    ROBOT = "robot"
    ENERGY = "energy"
    SUM = "sum"
    """A sum of energies."""
    ROOMS = "rooms"
    """A number of rooms."""
    STOPS = "stops"
    """Rooms in the order of their visits."""
    NUMBER = "number"
    PICTURE = "picture"
    NAME = "name"
    """Name of a treasure, a thing or a color."""
    NAMES = "names"
    """Several names; one of them is right."""
    CLAUSE = "clause"
    """A literal."""
    CLAUSES = "clauses"
    """Several literals that all hold."""
    ALTERNATIVES = "alternatives"
    """Several literals; one of them is enough."""


PREPOSITIONS = ("to", "from", "in")
"""Prepositions of rooms, as the first part of a reserved word."""


@dataclass(frozen=True, slots=True)
class Predicate:
    """Predicate of a class of propositions.

    Attributes:
        name: name as in written propositions: `next`.
        proposition: the class.
        values: kind of each of its fields.
    """

    name: str
    proposition: type[Proposition]
    values: Mapping[str, ValueKind]

    @property
    def robot(self) -> str | None:
        """Name of the field with the robot that the proposition is about, or None."""
        return next((name for name, kind in self.values.items() if kind is ValueKind.ROBOT), None)


def reserved_words(values: Mapping[str, ValueKind]) -> dict[str, str]:
    """Return the reserved words for values, each with the name of its value."""
    words = {name: name for name in values}
    for name, kind in values.items():
        if kind is ValueKind.ROOM:
            words |= {f"{preposition}_{name}": name for preposition in PREPOSITIONS}
    return words


_ROOM = {"room": ValueKind.ROOM}
_ROBOT_TO_ROOM = {"robot": ValueKind.ROBOT, **_ROOM}
_ENERGY = {"energy": ValueKind.ENERGY}

PREDICATES: Mapping[str, Predicate] = {
    proposition.predicate: Predicate(proposition.predicate, proposition, values)
    for proposition, values in (
        (Selected, _ROOM),
        (VisitOrder, {"place": ValueKind.NUMBER, **_ROOM}),
        (RoomSequence, {"rooms": ValueKind.STOPS}),
        (EnergyLevel, _ENERGY),
        (EnergyCost, {"start": ValueKind.ROOM, "goal": ValueKind.ROOM, **_ENERGY}),
        (CostsMore, {"start": ValueKind.ROOM, "goal": ValueKind.ROOM, **_ENERGY}),
        (ColourFound, {"image": ValueKind.PICTURE, "colour": ValueKind.NAME}),
        (InImage, {"thing": ValueKind.NAME, "image": ValueKind.PICTURE}),
        (TreasureIn, {"name": ValueKind.NAME, **_ROOM}),
        (Wanted, {"what": ValueKind.CLAUSE}),
        (Visited, _ROOM),
        (TooFar, _ROOM),
        (NextRoom, _ROBOT_TO_ROOM),
        (TeamPlan, {**_ROBOT_TO_ROOM, "rooms": ValueKind.ROOMS, **_ENERGY}),
        (DearerPlan, {**_ROOM, "instead": ValueKind.ROOM, **_ENERGY}),
        (ShorterPlan, {**_ROOM, "instead": ValueKind.ROOM, "rooms": ValueKind.ROOMS}),
        (LeftBehind, {"robot": ValueKind.ROBOT, "place": ValueKind.ROOM, **_ROOM}),
        (CostOfOther, {**_ROBOT_TO_ROOM, **_ENERGY}),
        (UnderWay, _ROBOT_TO_ROOM),
        (NoWay, _ROOM),
        (InTheWay, _ROOM),
        (TakesPicture, _ROOM),
        (NamesTreasure, _ROOM),
        (NamesTreasureAs, {**_ROOM, "name": ValueKind.NAME}),
        (PropertyFound, {**_ROOM, "value": ValueKind.NAME}),
        (PropertyListed, {"name": ValueKind.NAME, "value": ValueKind.NAME}),
        (SeenInPicture, {**_ROOM, "name": ValueKind.NAME}),
        (CouldBe, {**_ROOM, "names": ValueKind.NAMES}),
        (Settled, {**_ROOM, "name": ValueKind.NAME}),
        (PictureTaken, _ROOM),
        (PictureCost, _ENERGY),
        (NamingCost, _ENERGY),
        (LessThan, {"terms": ValueKind.SUM, "limit": ValueKind.ENERGY}),
        (FewerRooms, {"fewer": ValueKind.ROOMS, "more": ValueKind.ROOMS}),
    )
}
"""Predicates by name: one for each class of propositions of the hunt, in the order of reasons in a sentence."""

_OF_CLASS = {predicate.proposition: predicate for predicate in PREDICATES.values()}


def predicate_of(proposition: Proposition) -> Predicate | None:
    """Return the predicate of a proposition; None for a conjunction, whose parts have predicates."""
    return _OF_CLASS.get(type(proposition))
