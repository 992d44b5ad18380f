"""What it costs SimR to keep one window up to date about its robots, with everything that a study can show."""

from dataclasses import replace
from pathlib import Path

import pytest

from sim.common.observations import TICKS_PER_SECOND
from sim.inputs import SendGoal
from sim.robot.navigator.goals import Goal
from tests.bench.budget import Budgets, best
from thbridge.app.compose.robots import build_team
from thbridge.app.compose.setting import read_setting
from thbridge.hunt.events import Condition
from thbridge.roles.simr.pose_telemetry import TelemetryOptions, TelemetryPublisher
from thbridge.study.study_file import Study

pytestmark = pytest.mark.bench

SECONDS = 20


@pytest.mark.parametrize("robots", [4, 10])
def test_one_window_is_told_of_robots_under_way(robots: int, budgets: Budgets) -> None:
    setting = read_setting(replace(Study(), map="warehouse12", robots=robots), Path())
    team = build_team(setting)
    goals = [SendGoal(robot, Goal(1, setting.map.rooms[robot].goal)) for robot in range(robots)]
    film = [team.step(goals if tick == 0 else []) for tick in range(SECONDS * TICKS_PER_SECOND)]
    conditions = [Condition.WELL] * robots
    sent = []

    def publish() -> None:
        telemetry = TelemetryPublisher("SimR", TelemetryOptions(path=True, uncertainty=True, truth=True))
        telemetry.subscribe("Window", 0)
        sent[:] = [m for tick, snapshot in enumerate(film) for m in telemetry.messages(tick, snapshot, conditions, {})]

    spent = best(publish, 5)
    share, size = 100 * spent / SECONDS, sum(len(message.line()) for message in sent)
    print(f"{robots} robots: {share:.1f} % of a core, {size / SECONDS / 1024:.0f} KiB a second of the session")
    assert size > 0
    budgets.time(f"pose telemetry: a second of {robots} robots", spent / SECONDS)
