"""Treasures: their kinds, and hiding them in rooms."""

import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass

from thbridge.hunt.properties import Properties


@dataclass(frozen=True, slots=True)
class TreasureKind:
    """One kind of treasure in a file of treasures.

    Attributes:
        properties: the value of each property that its set declares.
        points: points for naming it correctly, never negative.
        name: name by which people identify it.
        image: file name of its picture without a directory; None in the participant's copy.
    """

    properties: Properties
    points: int
    name: str
    image: str | None = None


def hide(kinds: Sequence[TreasureKind], uniforms: Sequence[float]) -> tuple[TreasureKind, ...]:
    """Hide one treasure in each room. All kinds are equally likely, and rooms are independent of each other.

    Args:
        kinds: the kinds, at least one.
        uniforms: one number in [0, 1) per room, room 1 first. The same numbers give the same treasures.

    Returns:
        One kind per room, room 1 first. A kind may occur more than once or not at all.

    Raises:
        ValueError: no kinds, or a number outside [0, 1).
    """
    if not kinds:
        raise ValueError("there is no kind of treasure to hide")
    if not all(0.0 <= uniform < 1.0 for uniform in uniforms):
        raise ValueError("hiding needs numbers in [0, 1)")
    return tuple(kinds[int(uniform * len(kinds))] for uniform in uniforms)


def same_name(left: str, right: str) -> bool:
    """Return True for equal names of treasures; case, and the number of spaces around or between words, are ignored.

    Letters with marks are equal whether they are one character or two (NFC, NFD).
    """
    if left == right:
        return True
    left, right = (unicodedata.normalize("NFC", name).casefold() for name in (left, right))
    return left.split() == right.split()


def name_in_words(name: str) -> str:
    """Return a treasure's name in words for people: `beer_bottle` becomes `beer bottle`."""
    return " ".join(name.replace("_", " ").split())
