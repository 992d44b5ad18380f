"""The presets of noise, driven: robots of both estimators go from room to room for as long as a hunt takes."""

from pathlib import Path

import numpy as np
import pytest

from sim.inputs import SendGoal
from sim.robot.navigator.goals import Goal, GoalReached
from thbridge.app.compose.robots import build_team
from thbridge.app.compose.setting import read_setting
from thbridge.study.noise import PRESETS, NoisePreset
from thbridge.study.study_file import read_study_text

HUNT = 120 * 50
"""Ticks."""


@pytest.mark.parametrize(
    ("preset", "mean", "worst"),
    [(NoisePreset.PERFECT, 0.03, 0.15), (NoisePreset.TURTLEBOT2, 0.1, 0.4), (NoisePreset.BAD_WHEELS, 0.12, 0.5)],
)
def test_robots_know_where_they_are(preset: NoisePreset, mean: float, worst: float) -> None:
    text = f"noise: {{preset: {preset}}}\neach: {{2: {{localization: ekf}}}}\n"
    setting = read_setting(read_study_text(Path("study.yaml"), text), Path())
    team, rooms = build_team(setting), setting.map.rooms
    errors = np.empty((HUNT, 2))
    arrived = 0
    inputs = [SendGoal(robot, Goal(robot, rooms[robot].goal)) for robot in range(2)]
    for tick in range(HUNT):
        snapshot = team.step(inputs)
        inputs = []
        for robot, output in enumerate(snapshot.robots):
            estimate = output.estimate
            assert np.isfinite(estimate.covariance).all()
            assert not estimate.lost
            errors[tick, robot] = np.hypot(*(snapshot.world.poses[robot, :2] - estimate.base_in_map.array()[:2]))
            if isinstance(output.navigation.result, GoalReached):
                arrived += 1
                inputs.append(SendGoal(robot, Goal(robot, rooms[(3 * arrived + robot) % len(rooms)].goal)))
    assert (errors.mean(axis=0) < mean).all()
    assert (errors.max(axis=0) < worst).all()
    assert arrived > 4
    least = setting.study.robot.amcl.min_particles
    assert all(len(output.estimate.particles) >= least for output in snapshot.robots[:1])


@pytest.mark.parametrize("preset", NoisePreset)
def test_every_preset_is_written_down(preset: NoisePreset) -> None:
    documented = (Path(__file__).parents[3] / "docs" / "explanation" / "noise.md").read_text()
    assert PRESETS[preset].strip() in documented
