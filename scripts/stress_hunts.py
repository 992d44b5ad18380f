"""Play many random hunts on all cores, and report faults and the waiting times of robots.

Run this script from the project's folder: `.venv/bin/python scripts/stress_hunts.py` (`make stress`). Each hunt is a
separate session, as in `thbridge play`; its seed determines treasures, noise and participant. The exit code is 1 if
robots collided, a hunt did not end, or a goal was given up.

With `--conditions all --count 200`, the script instead plays hunts in all dialogue conditions. The seed of a hunt
determines map, team, energy, participant, manner of robots, obstacles and failures, equally in all conditions. The
script prints score, rooms and energy for each condition, and compares each condition with the scripted questions on the
same seeds. In these hunts goals may be given up, because rooms have obstacles, and robots die.
"""

import argparse
import math
import os
import re
import sys
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import cache
from multiprocessing import get_context
from operator import attrgetter
from pathlib import Path
from statistics import mean, stdev
from typing import TypeVar

from sim.common.geometry import Pose2
from sim.common.observations import TICK, TICKS_PER_SECOND
from sim.numerics import noise
from sim.robot.navigator.goals import GoalReached, NoPath
from sim.snapshot import TeamSnapshot
from thbridge.app.compose.game import build_bot, build_hider, build_keeper
from thbridge.app.compose.robots import build_simr
from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.app.session.session import Session
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.dialogue.games.strategies import Attitude
from thbridge.dialogue.moves import Speaker
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.participant.tabui import TabUI
from thbridge.study.study_file import DialogueSection, GameSection, MannerSection, ParticipantSection, Study
from thbridge.study.things import Mishap, MishapEntry, Shape, ThingEntry

T = TypeVar("T")
MAPS = ("arena8", "warehouse12")
MAX_SECONDS = 1800.0
"""Simulated seconds after which a hunt counts as stuck."""
PARTICIPANTS: Mapping[str, Callable[[Attitude, str], bool]] = {
    "all": lambda _attitude, _strategy: True,
    "attentive": lambda attitude, _strategy: attitude is not Attitude.SCEPTICAL,
    "attentive, by suggestion": lambda attitude, strategy: (
        attitude is not Attitude.SCEPTICAL and strategy == BotStrategy.SUGGESTION
    ),
    "attentive, nearest": lambda attitude, strategy: (
        attitude is not Attitude.SCEPTICAL and strategy == BotStrategy.NEAREST
    ),
    "attentive, random": lambda attitude, strategy: (
        attitude is not Attitude.SCEPTICAL and strategy == BotStrategy.RANDOM
    ),
}
"""Groups of participants to compare. Attentive participants consider what robots say."""
MOVED_DISTANCE = 0.05
"""Distance in meters, and angle in radians. A robot that moves less counts as standing still."""


@dataclass(frozen=True, slots=True)
class Hunt:
    """One hunt to play."""

    place: str
    robots: int
    seed: int
    condition: DialogueCondition | None = None


@dataclass(frozen=True, slots=True)
class Outcome:
    """Result of a hunt.

    Attributes:
        hunt: hunt that was played.
        ended: True if the hunt reached its end.
        seconds: simulated time, seconds.
        goals: number of goals reached.
        failures: codes of the reasons why goals were not reached.
        collisions: number of collisions of all robots.
        waited: longest time that a robot with a goal stood still, seconds.
        open: longest time from the request of a goal to its end, seconds.
        cpu: processor time, seconds.
        score: score of the game.
        rooms: number of rooms visited.
        energy: energy left to all robots.
        replies: number of the participant's replies in dialogues.
        who: attitude and strategy of the participant.
        fault: exception that ended the hunt; empty if there was no exception.
    """

    hunt: Hunt
    ended: bool
    seconds: float
    goals: int
    failures: tuple[str, ...]
    collisions: int
    waited: float
    open: float
    cpu: float
    score: float = 0.0
    rooms: int = 0
    energy: float = 0.0
    replies: int = 0
    who: tuple[Attitude, str] = (Attitude.CREDULOUS, BotStrategy.RANDOM)
    fault: str = ""


