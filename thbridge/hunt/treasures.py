"""Kinds of treasures, and the random choice of a treasure for each room."""

import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass

from thbridge.hunt.properties import Properties


@dataclass(frozen=True, slots=True)
class TreasureKind:
    """A kind of treasure in a file of treasures.

    Attributes:
        properties: the value of each declared property.
        points: points for the right name, 0 or more.
        name: the right name.
        image: file name of the picture, without a directory. None in the participant's copy of the file.
    """

    properties: Properties
    points: int
    name: str
    image: str | None = None


def hide(kinds: Sequence[TreasureKind], uniforms: Sequence[float]) -> tuple[TreasureKind, ...]:
    """Return a random treasure for each room. All kinds are equally likely, and rooms are independent.

    Args:
        kinds: at least one kind of treasure.
        uniforms: one number in [0, 1) per room, in the order of the rooms. The same numbers give the same treasures.

    Returns:
        One kind per room, in the order of the rooms. A kind may occur several times or not at all.

    Raises:
        ValueError: there are no kinds, or a number is outside [0, 1).
    """
    if not kinds:
        raise ValueError("there are no treasures")
    if not all(0.0 <= uniform < 1.0 for uniform in uniforms):
        raise ValueError("the random numbers must be in [0, 1)")
    return tuple(kinds[int(uniform * len(kinds))] for uniform in uniforms)


def same_name(left: str, right: str) -> bool:
    """Return True if two names of treasures are equal. Case and the number of spaces do not matter.

    Letters with diacritics may be one character or two characters (NFC, NFD).
    """
    if left == right:
        return True
    left, right = (unicodedata.normalize("NFC", name).casefold() for name in (left, right))
    return left.split() == right.split()


def name_in_words(name: str) -> str:
    """Return a treasure's name as words for people. For example, `beer_bottle` becomes `beer bottle`."""
    return " ".join(name.replace("_", " ").split())
