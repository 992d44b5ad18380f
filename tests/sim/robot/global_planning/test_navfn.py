import math
from pathlib import Path as Path_

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import label
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from sim.common.geometry import Pose2
from sim.parameters import GlobalPlannerParameters, NavfnParameters, RobotParameters, WorldParameters
from sim.robot.costmap.costmap_2d import Costmap2D
from sim.robot.costmap.costs import CostFrame
from sim.robot.global_planning import potential_planner
from sim.robot.global_planning.navfn import Navfn, passage_costs
from sim.robot.global_planning.path import Path, PlanRefusal
from sim.robot.global_planning.planners import global_planner
from sim.robot.global_planning.potential_planner import PORTION, PotentialPlanner
from sim.robot.global_planning.wave import BLOCKED, Workspace, prepare
from thbridge.files.map_files import read_map

FRAME = CostFrame(-1.0, -2.0, 0.05)


def open_room(rows=60, cols=80):
    return np.zeros((rows, cols), np.uint8)


def at(row, col, theta=0.0):
    return Pose2(FRAME.x + (col + 0.5) * 0.05, FRAME.y + (row + 0.5) * 0.05, theta)


def plan(costs, start, goal, **parameters):
    return PotentialPlanner(Navfn(NavfnParameters(**parameters))).plan(costs, FRAME, start, goal)


def cells_of(points):
    return (
        np.floor((points[:, 1] - FRAME.y) / 0.05 + 1e-6).astype(int),
        np.floor((points[:, 0] - FRAME.x) / 0.05 + 1e-6).astype(int),
    )


def test_costs_are_translated_as_navfn_does():
    table = passage_costs(allow_unknown=True)
    assert (table[0], table[100], table[252], table[255]) == (50, 130, 251, 253)
    assert (table[[253, 254]] == BLOCKED).all()
    assert passage_costs(allow_unknown=False)[255] == BLOCKED


def test_a_free_way_is_nearly_straight_and_ends_with_the_goals_heading():
    path = plan(open_room(), at(10, 10), at(45, 70, 1.25))
    assert isinstance(path, Path)
    assert path.length == pytest.approx(math.hypot(35, 60) * 0.05, rel=0.03)
    assert path.poses[0, :2] == pytest.approx([at(10, 10).x, at(10, 10).y])
    assert path.poses[-1] == pytest.approx([at(45, 70).x, at(45, 70).y, 1.25])
    steps = np.hypot(*np.diff(path.poses[:, :2], axis=0).T)
    # Half a cell each, but for a whole one across at the goal, beyond which the wave has not come.
    assert steps.max() < 0.0708
    assert (steps < 0.0251).sum() >= len(steps) - 2
    turns = np.abs(np.diff(np.unwrap(path.poses[1:-2, 2])))
    assert turns.max() < 0.3


