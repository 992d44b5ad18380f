"""Ticks in which nothing is due for a robot are skipped: whoever looks sees what a step would have shown."""

from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from sim.common.observations import Twist
from sim.inputs import (
    CancelGoal,
    ClearCostmapRegion,
    ClearCostmaps,
    DriveManually,
    GlobalLocalization,
    KidnapRobot,
    KillRobot,
    NomotionUpdate,
    PutThing,
    ReviveRobot,
    SendGoal,
    SetPoseEstimate,
)
from sim.numerics.noise_arrays import NoiseStream
from sim.parameters import RobotParameters, WorldParameters
from sim.robot.costmap.view import ShownCostmap
from sim.robot.navigator.goals import Goal
from sim.robot.software import LazyOutput
from sim.team import START_COVARIANCE, Team
from sim.world.thing import Thing
from thbridge.files.map_files import read_map

ARENA = read_map(Path(__file__).parents[2] / "maps" / "arena8")
STUDY = RobotParameters()
PARTICLES, EXTENDED, UNSCENTED, TRUTH = (replace(STUDY, localization=name) for name in ("amcl", "ekf", "ukf", "truth"))


def team_of(robots, seed):
    return Team(ARENA.grid, WorldParameters(), robots, ARENA.starts[: len(robots)], seed, 1e9)


def parts(value: object) -> Iterator[object]:
    """All numbers of an output, to the bit."""
    if isinstance(value, np.ndarray):
        yield value.shape, value.dtype.str, value.tobytes()
    elif isinstance(value, ShownCostmap):
        yield from parts(value.read())
    elif is_dataclass(value):
        for field in fields(value):
            yield field.name
            yield from parts(getattr(value, field.name))
    elif isinstance(value, tuple | list):
        for each in value:
            yield from parts(each)
    else:
        yield repr(value)


def requests(seed: int, robots: int, tick: int):
    """Requests of one tick: now and then one, of any kind."""
    chance = NoiseStream.named(seed, "requests").uniforms(tick, 4).tolist()
    if chance[0] > 0.03 and tick > 1:
        return []
    robot, place = int(chance[1] * robots), ARENA.rooms[int(chance[2] * len(ARENA.rooms))].goal
    crate = Thing("crate", ((0.15, 0.15), (-0.15, 0.15), (-0.15, -0.15), (0.15, -0.15)), place)
    kinds = [
        *[SendGoal(robot, Goal(tick, place))] * 6,
        CancelGoal(robot),
        DriveManually(robot, Twist(0.2, 0.3), 30),
        KillRobot(robot),
        *[ReviveRobot(each) for each in range(robots)],
        KidnapRobot(robot, place),
        SetPoseEstimate(robot, place, START_COVARIANCE),
        GlobalLocalization(robot),
        NomotionUpdate(robot),
        ClearCostmaps(robot),
        ClearCostmapRegion(robot, "local_costmap", 1.0),
        PutThing(crate),
    ]
    if tick == 1:
        return [SendGoal(each, Goal(each, ARENA.rooms[-1 - each].goal)) for each in range(robots)]
    return [kinds[int(chance[3] * len(kinds))]]


@pytest.mark.parametrize(
    ("seed", "robots"),
    [
        (2, [PARTICLES, EXTENDED, UNSCENTED, TRUTH]),
        (3, [PARTICLES]),
        *(pytest.param(seed, [PARTICLES] * robots, marks=pytest.mark.slow) for seed, robots in ((1, 4), (4, 3))),
    ],
)
def test_a_team_whose_robots_skip_ticks_does_what_one_does_that_steps_them_all(seed, robots):
    skipping, stepping = team_of(robots, seed), team_of(robots, seed)
    skipped = 0
    for tick in range(1, 900):
        inputs = requests(seed, len(robots), tick)
        stepping._next_due[:] = 0
        for robot in stepping._robots:
            robot.rests = False
        one, other = skipping.step(inputs), stepping.step(inputs)
        skipped += sum(isinstance(output, LazyOutput) for output in one.robots)
        assert not any(isinstance(output, LazyOutput) for output in other.robots)
        # Most ticks nobody looks at: what is then not made must not be missed.
        if tick % 7 in {0, 1, 3}:
            assert [*parts(list(one.robots))] == [*parts(list(other.robots))], tick
        assert one.commands.tobytes() == other.commands.tobytes()
        assert one.truth.poses.tobytes() == other.truth.poses.tobytes()
    assert skipped > 50


def test_a_robot_that_stands_is_stepped_for_its_costmaps_alone():
    team = team_of([PARTICLES] * 4, 1)
    for _ in range(100):
        team.step()
    skipped = [sum(isinstance(output, LazyOutput) for output in team.step().robots) for _ in range(500)]
    assert sum(skipped) > 0.95 * 4 * 500
