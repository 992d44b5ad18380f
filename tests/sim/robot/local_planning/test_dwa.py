import math
from dataclasses import replace

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.observations import STANDSTILL, Twist
from sim.parameters import DwaPlannerParameters, InflationParameters, TrajectoryPlannerParameters, WorldParameters
from sim.robot.costmap.costs import CostFrame
from sim.robot.local_planning.braking import surroundings
from sim.robot.local_planning.dwa import DwaPlanner
from sim.robot.local_planning.local_planner import STALL_TIMEOUT
from sim.robot.local_planning.rollout import MotionState
from sim.robot.local_planning.trajectory_rollout import TrajectoryPlanner

STUDY = np.array(WorldParameters().footprint)
FRAME = CostFrame(-2.5, -2.5, 0.05)
OPEN = np.zeros((100, 100), np.uint8)
FAR = np.full((100, 100), 2.0, np.float32)
AHEAD = np.column_stack([np.linspace(0.0, 1.9, 20), np.zeros(20)])
PERIOD = 0.1
BARE = InflationParameters(inflation_radius=0.0)
"""The costs here are drawn without inflation."""
HERE = Pose2(0.0, 0.0, 0.0)
FAST = Twist(0.5, 0.0)


def dwa(**changes):
    return DwaPlanner(DwaPlannerParameters(**changes), STUDY, BARE, OPEN.shape, PERIOD)


def rollout(**changes):
    return TrajectoryPlanner(TrajectoryPlannerParameters(**changes), STUDY, BARE, OPEN.shape, PERIOD)


def follow(planner, pose=HERE, twist=FAST, path=AHEAD, costs=OPEN, slow_down=0.1):
    around = surroundings(FAR, FRAME, STUDY, pose, [], 2.5, PERIOD + 0.02)
    return planner.follow(pose, twist, costs, FRAME, path, slow_down, around)


def walls(*boxes):
    """Costs that are lethal in boxes (x0, y0, x1, y1), meters, and nothing around them."""
    costs = OPEN.copy()
    for x0, y0, x1, y1 in boxes:
        rows = slice(round((y0 - FRAME.y) / 0.05), round((y1 - FRAME.y) / 0.05))
        costs[rows, round((x0 - FRAME.x) / 0.05) : round((x1 - FRAME.x) / 0.05)] = 254
    return costs


def test_a_straight_path_is_driven_straight_and_as_fast_as_may_be() -> None:
    assert follow(dwa()).command == Twist(0.55, 0.0)


def test_only_what_the_next_period_reaches_is_tried() -> None:
    assert follow(dwa(acc_lim_x=1.0), twist=STANDSTILL).command.linear == pytest.approx(1.0 * PERIOD)
    assert follow(dwa(acc_lim_x=1.0, use_dwa=False), twist=STANDSTILL).command.linear == pytest.approx(0.55)


def test_speeds_keep_to_their_limits() -> None:
    assert follow(dwa(max_vel_trans=0.3), twist=Twist(0.3, 0.0)).command.linear == pytest.approx(0.3)
    assert follow(dwa(), path=AHEAD[:4], twist=Twist(0.2, 0.0), slow_down=1.7).command.linear <= 0.3 / 1.7 + 1e-9
    least = follow(dwa(), path=AHEAD[:3], twist=STANDSTILL, slow_down=10.0).command
    assert least.linear >= 0.1 - 1e-9 or abs(least.angular) >= 0.4


def test_a_path_to_the_side_is_turned_to() -> None:
    aside = np.column_stack([np.linspace(0.0, 1.2, 20), np.linspace(0.0, 1.2, 20)])
    assert follow(dwa(), path=aside).command.angular > 0.2
    assert follow(dwa(), path=aside * [1, -1]).command.angular < -0.2


def test_twirling_has_its_price() -> None:
    aside = np.column_stack([np.linspace(0.0, 1.8, 20), np.linspace(0.0, 0.6, 20)])
    assert follow(dwa(), path=aside).command.angular > 0.0
    assert follow(dwa(twirling_scale=100.0), path=aside).command.angular == 0.0


def test_the_footprint_grows_with_the_speed() -> None:
    # 0.4 m on either side: the body's 0.25 fits, a tenth more does, twice as much does not.
    gap = walls((0.6, 0.4, 2.0, 0.7), (0.6, -0.7, 2.0, -0.4))
    narrow = {"occdist_scale": 0.0, "acc_lim_x": 10.0, "vx_samples": 12}
    fast = follow(dwa(max_scaling_factor=0.1, **narrow), costs=gap).command
    slow = follow(dwa(max_scaling_factor=1.0, **narrow), costs=gap).command
    assert fast.linear == pytest.approx(0.55)
    assert slow.linear < 0.45


