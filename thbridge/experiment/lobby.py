"""Matching of people for games of several people.

The lobby is a value, and time is an argument, so equal visits always give equal groups. People wait in pools. All
people of a pool may play the same game. Within a pool, the person who has waited longest is placed first.
"""

import dataclasses
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TypeAlias

from sim.numerics import noise
from thbridge.experiment.design.lobby import WaitRule


class SeatHolder(StrEnum):
    """Holder of a seat in a game of several people."""

    PERSON = "person"
    PROGRAM = "program"
    """A simulated participant."""
    EMPTY = "empty"


@dataclass(frozen=True, slots=True)
class PoolRule:
    """Rule of a pool.

    Attributes:
        seats: names of the seats of the game.
        wait: time for which a person waits, s.
        then: rule for the end of the wait.
        least: smallest number of people for `WaitRule.FEWER`.
        quota: number of people of a group with each value. If empty, the values of people do not matter.
        seat_of: value of the person in each seat, by its name. If empty, every person may have every seat.
        random_seed: seed for seats at random. If None, people get the seats in the order of their arrival.
        fixed: for people who already are a group: the seat of each of them, by their ids.
        others: holders of the seats that people cannot have.
        is_skipped: True if the game cannot be played. Then people go on to their next step.
    """

    seats: tuple[str, ...]
    wait: float = 300.0
    then: WaitRule = WaitRule.PAY
    least: int = 2
    quota: Mapping[str, int] = field(default_factory=dict)
    seat_of: Mapping[str, str] = field(default_factory=dict)
    random_seed: int | None = None
    fixed: Mapping[str, str] = field(default_factory=dict)
    others: Mapping[str, SeatHolder] = field(default_factory=dict)
    is_skipped: bool = False

    def needs(self) -> Counter[str]:
        """Return the number of people that a group needs, by their value; see `kind_of`."""
        if self.fixed:
            return Counter(self.fixed.keys())
        if self.seat_of:
            return Counter(self.seat_of.values())
        return Counter(self.quota) if self.quota else Counter({"": len(self.seats) - len(self.others)})

    def kind_of(self, person: "WaitingPerson") -> str:
        """Return the key of a person in `needs`: the id in a known group, otherwise the value if it matters."""
        if self.fixed:
            return person.participant
        return person.value if self.seat_of or self.quota else ""


@dataclass(frozen=True, slots=True)
class WaitingPerson:
    """A person in the lobby.

    Attributes:
        participant: id of the person.
        pool: name of the pool.
        since: time at which the person entered the lobby, s.
        value: level or answer by which groups are formed; empty if it does not matter.
    """

    participant: str
    pool: str
    since: float
    value: str = ""


@dataclass(frozen=True, slots=True)
class FormedGroup:
    """A group whose game can start.

    Attributes:
        pool: name of the pool.
        seats: holder of each seat, in the order of the game's seats.
        people: id of the person in each seat with a person.
        waited: time for which each person has waited, s, by their ids.
    """

    pool: str
    seats: Mapping[str, SeatHolder]
    people: Mapping[str, str]
    waited: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class WaitEnded:
    """End of a person's wait without a game.

    Attributes:
        participant: id of the person.
        waited: time for which the person has waited, s.
        is_skipped: True if the person goes on to the next step. Otherwise, the person's run ends.
    """

    participant: str
    waited: float
    is_skipped: bool = False


LobbyOutcome: TypeAlias = FormedGroup | WaitEnded


