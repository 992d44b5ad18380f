import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.common.observations import STANDSTILL, Neighbour, Twist
from sim.common.polygons import placed_at
from sim.parameters import WorldParameters
from sim.robot.costmap.costs import CostFrame
from sim.robot.costmap.footprint import outline
from sim.robot.local_planning.braking import (
    NEIGHBOUR_MARGIN,
    TURNING_MARGIN,
    WALL_MARGIN,
    gap,
    safe,
    stopping_poses,
    surroundings,
    wall_clearance,
)

STUDY = np.array(WorldParameters().footprint)
OUTLINE = outline(STUDY, 0.1)
FRAME = CostFrame(-5.0, -5.0, 0.05)
OPEN = np.full((200, 200), 2.0, np.float32)
HOLD = 0.12
angles = st.floats(-math.pi, math.pi)


def around(pose, others, clearance=OPEN):
    return surroundings(clearance, FRAME, STUDY, Pose2(*pose), others, 10.0, HOLD)


def other(x, y, theta, twist=STANDSTILL):
    return Neighbour(1, Pose2(x, y, theta), twist, STUDY, np.empty((0, 2)), np.empty(0))


def is_safe(pose, twist, command, others=(), clearance=OPEN):
    return safe(around(pose, others, clearance), STUDY, OUTLINE, *pose, *twist, *command, HOLD, 10.0, 10.0, WALL_MARGIN)


@given(st.floats(-1.5, 1.5), st.floats(-1.5, 1.5), angles)
def test_the_gap_is_the_least_distance_of_any_two_points(x, y, theta):
    moved = placed_at(STUDY, x, y, theta)
    ours, theirs = outline(STUDY, 0.02), outline(moved, 0.02)
    sampled = np.hypot(ours[:, None, 0] - theirs[None, :, 0], ours[:, None, 1] - theirs[None, :, 1]).min()
    found = gap(STUDY, moved)
    assert found <= sampled + 1e-9
    if found > 0:
        assert sampled - found < 0.02
    else:
        assert sampled < 0.02 or math.hypot(x, y) < 0.5
    assert gap(moved, STUDY) == pytest.approx(found)


def test_one_inside_the_other_has_no_gap():
    assert gap(STUDY, 0.1 * STUDY) == 0.0
    assert gap(0.1 * STUDY, STUDY) == 0.0


def test_stopping_obeys_then_brakes():
    poses = stopping_poses(0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, HOLD, 10.0, 10.0)
    # 0.12 s at 1 m/s, then v^2 / 2a.
    assert poses[-1, 0] == pytest.approx(0.12 + 0.05, abs=0.03)


def test_clearance_is_measured_from_the_outline():
    x = FRAME.x + (np.arange(200) + 0.5) * 0.05
    to_wall = np.tile(np.maximum(2.0 - x, 0.0), (200, 1)).astype(np.float32)
    assert wall_clearance(to_wall, FRAME, OUTLINE, 0.0, 0.0, 0.0) == pytest.approx(1.65, abs=1e-6)
    assert wall_clearance(to_wall, FRAME, OUTLINE, 0.0, 0.0, math.pi) == pytest.approx(1.75, abs=1e-6)
    assert wall_clearance(to_wall, FRAME, OUTLINE, 4.9, 0.0, 0.0) == 0.0


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10_000))
def test_two_that_rush_at_each_other_never_touch(seed):
    """Each hears of the other one tick late, decides every five ticks, and asks for the fastest safe command."""
    rng = np.random.default_rng(seed)
    poses = [np.array([-0.9, 0.0, 0.0]), np.array([0.9, rng.uniform(-0.4, 0.4), math.pi + rng.uniform(-0.5, 0.5)])]
    speeds = [np.zeros(2), np.zeros(2)]
    commands = [np.zeros(2), np.zeros(2)]
    phases = rng.integers(0, 5, 2)
    heard = [other(*poses[0]), other(*poses[1])]
    for tick in range(150):
        for i in range(2):
            speeds[i] += np.clip(commands[i] - speeds[i], -0.2, 0.2)
            poses[i] = poses[i] + 0.02 * np.array(
                [speeds[i][0] * math.cos(poses[i][2]), speeds[i][0] * math.sin(poses[i][2]), speeds[i][1]]
            )
        for i in range(2):
            if tick % 5 == phases[i]:
                wanted = [(v, w) for v in (1.0, 0.5, 0.2, 0.1, 0.0) for w in rng.permutation([-1.0, 0.0, 1.0])]
                commands[i] = np.zeros(2)
                for command in wanted:
                    if is_safe(tuple(poses[i]), tuple(speeds[i]), command, [heard[1 - i]]):
                        commands[i] = np.array(command)
                        break
        heard = [other(*poses[i], Twist(*speeds[i])) for i in range(2)]
        assert gap(placed_at(STUDY, *poses[0]), placed_at(STUDY, *poses[1])) > 0.5 * TURNING_MARGIN


def test_a_wall_ahead_is_not_driven_into_but_along():
    x = FRAME.x + (np.arange(200) + 0.5) * 0.05
    to_wall = np.tile(np.maximum(2.0 - x, 0.0), (200, 1)).astype(np.float32)
    near = 2.0 - 0.35 - WALL_MARGIN
    assert is_safe((near - 0.25, 0.0, 0.0), (1.0, 0.0), (1.0, 0.0), clearance=to_wall)
    assert not is_safe((near - 0.1, 0.0, 0.0), (1.0, 0.0), (1.0, 0.0), clearance=to_wall)
    assert is_safe((2.0 - 0.25 - 0.05, 0.0, math.pi / 2), (0.0, 0.0), (1.0, 0.0), clearance=to_wall)


def test_where_it_is_too_near_already_it_may_go_away_but_not_nearer():
    beside = [other(0.0, 0.5 + NEIGHBOUR_MARGIN / 2, 0.0)]
    assert is_safe((0.0, 0.0, 0.0), (0.0, 0.0), (0.0, 0.0), beside)
    assert is_safe((0.0, 0.0, 0.0), (0.0, 0.0), (0.5, 0.0), beside)
    assert is_safe((0.0, 0.0, -1.0), (0.0, 0.0), (0.5, 0.0), [other(0.0, 0.7, 0.0)])
    assert not is_safe((0.0, 0.0, math.pi / 2), (0.0, 0.0), (0.5, 0.0), [other(0.0, 0.7, 0.0)])
