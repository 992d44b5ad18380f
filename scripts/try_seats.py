"""Play many hunts of several simulated people on all cores, and report hunts that do not end.

Run this script from the project's folder: `.venv/bin/python scripts/try_seats.py`. It plays hunts of 2, 3 and 4 people
in each of four seat plans:

* `own-robot`: each person commands one robot and may do everything with it.
* `roles`: one person commands all robots, and one names the treasures. The third may take over robots, and the fourth
  may name treasures, too.
* `split-sight`: each person commands robots, but one does not see the map, one does not see the energy, and further
  people see neither the score nor others' dialogues.
* `majority`: each person commands robots, and a majority must agree to each move and to each name.

The seed of a hunt determines its treasures, the dialogue condition, and the strategy and attitude of each person. The
script prints a table with score, agreement and time to decide. The exit code is 1 if a hunt did not end.

With `--without-simulator`, each move takes the same time. This is much faster, and plays the same game.
"""

import argparse
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import cache
from itertools import groupby
from multiprocessing import get_context
from pathlib import Path
from statistics import mean, stdev
from typing import TypeVar

from sim.common.observations import TICKS_PER_SECOND
from sim.numerics import noise
from thbridge.app.compose.game import build_hider, build_keeper, build_participants
from thbridge.app.compose.robots import build_simr
from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.app.session.session import Session
from thbridge.app.trials.puppets import Puppets
from thbridge.batch.seat_measures import SeatObserver
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.dialogue.games.strategies import Attitude
from thbridge.hunt.seats import DialogueSight, StopRight
from thbridge.roles.keeper.disclosed.disclosure import plain_costs
from thbridge.roles.keeper.team.decisions import AgreementRule
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.shared.robots_role import RobotsRole
from thbridge.roles.shared.role import Role
from thbridge.study.seats import AgreementSection, SeatEntry, TeamSection
from thbridge.study.study_file import DialogueSection, GameSection, Study

T = TypeVar("T")
MAX_SECONDS = 1800.0
"""Simulated seconds after which a hunt counts as stuck."""
PEOPLE = (2, 3, 4)
COLUMNS = (
    "plan",
    "people",
    "hunts",
    "stuck",
    "exceptions",
    "score",
    "rooms",
    "seconds",
    "votes",
    "agreement",
    "seconds to decide",
    "share of the most active person",
)


@dataclass(frozen=True, slots=True)
class Plan:
    """Seat plan: the seats for a number of people, and the rules of votes."""

    seats: Callable[[int], Iterator[SeatEntry]]
    agreement: AgreementSection


@dataclass(frozen=True, slots=True)
class Hunt:
    """One hunt to play: name of its plan, number of people, and random seed."""

    plan: str
    people: int
    seed: int
    simulated: bool


@dataclass(frozen=True, slots=True)
class Outcome:
    """Result of a hunt.

    Attributes:
        hunt: hunt that was played.
        ended: True if the hunt reached its end.
        seconds: simulated time, seconds.
        score: score of the game.
        rooms: number of rooms visited.
        votes: number of votes.
        agreement: share of votes with a decision for the proposal; None without votes.
        seconds_to_decide: mean duration of a vote, seconds; None without votes.
        busiest: share of all decisions that the most active person made.
        fault: exception that ended the hunt; empty if there was no exception.
    """

    hunt: Hunt
    ended: bool = False
    seconds: float = 0.0
    score: float = 0.0
    rooms: int = 0
    votes: int = 0
    agreement: float | None = None
    seconds_to_decide: float | None = None
    busiest: float = 0.0
    fault: str = ""


def own_robot(people: int) -> Iterator[SeatEntry]:
    """Yield the seats of `own-robot`."""
    for number in range(1, people + 1):
        yield SeatEntry(f"person{number}", robots=(number,))


def roles(people: int) -> Iterator[SeatEntry]:
    """Yield the seats of `roles`."""
    yield SeatEntry("driver", robots=(1, 2, 3), names_treasures=False)
    yield SeatEntry("namer", takes_over=False, sees_map=False)
    if people > 2:
        yield SeatEntry("helper", names_treasures=False, stops=StopRight.ALL)
    if people > 3:
        yield SeatEntry("judge", takes_over=False, sees_dialogues=DialogueSight.OWN, ends_game=False)


def split_sight(people: int) -> Iterator[SeatEntry]:
    """Yield the seats of `split-sight`."""
    yield SeatEntry("map", robots=(1,), sees_energy=False)
    yield SeatEntry("energy", robots=(2,), sees_map=False)
    for number in range(3, people + 1):
        yield SeatEntry(f"person{number}", robots=(number,), sees_score=False, sees_dialogues=DialogueSight.OWN)


PLANS = {
    "own-robot": Plan(own_robot, AgreementSection()),
    "roles": Plan(roles, AgreementSection()),
    "split-sight": Plan(split_sight, AgreementSection()),
    "majority": Plan(own_robot, AgreementSection(send=AgreementRule.MAJORITY, name=AgreementRule.MAJORITY)),
}


