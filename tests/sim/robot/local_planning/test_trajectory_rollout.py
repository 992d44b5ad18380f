import math
from collections import deque

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import distance_transform_edt

from sim.common.geometry import Pose2
from sim.common.observations import STANDSTILL, Twist
from sim.parameters import InflationParameters, RobotParameters, WorldParameters
from sim.robot.costmap.costs import CostFrame
from sim.robot.local_planning.braking import surroundings
from sim.robot.local_planning.map_grid import index_of, map_grids, spread, survey
from sim.robot.local_planning.trajectory_rollout import TrajectoryPlanner

STUDY = np.array(WorldParameters().footprint)
FRAME = CostFrame(-2.0, -2.0, 0.05)
OPEN = np.zeros((80, 80), np.uint8)
FAR = np.full((80, 80), 2.0, np.float32)
ALL = np.empty(0, np.int32)
AHEAD = np.column_stack([np.linspace(0.0, 1.9, 20), np.zeros(20)])


def planner():
    return TrajectoryPlanner(RobotParameters().TrajectoryPlannerROS, STUDY, InflationParameters(), (80, 80), 0.1)


def around(pose, clearance=FAR):
    return surroundings(clearance, FRAME, STUDY, pose, [], 10.0, 0.12)


def follow(pose, path, twist=STANDSTILL, costs=OPEN, slow_down=0.1, clearance=FAR):
    return planner().follow(pose, twist, costs, FRAME, path, slow_down, around(pose, clearance))


@settings(max_examples=30, deadline=None)
@given(st.lists(st.tuples(st.integers(0, 19), st.integers(0, 19)), max_size=120), st.integers(0, 19))
def test_steps_are_counted_as_a_breadth_first_search_does(walls, seed_col):
    costs = np.zeros((20, 20), np.uint8)
    for row, col in walls:
        costs[row, col] = 254
    frame = CostFrame(0.0, 0.0, 1.0)
    grid = map_grids(20, 20)
    survey(costs, frame, -9.0, -9.0, 0.0, grid.terrain)
    spread(grid, 20, np.array([index_of(costs, frame, seed_col + 0.5, 3.5)], np.int32), ALL, grid.path)
    steps = grid.path.reshape(22, 22)[1:-1, 1:-1]
    expected = {(3, seed_col): 0}
    waiting = deque(expected)
    while waiting:
        row, col = waiting.popleft()
        for cell in ((row + 1, col), (row - 1, col), (row, col + 1), (row, col - 1)):
            if min(cell) >= 0 and max(cell) < 20 and costs[cell] < 253 and cell not in expected:
                expected[cell] = expected[row, col] + 1
                waiting.append(cell)
    assert {cell: int(count) for cell, count in np.ndenumerate(steps) if count >= 0} == expected


@settings(max_examples=30, deadline=None)
@given(
    st.lists(st.tuples(st.integers(0, 19), st.integers(0, 19)), max_size=120),
    st.lists(st.tuples(st.integers(0, 19), st.integers(0, 19)), min_size=1, max_size=8),
)
def test_steps_that_are_asked_for_are_the_same_without_the_others(walls, asked):
    costs = np.zeros((20, 20), np.uint8)
    for row, col in walls:
        costs[row, col] = 254
    frame = CostFrame(0.0, 0.0, 1.0)
    grid = map_grids(20, 20)
    survey(costs, frame, -9.0, -9.0, 0.0, grid.terrain)
    seeds = np.array([index_of(costs, frame, 4.5, 3.5)], np.int32)
    looked_at = np.array([index_of(costs, frame, col + 0.5, row + 0.5) for row, col in asked], np.int32)
    spread(grid, 20, seeds, ALL, grid.path)
    spread(grid, 20, seeds, looked_at, grid.goal)
    reached = grid.path[looked_at] >= 0
    assert grid.goal[looked_at][reached].tolist() == grid.path[looked_at][reached].tolist()
    assert (grid.goal[looked_at][~reached] < 0).all()
    assert not grid.wanted.any()


