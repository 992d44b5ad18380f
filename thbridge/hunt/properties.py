"""Properties of treasures: their declaration in a set of treasures, and the words for their values."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TypeAlias

Properties: TypeAlias = Mapping[str, str]
"""Values by the name of their property, in the order of the declaration."""


class Teller(StrEnum):
    """Side that can report a property of a treasure."""

    ROBOT = "robot"
    PERSON = "person"


class PropertyDrawing(StrEnum):
    """Drawing next to a value: a patch of that color, an outline of that shape (round or square), or none."""

    NONE = "none"
    COLOUR = "colour"
    SHAPE = "shape"


@dataclass(frozen=True, slots=True)
class TreasureProperty:
    """Declaration of one property.

    A robot senses a property without cost when it finds the treasure, and a property with a cost on request. A person
    reports a property from the picture.

    Attributes:
        name: name in files, recordings and between the pound signs of sentences: lower-case letters and underscores.
        label: heading above a value, e.g. `Weight`.
        values: all possible values, in their order; if empty, any text.
        told_by: the side that can report it.
        sensor: name of the robot's sensor, for people, e.g. `scale`; may be empty.
        cost: energy of sensing it.
        drawn: drawing next to the value.
        said: phrase about a treasure within a sentence, with the name between pound signs: `weighing £weight£`.
        words: words for the values within a sentence, in the participant's language; not in recordings.
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
        """True if a robot senses it when it finds a treasure."""
        return self.told_by is Teller.ROBOT and self.cost == 0.0

    @property
    def is_measured(self) -> bool:
        """True if a robot senses it on request, which costs energy."""
        return self.told_by is Teller.ROBOT and self.cost > 0.0

    def shown(self, value: str) -> str:
        """Return a value of it for display by itself."""
        return self.words.get(value) or value

    def word(self, value: str) -> str:
        """Return the word for a value of it within a sentence."""
        return self.words.get(value) or value_in_words(value)

    def phrase(self, value: str) -> str:
        """Return the phrase for a value of it in a sentence about a treasure."""
        return self.said.replace(f"£{self.name}£", self.word(value)) if self.said else self.word(value)


OF_2016 = (
    TreasureProperty("colour", "Colour", drawn=PropertyDrawing.COLOUR),
    TreasureProperty("footprint", "Footprint", drawn=PropertyDrawing.SHAPE),
)
"""Properties of 2016, for files and lines of 2016, which have these two and do not declare them."""


def property_named(properties: Sequence[TreasureProperty], name: str) -> TreasureProperty | None:
    """Return the property of this name, or None."""
    return next((each for each in properties if each.name == name), None)


def value_in_words(value: str) -> str:
    """Return a value for use within a sentence: plain words without their capitals, `Round` but not `USB`."""
    return re.sub(r"\w\w+", lambda word: word[0].lower() if word[0].istitle() else word[0], value)


def values_in_words(properties: Sequence[TreasureProperty], known: Properties) -> str:
    """Return the known properties of a treasure for use within a sentence: `orange, round and large`."""
    return ", ".join(each.phrase(known[each.name]) for each in properties if each.name in known)


def properties_in_words(properties: Sequence[TreasureProperty], known: Properties) -> str:
    """Return the known properties of a treasure in English: `something orange, round and large`."""
    return f"something {values_in_words(properties, known)}".rstrip()


def labelled(properties: Sequence[TreasureProperty], values: Properties) -> tuple[tuple[str, str], ...]:
    """Return label and value of each property that a robot senses when it finds a treasure, as in lines of 2016."""
    return tuple((each.label, values[each.name]) for each in properties if each.is_found and each.name in values)


def named_by_labels(properties: Sequence[TreasureProperty], senses: Sequence[tuple[str, str]]) -> Properties:
    """Return the values in a line of 2016 by the names of their properties; unknown labels are left out."""
    names = {each.label: each.name for each in properties}
    return {names[label]: value for label, value in senses if label in names}
