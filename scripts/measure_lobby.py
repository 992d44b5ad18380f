"""Simulate a crowd in the lobby of a study with games of several people, and print a table of waiting times.

90 people come within a minute, to games of 2 and of 4. A tenth of them leaves at any moment.

python scripts/measure_lobby.py [--people N] [--seed N]
"""

import argparse
import itertools
import random
import statistics
from collections.abc import Iterator
from dataclasses import dataclass, field

from thbridge.experiment.design.lobby import WaitRule
from thbridge.experiment.lobby import FormedGroup, Lobby, PoolRule, SeatHolder, WaitEnded, WaitingPerson

SEATS = ("driver", "namer", "guide", "scout")
ARRIVALS, STAY, WAIT = 60.0, 90.0, 120.0
"""Seconds: all people arrive within the first time; people who leave do so within the second time after their arrival;
the third is the longest wait."""


@dataclass
class Crowd:
    """All that happened to the people of one kind of game.

    Attributes:
        rule: rule of the lobby.
        arrived: time at which each person came, s.
        groups: groups that played.
        ended: ends of waits.
        left: people who left while they waited.
    """

    rule: PoolRule
    arrived: dict[str, float] = field(default_factory=dict)
    groups: list[FormedGroup] = field(default_factory=list)
    ended: list[WaitEnded] = field(default_factory=list)
    left: set[str] = field(default_factory=set)

    @property
    def played(self) -> list[str]:
        """People who played."""
        return [person for group in self.groups for person in group.people.values()]

    @property
    def incomplete(self) -> int:
        """Number of games with an empty seat or a program."""
        return sum(set(group.seats.values()) != {SeatHolder.PERSON} for group in self.groups)

    @property
    def waits(self) -> list[float]:
        """Waiting times of people who got a game or an ending, s, without errors of rounding."""
        times = [wait for group in self.groups for wait in group.waited.values()]
        return sorted(round(wait, 6) for wait in (*times, *(each.waited for each in self.ended)))


def simulate(people: int, then: WaitRule, seed: int, *, by_answers: bool = False) -> dict[int, Crowd]:
    """Return what happens if people come to games of 2 and of 4 until no person waits any more, by the size of a game.

    Args:
        people: number of people, half of them for each size.
        then: rule for the end of a wait.
        seed: random seed of arrivals, departures and answers.
        by_answers: True if half of a group must have said yes, and half of it no. Otherwise, people play by arrival.
    """
    drawn = random.Random(seed)
    crowds = {}
    for size in (2, 4):
        quota = {"yes": size // 2, "no": size // 2} if by_answers else {}
        crowds[size] = Crowd(PoolRule(SEATS[:size], WAIT, then, quota=quota))
    happens: list[tuple[float, str, str, int]] = []
    leaving = {*drawn.sample(range(people), people // 10)}
    for number in range(people):
        size, at = (2, 4)[number % 2], drawn.uniform(0.0, ARRIVALS)
        happens.append((at, f"P-{number}", "comes", size))
        if number in leaving:
            happens.append((at + drawn.uniform(0.0, STAY), f"P-{number}", "leaves", size))
    answers = {f"P-{number}": drawn.choice(("yes", "no")) for number in range(people)}
    lobby, now = Lobby(), 0.0
    pending = sorted(happens)
    while pending or lobby.waiting:
        end = lobby.next_end
        if pending and (end is None or pending[0][0] <= end):
            now, person, act, size = pending.pop(0)
            if act == "comes":
                crowds[size].arrived[person] = now
                answer = answers[person]
                lobby = lobby.enter(WaitingPerson(person, str(size), now, answer), crowds[size].rule)
            elif any(each.participant == person for each in lobby.waiting):
                crowds[size].left.add(person)
                lobby = lobby.leave(person)
        else:
            now = now if end is None else end
        lobby, outcomes = lobby.matched(now)
        for outcome in outcomes:
            if isinstance(outcome, FormedGroup):
                crowds[int(outcome.pool)].groups.append(outcome)
            else:
                next(each for each in crowds.values() if outcome.participant in each.arrived).ended.append(outcome)
    return crowds


def table(people: int, seed: int) -> Iterator[str]:
    """Yield the lines of the table of waiting times."""
    yield (
        "| groups by | game of | at the end of a wait | people | played | games | with fewer people | "
        "ended with thanks | left while waiting | wait: median (s) | 95 % (s) | longest (s) |"
    )
    yield "|---|---|---|---|---|---|---|---|---|---|---|---|"
    for by_answers, then in itertools.product((False, True), WaitRule):
        for size, crowd in simulate(people, then, seed, by_answers=by_answers).items():
            waits = crowd.waits
            times = (statistics.median(waits), waits[int(0.95 * (len(waits) - 1))], waits[-1])
            counts = (
                len(crowd.arrived),
                len(crowd.played),
                len(crowd.groups),
                crowd.incomplete,
                len(crowd.ended),
                len(crowd.left),
            )
            cells = ["answers" if by_answers else "arrival", size, then, *counts, *(f"{each:.1f}" for each in times)]
            yield f"| {' | '.join(map(str, cells))} |"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--people", type=int, default=90, help="number of people")
    parser.add_argument("--seed", type=int, default=1, help="random seed of arrivals and departures")
    arguments = parser.parse_args()
    print("\n".join(table(arguments.people, arguments.seed)))