def test_a_straight_path_is_driven_straight_and_fast():
    drive = follow(Pose2(0.0, 0.0, 0.0), AHEAD)
    assert drive.command == Twist(1.0, 0.0)
    assert drive.local_plan[0].tolist() == [0.0, 0.0, 0.0]
    assert drive.local_plan[-1, 0] > 1.2


def test_it_slows_toward_the_end():
    path = AHEAD[:6]
    drive = follow(Pose2(0.0, 0.0, 0.0), path, slow_down=1.7)
    assert drive.command.linear == pytest.approx(0.5 / 1.7)


def test_facing_away_it_turns_in_place_and_only_then_sets_out():
    local = planner()
    pose = Pose2(0.0, 0.0, 2.0)
    drive = local.follow(pose, STANDSTILL, OPEN, FRAME, AHEAD, 0.1, around(pose))
    assert drive.command == Twist(0.0, -1.0)
    pose = Pose2(0.0, 0.0, 0.5)
    drive = local.follow(pose, STANDSTILL, OPEN, FRAME, AHEAD, 0.1, around(pose))
    assert drive.command.linear == 0.0
    pose = Pose2(0.0, 0.0, 0.2)
    drive = local.follow(pose, STANDSTILL, OPEN, FRAME, AHEAD, 0.1, around(pose))
    assert drive.command.linear > 0.5


def test_an_obstacle_on_the_path_is_gone_around():
    costs = OPEN.copy()
    costs[36:42, 58:62] = 254
    drive = follow(Pose2(0.0, 0.0, 0.0), AHEAD, costs=costs)
    assert not drive.stuck
    assert abs(drive.command.angular) > 0.05 or drive.command.linear < 1.0


def test_nose_to_a_wall_it_is_stuck_and_backs_up():
    x = FRAME.x + (np.arange(80) + 0.5) * 0.05
    clearance = np.tile(np.maximum(0.38 - x, 0.0), (80, 1)).astype(np.float32)
    costs = OPEN.copy()
    costs[:, x > 0.38] = 254
    pose = Pose2(0.0, 0.0, 0.0)
    drive = follow(pose, AHEAD[:5], costs=costs, clearance=clearance)
    assert drive.stuck
    assert drive.command == STANDSTILL
    back = planner().escape(pose, STANDSTILL, around(pose, clearance))
    assert back.command.linear < 0
    assert not back.stuck


def test_where_no_command_leads_on_it_turns_to_the_heading_from_which_one_does():
    """Something on the right half of what is ahead, and a path past it on the left."""
    x, y = np.meshgrid(FRAME.x + (np.arange(80) + 0.5) * 0.05, FRAME.y + (np.arange(80) + 0.5) * 0.05)
    costs = np.where((x > 0.4) & (x < 0.6) & (y < 0.1), 254, 0).astype(np.uint8)
    clearance = (distance_transform_edt(costs == 0) * 0.05).astype(np.float32)
    path = np.column_stack([np.linspace(0.0, 0.9, 20), np.linspace(0.0, 1.2, 20)])
    local, pose = planner(), Pose2(0.0, 0.0, 0.0)
    for _ in range(40):
        drive = local.follow(pose, STANDSTILL, costs, FRAME, path, 0.1, around(pose, clearance))
        assert not drive.stuck
        if drive.command.linear > 0.0:
            break
        assert drive.command.angular > 0.0
        pose = Pose2(0.0, 0.0, pose.theta + 0.1 * drive.command.angular)
    assert drive.command.linear > 0.0
    assert pose.theta > 0.1


