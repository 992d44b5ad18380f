"""Matching of people for games of several: who plays together. It knows no sockets; times are arguments."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol

LONGEST_WAIT = 1800.0
"""Seconds after which a person need not wait for others any longer."""


@dataclass(frozen=True, slots=True)
class MatchedGame:
    """Game of several people.

    Attributes:
        key: key of the game.
        people: key of the person in each seat, by the seat's name.
    """

    key: str
    people: Mapping[str, str]

    def seat_of(self, person: str) -> str:
        """Return the seat of a person."""
        return next(seat for seat, each in self.people.items() if each == person)


@dataclass(frozen=True, slots=True)
class Matches:
    """Changes among people who wait.

    Attributes:
        games: games that start.
        ended: people whose wait ends without a game.
    """

    games: tuple[MatchedGame, ...] = ()
    ended: tuple[str, ...] = ()


class Matching(Protocol):
    """People who wait, and the rule of who plays together. All times are in seconds of the same clock."""

    def enter(self, person: str, now: float) -> None:
        """Let a person wait behind all others."""

    def leave(self, person: str) -> None:
        """Stop waiting; this has no effect on a person who does not wait."""

    def update(self, now: float, most: int) -> Matches:
        """Return the games that start now, at most this number, and the waits that end now."""


class MatchByArrival:
    """Matching that fills all seats of a game by order of arrival; see `Matching`.

    Args:
        seats: names of the seats, in the order in which they are filled.
        new_key: function that returns the key of another game.
        longest: seconds after which a person need not wait any longer.
    """

    def __init__(self, seats: tuple[str, ...], new_key: Callable[[], str], longest: float = LONGEST_WAIT) -> None:
        self._seats = seats
        self._new_key = new_key
        self._longest = longest
        self._since: dict[str, float] = {}

    def enter(self, person: str, now: float) -> None:
        """See `Matching`."""
        self._since[person] = now

    def leave(self, person: str) -> None:
        """See `Matching`."""
        self._since.pop(person, None)

    def update(self, now: float, most: int) -> Matches:
        """See `Matching`."""
        games: list[MatchedGame] = []
        while len(games) < most and len(self._since) >= len(self._seats) > 0:
            people = dict(zip(self._seats, [*self._since], strict=False))
            games.append(MatchedGame(self._new_key(), people))
            for person in people.values():
                del self._since[person]
        ended = tuple(person for person, since in self._since.items() if now - since > self._longest)
        for person in ended:
            del self._since[person]
        return Matches(tuple(games), ended)
