"""Progress of long work on files, told to whoever shows it."""

from collections.abc import Callable, Iterable, Iterator
from typing import TypeAlias, TypeVar

T = TypeVar("T")

Tell: TypeAlias = Callable[[str, int, int], None]
"""Takes what is counted, for example "messages", how many are done, and of how many."""

EVERY = 2000
"""Number of things from one time that it is told to the next."""


def followed(things: Iterable[T], what: str, total: int, tell: Tell, every: int = EVERY) -> Iterator[T]:
    """Yield the things, telling now and then how many they were, and at the end."""
    for done, thing in enumerate(things):
        if done % every == 0:
            tell(what, done, total)
        yield thing
    tell(what, total, total)


def untold(what: str, done: int, total: int) -> None:
    """Tell nobody."""