@dataclass(frozen=True, slots=True)
class Lobby:
    """People who wait for a game of several people.

    Attributes:
        waiting: the people, in the order of their arrival.
        rules: rule of each pool.
        formed: number of groups formed so far. It determines the seats at random.
    """

    waiting: tuple[WaitingPerson, ...] = ()
    rules: Mapping[str, PoolRule] = field(default_factory=dict)
    formed: int = 0

    def enter(self, person: WaitingPerson, rule: PoolRule) -> "Lobby":
        """Return the lobby after a person has entered. A person who already waits keeps their turn."""
        rules = {**self.rules, person.pool: rule}
        if any(each.participant == person.participant for each in self.waiting):
            return dataclasses.replace(self, rules=rules)
        return dataclasses.replace(self, waiting=(*self.waiting, person), rules=rules)

    def leave(self, participant: str) -> "Lobby":
        """Return the lobby after a person has left."""
        return self._without({participant})

    def changed(self, pool: str, rule: PoolRule) -> "Lobby":
        """Return the lobby with another rule of a pool."""
        return dataclasses.replace(self, rules={**self.rules, pool: rule})

    @property
    def next_end(self) -> float | None:
        """Time at which the next wait ends, s, or None if no person waits."""
        return min((each.since + self.rules[each.pool].wait for each in self.waiting), default=None)

    def matched(self, now: float, most: int | None = None) -> tuple["Lobby", tuple[LobbyOutcome, ...]]:
        """Return the lobby after all present matches, and these matches: complete groups, and waits that end.

        Args:
            now: time, s.
            most: greatest number of groups. The people of further groups go on waiting. If None, there is no limit.
        """
        lobby, found = self, list[LobbyOutcome]()
        for pool in dict.fromkeys(each.pool for each in self.waiting):
            while outcomes := lobby._next_of(pool, now):
                groups = sum(isinstance(outcome, FormedGroup) for outcome in outcomes)
                if most is not None and lobby.formed + groups - self.formed > most:
                    break
                found += outcomes
                done = {each for outcome in outcomes for each in _people_of(outcome)}
                lobby = dataclasses.replace(lobby._without(done), formed=lobby.formed + groups)
        return lobby, tuple(found)

    def _next_of(self, pool: str, now: float) -> list[LobbyOutcome]:
        """Return the next outcomes in a pool: a group, or ends of waits; empty if all people go on waiting."""
        people = [each for each in self.waiting if each.pool == pool]
        if not people:
            return []
        rule = self.rules[pool]
        needs = rule.needs()
        if rule.is_skipped:
            return [WaitEnded(each.participant, now - each.since, is_skipped=True) for each in people]
        if unfit := [each for each in people if needs[rule.kind_of(each)] == 0]:
            return [WaitEnded(each.participant, now - each.since) for each in unfit]
        chosen = list(_first_of_each_kind(rule, people))
        if len(chosen) == needs.total():
            return [self._group(rule, chosen, now)]
        overdue = [each for each in people if each.since + rule.wait <= now]
        if not overdue:
            return []
        # The people of a pool wait equally long, so the first of them also is the first whose wait ends.
        if rule.then is WaitRule.PAY or (rule.then is WaitRule.FEWER and len(chosen) < rule.least):
            return [WaitEnded(each.participant, now - each.since) for each in overdue[:1]]
        return [self._group(rule, chosen, now)]

    def _group(self, rule: PoolRule, people: Sequence[WaitingPerson], now: float) -> FormedGroup:
        seat_of = rule.fixed or self._seats(rule, people)
        people_of = {seat_of[each.participant]: each.participant for each in people}
        missing = SeatHolder.PROGRAM if rule.then is WaitRule.PROGRAM else SeatHolder.EMPTY
        holders = {
            seat: SeatHolder.PERSON if seat in people_of else rule.others.get(seat, missing) for seat in rule.seats
        }
        waited = {each.participant: now - each.since for each in people}
        return FormedGroup(
            people[0].pool, holders, {seat: people_of[seat] for seat in holders if seat in people_of}, waited
        )

    def _seats(self, rule: PoolRule, people: Sequence[WaitingPerson]) -> dict[str, str]:
        """Return the seat of each person of a new group."""
        free = [seat for seat in rule.seats if seat not in rule.others]
        if rule.random_seed is not None:
            stream = noise.key(rule.random_seed, "experiment", "seats", str(self.formed))
            drawn = {seat: float(noise.uniform(stream, index, 0)) for index, seat in enumerate(free)}
            free.sort(key=drawn.__getitem__)
        found: dict[str, str] = {}
        for each in people:
            fitting = [seat for seat in free if not rule.seat_of or rule.seat_of[seat] == each.value]
            found[each.participant] = fitting[0]
            free.remove(fitting[0])
        return found

    def _without(self, people: set[str]) -> "Lobby":
        waiting = tuple(each for each in self.waiting if each.participant not in people)
        pools = {each.pool for each in waiting}
        rules = {pool: rule for pool, rule in self.rules.items() if pool in pools}
        return dataclasses.replace(self, waiting=waiting, rules=rules)


def _first_of_each_kind(rule: PoolRule, people: Sequence[WaitingPerson]) -> Iterator[WaitingPerson]:
    """Yield the people of the next group, in the order of their arrival."""
    needs = rule.needs()
    for each in people:
        if needs[kind := rule.kind_of(each)] > 0:
            needs[kind] -= 1
            yield each


def _people_of(outcome: LobbyOutcome) -> list[str]:
    return [outcome.participant] if isinstance(outcome, WaitEnded) else [*outcome.people.values()]
