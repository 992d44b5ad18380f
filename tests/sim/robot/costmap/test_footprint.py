import math

import numpy as np
import pytest
from hypothesis import assume, given
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


def distance_to_outline(x: float, y: float, theta: float, row: int, col: int) -> float:
    """Meters from a cell's center to the outline of a footprint at a pose."""
    c, s = math.cos(theta), math.sin(theta)
    points = outline(STUDY, 0.005) @ np.array([[c, s], [-s, c]]) + [x, y]
    return float(np.hypot(*(points - [(col + 0.5) * 0.05, (row + 0.5) * 0.05]).T).min())


COORDINATES, ANGLES = st.floats(1.0, 3.0), st.floats(-4.0, 4.0)


# The corners of an outline go to the middles of their cells, and its sides in steps of whole cells: each cell that is
# looked at lies within a cell and a half of the true side.
@given(st.integers(20, 59), st.integers(20, 59), ANGLES, st.floats(0.0, 1.0))
def test_an_obstacle_of_three_cells_under_the_outline_is_seen(row, col, theta, share):
    points = outline(STUDY, 0.005)
    px, py = points[round(share * (len(points) - 1))]
    c, s = math.cos(theta), math.sin(theta)
    x, y = (col + 0.5) * 0.05 - (c * px - s * py), (row + 0.5) * 0.05 - (s * px + c * py)
    costs = np.zeros((80, 80), np.uint8)
    costs[row - 1 : row + 2, col - 1 : col + 2] = 254
    assert footprint_cost(costs, FRAME, STUDY, x, y, theta) == COLLIDES


@given(COORDINATES, COORDINATES, ANGLES, st.integers(0, 79), st.integers(0, 79))
def test_a_lethal_cell_off_the_outline_does_not_matter(x, y, theta, row, col):
    assume(distance_to_outline(x, y, theta, row, col) > 0.1)
    costs = np.zeros((80, 80), np.uint8)
    costs[row, col] = 254
    assert footprint_cost(costs, FRAME, STUDY, x, y, theta) == 0.0


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
