"""The lobby of games of several people: who plays together, in which seats, and what follows if people are missing."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from sim.parameters import param
from thbridge.hunt.seats import MOST_SEATS

LONGEST_WAIT = 4 * 3600.0


class SeatOrder(StrEnum):
    """Rule for the seat of each person of a group."""

    ARRIVAL = "arrival"
    """The person who has waited longest gets the first seat of the study, and so on."""
    RANDOM = "random"
    """The random seed of the study decides."""


class WaitRule(StrEnum):
    """Rule for people whose group is not complete at the end of their wait."""

    PAY = "pay"
    """The run ends with thanks and a completion code. It does not count, and its place becomes free."""
    FEWER = "fewer"
    """The game starts with the people who wait. The other seats stay empty."""
    PROGRAM = "program"
    """The game starts with the people who wait. Programs take the other seats."""


class LeavingRule(StrEnum):
    """Rule for the seat of a person who leaves a game, or is absent for longer than the grace period."""

    END = "end"
    """The game ends. The other people go on to their next step."""
    EMPTY = "empty"
    """The game goes on. The seat is empty until the person comes back."""
    PROGRAM = "program"
    """The game goes on. A program takes the seat until the person comes back."""


@dataclass(frozen=True, slots=True)
class LobbySection:
    """Lobby of games of several people. It has no effect on games with one participant."""

    by: str = param(
        "",
        "how groups are formed: a factor between people, or an answer of an earlier form (STEP.ITEM); if empty, by "
        "order of arrival",
    )
    quota: Mapping[str, str] = field(
        default_factory=dict,
        metadata={
            "help": "number of people of a group with each level of the factor, or with each answer: {VALUE: NUMBER}"
        },
    )
    seat_of: Mapping[str, str] = field(
        default_factory=dict,
        metadata={
            "help": "instead of quota: level or answer of the person in each seat, {SEAT: VALUE}; each person gets a "
            "seat with their value"
        },
    )
    seats: SeatOrder = param(SeatOrder.ARRIVAL, "who gets which seat, if seat_of is empty")
    same_group: bool = param(
        default=True,
        help="the people of a group play all their games together; if false, the lobby forms new groups for each game",
    )
    wait: float = param(300.0, "time for which a person waits in the lobby", "s", 5, LONGEST_WAIT)
    then: WaitRule = param(WaitRule.PAY, "what follows if the group is not complete at the end of the wait")
    least: int = param(2, "for then = fewer: smallest number of people with which a game starts", "", 1, MOST_SEATS)
    leaving: LeavingRule = param(
        LeavingRule.END,
        "what follows if a person leaves a game, or is absent from it for longer than presence.grace",
    )
    incomplete_counts: bool = param(
        default=False,
        help="a run counts even if a seat of one of its games was empty or was taken by a program; if false, the "
        "people of such a game are paid, and their places become free",
    )

    def people_of(self, value: str) -> int:
        """Return the number of people of a group with a level or answer."""
        if self.seat_of:
            return [*self.seat_of.values()].count(value)
        return int(self.quota.get(value, "0"))


def lobby_problems(lobby: LobbySection) -> Iterator[tuple[str, str, str]]:
    """Yield the key, problem and remedy of keys that contradict each other, and of bad numbers."""
    for value, number in lobby.quota.items():
        if not (number.isascii() and number.isdecimal() and 1 <= int(number) <= MOST_SEATS):
            yield f"lobby.quota.{value}", f"{number!r} is not a number of people", f"Write 1 to {MOST_SEATS}"
    written = [key for key in ("quota", "seat_of") if getattr(lobby, key)]
    if len(written) == 2:
        yield "lobby.seat_of", "quota and seat_of both say who forms a group", "Keep one of the two"
    if written and not lobby.by:
        problem = f"{written[0]} has no effect without `by`"
        yield f"lobby.{written[0]}", problem, "Write by: FACTOR or by: STEP.ITEM, or delete the key"
    if lobby.by and not written:
        problem = "the lobby does not know how many people of each kind a group needs"
        yield "lobby.by", problem, "Write quota: {VALUE: NUMBER} or seat_of: {SEAT: VALUE}"
