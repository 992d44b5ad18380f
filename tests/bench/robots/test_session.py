"""How much simulated time a second of CPU buys, for the whole chain, robots always under way."""

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import pytest

from sim.common.geometry import Pose2
from sim.parameters import LaserParameters, RobotParameters, WorldParameters
from sim.robot.costmap.costmap_2d import Costmap2D
from sim.robot.global_planning.itinerary_planner import ItineraryPlanner
from sim.robot.localization.amcl import Amcl
from sim.robot.navigator.controller import Controller
from sim.robot.navigator.follower import Follower
from sim.robot.navigator.move_base import Navigator
from sim.snapshot import TeamSnapshot
from sim.team import Team
from sim.world.physics import World
from sim.world.sensors import Sensors
from tests.bench.budget import Budgets
from tests.support.maps.hall_of_shelves import hall
from tests.support.robots.robots_under_way import best_ticks, drive
from thbridge.app.compose.recording import build_publisher, build_record, build_writer
from thbridge.app.compose.robots import build_team
from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.app.session.broadcast import Broadcast
from thbridge.study.study_file import Study

pytestmark = pytest.mark.bench

SECONDS = 60
RUNS = 3

STAGES = {
    "world": ((World, "step"),),
    "sensing": ((Sensors, "sense"),),
    "localisation": ((Amcl, "update"),),
    "costmaps": (
        (Costmap2D, "observe"),
        (Costmap2D, "update_neighbours"),
        (Costmap2D, "update"),
        (Costmap2D, "without_robots"),
        (Costmap2D, "as_updated"),
    ),
    "planning": ((ItineraryPlanner, "plan"), (ItineraryPlanner, "refuge"), (ItineraryPlanner, "obstructed")),
    "control": ((Follower, "step"), (Controller, "rotate_recovery")),
    "rest of the navigator": ((Navigator, "step"),),
}


def test_simulated_seconds_per_cpu_second(tmp_path, budgets: Budgets, capsys):
    figures = {}
    for robots in (2, 10):
        # Twelve rooms, so that ten robots always have somewhere to go.
        setting = read_setting(replace(Study(), map="warehouse12", robots=robots), Path())
        rooms = [room.goal for room in setting.map.rooms]
        drive(build_team(setting), rooms, 2)
        alone = best_ticks([drive(build_team(setting), rooms, SECONDS) for _ in range(RUNS)]).sum()
        recorded = min(drive_recorded(setting, rooms, tmp_path / "session.bag") for _ in range(RUNS))
        figures[robots] = (alone / SECONDS, recorded / SECONDS)
    with capsys.disabled():
        print()
        for robots, (alone, recorded) in figures.items():
            print(f"{robots:3d} robots: {1 / alone:6.1f} simulated s per CPU s, {1 / recorded:6.1f} with a bag")
    for robots, (alone, recorded) in figures.items():
        budgets.time(f"team: a simulated second, {robots} robots in the warehouse", alone)
        budgets.time(f"team: a simulated second, {robots} robots in the warehouse, with a bag", recorded)


def drive_recorded(setting: StudySetting, goals: list[Pose2], path: Path) -> float:
    """CPU seconds of all threads: those that pack and write work beside the ticks, and after the last."""
    path.unlink(missing_ok=True)
    team = build_team(setting)
    began = time.process_time()
    with build_writer(setting, path) as writer:
        said = Broadcast(build_publisher(setting), build_record(setting, "play", [], ""), setting.map.grid, [writer])
        drive(team, goals, SECONDS, said.record)
    return time.process_time() - began


@contextmanager
def timed_stages(monkeypatch) -> Iterator[dict[str, float]]:
    """CPU seconds of each stage, without those of stages that it calls."""
    spent = dict.fromkeys(STAGES, 0.0)
    inner: list[float] = []

    def timed(stage: str, method: Callable[..., object]) -> Callable[..., object]:
        def run(*args: object) -> object:
            inner.append(0.0)
            began = time.process_time()
            try:
                return method(*args)
            finally:
                took = time.process_time() - began
                spent[stage] += took - inner.pop()
                if inner:
                    inner[-1] += took

        return run

    with monkeypatch.context() as patched:
        for stage, methods in STAGES.items():
            for owner, name in methods:
                patched.setattr(owner, name, timed(stage, getattr(owner, name)))
        yield spent


class Count:
    """What has come of it."""

    def __init__(self) -> None:
        self.ended = 0
        self.collisions = 0

    def watch(self, snapshot: TeamSnapshot) -> None:
        self.ended += sum(output.navigation.result is not None for output in snapshot.robots)
        self.collisions = int(snapshot.world.collisions.sum())


def test_how_it_grows(monkeypatch, budgets: Budgets, capsys):
    """Teams of 1 to 50 robots with 360 beams each, everything on, for half a minute."""
    grid, places = hall()
    world = WorldParameters(laser=LaserParameters(beams=360, field_of_view=2 * math.pi))
    with capsys.disabled():
        print()
    for robots in (2, 1, 5, 10, 20, 50):
        runs = []
        for _ in range(RUNS):
            team = Team(grid, world, [RobotParameters()] * robots, places[:robots], 1, 1000.0)
            # Two robots need all that is compiled at once.
            drive(team, places, 10 if robots == 2 else 2)
            count = Count()
            runs.append(drive(team, places, 30, count.watch))
        total = best_ticks(runs).sum()
        # Apart, for looking at the clock takes time too.
        with timed_stages(monkeypatch) as spent:
            spent["rest"] = drive(team, places, 5).sum() - sum(spent.values())
        shares = ", ".join(f"{stage} {share / sum(spent.values()):.0%}" for stage, share in spent.items())
        with capsys.disabled():
            print(
                f"{robots:3d} robots: {30 / total:6.1f} simulated s per CPU s,"
                f" {total / 30 / robots * 1e3:5.2f} ms per robot and s; {count.ended} goals ended,"
                f" {count.collisions} collisions; {shares}"
            )
        assert count.collisions == 0
        budgets.time(f"team: a simulated second, {robots} robots in a hall", total / 30)