class GoalTimer:
    """Recorder of the durations of goals, and of the times that robots with a goal stand still."""

    def __init__(self, robots: int) -> None:
        self._goal: list[int | None] = [None] * robots
        self._since = [0] * robots
        self._stood = [0] * robots
        self._place: list[Pose2 | None] = [None] * robots
        self.waited = self.open = 0
        self.reached = 0
        self.failures: list[str] = []

    def saw(self, snapshot: TeamSnapshot) -> None:
        """Process one tick."""
        for robot, output in enumerate(snapshot.robots):
            navigation, tick = output.navigation, snapshot.tick
            goal = None if navigation.goal is None else navigation.goal.id
            self.reached += isinstance(navigation.result, GoalReached)
            if isinstance(navigation.result, NoPath):
                self.failures.append(navigation.result.reason)
            here = Pose2(*snapshot.truth.poses[robot])
            before = self._place[robot]
            moved = (
                before is None
                or before.distance(here) > MOVED_DISTANCE
                or abs(before.theta - here.theta) > MOVED_DISTANCE
            )
            if goal != self._goal[robot] or goal is None:
                self._goal[robot], self._since[robot], moved = goal, tick, True
            if moved:
                self._place[robot], self._stood[robot] = here, tick
            self.waited = max(self.waited, tick - self._stood[robot])
            self.open = max(self.open, tick - self._since[robot])


class Draw:
    """Random choices that depend only on a seed and the name of a stream."""

    def __init__(self, seed: int, stream: str) -> None:
        self._key, self._number = noise.key(seed, stream), 0

    def __call__(self, options: Sequence[T]) -> T:
        """Return one of some options."""
        self._number += 1
        return options[int(noise.uniform(self._key, self._number, 0) * len(options))]


@cache
def setting_at(place: str) -> StudySetting:
    """Return the setting of a study with this map and with the data for arguing robots.

    Reading these data is slow, so the setting is kept.
    """
    talk = DialogueSection(condition=DialogueCondition.COLLABORATOR)
    return read_setting(replace(Study(dialogue=talk), map=place), Path())


def drawn_hunt(seed: int, condition: DialogueCondition) -> Hunt:
    """Return a hunt; its random seed determines map and team."""
    draw = Draw(seed, "drawn team")
    return Hunt(draw(("arena8", "office", "warehouse12")), draw(range(1, 5)), seed, condition)


def drawn_study(hunt: Hunt, condition: DialogueCondition) -> Study:
    """Return the study of a hunt in a condition. Apart from the condition, it depends only on the hunt's seed."""
    draw = Draw(hunt.seed, "drawn study")
    manner = MannerSection(
        attitude=draw(tuple(Attitude)),
        persistence=draw(range(3)),
        talkative=draw((False, True)),
        gives_reasons=draw((True, True, False)),
        misheard=draw((0.0, 0.0, 0.2)),
    )
    talk = DialogueSection(condition=condition, manner=manner, adviser_error_rate=draw((0.0, 0.0, 0.3)))
    person = ParticipantSection(strategy=draw(tuple(BotStrategy)), attitude=draw(tuple(Attitude)))
    study = Study(robots=hunt.robots, seed=hunt.seed, dialogue=talk, participant=person)
    study = replace(study, map=hunt.place, game=GameSection(energy=draw((30.0, 45.0, 60.0))))
    goal = draw(setting_at(hunt.place).map.rooms).goal
    crate = ThingEntry("crate", Shape.CRATE, (goal.x, goal.y, 0.0), vanishes=draw((None, 60.0)))
    robot, time_of_mishap = draw(range(1, hunt.robots + 1)), draw((5.0, 20.0, 35.0))
    dies = MishapEntry(robot, Mishap.DIES, time_of_mishap)
    mishaps = draw(((), (), (dies,), (dies, MishapEntry(robot, Mishap.REVIVES, time_of_mishap + 30.0))))
    return replace(study, things=draw(((), (), (crate,))), mishaps=mishaps)


