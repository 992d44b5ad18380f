"""A floor plan is unpacked without a loss, and one that cannot be read does no harm."""

import base64
import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec import structs

from tests.support.maps.sample_maps import house_of, shipped_map
from thbridge.roles.shared.notices import FloorPlan
from ui.model.shared.map_geometry import FREE, UNKNOWN, WALL, contains, unpack


def test_the_bounds_hold_all_that_is_known() -> None:
    shown = shipped_map("arena8")
    left, bottom, right, top = unpack(house_of(shown)).bounds
    for room in shown.rooms:
        for x, y in room.region:
            assert left <= x <= right
            assert bottom <= y <= top


def test_walls_are_told_from_floor() -> None:
    shown = shipped_map("arena8")
    plan = unpack(house_of(shown))
    goal = shown.rooms[0].goal
    box = np.array([[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]])
    wide = 40.0 * box
    middle = np.array([goal.x, goal.y])
    around = np.stack((box + middle, wide + middle))
    assert plan.is_clear(around).tolist() == [True, False]


@pytest.fixture(scope="module")
def house() -> FloorPlan:
    return house_of(shipped_map("arena8"))


@given(noise=st.binary(max_size=40))
def test_cells_that_cannot_be_read_leave_the_rooms(house: FloorPlan, noise: bytes) -> None:
    plan = unpack(structs.replace(house, cells=base64.b64encode(noise).decode()))
    assert not (plan.cells == WALL).any()
    assert plan.bounds[0] < plan.bounds[2]


def test_more_cells_than_announced_are_not_unpacked(house: FloorPlan) -> None:
    bomb = base64.b64encode(zlib.compress(bytes(1_000_000))).decode()
    assert (unpack(structs.replace(house, cells=bomb, width=4, height=4)).cells == np.full((4, 4), FREE)).all()


@pytest.mark.parametrize(("width", "height"), [(10**6, 10**6), (-4, -4), (0, 5)])
def test_no_memory_is_taken_for_a_map_that_no_keeper_has(house: FloorPlan, width: int, height: int) -> None:
    plan = unpack(structs.replace(house, width=width, height=height))
    assert plan.cells.tolist() == [[UNKNOWN]]


def test_a_region_holds_what_lies_in_it() -> None:
    triangle = np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]])
    assert contains(triangle, np.array([[0.5, 0.5], [1.5, 1.5]])).tolist() == [True, False]