def test_costs_along_the_way_may_be_added_up() -> None:
    costs = OPEN.copy()
    costs[48:53, 52:] = 40
    worst = follow(dwa(occdist_scale=0.001), costs=costs).command
    total = follow(dwa(occdist_scale=0.001, sum_scores=True), costs=costs).command
    assert worst.linear > 0.5
    assert total.linear < worst.linear or abs(total.angular) > 0.1


def test_what_turned_one_way_in_place_does_not_turn_back_at_once() -> None:
    planner = dwa()
    oscillation = planner._oscillation
    now = motion(0.0)
    oscillation.took(now, 0.0, 0.5, 0.1)
    assert oscillation.only[1] == 0.0
    oscillation.took(now, 0.0, -0.5, 0.1)
    assert oscillation.only[1] == -1.0
    oscillation.took(motion(-0.1), 0.0, -0.5, 0.1)
    assert oscillation.only[1] == -1.0
    oscillation.took(motion(-0.3), 0.0, -0.5, 0.1)
    assert oscillation.only[1] == 0.0


def motion(theta):
    return MotionState(0.0, 0.0, theta, 0.0, 0.0)


@pytest.mark.parametrize("make", [dwa, rollout])
def test_where_costs_outweigh_the_way_it_goes_on_after_a_while(make) -> None:
    costs = np.full_like(OPEN, 200)
    costs[:, :57] = 0
    planner = make(occdist_scale=5.0)
    commands = [
        follow(planner, twist=STANDSTILL, costs=costs).command for _ in range(round(STALL_TIMEOUT / PERIOD) + 2)
    ]
    assert follow(make(occdist_scale=0.0), twist=STANDSTILL, costs=costs).command.linear > 0.2
    # It may go to the edge of what costs something, or turn; it does not go in.
    assert commands[0].linear * 1.7 < 0.37
    assert commands[-1].linear > 0.2


@pytest.mark.parametrize("make", [dwa, rollout])
def test_comfort_is_kept_where_there_is_room(make) -> None:
    # A wall just beside the straight way: the outline would pass it with 3 cm to spare.
    beside = walls((0.5, 0.3, 2.2, 0.35))
    drive = follow(make(occdist_scale=0.0), costs=beside)
    assert not drive.stuck
    assert drive.local_plan[-1, 1] < -0.01 or drive.command.linear < 0.3


def test_a_bias_in_metres_is_the_same_on_every_grid() -> None:
    for parameters in (TrajectoryPlannerParameters(meter_scoring=True), TrajectoryPlannerParameters()):
        planner = TrajectoryPlanner(parameters, STUDY, BARE, OPEN.shape, PERIOD)
        # A cost of 100 against 0.9 m of way: in meters the cost wins, in cells the way.
        costs = OPEN.copy()
        costs[:, 56:] = 100
        command = follow(planner, twist=STANDSTILL, costs=costs).command
        assert (command.linear > 0.4) != parameters.meter_scoring


def test_the_window_of_trajectory_rollout_may_be_dynamic() -> None:
    assert follow(rollout(acc_lim_x=1.0), twist=STANDSTILL).command.linear > 0.5
    assert follow(rollout(acc_lim_x=1.0, dwa=True), twist=STANDSTILL).command.linear == pytest.approx(0.1)


def test_a_simple_attractor_knows_no_way_around() -> None:
    # A bar across the path, open at one side only: 3 m round it.
    bar = walls((0.6, -2.4, 0.7, 0.5))
    path = np.array([(0.0, 0.0), (0.3, 0.3), (0.35, 0.7), (0.6, 1.0), (1.0, 0.9), (1.2, 0.0)])
    around = follow(rollout(), costs=bar, path=path, twist=STANDSTILL)
    straight = follow(rollout(simple_attractor=True), costs=bar, path=path, twist=STANDSTILL)
    assert around.local_plan[-1, 1] > straight.local_plan[-1, 1] + 0.1


def test_headings_may_be_scored_early_on() -> None:
    aside = np.column_stack([np.linspace(0.0, 1.2, 20), np.linspace(0.0, 1.2, 20)])
    scored = rollout(heading_scoring=True, heading_scoring_timestep=0.8, path_distance_bias=0.0, goal_distance_bias=0.0)
    command = follow(scored, path=aside, twist=STANDSTILL).command
    assert 0.8 * command.angular == pytest.approx(math.pi / 4, abs=0.12)


def test_a_turn_begun_is_not_turned_back_until_the_robot_has_moved() -> None:
    def turned(planner, pose, heading):
        around = surroundings(FAR, FRAME, STUDY, pose, [], 2.5, PERIOD + 0.02)
        return planner.turn(pose, STANDSTILL, heading, around).command.angular

    planner = rollout()
    assert turned(planner, HERE, 3.1) > 0
    assert turned(planner, HERE, -3.1) > 0
    assert turned(planner, replace(HERE, x=0.06), -3.1) < 0