def study_of(hunt: Hunt) -> Study:
    """Return the study of a hunt."""
    if hunt.condition is not None:
        return drawn_study(hunt, hunt.condition)
    person = ParticipantSection(strategy=BotStrategy.RANDOM)
    return replace(Study(robots=hunt.robots, seed=hunt.seed, participant=person), map=hunt.place)


def played(hunt: Hunt) -> Outcome:
    """Play one hunt to its end. If an exception ends the hunt, store the exception in the result."""
    try:
        return play(hunt)
    except Exception as fault:
        # The failure of one hunt must not stop the others.
        return Outcome(hunt, False, 0.0, 0, (), 0, 0.0, 0.0, 0.0, fault=repr(fault))


def play(hunt: Hunt) -> Outcome:
    """Play one hunt to its end."""
    began = time.process_time()
    setting = replace(setting_at(hunt.place), study=study_of(hunt))
    simr, who, replies = build_simr(setting), setting.study.participant, 0
    person = TabUI(build_bot(setting.templates, who.strategy, hunt.seed, who.attitude))
    session = Session(
        build_keeper(setting),
        [simr, build_hider(setting.templates, setting.study.seed), person],
    )
    watch = GoalTimer(hunt.robots)
    while session.tick < MAX_SECONDS * TICKS_PER_SECOND and not (session.game is not None and session.game.ended):
        record = session.step()
        replies += sum(said.speaker is Speaker.PERSON for said in record.utterances)
        if record.snapshot is not None:
            watch.saw(record.snapshot)
    game = session.game
    return Outcome(
        hunt,
        game is not None and bool(game.ended),
        session.tick * TICK,
        watch.reached,
        tuple(watch.failures),
        int(simr.snapshot.truth.collisions.sum()) if simr.snapshot is not None else 0,
        watch.waited * TICK,
        watch.open * TICK,
        time.process_time() - began,
        0.0 if game is None else game.score,
        0 if game is None else sum(room.visited for room in game.rooms),
        0.0 if game is None else math.fsum(robot.energy for robot in game.robots),
        replies,
        (who.attitude, who.strategy),
    )


def report_line(robots: int, outcomes: Sequence[Outcome]) -> str:
    """Return one line about the hunts with this number of robots."""
    failures = Counter(reason for outcome in outcomes for reason in outcome.failures)
    simulated, cpu = (math.fsum(values) for values in zip(*((o.seconds, o.cpu) for o in outcomes), strict=True))
    missed = f"{failures.total()} not reached {dict(failures)}" if failures else "0 not reached"
    return (
        f"{robots:2} robots: {len(outcomes)} hunts, {sum(not o.ended for o in outcomes)} did not end, "
        f"{sum(o.collisions for o in outcomes)} collisions, {sum(o.goals for o in outcomes)} goals reached, {missed}; "
        f"longest wait {max(o.waited for o in outcomes):.0f} s, longest goal {max(o.open for o in outcomes):.0f} s; "
        f"{simulated / cpu:.0f} simulated seconds per second of processor time"
    )


def condition_row(condition: DialogueCondition, outcomes: Sequence[Outcome]) -> str:
    """Return the row of a table for the hunts in one condition."""
    values = ([o.score for o in outcomes], [o.rooms for o in outcomes], [o.energy for o in outcomes])
    cells = [f"{mean(each):.1f} ± {stdev(each):.1f}" for each in values]
    wrong = (
        sum(not o.ended for o in outcomes),
        sum(o.collisions for o in outcomes),
        sum(bool(o.fault) for o in outcomes),
    )
    replies = f"{mean(o.replies for o in outcomes):.1f}"
    return f"| {' | '.join(map(str, (condition, len(outcomes), *wrong, *cells, replies)))} |"


def comparison_row(name: str, outcomes: Sequence[Outcome], scripted: Sequence[Outcome]) -> str:
    """Return the row of a table that compares hunts with the hunts with scripted questions on the same seeds."""
    cells = [f"{name} | {len(outcomes)}"]
    for of in (attrgetter("score"), attrgetter("rooms"), attrgetter("energy")):
        gains = [of(here) - of(there) for here, there in zip(outcomes, scripted, strict=True)]
        better, worse = sum(gain > 0 for gain in gains), sum(gain < 0 for gain in gains)
        cells.append(f"{mean(gains):+.2f} ± {stdev(gains) / math.sqrt(len(gains)):.2f} ({better}:{worse})")
    return f"| {' | '.join(cells)} |"


