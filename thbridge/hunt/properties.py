"""Properties of treasures: what a set of treasures declares of each, and how values are said."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TypeAlias

Properties: TypeAlias = Mapping[str, str]
"""Values by the name of their property, in the order of the declaration."""


class Teller(StrEnum):
    """Side that can tell a property of a treasure."""

    ROBOT = "robot"
    PERSON = "person"


class PropertyDrawing(StrEnum):
    """Drawing beside a value: a patch of that color, an outline of that shape (round or square), or none."""

    NONE = "none"
    COLOUR = "colour"
    SHAPE = "shape"


@dataclass(frozen=True, slots=True)
class TreasureProperty:
    """Declaration of one property.

    A robot senses a property without cost when it finds the treasure, and one with a cost when it is asked to. What a
    person can tell is told from the picture.

    Attributes:
        name: in files, recordings and between the pound signs of sentences: small letters and underscores.
        label: as people read it above a value, e.g. `Weight`.
        values: all that it can be, in their order; empty: any text.
        told_by: the side that can tell it.
        sensor: of a robot, for people, e.g. `scale`; may be empty.
        cost: energy of sensing it.
        drawn: beside the value.
        said: of a treasure within a sentence, with the name between pound signs: `weighing £weight£`.
        words: of values within a sentence, in the participant's language; recordings have none.
    """

    name: str
    label: str
    values: tuple[str, ...] = ()
    told_by: Teller = Teller.ROBOT
    sensor: str = ""
    cost: float = 0.0
    drawn: PropertyDrawing = PropertyDrawing.NONE
    said: str = ""
    words: Mapping[str, str] = field(default_factory=dict, hash=False)

    @property
    def is_found(self) -> bool:
        """True when a robot senses it as it finds a treasure."""
        return self.told_by is Teller.ROBOT and self.cost == 0.0

    @property
    def is_measured(self) -> bool:
        """True when a robot senses it on request, for energy."""
        return self.told_by is Teller.ROBOT and self.cost > 0.0

    def shown(self, value: str) -> str:
        """Return a value of it as it stands by itself."""
        return self.words.get(value) or value

    def word(self, value: str) -> str:
        """Return a value of it as it is said within a sentence."""
        return self.words.get(value) or value_in_words(value)

    def phrase(self, value: str) -> str:
        """Return a value of it as part of a sentence about a treasure."""
        return self.said.replace(f"£{self.name}£", self.word(value)) if self.said else self.word(value)


OF_2016 = (
    TreasureProperty("colour", "Colour", drawn=PropertyDrawing.COLOUR),
    TreasureProperty("footprint", "Footprint", drawn=PropertyDrawing.SHAPE),
)
"""Properties in the dialect of 2016, whose files and lines have these two and declare none."""


def property_named(properties: Sequence[TreasureProperty], name: str) -> TreasureProperty | None:
    """Return the property of this name, or None."""
    return next((each for each in properties if each.name == name), None)


def value_in_words(value: str) -> str:
    """Return a value as it is said within a sentence: plain words without their capitals, `Round` but not `USB`."""
    return re.sub(r"\w\w+", lambda word: word[0].lower() if word[0].istitle() else word[0], value)


def values_in_words(properties: Sequence[TreasureProperty], known: Properties) -> str:
    """Return what is known of a treasure as people read it within a sentence: `orange, round and large`."""
    return ", ".join(each.phrase(known[each.name]) for each in properties if each.name in known)


def properties_in_words(properties: Sequence[TreasureProperty], known: Properties) -> str:
    """Return what is known of a treasure in English: `something orange, round and large`."""
    return f"something {values_in_words(properties, known)}".rstrip()


def labelled(properties: Sequence[TreasureProperty], values: Properties) -> tuple[tuple[str, str], ...]:
    """Return label and value of what a robot senses as it finds a treasure, as lines of 2016 tell it."""
    return tuple((each.label, values[each.name]) for each in properties if each.is_found and each.name in values)


def named_by_labels(properties: Sequence[TreasureProperty], senses: Sequence[tuple[str, str]]) -> Properties:
    """Return the values of a line of 2016 by the names of their properties; labels of no property are left out."""
    names = {each.label: each.name for each in properties}
    return {names[label]: value for label, value in senses if label in names}
