"""Games of groups in an experiment's log: the people of each group, their seats, and who holds the seats at present."""

import dataclasses
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from thbridge.experiment.lobby import SeatHolder
from thbridge.experiment.store.events import EventKind, JsonValue, LogEntry, LoggedEvent, NewEvent

GROUP = "G-"
"""Prefix of the ids of groups, which are also the names of the folders of their recordings."""


class BadSeat(ValueError):  # noqa: N818 - it names the fault
    """Seat in an event that does not fit the earlier events. `str()` gives the reason as a clause."""


GroupGames: TypeAlias = Mapping[tuple[str, int], "GroupGame"]
"""Games of groups, by the id of the group and the number of the step."""


@dataclass(frozen=True, slots=True)
class GroupSeat:
    """Seat of a person in the game of a step.

    Attributes:
        group: id of the group.
        seat: name of the seat.
    """

    group: str
    seat: str


@dataclass(frozen=True, slots=True)
class GroupGame:
    """Game of a group.

    Attributes:
        group: id of the group.
        step: number of the game's step in the plan of each person.
        began: holder of each seat at the start of the game, in the order of the game's seats.
        seats: present holder of each seat.
        people: id of the person of each seat that a person took at the start. People who withdrew are missing.
        incomplete: True if a seat was empty or was taken by a program at any time.
        played: data of the log about the finished game, or None before its end.
    """

    group: str
    step: int
    began: Mapping[str, SeatHolder]
    seats: Mapping[str, SeatHolder]
    people: Mapping[str, str] = dataclasses.field(default_factory=dict)
    incomplete: bool = False
    played: Mapping[str, JsonValue] | None = None

    @property
    def present(self) -> tuple[str, ...]:
        """Ids of the people who hold their seats."""
        return tuple(person for seat, person in self.people.items() if self.seats[seat] is SeatHolder.PERSON)

    @property
    def has_absent(self) -> bool:
        """True if a person who took a seat at the start does not hold it now."""
        return len(self.present) < len(self.people)


HOLDERS = {
    EventKind.SEAT_LEFT: SeatHolder.EMPTY,
    EventKind.SEAT_FILLED: SeatHolder.PROGRAM,
    EventKind.SEAT_RESUMED: SeatHolder.PERSON,
}
"""Holder of a seat after each kind of event."""


def game_after(games: GroupGames, event: NewEvent) -> GroupGame | None:
    """Return the game of a group after an event, or None if the event does not belong to a known game.

    Raises:
        BadSeat: the game has no such seat, or another person has it.
    """
    data = event.data or {}
    group, seat = str(data.get("group", "")), str(data.get("seat", ""))
    game = games.get((group, event.step))
    if event.kind == EventKind.GROUP_FORMED:
        written = data["seats"]
        seats = {name: SeatHolder(str(holder)) for name, holder in written.items()} if isinstance(written, dict) else {}
        game = game or GroupGame(group, event.step, seats, seats, incomplete=set(seats.values()) != {SeatHolder.PERSON})
        if game.began != seats or seats.get(seat) is not SeatHolder.PERSON or seat in game.people:
            raise BadSeat(f"{event.participant} takes the seat {seat} of {group}, which is not free")
        people = {**game.people, seat: event.participant}
        return dataclasses.replace(game, people={name: people[name] for name in seats if name in people})
    if game is None:
        return None
    if event.kind == EventKind.GAME_PLAYED:
        return dataclasses.replace(game, played=data)
    holder = HOLDERS[EventKind(event.kind)]
    if seat not in game.seats:
        raise BadSeat(f"{group} has no seat {seat}")
    return dataclasses.replace(game, seats={**game.seats, seat: holder}, incomplete=True)


CHANGES_GROUPS = frozenset({EventKind.GROUP_FORMED, EventKind.GAME_PLAYED, *HOLDERS})
"""Kinds of events that `game_after` processes."""


def withdrawn_groups(entries: Iterable[LogEntry]) -> frozenset[str]:
    """Return the ids of groups with a person who withdrew. Their recordings must not be kept."""
    missing = Counter[tuple[str, int]]()
    for entry in entries:
        if isinstance(entry, LoggedEvent) and entry.event.kind == EventKind.GROUP_FORMED:
            data = entry.event.data or {}
            game, seats = (str(data["group"]), entry.event.step), data["seats"]
            if game not in missing:
                missing[game] = [*seats.values()].count(SeatHolder.PERSON) if isinstance(seats, dict) else 0
            missing[game] -= 1
    return frozenset(group for (group, _), number in missing.items() if number > 0)


def kept_groups(entries: Sequence[LogEntry]) -> frozenset[str]:
    """Return the ids of groups without a person who withdrew."""
    events = (entry.event for entry in entries if isinstance(entry, LoggedEvent))
    groups = {str((event.data or {})["group"]) for event in events if event.kind == EventKind.GROUP_FORMED}
    return frozenset(groups) - withdrawn_groups(entries)