def play_conditions(pool: Executor, conditions: Sequence[DialogueCondition], seeds: Sequence[int]) -> bool:
    """Play hunts in several conditions on the same seeds, and print their tables; return True if no hunt is faulty."""
    found: dict[DialogueCondition, list[Outcome]] = {}
    print("| condition | hunts | did not end | collisions | exceptions | score | rooms | energy left | replies |")
    print("|---|---|---|---|---|---|---|---|---|")
    for condition in conditions:
        found[condition] = list(pool.map(played, [drawn_hunt(seed, condition) for seed in seeds]))
        print(condition_row(condition, found[condition]), flush=True)
    scripted = found.get(DialogueCondition.SCRIPT)
    if scripted is not None and len(seeds) > 1:
        print("\nDifference from `script` on the same seeds: mean ± standard error (better hunts:worse hunts)\n")
        print("| condition, participants | hunts | score | rooms | energy left |\n|---|---|---|---|---|")
        for condition, outcomes in found.items():
            pairs = list(zip(outcomes, scripted, strict=True))
            for name, belongs in PARTICIPANTS.items():
                chosen = [pair for pair in pairs if belongs(*pair[0].who)]
                if condition is not DialogueCondition.SCRIPT and len(chosen) > 1:
                    print(comparison_row(f"{condition}, {name}", *zip(*chosen, strict=True)))
    faulty = [o for outcomes in found.values() for o in outcomes if o.collisions or o.fault or not o.ended]
    for outcome in faulty:
        print("  ", outcome, flush=True)
    return not faulty


def conditions_of(words: str) -> tuple[DialogueCondition, ...]:
    """Parse conditions from "script,adviser" or "all". Raise ArgumentTypeError for other words."""
    try:
        return tuple(DialogueCondition if words == "all" else map(DialogueCondition, words.split(",")))
    except ValueError as fault:
        raise argparse.ArgumentTypeError(f"{fault}: write all, or some of {', '.join(DialogueCondition)}") from fault


def batches(words: str) -> list[tuple[int, int]]:
    """Parse numbers of robots and of hunts from "3x100,8x20". Raise ArgumentTypeError for other words."""
    found = [re.fullmatch(r"([1-9]\d*)x([1-9]\d*)", word) for word in words.split(",")]
    read = [(int(each[1]), int(each[2])) for each in found if each is not None]
    if len(read) < len(found):
        raise argparse.ArgumentTypeError(f"{words!r} is not a list of ROBOTSxHUNTS, such as 3x100,8x20")
    return read


def main() -> int:
    """Play all hunts."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    usual, shape = "2x100,4x100,8x100,16x20", "ROBOTSxHUNTS, separated by commas"
    parser.add_argument("--hunts", type=batches, default=usual, help=shape)
    parser.add_argument("--conditions", type=conditions_of, help="`all`, or names of conditions, separated by commas")
    parser.add_argument("--count", type=int, default=200, help="number of hunts in each condition")
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    well = True
    with ProcessPoolExecutor(options.jobs, mp_context=get_context("spawn")) as pool:
        if options.conditions:
            seeds = range(options.first_seed, options.first_seed + options.count)
            return 0 if play_conditions(pool, options.conditions, seeds) else 1
        for robots, count in options.hunts:
            # On a small map, there is not enough space at the start for a large team.
            places = MAPS if robots <= 10 else MAPS[1:]
            hunts = [Hunt(places[n % len(places)], robots, options.first_seed + n) for n in range(count)]
            outcomes = list(pool.map(play, hunts))
            print(report_line(robots, outcomes), flush=True)
            for outcome in outcomes:
                if outcome.collisions or outcome.failures or not outcome.ended:
                    well = False
                    print("  ", outcome, flush=True)
    return 0 if well else 1


if __name__ == "__main__":
    sys.exit(main())
