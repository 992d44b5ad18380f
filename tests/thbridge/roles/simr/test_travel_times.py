"""What moves cost from anywhere on a map: more the farther it is, and the file's own costs in the rooms."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from thbridge.app.compose.robots import build_travel_times
from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.offline.plan import costmap
from thbridge.roles.keeper.disclosed.disclosure import plain_costs
from thbridge.roles.simr.travel_times import AT_GOAL, TravelTimes, non_negative_weights
from thbridge.study.study_file import CostModel, GameSection, Study

POSITION = GameSection(cost_model=CostModel.POSITION)


def setting_of(place: str) -> StudySetting:
    return read_setting(Study(map=place, game=POSITION), Path())


@pytest.fixture(scope="module")
def arena() -> TravelTimes:
    return build_travel_times(setting_of("arena8"))


def test_the_room_next_door_costs_less_than_the_far_one(arena: TravelTimes) -> None:
    rooms = setting_of("arena8").map.rooms
    for room in rooms:
        costs = arena.costs_from(room.goal.compose(Pose2(-1.1 * AT_GOAL, 0.0, 0.0)))
        assert min(cost for cost in costs if cost is not None) == costs[room.room.people]


def test_at_a_rooms_goal_the_costs_are_those_of_the_file_and_the_room_itself_is_near(arena: TravelTimes) -> None:
    setting = setting_of("arena8")
    rows = plain_costs(setting.costs)
    for room in setting.map.rooms:
        costs, number = arena.costs_from(room.goal), room.room.people
        assert costs[:number] == rows[number][:number] and costs[number + 1 :] == rows[number][number + 1 :]
        itself = costs[number]
        assert itself is not None and itself <= min(cost for cost in rows[number] if cost is not None)


@pytest.mark.parametrize("place", ["arena8", "warehouse12", "office"])
def test_the_line_meets_the_files_own_times(place: str) -> None:
    setting = setting_of(place)
    times = build_travel_times(setting)
    errors = []
    for room in setting.map.rooms:
        beside = Pose2(room.goal.x, room.goal.y + 1.01 * AT_GOAL, 0.0)
        if setting.floor().clearance_at(beside) < setting.floor().inscribed:
            continue
        row = plain_costs(setting.costs)[room.room.people]
        pairs = zip(times.costs_from(beside)[1:], row[1:], strict=True)
        errors += [abs(mine - known) / known for mine, known in pairs if mine is not None and known is not None]
    assert errors and np.median(errors) < 0.12


def test_the_starts_cost_what_was_measured_from_them_on_average(arena: TravelTimes) -> None:
    setting = setting_of("arena8")
    starts = np.array([arena.costs_from(start)[1:] for start in setting.map.starts[:5]], dtype=np.float64)
    known = np.array(plain_costs(setting.costs)[0][1:], dtype=np.float64)
    assert np.median(abs(starts.mean(axis=0) - known) / known) < 0.1


def test_turning_on_the_spot_costs_too(arena: TravelTimes) -> None:
    ahead, back = (arena.costs_from(Pose2(0.0, 0.0, heading))[7] for heading in (0.0, np.pi))
    assert ahead is not None and back is not None and ahead + 2.0 <= back


def test_what_no_robot_can_reach_is_no_move() -> None:
    cells = np.zeros((40, 80), dtype=np.int8)
    cells[:, 39:41] = 100
    cells[0], cells[-1], cells[:, 0], cells[:, -1] = 100, 100, 100, 100
    grid = OccupancyGrid(cells, 0.1, Pose2(0.0, 0.0, 0.0))
    goals = [Pose2(1.0, 2.0, 0.0), Pose2(3.0, 2.0, 0.0), Pose2(7.0, 2.0, 0.0)]
    matrix = ((None, 5.0, 8.0, None), (None, None, 6.0, None), (None, 6.0, None, None), (None, None, None, None))
    times = TravelTimes(grid, costmap(grid, 0.2, 0.3), goals, [Pose2(2.0, 3.0, 0.0)], matrix)
    corridor, near, middle, beyond = times.costs_from(Pose2(2.0, 3.4, 0.0))
    assert corridor is None and beyond is None
    assert near is not None and middle is not None


@settings(deadline=None, max_examples=60)
@given(x=st.floats(-30.0, 30.0), y=st.floats(-30.0, 30.0))
def test_any_pose_has_a_cost_or_none_for_each_place(arena: TravelTimes, x: float, y: float) -> None:
    costs = arena.costs_from(Pose2(x, y, 0.0))
    assert len(costs) == 9 and costs[0] is None
    assert all(cost is None or (cost >= 1.0 and cost == round(cost)) for cost in costs)


@pytest.mark.parametrize("seed", range(40))
def test_weights_are_those_of_scipy(seed: int) -> None:
    chance = np.random.default_rng(seed)
    parts = np.column_stack([np.ones(30), chance.uniform(0, 20, 30), chance.uniform(0, 6, 30)])
    wholes = parts @ chance.normal(0.5, 1.0, 3) + chance.normal(0.0, 0.3, 30)
    assert non_negative_weights(parts, wholes) == pytest.approx(nnls(parts, wholes)[0], abs=1e-9)
