"""Costs of a costmap at points and under a robot's footprint."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.robot.costmap.costs import INSCRIBED, LETHAL, UNKNOWN
from sim.robot.costmap.robot_costmap import RobotCostmap

SQUARE = np.array([[0.2, 0.2], [-0.2, 0.2], [-0.2, -0.2], [0.2, -0.2]])
START = Pose2(0.0, 0.0, 0.0)


def costmap(cells, origin=START):
    costs = np.zeros((20, 30), np.uint8)
    for (row, col), cost in cells.items():
        costs[row, col] = cost
    return RobotCostmap(0, START, origin, 0.1, costs, SQUARE, circular=False)


def test_the_cost_of_a_cell_and_outside():
    now = costmap({(3, 7): 99}, Pose2(1.0, -1.0, 0.0))
    assert now.cost_at(Pose2(1.75, -0.65, 0.0)) == 99
    assert now.cost_at(Pose2(1.85, -0.65, 0.0)) == 0
    assert now.cost_at(Pose2(0.99, -0.65, 0.0)) is None
    assert now.cost_at(Pose2(4.01, -0.65, 0.0)) is None


def test_the_cost_under_the_outline_is_the_highest():
    # The outline of a robot at (1, 1) runs through the cells 8 and 12.
    base = Pose2(1.05, 1.05, 0.0)
    assert costmap({(10, 10): LETHAL}).footprint_cost(base) == 0
    assert costmap({(8, 10): 40, (12, 9): 70}).footprint_cost(base) == 70
    assert costmap({(8, 10): INSCRIBED}).footprint_cost(base) == INSCRIBED
    assert costmap({(8, 10): UNKNOWN, (12, 9): 70}).footprint_cost(base) == UNKNOWN
    assert costmap({(8, 10): UNKNOWN, (12, 9): LETHAL}).footprint_cost(base) == LETHAL
    assert costmap({}).footprint_cost(Pose2(0.1, 1.0, 0.0)) == LETHAL


@given(
    st.dictionaries(st.tuples(st.integers(0, 19), st.integers(0, 29)), st.integers(0, 255), max_size=30),
    st.floats(-0.5, 3.5),
    st.floats(-0.5, 2.5),
    st.floats(-3.0, 3.0),
)
def test_a_turned_map_has_the_same_costs(cells, x, y, theta):
    origin, base = Pose2(2.0, -3.0, math.pi / 2), Pose2(x, y, theta)
    straight, turned = costmap(cells), costmap(cells, origin)
    back = origin.inverse().compose(origin.compose(base))
    assert turned.cost_at(origin.compose(base)) == straight.cost_at(back)
    assert turned.footprint_cost(origin.compose(base)) == straight.footprint_cost(back)
