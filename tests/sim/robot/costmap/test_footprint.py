import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.parameters import WorldParameters
from sim.robot.costmap.costs import CostFrame
from sim.robot.costmap.footprint import outline, pad, radii
from sim.robot.costmap.footprint_cost import COLLIDES, footprint_cost

STUDY = np.array(WorldParameters().footprint)
FRAME = CostFrame(0.0, 0.0, 0.05)


def test_radii_of_the_study_robot():
    inscribed, circumscribed = radii(STUDY)
    assert inscribed == pytest.approx(0.25)
    assert circumscribed == pytest.approx(math.hypot(0.25, 0.25))


def test_padding_moves_corners_outward_and_leaves_zero_alone():
    padded = pad(STUDY, 0.01)
    assert padded[0].tolist() == pytest.approx([0.26, 0.26])
    assert padded[2].tolist() == pytest.approx([-0.26, -0.26])
    assert padded[4].tolist() == pytest.approx([0.36, 0.0])


def test_outline_has_the_corners_and_no_gap():
    points = outline(STUDY, 0.1)
    for corner in STUDY:
        assert np.hypot(*(points - corner).T).min() == 0.0
    assert np.hypot(*(np.roll(points, -1, axis=0) - points).T).max() <= 0.1 + 1e-9


@settings(deadline=None)
@given(st.floats(1.0, 3.0), st.floats(1.0, 3.0), st.floats(-4.0, 4.0), st.integers(0, 79), st.integers(0, 79))
def test_a_lethal_cell_matters_when_the_outline_runs_over_it_and_not_when_it_is_clear_of_it(x, y, theta, row, col):
    costs = np.zeros((80, 80), np.uint8)
    costs[row, col] = 254
    c, s = math.cos(theta), math.sin(theta)
    points = outline(STUDY, 0.005) @ np.array([[c, s], [-s, c]]) + [x, y]
    centre = np.array([(col + 0.5) * 0.05, (row + 0.5) * 0.05])
    nearest = np.hypot(*(points - centre).T).min()
    cost = footprint_cost(costs, FRAME, STUDY, x, y, theta)
    if nearest < 0.005:
        assert cost == COLLIDES
    if nearest > 0.1:
        assert cost == 0.0


def test_the_greatest_cost_under_the_outline_counts():
    costs = np.full((80, 80), 7, np.uint8)
    costs[:, 45] = 99
    assert footprint_cost(costs, FRAME, STUDY, 2.0, 2.0, 0.0) == 99
    assert footprint_cost(costs, FRAME, STUDY, 1.0, 2.0, 0.0) == 7


def test_leaving_the_costmap_or_known_space_collides():
    costs = np.zeros((80, 80), np.uint8)
    assert footprint_cost(costs, FRAME, STUDY, 0.2, 2.0, 0.0) == COLLIDES
    costs[:, 45] = 255
    assert footprint_cost(costs, FRAME, STUDY, 2.0, 2.0, 0.0) == COLLIDES