@pytest.mark.parametrize(("padding", "safe"), [(0.0, False), (0.01, False), (0.1, True)])
def test_what_a_footprint_is_padded_by_is_not_kept_from_walls_once_more(padding, safe):
    """Into a passage that leaves 5 cm on either side of the padded footprint."""
    x, y = np.meshgrid(FRAME.x + (np.arange(80) + 0.5) * 0.05, FRAME.y + (np.arange(80) + 0.5) * 0.05)
    clearance = (np.where(x > 0.35, 0.3, 0.6) - np.abs(y)).clip(0.0).astype(np.float32)
    robot = RobotParameters().TrajectoryPlannerROS
    local = TrajectoryPlanner(robot, STUDY, InflationParameters(), (80, 80), 0.1, padding)
    pose = Pose2(0.0, 0.0, 0.0)
    assert local.safe(pose, Twist(1.0, 0.0), Twist(1.0, 0.0), around(pose, clearance)) == safe


def test_with_little_margin_it_backs_up_only_the_way_it_came():
    """The costmap forgets what lies under the padded outline, and the laser does not see behind."""
    robot = RobotParameters().TrajectoryPlannerROS
    local = TrajectoryPlanner(robot, STUDY, InflationParameters(), (80, 80), 0.1, 0.1)
    came = Pose2(0.0, 0.0, 0.0)
    assert local.follow(came, STANDSTILL, OPEN, FRAME, AHEAD, 0.1, around(came)).command.linear > 0.0
    assert local.escape(Pose2(0.0, 0.0, 0.05), STANDSTILL, around(came)).command.linear < 0.0
    assert local.escape(Pose2(0.0, 0.0, 0.3), STANDSTILL, around(came)).command.linear >= 0.0


def test_a_robot_of_no_size_escapes_too():
    point = np.zeros((16, 2))
    local = TrajectoryPlanner(RobotParameters().TrajectoryPlannerROS, point, InflationParameters(), (80, 80), 0.1)
    pose = Pose2(0.0, 0.0, 0.0)
    drive = local.escape(pose, STANDSTILL, surroundings(FAR, FRAME, point, pose, [], 10.0, 0.12))
    assert drive.command.linear < 0.0


def test_with_a_wall_behind_it_escapes_forwards_and_does_not_go_back():
    x = FRAME.x + (np.arange(80) + 0.5) * 0.05
    clearance = np.tile(np.maximum(x + 0.34, 0.0), (80, 1)).astype(np.float32)
    local, pose = planner(), Pose2(0.0, 0.0, 0.0)
    for _ in range(10):
        drive = local.escape(pose, STANDSTILL, around(pose, clearance))
        assert drive.command.linear > 0
        pose = Pose2(pose.x + 0.1 * drive.command.linear, 0.0, 0.0)


def test_between_two_walls_it_does_not_turn_to_and_fro_but_says_that_it_is_stuck():
    y = FRAME.y + (np.arange(80) + 0.5) * 0.05
    clearance = np.repeat(np.maximum(0.4 - np.abs(y), 0.0)[:, np.newaxis], 80, axis=1).astype(np.float32)
    local, pose, turns = planner(), Pose2(0.0, 0.0, 0.0), []
    for _ in range(100):
        drive = local.turn(pose, STANDSTILL, 1.5, around(pose, clearance))
        if drive.stuck:
            break
        turns.append(math.copysign(1.0, drive.command.angular))
        pose = Pose2(0.0, 0.0, pose.theta + 0.1 * drive.command.angular)
    assert drive.stuck
    assert len(turns) > 1
    assert turns == sorted(turns, reverse=True)


@pytest.mark.parametrize("heading", [0.3, -2.0, 3.0])
def test_turning_ends_at_the_heading(heading):
    local, pose = planner(), Pose2(0.0, 0.0, 0.0)
    for _ in range(100):
        drive = local.turn(pose, STANDSTILL, heading, around(pose))
        pose = Pose2(0.0, 0.0, pose.theta + 0.1 * drive.command.angular)
        if abs(math.remainder(heading - pose.theta, math.tau)) < 0.05:
            return
    pytest.fail(f"still at {pose.theta}")