@cache
def files() -> StudySetting:
    """Return the setting of a study with the data for arguing robots. Reading these data is slow, so it is kept."""
    return read_setting(Study(dialogue=DialogueSection(condition=DialogueCondition.COLLABORATOR)), Path())


def study_of(hunt: Hunt) -> Study:
    """Return the study of a hunt. It depends only on the hunt."""
    key, plan = noise.key(hunt.seed, "seats", hunt.plan), PLANS[hunt.plan]

    def draw(options: Sequence[T], number: int) -> T:
        return options[int(noise.uniform(key, number, 0) * len(options))]

    seats = tuple(
        replace(
            seat, strategy=draw(tuple(BotStrategy), 2 * number + 10), attitude=draw(tuple(Attitude), 2 * number + 11)
        )
        for number, seat in enumerate(plan.seats(hunt.people))
    )
    return replace(
        Study(robots=max(robot for seat in seats for robot in seat.robots), seed=hunt.seed),
        seats=seats,
        team=TeamSection(agreement=plan.agreement),
        dialogue=DialogueSection(condition=draw(tuple(DialogueCondition), 1)),
        game=GameSection(energy=draw((30.0, 60.0, 100.0), 2)),
    )


def played(hunt: Hunt) -> Outcome:
    """Play one hunt to its end. If an exception ends the hunt, store the exception in the result."""
    try:
        return play(hunt)
    except Exception as fault:
        # The failure of one hunt must not stop the others.
        return Outcome(hunt, fault=repr(fault))


def play(hunt: Hunt) -> Outcome:
    """Play one hunt to its end."""
    setting, observer = replace(files(), study=study_of(hunt)), SeatObserver()
    study = setting.study
    robots: Role | RobotsRole = (
        build_simr(setting) if hunt.simulated else Puppets(study.robots, plain_costs(setting.costs), ticks=500)
    )
    hider = build_hider(setting.templates, study.seed)
    session = Session(build_keeper(setting), [robots, hider], [observer], build_participants(setting))
    while session.tick < MAX_SECONDS * TICKS_PER_SECOND and not (session.game is not None and session.game.ended):
        session.step()
    game = session.game
    decisions = [seat.decisions for seat in observer.each_seat]
    return Outcome(
        hunt,
        game is not None and bool(game.ended),
        session.tick / TICKS_PER_SECOND,
        0.0 if game is None else game.score,
        0 if game is None else sum(room.visited for room in game.rooms),
        observer.votes,
        observer.agreement,
        observer.seconds_to_decide,
        max(decisions, default=0) / max(sum(decisions), 1),
    )


def spread(values: Sequence[float | None], digits: int = 2) -> str:
    """Return mean and standard deviation of the known values, such as "170.0 ± 12.5"; "-" if there are none."""
    known = [value for value in values if value is not None]
    deviation = stdev(known) if len(known) > 1 else 0.0
    return f"{mean(known):.{digits}f} ± {deviation:.{digits}f}" if known else "-"


def row(name: str, people: int, outcomes: Sequence[Outcome]) -> str:
    """Return the row of the table for the hunts of a plan with a number of people."""
    cells = (
        name,
        people,
        len(outcomes),
        sum(not each.ended for each in outcomes),
        sum(bool(each.fault) for each in outcomes),
        spread([each.score for each in outcomes], 1),
        spread([each.rooms for each in outcomes], 1),
        spread([each.seconds for each in outcomes], 0),
        spread([each.votes for each in outcomes], 1),
        spread([each.agreement for each in outcomes]),
        spread([each.seconds_to_decide for each in outcomes]),
        spread([each.busiest for each in outcomes]),
    )
    return f"| {' | '.join(map(str, cells))} |"


def main() -> int:
    """Play all hunts."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--hunts", type=int, default=200, help="number of hunts of each plan")
    parser.add_argument("--plans", nargs="+", choices=PLANS, default=list(PLANS), help="names of plans")
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--without-simulator", action="store_true", help="let each move take the same time")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    print(f"| {' | '.join(COLUMNS)} |\n|{'---|' * len(COLUMNS)}", flush=True)
    faulty: list[Outcome] = []
    with ProcessPoolExecutor(options.jobs, mp_context=get_context("spawn")) as pool:
        for name in options.plans:
            hunts = sorted(
                (
                    Hunt(name, PEOPLE[number % len(PEOPLE)], options.first_seed + number, not options.without_simulator)
                    for number in range(options.hunts)
                ),
                key=lambda hunt: hunt.people,
            )
            outcomes = list(pool.map(played, hunts))
            for people, group in groupby(outcomes, key=lambda outcome: outcome.hunt.people):
                print(row(name, people, list(group)), flush=True)
            faulty += [outcome for outcome in outcomes if not outcome.ended]
    for outcome in faulty:
        print("  ", outcome)
    return 1 if faulty else 0


if __name__ == "__main__":
    sys.exit(main())
