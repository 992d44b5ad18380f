import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from sim.costmap.costs import CostFrame
from sim.geometry import Pose2
from sim.planning.navfn import plan, potential, translation
from sim.planning.path import Path, Refused, thinned

FRAME = CostFrame(-1.0, -2.0, 0.05)


def open_room(rows=60, cols=80):
    return np.zeros((rows, cols), np.uint8)


def at(row, col, theta=0.0):
    return Pose2(FRAME.x + (col + 0.5) * 0.05, FRAME.y + (row + 0.5) * 0.05, theta)


def test_costs_are_translated_as_navfn_does():
    table = translation(allow_unknown=True)
    assert (table[0], table[100], table[252], table[253], table[254], table[255]) == (50, 130, 251, 254, 254, 253)
    assert translation(allow_unknown=False)[255] == 254


def test_a_free_way_is_nearly_straight_and_ends_with_the_goals_heading():
    path = plan(open_room(), FRAME, at(10, 10), at(45, 70, 1.25), True)
    assert isinstance(path, Path)
    assert path.length == pytest.approx(math.hypot(35, 60) * 0.05, rel=0.03)
    assert path.poses[0, :2] == pytest.approx([at(10, 10).x, at(10, 10).y])
    assert path.poses[-1] == pytest.approx([at(45, 70).x, at(45, 70).y, 1.25])


@settings(max_examples=25, deadline=None)
@given(st.lists(st.tuples(st.integers(1, 28), st.integers(1, 28)), max_size=250), st.integers(0, 200))
def test_a_way_is_found_exactly_when_there_is_one_and_it_never_crosses_a_wall(walls, cost):
    costs = np.full((30, 30), cost, np.uint8)
    for row, col in walls:
        costs[row, col] = 254
    costs[2, 2] = costs[27, 27] = cost
    path = plan(costs, FRAME, at(2, 2), at(27, 27), True)
    index = np.arange(900).reshape(30, 30)
    free = np.zeros((30, 30), bool)
    free[1:-1, 1:-1] = costs[1:-1, 1:-1] < 253
    edges = [
        (index[r, c], index[r + dr, c + dc])
        for r in range(29)
        for c in range(29)
        for dr, dc in ((0, 1), (1, 0))
        if free[r, c] and free[r + dr, c + dc]
    ]
    links = csr_matrix((np.ones(len(edges)), tuple(np.array(edges).T)), shape=(900, 900))
    steps = dijkstra(links, directed=False, indices=index[27, 27], unweighted=True)[index[2, 2]]
    if not np.isfinite(steps):
        assert isinstance(path, Refused)
        assert path.code == "no_way"
        return
    assert isinstance(path, Path)
    assert path.length <= steps * 0.05 * 1.1 + 0.1
    cols = ((path.poses[:, 0] - FRAME.x) / 0.05).astype(int)
    rows = ((path.poses[:, 1] - FRAME.y) / 0.05).astype(int)
    assert (costs[rows, cols] < 253).all()


def test_the_potential_in_the_open_is_the_distance():
    field = potential(open_room(), translation(True), 30 * 80 + 10, 30 * 80 + 60).reshape(60, 80)
    assert field[30, 30] == pytest.approx(50 * 30, rel=0.02)
    # Along diagonals the plane wave of two neighbours takes a little long.
    assert field[40, 50] == pytest.approx(50 * math.hypot(10, 10), rel=0.07)


def test_cost_is_avoided_where_there_is_a_cheaper_way():
    costs = open_room()
    costs[20:40, 20:60] = 200
    path = plan(costs, FRAME, at(30, 5), at(30, 74), True)
    assert isinstance(path, Path)
    rows = ((path.poses[:, 1] - FRAME.y) / 0.05).astype(int)
    assert rows.min() < 20 or rows.max() >= 40


@pytest.mark.parametrize(
    ("start", "goal", "code"),
    [
        (at(10, 10), at(30, 30), "goal_occupied"),
        (at(10, 10), at(30, 200), "goal_outside"),
        (at(-5, 10), at(10, 30), "start_outside"),
        (at(30, 30), at(10, 10), "start_occupied"),
        (at(10, 10), at(50, 10), "no_way"),
    ],
)
def test_refusals_say_why(start, goal, code):
    costs = open_room()
    costs[30, :] = 254
    refusal = plan(costs, FRAME, start, goal, True)
    assert isinstance(refusal, Refused)
    assert refusal.code == code
    assert refusal.sentence


def test_unknown_space_is_crossed_only_when_allowed():
    costs = open_room()
    costs[30, :] = 255
    assert isinstance(plan(costs, FRAME, at(10, 10), at(50, 10), True), Path)
    assert isinstance(plan(costs, FRAME, at(10, 10), at(50, 10), False), Refused)


def test_being_there_is_a_path_too():
    path = plan(open_room(), FRAME, at(10, 10, 0.3), at(10, 10, 2.0), True)
    assert isinstance(path, Path)
    assert path.length == 0.0
    assert path.poses[-1, 2] == 2.0


def test_thinning_keeps_the_ends():
    points = np.column_stack([np.linspace(0, 1, 51), np.zeros(51)])
    kept = thinned(points, 0.099)
    assert kept[0].tolist() == [0, 0]
    assert kept[-1].tolist() == [1, 0]
    assert len(kept) == 11
