"""Play many random hunts on all cores, and tell what went wrong in them and how long robots had to wait.

Run it from the project's folder: `.venv/bin/python scripts/stress_hunts.py` (`make stress`). Every hunt is its own
session as `thbridge play` would run it, its treasures, noise and participant drawn by its seed. Ends with 1 when
robots collided, a hunt did not end, or a goal was given up.
"""

import argparse
import math
import os
import re
import sys
import time
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from multiprocessing import get_context
from pathlib import Path

from sim.common.geometry import Pose2
from sim.common.observations import TICK, TICKS_PER_SECOND
from sim.robot.navigator.goals import GoalReached, NoPath
from sim.team import TeamSnapshot
from thbridge.app.compose.game import build_bot, build_hider, build_keeper
from thbridge.app.compose.robots import build_simr
from thbridge.app.compose.setting import read_setting
from thbridge.app.session.session import Session
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.participant.tabui import TabUI
from thbridge.study.study_file import Study

MAPS = ("arena8", "warehouse12")
MAX_SECONDS = 1800.0
"""Simulated seconds after which a hunt counts as hung."""
MOVED_DISTANCE = 0.05
"""Metres, and radians, that count as having moved."""


@dataclass(frozen=True, slots=True)
class Hunt:
    """One hunt to play."""

    place: str
    robots: int
    seed: int


@dataclass(frozen=True, slots=True)
class Outcome:
    """Result of a hunt.

    Attributes:
        hunt: the hunt.
        ended: it came to its end.
        seconds: simulated.
        goals: number of goals reached.
        failures: the reasons of the goals that were not, as codes.
        collisions: of all robots.
        waited: longest time that a robot with a goal stood still, seconds.
        open: longest time from a goal to its end, seconds.
        cpu: processor seconds.
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


class GoalTimer:
    """Measures how long goals stay open, and how long robots stand still meanwhile."""

    def __init__(self, robots: int) -> None:
        self._goal: list[int | None] = [None] * robots
        self._since = [0] * robots
        self._stood = [0] * robots
        self._place: list[Pose2 | None] = [None] * robots
        self.waited = self.open = 0
        self.reached = 0
        self.failures: list[str] = []

    def saw(self, snapshot: TeamSnapshot) -> None:
        """Take one tick."""
        for robot, output in enumerate(snapshot.robots):
            navigation, tick = output.navigation, snapshot.tick
            goal = None if navigation.goal is None else navigation.goal.id
            self.reached += isinstance(navigation.result, GoalReached)
            if isinstance(navigation.result, NoPath):
                self.failures.append(navigation.result.reason)
            here = Pose2(*snapshot.world.poses[robot])
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


def play(hunt: Hunt) -> Outcome:
    """Play one hunt to its end."""
    began = time.process_time()
    setting = read_setting(replace(Study(robots=hunt.robots, seed=hunt.seed), map=hunt.place), Path())
    simr = build_simr(setting)
    person = TabUI(build_bot(setting.templates, BotStrategy.RANDOM, hunt.seed))
    session = Session(
        build_keeper(setting),
        [simr, build_hider(setting.templates, setting.study.seed), person],
    )
    watch = GoalTimer(hunt.robots)
    while session.tick < MAX_SECONDS * TICKS_PER_SECOND and not (session.game is not None and session.game.ended):
        snapshot = session.step().snapshot
        if snapshot is not None:
            watch.saw(snapshot)
    return Outcome(
        hunt,
        session.game is not None and bool(session.game.ended),
        session.tick * TICK,
        watch.reached,
        tuple(watch.failures),
        int(simr.snapshot.world.collisions.sum()) if simr.snapshot is not None else 0,
        watch.waited * TICK,
        watch.open * TICK,
        time.process_time() - began,
    )


def report_line(robots: int, outcomes: Sequence[Outcome]) -> str:
    """Return one line on the hunts with so many robots."""
    failures = Counter(reason for outcome in outcomes for reason in outcome.failures)
    simulated, cpu = (math.fsum(values) for values in zip(*((o.seconds, o.cpu) for o in outcomes), strict=True))
    missed = f"{failures.total()} not {dict(failures)}" if failures else "0 not"
    return (
        f"{robots:2} robots: {len(outcomes)} hunts, {sum(not o.ended for o in outcomes)} hung, "
        f"{sum(o.collisions for o in outcomes)} collisions, {sum(o.goals for o in outcomes)} goals reached, {missed}; "
        f"longest stand {max(o.waited for o in outcomes):.0f} s, longest goal {max(o.open for o in outcomes):.0f} s; "
        f"{simulated / cpu:.0f} simulated s per CPU s"
    )


def batches(words: str) -> list[tuple[int, int]]:
    """Parse numbers of robots and of hunts from "3x100,8x20". Raises ArgumentTypeError."""
    found = [re.fullmatch(r"([1-9]\d*)x([1-9]\d*)", word) for word in words.split(",")]
    read = [(int(each[1]), int(each[2])) for each in found if each is not None]
    if len(read) < len(found):
        raise argparse.ArgumentTypeError(f"{words!r} is not like 3x100,8x20: ROBOTSxHUNTS, with commas between")
    return read


def main() -> int:
    """Play all hunts."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    usual, shape = "2x100,4x100,8x100,16x20", "ROBOTSxHUNTS, with commas between"
    parser.add_argument("--hunts", type=batches, default=usual, help=shape)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    well = True
    with ProcessPoolExecutor(options.jobs, mp_context=get_context("spawn")) as pool:
        for robots, count in options.hunts:
            # A small map has no room for so many to start.
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
