"""Treasures: the kinds there are, and which lies in which room."""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class TreasureKind:
    """One line of a treasures file.

    Attributes:
        colour: what a robot senses of it, e.g. `Orange`.
        footprint: the other thing a robot senses, e.g. `Round and Large`.
        points: won by naming it rightly, never negative.
        name: what it is; people identify it by this.
        image: file name of its picture without a directory; None in the participant's copy.
    """

    colour: str
    footprint: str
    points: int
    name: str
    image: str | None = None


def hide(kinds: Sequence[TreasureKind], uniforms: Sequence[float]) -> tuple[TreasureKind, ...]:
    """Lay one treasure into each room, every kind equally likely, rooms independent of each other.

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
    """Whether two names of treasures are the same to people: case and blanks around or between words do not count."""
    return left.casefold().split() == right.casefold().split()
