"""Properties of treasures: their declarations in a set of treasures, and words for their values."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TypeAlias

Properties: TypeAlias = Mapping[str, str]
"""Values of properties, by the property's name, in the order of the declarations."""


class Teller(StrEnum):
    """Side that can report a property of a treasure."""

    ROBOT = "robot"
    PERSON = "person"


class PropertyDrawing(StrEnum):
    """Drawing next to a value: none, a patch in this color, or an outline in this shape (round or square)."""

    NONE = "none"
    COLOUR = "colour"
    SHAPE = "shape"


@dataclass(frozen=True, slots=True)
class TreasureProperty:
    """Declaration of a property.

    When a robot finds a treasure, it senses all properties that cost nothing. On request, it senses a property that
    costs energy. A person who sees the picture reports the other properties.

    Attributes:
        name: name in files, in recordings, and between the pound signs of sentences. It has lower-case letters and
            underscores.
        label: heading of the value, such as `Weight`.
        values: all possible values, in order. If empty, any text is possible.
        told_by: the side that can report the property.
        sensor: name of the robot's sensor for people, such as `scale`. It may be empty.
        cost: energy for sensing the property.
        drawn: drawing next to the value.
        said: phrase about a treasure in a sentence, with the property's name between pound signs, such as
            `weighing £weight£`.
        words: words for the values in a sentence, in the participant's language. They are not in recordings.
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
        """True if a robot senses the property when it finds a treasure."""
        return self.told_by is Teller.ROBOT and self.cost == 0.0

    @property
    def is_measured(self) -> bool:
        """True if a robot senses the property on request. This costs energy."""
        return self.told_by is Teller.ROBOT and self.cost > 0.0

    def shown(self, value: str) -> str:
        """Return the text of a value outside of sentences."""
        return self.words.get(value) or value

    def word(self, value: str) -> str:
        """Return the word for a value in a sentence."""
        return self.words.get(value) or value_in_words(value)

    def phrase(self, value: str) -> str:
        """Return the phrase for a value in a sentence about a treasure."""
        return self.said.replace(f"£{self.name}£", self.word(value)) if self.said else self.word(value)


OF_2016 = (
    TreasureProperty("colour", "Colour", drawn=PropertyDrawing.COLOUR),
    TreasureProperty("footprint", "Footprint", drawn=PropertyDrawing.SHAPE),
)
"""The two properties of treasures in 2016. The files and lines of 2016 do not declare properties."""


def property_named(properties: Sequence[TreasureProperty], name: str) -> TreasureProperty | None:
    """Return the property with this name, or None."""
    return next((each for each in properties if each.name == name), None)


def value_in_words(value: str) -> str:
    """Return a value for a sentence: `Round` becomes `round`, but `USB` does not change."""
    return re.sub(r"\w\w+", lambda word: word[0].lower() if word[0].istitle() else word[0], value)


def values_in_words(properties: Sequence[TreasureProperty], known: Properties) -> str:
    """Return the known properties of a treasure for a sentence: `orange, round, large`."""
    return ", ".join(each.phrase(known[each.name]) for each in properties if each.name in known)


def properties_in_words(properties: Sequence[TreasureProperty], known: Properties) -> str:
    """Return an English phrase with the known properties of a treasure: `something orange, round, large`."""
    return f"something {values_in_words(properties, known)}".rstrip()


def labelled(properties: Sequence[TreasureProperty], values: Properties) -> tuple[tuple[str, str], ...]:
    """Return the label and value of each property that a robot senses when it finds a treasure, as in lines of 2016."""
    return tuple((each.label, values[each.name]) for each in properties if each.is_found and each.name in values)


def named_by_labels(properties: Sequence[TreasureProperty], senses: Sequence[tuple[str, str]]) -> Properties:
    """Return the values in a line of 2016 by the names of their properties. Ignore unknown labels."""
    names = {each.label: each.name for each in properties}
    return {names[label]: value for label, value in senses if label in names}
