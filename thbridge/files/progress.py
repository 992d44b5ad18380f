"""Progress of long work on files, reported to a callback."""

from collections.abc import Callable, Iterable, Iterator
from typing import TypeAlias, TypeVar

T = TypeVar("T")

Tell: TypeAlias = Callable[[str, int, int], None]
"""Function that receives the unit, for example "messages", the number done, and the total number."""

EVERY = 2000
"""Number of items between two reports."""


def followed(things: Iterable[T], what: str, total: int, tell: Tell, every: int = EVERY) -> Iterator[T]:
    """Yield the items and report how many have been yielded, from time to time and at the end."""
    for done, thing in enumerate(things):
        if done % every == 0:
            tell(what, done, total)
        yield thing
    tell(what, total, total)


def untold(what: str, done: int, total: int) -> None:
    """Report nothing."""
