"""Plans to places near a goal that cannot be reached."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.parameters import GlobalPlannerParameters, NavfnParameters
from sim.robot.costmap.costs import INSCRIBED, LETHAL, CostFrame
from sim.robot.global_planning.make_plan import make_plan
from sim.robot.global_planning.path import Path, PlanRefusal
from sim.robot.global_planning.planners import global_planner

FRAME = CostFrame(-1.0, 2.0, 0.05)
SHAPE = (60, 80)
START = Pose2(-0.5, 2.5, 0.0)
PLANNERS = ("navfn/NavfnROS", "global_planner/GlobalPlanner")


def planner_of(name):
    return global_planner(name, NavfnParameters(), GlobalPlannerParameters())


def in_the_order_of_ros(goal, tolerance):
    """Places at which move_base's make_plan looks for a goal that it can reach, written down as its five loops."""
    step = min(3 * FRAME.resolution, tolerance)
    tried = [(0.0, 0.0)]
    ring = 1
    while ring * step <= tolerance + 1e-9:
        for up in range(ring + 1):
            for right in range(ring + 1):
                if right == ring or up == ring:
                    tried += [(dx * right, dy * up) for dy in (-1, 1) for dx in (-1, 1)]
        ring += 1
    return [Pose2(goal.x + dx * step, goal.y + dy * step, goal.theta) for dx, dy in tried]


@pytest.mark.parametrize("name", PLANNERS)
@given(seed=st.integers(0, 2**32 - 1), tolerance=st.floats(0.02, 1.2))
def test_the_plan_is_that_to_the_first_place_to_which_there_is_one(name, seed, tolerance):
    random = np.random.default_rng(seed)
    costs = np.zeros(SHAPE, np.uint8)
    for _ in range(12):
        row, col = random.integers(0, SHAPE[0]), random.integers(0, SHAPE[1])
        costs[row : row + random.integers(2, 20), col : col + random.integers(2, 20)] = random.choice(
            [LETHAL, INSCRIBED]
        )
    costs[5:15, 5:15] = 0
    x, y = random.uniform((-1.5, 1.5), (3.5, 5.5)).tolist()
    goal = Pose2(x, y, 0.7)
    planner = planner_of(name)
    paths = [planner.plan(costs, FRAME, START, place) for place in in_the_order_of_ros(goal, tolerance)]
    expected = next((path.poses for path in paths if isinstance(path, Path)), paths[0])
    found = make_plan(planner_of(name), costs, FRAME, START, goal, tolerance, add_unreachable_goal=False)
    if isinstance(expected, PlanRefusal):
        assert found == expected
    else:
        assert np.array_equal(found, expected)


def test_the_goal_itself_follows_where_that_is_asked_for():
    costs = np.zeros(SHAPE, np.uint8)
    costs[30:40, 30:40] = LETHAL
    goal = Pose2(0.75, 3.75, 0.3)
    short, long = (make_plan(planner_of(PLANNERS[0]), costs, FRAME, START, goal, 1.0, add) for add in (False, True))
    assert np.array_equal(long, np.vstack([short, [0.75, 3.75, 0.3]]))


def test_from_within_an_obstacle_there_is_no_plan():
    costs = np.full(SHAPE, LETHAL, np.uint8)
    assert isinstance(
        make_plan(planner_of(PLANNERS[0]), costs, FRAME, START, Pose2(1.0, 3.0, 0.0), 1.0, True), PlanRefusal
    )


@pytest.mark.parametrize("name", PLANNERS)
def test_what_is_reached_is_where_there_are_plans_to(name):
    costs = np.zeros(SHAPE, np.uint8)
    costs[25] = LETHAL
    reached = planner_of(name).reached(costs, FRAME, START)
    assert reached[1:24, 1:-1].all()
    assert not reached[25:].any()
    assert not planner_of(name).reached(costs, FRAME, Pose2(99.0, 0.0, 0.0)).any()
