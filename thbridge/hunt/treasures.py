"""Treasures: their kinds, and hiding them in rooms."""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class TreasureKind:
    """One line of a treasures file.

    Attributes:
        colour: as a robot senses it, e.g. `Orange`.
        footprint: as a robot senses it, e.g. `Round and Large`.
        points: won by naming it rightly, never negative.
        name: by which people identify it.
        image: file name of its picture without a directory; None in the participant's copy.
    """

    colour: str
    footprint: str
    points: int
    name: str
    image: str | None = None


def hide(kinds: Sequence[TreasureKind], uniforms: Sequence[float]) -> tuple[TreasureKind, ...]:
    """Hide one treasure in each room; all kinds are equally likely, rooms independent of each other.

    Args:
        kinds: at least one.
        uniforms: one number in [0, 1) per room, room 1 first. Same numbers, same treasures.

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
    """Return True for two equal names of treasures: case and blanks around or between words do not count."""
    return left.casefold().split() == right.casefold().split()


def name_in_words(name: str) -> str:
    """Return a treasure's name as people read it: `beer_bottle` of a file is `beer bottle`."""
    return " ".join(name.replace("_", " ").split())


def sensed_in_words(colour: str, footprint: str) -> str:
    """Return what a robot senses as people read it within a sentence: `orange, round and large`."""
    return f"{colour.lower()}, {footprint.lower()}"
