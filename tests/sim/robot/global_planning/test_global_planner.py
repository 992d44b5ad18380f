import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import label

from sim.common.geometry import Pose2
from sim.parameters import GlobalPlannerParameters, NavfnParameters
from sim.robot.costmap.costs import CostFrame
from sim.robot.global_planning.global_planner import GlobalPlanner, orientations, passage_costs
from sim.robot.global_planning.path import Path, PlanRefusal
from sim.robot.global_planning.planners import global_planner
from sim.robot.global_planning.potential_planner import PORTION, PotentialPlanner
from sim.robot.global_planning.wave import BLOCKED, Workspace, prepare

FRAME = CostFrame(0.0, 0.0, 0.1)


def plan(costs, start, goal, **parameters):
    return PotentialPlanner(GlobalPlanner(GlobalPlannerParameters(**parameters))).plan(costs, FRAME, start, goal)


def test_costs_are_translated_as_global_planner_does():
    table = passage_costs(GlobalPlannerParameters())
    assert (table[0], table[10], table[100], table[251], table[255]) == (50, 80, 252, 252, 252)
    assert (table[252:255] == BLOCKED).all()
    assert passage_costs(GlobalPlannerParameters(allow_unknown=False))[255] == BLOCKED
    table = passage_costs(GlobalPlannerParameters(use_dijkstra=False))
    assert (table[0], table[10], table[252], table[255]) == (50, 60, 255, 255)
    assert (table[[253, 254]] == BLOCKED).all()


@pytest.mark.parametrize("use_dijkstra", [False, True])
@pytest.mark.parametrize("portion", [2, 50, 777])
def test_a_wave_that_spreads_a_portion_at_a_time_becomes_the_same(use_dijkstra, portion):
    method, space = GlobalPlanner(GlobalPlannerParameters(use_dijkstra=use_dijkstra)), Workspace(60, 80)
    for seed in range(20):
        random = np.random.default_rng(seed)
        costs = random.choice(np.array([0, 20, 60, 254], np.uint8), (60, 80), p=[0.6, 0.1, 0.1, 0.2])
        potentials = []
        for size in (PORTION, portion):
            prepare(costs, method.table, space.costs, space.potential, space.waiting)
            for _ in method.spread(space, 10.2, 30.4, 30 * 80 + 60, size):
                pass
            potentials.append(space.potential.copy())
        assert np.array_equal(*potentials)


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.tuples(st.integers(1, 18), st.integers(1, 18)), max_size=110),
    st.tuples(st.floats(0.2, 0.3), st.floats(0.2, 0.3)),
    st.booleans(),
    st.booleans(),
    st.booleans(),
    st.booleans(),
)
def test_a_way_is_found_exactly_when_there_is_one(walls, place, use_dijkstra, use_quadratic, use_grid_path, old):
    costs = np.zeros((20, 20), np.uint8)
    for row, col in walls:
        costs[row, col] = 254
    costs[2, 2] = costs[17, 17] = 0
    start = Pose2(*(min(coordinate, 0.2999) for coordinate in place), 0.0)
    goal = Pose2(1.78, 1.72, 0.4)
    path = plan(
        costs,
        start,
        goal,
        use_dijkstra=use_dijkstra,
        use_quadratic=use_quadratic,
        use_grid_path=use_grid_path,
        old_navfn_behavior=old,
    )
    passable = costs == 0
    passable[[0, -1]] = passable[:, [0, -1]] = False
    regions, _ = label(passable)
    if regions[2, 2] != regions[17, 17]:
        assert isinstance(path, PlanRefusal)
        assert path.code == "no_way"
        return
    assert isinstance(path, Path)
    assert path.poses[0, :2] == pytest.approx([start.x, start.y])
    assert path.poses[-1] == pytest.approx([1.78, 1.72, 0.4])
    cells = np.floor(path.poses[:, :2] / 0.1 + 1e-5).astype(int)
    assert passable[cells[:, 1], cells[:, 0]].all()
    assert np.hypot(*np.diff(path.poses[:, :2], axis=0).T).max() < 0.3


def test_a_path_begins_and_ends_in_between_cells_without_a_kink():
    path = plan(np.zeros((60, 60), np.uint8), Pose2(1.03, 1.08, 0.0), Pose2(4.52, 3.57, 0.0))
    assert isinstance(path, Path)
    turns = np.abs(np.diff(np.unwrap(path.poses[:-1, 2])))
    assert turns.max() < 0.2
    assert path.length == pytest.approx(math.hypot(3.49, 2.49), rel=0.02)


def test_headings_by_mode():
    corner = np.array([[0, 0], [1, 0], [2, 0], [3, 0], [3, 1], [3, 2], [3, 3.0]])
    quarter = math.pi / 2

    def by(mode, window=1):
        return orientations(corner, mode, window, 0.3, quarter + 0.6).tolist()

    forward = [0, 0, 0, math.pi / 4, quarter, quarter]
    assert by(0) == pytest.approx([0, 0, 0, 0, 0, 0, quarter + 0.6])
    assert by(1) == pytest.approx([*forward, quarter + 0.6])
    assert by(1, window=3)[3] == pytest.approx(math.pi / 4)
    assert by(1, window=3)[1] == pytest.approx(math.atan2(1, 3))
    assert by(2) == pytest.approx(np.linspace(0.3, quarter + 0.6, 7))
    # The last straight stretch begins at the fifth pose.
    assert by(3) == pytest.approx([0.3, 0, 0, math.pi / 4, quarter, quarter + 0.3, quarter + 0.6])
    assert by(4)[1:4] == pytest.approx([-math.pi, -math.pi, math.pi / 4 - math.pi])
    assert by(5)[1] == pytest.approx(-quarter)
    assert by(6)[1] == pytest.approx(quarter)
    assert [by(mode)[-1] for mode in range(7)] == pytest.approx([quarter + 0.6] * 7)


def test_the_planner_is_chosen_by_its_name_in_ros():
    costs = np.zeros((30, 30), np.uint8)
    start, goal = Pose2(0.53, 0.57, 0.0), Pose2(2.41, 2.29, 0.0)
    parameters = NavfnParameters(), GlobalPlannerParameters(orientation_mode=0)
    first = global_planner("navfn/NavfnROS", *parameters).plan(costs, FRAME, start, goal)
    second = global_planner("global_planner/GlobalPlanner", *parameters).plan(costs, FRAME, start, goal)
    assert isinstance(first, Path)
    assert isinstance(second, Path)
    assert first.poses[:-1, 2].any()
    assert not second.poses[:-1, 2].any()
