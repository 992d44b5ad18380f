"""Predicates: propositions as wordings know them, by name, each with the reserved words for its values."""

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
    """Kind of a value, by which a language says it."""

    ROOM = "room"
    """`£room£`, and with a preposition `£to_room£`, `£from_room£`, `£in_room£`."""
    ROBOT = "robot"
    ENERGY = "energy"
    SUM = "sum"
    """Energies that are added up."""
    ROOMS = "rooms"
    """Rooms that are counted."""
    STOPS = "stops"
    """Rooms in the order in which they are visited."""
    NUMBER = "number"
    PICTURE = "picture"
    NAME = "name"
    """Of a treasure, a thing or a colour."""
    NAMES = "names"
    """Names of which one is right."""
    CLAUSE = "clause"
    """Something that holds or does not."""
    CLAUSES = "clauses"
    """Several of them, all at once."""
    ALTERNATIVES = "alternatives"
    """Several of them, of which one is enough."""


PREPOSITIONS = ("to", "from", "in")
"""Prepositions with which rooms may be said, as the first part of a reserved word."""


@dataclass(frozen=True, slots=True)
class Predicate:
    """Predicate of a class of propositions.

    Attributes:
        name: as propositions are written: `next`.
        proposition: the class.
        values: kind of each of its fields.
    """

    name: str
    proposition: type[Proposition]
    values: Mapping[str, ValueKind]

    @property
    def robot(self) -> str | None:
        """Name of the field that tells the robot it is about; None without one."""
        return next((name for name, kind in self.values.items() if kind is ValueKind.ROBOT), None)


def reserved_words(values: Mapping[str, ValueKind]) -> dict[str, str]:
    """Return the reserved words for values, each with the name of the value that it says."""
    words = {name: name for name in values}
    for name, kind in values.items():
        if kind is ValueKind.ROOM:
            words |= {f"{preposition}_{name}": name for preposition in PREPOSITIONS}
    return words


_ROOM = {"room": ValueKind.ROOM}
_ROBOT_TO_ROOM = {"robot": ValueKind.ROBOT, **_ROOM}
_ENERGY = {"energy": ValueKind.ENERGY}

PREDICATES: Mapping[str, Predicate] = {
    name: Predicate(name, proposition, values)
    for name, proposition, values in (
        ("selected", Selected, _ROOM),
        ("order", VisitOrder, {"place": ValueKind.NUMBER, **_ROOM}),
        ("tour", RoomSequence, {"rooms": ValueKind.STOPS}),
        ("current_energy_level", EnergyLevel, _ENERGY),
        ("energy_cost", EnergyCost, {"start": ValueKind.ROOM, "goal": ValueKind.ROOM, **_ENERGY}),
        ("costs_more", CostsMore, {"start": ValueKind.ROOM, "goal": ValueKind.ROOM, **_ENERGY}),
        ("color_found", ColourFound, {"image": ValueKind.PICTURE, "colour": ValueKind.NAME}),
        ("in_image", InImage, {"thing": ValueKind.NAME, "image": ValueKind.PICTURE}),
        ("treasure_in", TreasureIn, {"name": ValueKind.NAME, **_ROOM}),
        ("wanted", Wanted, {"what": ValueKind.CLAUSE}),
        ("visited", Visited, _ROOM),
        ("too_far", TooFar, _ROOM),
        ("next", NextRoom, _ROBOT_TO_ROOM),
        ("plan", TeamPlan, {**_ROBOT_TO_ROOM, "rooms": ValueKind.ROOMS, **_ENERGY}),
        ("dearer_plan", DearerPlan, {**_ROOM, "instead": ValueKind.ROOM, **_ENERGY}),
        ("shorter_plan", ShorterPlan, {**_ROOM, "instead": ValueKind.ROOM, "rooms": ValueKind.ROOMS}),
        ("left_behind", LeftBehind, {"robot": ValueKind.ROBOT, "place": ValueKind.ROOM, **_ROOM}),
        ("energy_cost_of", CostOfOther, {**_ROBOT_TO_ROOM, **_ENERGY}),
        ("under_way", UnderWay, _ROBOT_TO_ROOM),
        ("no_way", NoWay, _ROOM),
        ("in_the_way", InTheWay, _ROOM),
        ("picture", TakesPicture, _ROOM),
        ("name", NamesTreasure, _ROOM),
        ("name_as", NamesTreasureAs, {**_ROOM, "name": ValueKind.NAME}),
        ("found", PropertyFound, {**_ROOM, "value": ValueKind.NAME}),
        ("listed", PropertyListed, {"name": ValueKind.NAME, "value": ValueKind.NAME}),
        ("seen", SeenInPicture, {**_ROOM, "name": ValueKind.NAME}),
        ("could_be", CouldBe, {**_ROOM, "names": ValueKind.NAMES}),
        ("settled", Settled, {**_ROOM, "name": ValueKind.NAME}),
        ("picture_taken", PictureTaken, _ROOM),
        ("picture_cost", PictureCost, _ENERGY),
        ("naming_cost", NamingCost, _ENERGY),
        ("less_than", LessThan, {"terms": ValueKind.SUM, "limit": ValueKind.ENERGY}),
        ("fewer_rooms", FewerRooms, {"fewer": ValueKind.ROOMS, "more": ValueKind.ROOMS}),
    )
}
"""Predicates by name: one for each class of propositions of the hunt, in the order in which reasons are said."""

_OF_CLASS = {predicate.proposition: predicate for predicate in PREDICATES.values()}


def predicate_of(proposition: Proposition) -> Predicate | None:
    """Return the predicate of a proposition; None for a conjunction, which has those of its parts."""
    return _OF_CLASS.get(type(proposition))