def cheapest(costs, start, goal):
    """Length in cells of a cheapest way from center to center of cells, eight neighbors each, none across a corner."""
    rows, cols = costs.shape
    price = passage_costs(allow_unknown=True)[costs].astype(np.float64)
    price[price == BLOCKED] = np.inf
    price[[0, -1]] = price[:, [0, -1]] = np.inf
    index = np.arange(costs.size).reshape(costs.shape)
    begins, ends, prices = [], [], []
    for dr, dc in ((0, 1), (1, 0), (1, 1), (1, -1)):
        for r in range(rows - dr):
            for c in range(max(0, -dc), cols - max(0, dc)):
                passed = [price[r, c], price[r + dr, c + dc], price[r, c + dc], price[r + dr, c]]
                if np.isfinite(passed).all():
                    begins.append(index[r, c])
                    ends.append(index[r + dr, c + dc])
                    prices.append(math.hypot(dr, dc) * (passed[0] + passed[1]) / 2)
    links = csr_matrix((prices, (begins, ends)), shape=(costs.size, costs.size))
    _, before = dijkstra(links, directed=False, indices=index[start], return_predecessors=True)
    length, cell = 0.0, index[goal]
    while cell != index[start]:
        length += math.hypot(cell // cols - before[cell] // cols, cell % cols - before[cell] % cols)
        cell = before[cell]
    return length


@settings(max_examples=40, deadline=None)
@given(
    st.lists(st.tuples(st.integers(1, 28), st.integers(1, 28)), max_size=250),
    st.sampled_from([0, 60, 252, 255]),
    st.booleans(),
)
def test_a_way_is_found_exactly_when_there_is_one_and_it_never_crosses_a_wall(walls, cost, astar):
    costs = np.full((30, 30), cost, np.uint8)
    for row, col in walls:
        costs[row, col] = 254
    costs[2, 2] = costs[27, 27] = cost
    before = costs.copy()
    path = plan(costs, at(2, 2), at(27, 27), use_astar=astar)
    again = plan(costs, at(2, 2), at(27, 27), use_astar=astar)
    assert np.array_equal(costs, before)
    passable = costs != 254
    passable[[0, -1]] = passable[:, [0, -1]] = False
    regions, _ = label(passable)
    if regions[2, 2] != regions[27, 27]:
        assert isinstance(path, PlanRefusal)
        assert path.code == "no_way"
        return
    assert isinstance(path, Path)
    assert np.array_equal(path.poses, again.poses)
    assert path.length >= math.hypot(25, 25) * 0.05 - 1e-9
    assert path.length <= cheapest(costs, (2, 2), (27, 27)) * 0.05 * 1.1
    rows, cols = cells_of(path.poses[:, :2])
    assert passable[rows, cols].all()
    # Nor in between: no path squeezes between two cells that meet at a corner.
    along = np.linspace(0, 1, 5)[:, None, None]
    fine = (path.poses[:-1, :2] + along * np.diff(path.poses[:, :2], axis=0)).reshape(-1, 2)
    rows, cols = cells_of(fine)
    assert (passable[rows, cols] | passable[rows - 1, cols] | passable[rows, cols - 1]).all()


def field_of(costs, start, goal=None, astar=False, portion=PORTION):
    """The potential from one cell, (rows, cols), until it reaches the goal."""
    method, space = Navfn(NavfnParameters(use_astar=astar)), Workspace(*costs.shape)
    prepare(costs, method.table, space.costs, space.potential, space.waiting)
    for _ in method.spread(
        space, start[1], start[0], -1 if goal is None else goal[0] * costs.shape[1] + goal[1], portion
    ):
        pass
    return space.potential.reshape(costs.shape)


def crowded(seed):
    """A room with walls and costs at random."""
    random = np.random.default_rng(seed)
    costs = random.choice(np.array([0, 60, 200, 254], np.uint8), (60, 80), p=[0.6, 0.1, 0.1, 0.2])
    costs[30, 10] = costs[30, 60] = 0
    return costs


@pytest.mark.parametrize("astar", [False, True])
@pytest.mark.parametrize("portion", [1, 50, 777])
def test_a_wave_that_spreads_a_portion_at_a_time_becomes_the_same(astar, portion):
    for seed in range(20):
        whole, parts = (field_of(crowded(seed), (30, 10), (30, 60), astar, size) for size in (PORTION, portion))
        assert np.array_equal(whole, parts)


def test_the_potential_in_the_open_is_the_distance():
    field = field_of(open_room(), (30, 60))
    assert field[30, 30] == pytest.approx(50 * 30, rel=0.02)
    # Along diagonals the plane wave of two neighbors takes a little long.
    assert field[40, 50] == pytest.approx(50 * math.hypot(10, 10), rel=0.07)


def test_astar_looks_at_fewer_cells():
    whole = field_of(open_room(), (30, 10), (30, 60))
    some = field_of(open_room(), (30, 10), (30, 60), astar=True)
    assert (some < 1e10).sum() < 0.7 * (whole < 1e10).sum()
    assert some[30, 60] < 1e10


def test_cost_is_avoided_where_there_is_a_cheaper_way():
    costs = open_room()
    costs[20:40, 20:60] = 200
    path = plan(costs, at(30, 5), at(30, 74))
    assert isinstance(path, Path)
    rows, _ = cells_of(path.poses)
    assert rows.min() < 20 or rows.max() >= 40


@pytest.mark.parametrize(
    ("start", "goal", "code"),
    [
        (at(10, 10), at(30, 30), "goal_occupied"),
        (at(10, 10), at(30, 200), "goal_outside"),
        (at(10, 10), at(0, 30), "goal_occupied"),
        (at(-5, 10), at(10, 30), "start_outside"),
        (at(30, 30), at(10, 10), "start_occupied"),
        (at(10, 10), at(50, 10), "no_way"),
    ],
)
def test_refusals_say_why(start, goal, code):
    costs = open_room()
    costs[30, :] = 254
    refusal = plan(costs, start, goal)
    assert isinstance(refusal, PlanRefusal)
    assert refusal.code == code
    assert refusal.sentence


def test_the_robots_own_cell_is_passable_whatever_its_cost():
    costs = open_room()
    costs[10, 10] = 253
    assert isinstance(plan(costs, at(10, 10), at(30, 30)), Path)
    assert isinstance(plan(open_room(), at(0, 10), at(30, 30)), Path)


@pytest.mark.parametrize("astar", [False, True])
def test_within_the_tolerance_a_path_ends_as_near_as_can_be(astar):
    costs = open_room()
    costs[28:33, 38:43] = 254
    goal = at(30, 39, 0.5)
    assert isinstance(plan(costs, at(10, 10), goal, default_tolerance=0.09, use_astar=astar), PlanRefusal)
    path = plan(costs, at(10, 10), goal, default_tolerance=0.2, use_astar=astar)
    assert isinstance(path, Path)
    assert path.poses[-1] == pytest.approx([at(30, 37).x, at(30, 37).y, 0.5])


def test_a_goal_that_can_be_reached_is_reached_in_spite_of_a_tolerance():
    path = plan(open_room(), at(10, 10), at(30, 30), default_tolerance=0.12)
    assert isinstance(path, Path)
    assert path.poses[-1, :2] == pytest.approx([at(30, 30).x, at(30, 30).y])


def test_unknown_space_is_crossed_only_when_allowed():
    costs = open_room()
    costs[30, :] = 255
    assert isinstance(plan(costs, at(10, 10), at(50, 10)), Path)
    assert isinstance(plan(costs, at(10, 10), at(50, 10), allow_unknown=False), PlanRefusal)


def test_being_there_is_a_path_too():
    path = plan(open_room(), at(10, 10, 0.3), at(10, 10, 2.0))
    assert isinstance(path, Path)
    assert path.length == 0.0
    assert path.poses[-1, 2] == 2.0


@pytest.mark.parametrize("shared", [False, True])
def test_planners_that_share_their_room_plan_as_alone(shared):
    space = Workspace(60, 80) if shared else None
    one, other = (PotentialPlanner(Navfn(NavfnParameters(use_astar=astar)), space) for astar in (False, True))
    walls = open_room()
    walls[30, :70] = 254
    alone = plan(walls, at(10, 10), at(50, 10))
    for _ in range(2):
        assert np.array_equal(one.plan(walls, FRAME, at(10, 10), at(50, 10)).poses, alone.poses)
        assert not isinstance(other.plan(open_room(), FRAME, at(50, 5), at(5, 70)), PlanRefusal)
        assert not isinstance(other.plan(open_room(20, 20), FRAME, at(5, 5), at(15, 15)), PlanRefusal)


def ended(search):
    """The result of a search, and how many portions it takes."""
    portions = 1
    while True:
        try:
            next(search)
        except StopIteration as done:
            return done.value, portions
        portions += 1


def test_searches_that_share_their_room_take_turns(monkeypatch):
    monkeypatch.setattr(potential_planner, "PORTION", 500)
    space = Workspace(60, 80)
    first, second, third = (PotentialPlanner(Navfn(NavfnParameters()), space) for _ in range(3))
    began = first.search(open_room(), FRAME, at(10, 10), at(50, 70))
    next(began)
    waits = second.search(open_room(), FRAME, at(50, 10), at(5, 70))
    next(waits)
    last = third.search(open_room(), FRAME, at(50, 10), at(5, 5))
    for _ in range(20):
        next(last)
    # Who gives up leaves the room to the next.
    began.close()
    path, portions = ended(waits)
    assert np.array_equal(path.poses, plan(open_room(), at(50, 10), at(5, 70)).poses)
    assert portions > 3
    assert np.array_equal(ended(last)[0].poses, plan(open_room(), at(50, 10), at(5, 5)).poses)


MAPS = Path_(__file__).parents[4] / "maps"


@pytest.mark.parametrize("name", sorted(folder.name for folder in MAPS.iterdir() if folder.is_dir()))
@pytest.mark.parametrize("base_global_planner", ["navfn/NavfnROS", "global_planner/GlobalPlanner"])
@pytest.mark.parametrize("astar", [False, True])
def test_on_the_maps_that_come_with_it_no_search_takes_more_than_a_portion(name, base_global_planner, astar):
    place, software = read_map(MAPS / name), RobotParameters()
    costmap = Costmap2D(software.global_costmap, np.array(WorldParameters().footprint), place.grid)
    costmap.update(0.0, 0.0)
    planner = global_planner(
        base_global_planner, NavfnParameters(use_astar=astar), GlobalPlannerParameters(use_dijkstra=not astar)
    )
    costs = costmap.costs.copy()
    # A goal that no wave reaches: it spreads over all of the map.
    middle = costs.shape[0] // 2, costs.shape[1] // 2
    costs[middle[0] - 2 : middle[0] + 3, middle[1] - 2 : middle[1] + 3] = 254
    costs[middle] = 0
    x, y = place.grid.centre_of(*middle)
    path, portions = ended(planner.search(costs, costmap.frame, place.starts[0], Pose2(x, y, 0.0)))
    assert path.code == "no_way"
    assert portions == 1


def test_a_planner_keeps_nothing_from_plan_to_plan():
    planner = PotentialPlanner(Navfn(NavfnParameters()))
    walls = open_room()
    walls[30, :70] = 254
    small = open_room(20, 20)
    first = planner.plan(walls, FRAME, at(10, 10), at(50, 10))
    planner.plan(small, FRAME, at(5, 5), at(15, 15))
    planner.plan(open_room(), FRAME, at(10, 10), at(50, 10))
    again = planner.plan(walls, FRAME, at(10, 10), at(50, 10))
    assert np.array_equal(first.poses, again.poses)
