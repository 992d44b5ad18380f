"""How much simulated time a second of CPU buys, for the whole chain, robots always under way."""

import time
from dataclasses import replace
from pathlib import Path

import pytest

from sim.geometry import Pose2
from sim.navigator import Goal
from sim.noise import Stream
from sim.observations import TICKS_PER_SECOND
from sim.team import Go, Team, TeamInput, TeamSnapshot
from thbridge.app.compose import Setting, read_setting
from thbridge.app.config import Study

pytestmark = pytest.mark.bench

SECONDS = 60


class Errands:
    """Sends every robot that stands to another room that nobody is at or under way to."""

    def __init__(self, goals: tuple[Pose2, ...], robots: int) -> None:
        self._goals = goals
        self._bound = [-1] * robots
        self._chance = Stream.named(1, "errands")
        self._count = 0

    def next(self, snapshot: TeamSnapshot | None) -> list[TeamInput]:
        inputs: list[TeamInput] = []
        for robot in range(len(self._bound)):
            if snapshot is not None and snapshot.robots[robot].navigation.goal is not None:
                continue
            free = [room for room in range(len(self._goals)) if room not in self._bound]
            if not free:
                continue
            self._count += 1
            self._bound[robot] = free[int(self._chance.uniforms(self._count, 1)[0] * len(free))]
            inputs.append(Go(robot, Goal(self._count, self._goals[self._bound[robot]])))
        return inputs


def drive(setting: Setting, team: Team, seconds: int, bag: Path | None = None) -> float:
    """CPU seconds for so many simulated ones."""
    errands = Errands(tuple(room.goal for room in setting.place.rooms), team.size)
    recorder = None if bag is None else setting.recorder(bag)
    snapshot = None
    began = time.process_time()
    for _ in range(seconds * TICKS_PER_SECOND):
        snapshot = team.step(errands.next(snapshot))
        if recorder is not None:
            recorder.record(snapshot)
    spent = time.process_time() - began
    if recorder is not None:
        recorder.close()
    return spent


def test_simulated_seconds_per_cpu_second(tmp_path, capsys):
    figures = {}
    for robots in (2, 10):
        # Twelve rooms, so that ten robots always have somewhere to go.
        setting = read_setting(replace(Study(), map="warehouse12", robots=robots), Path())
        drive(setting, setting.team(), 2, tmp_path / f"warm-{robots}.bag")
        figures[robots] = (
            SECONDS / drive(setting, setting.team(), SECONDS),
            SECONDS / drive(setting, setting.team(), SECONDS, tmp_path / f"{robots}.bag"),
        )
    with capsys.disabled():
        print()
        for robots, (alone, recorded) in figures.items():
            print(f"{robots:3d} robots: {alone:6.1f} simulated s per CPU s, {recorded:6.1f} with a bag")
