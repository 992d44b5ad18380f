"""Rules of which people in a lobby play together. They know no sockets, clocks or games."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

LONGEST_WAIT = 1800.0
"""Seconds after which a person need not wait for others any longer."""


@dataclass(frozen=True, slots=True)
class WaitingPerson:
    """Person who waits in a lobby.

    Attributes:
        person: key of the person.
        since: time since which they wait, seconds of any clock.
    """

    person: str
    since: float


class MatchingRule(Protocol):
    """Rule of which people play together."""

    def next_game(self, waiting: Sequence[WaitingPerson], now: float) -> Mapping[str, str] | None:
        """Return the people of a game that can start now, by their seats; None if no game can start.

        Args:
            waiting: people who wait and whose browsers are connected, in the order of their arrival.
            now: present time, on the clock of `WaitingPerson.since`.
        """

    def ends_wait(self, person: WaitingPerson, now: float) -> bool:
        """Return True if a person has waited so long that they need not wait any longer."""


@dataclass(frozen=True, slots=True)
class MatchByArrival:
    """Rule that fills all seats of a game by order of arrival; see `MatchingRule`.

    Attributes:
        seats: names of the seats, in the order in which they are filled.
        longest: seconds after which a person need not wait any longer.
    """

    seats: tuple[str, ...]
    longest: float = LONGEST_WAIT

    def next_game(self, waiting: Sequence[WaitingPerson], now: float) -> Mapping[str, str] | None:
        """See `MatchingRule`."""
        if len(waiting) < len(self.seats):
            return None
        return {seat: each.person for seat, each in zip(self.seats, waiting, strict=False)}

    def ends_wait(self, person: WaitingPerson, now: float) -> bool:
        """See `MatchingRule`."""
        return now - person.since > self.longest
