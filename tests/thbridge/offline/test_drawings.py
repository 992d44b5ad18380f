"""Architects' plans: what closes doors is found and left out, hatching is filled, and walls stay as they are."""

import numpy as np
import pytest
from numpy.typing import NDArray

from sim.common.geometry import IDENTITY
from sim.common.grid import FREE, OCCUPIED, OccupancyGrid, interpret_image
from tests.support.maps.floor_plans import SCALE, pixels, plan
from tests.support.slow import slow
from thbridge.offline.drawings import blocked_paths, squared, turned, without_thin_lines

INSCRIBED = 0.2


def grid_of(image: NDArray[np.uint8]) -> OccupancyGrid:
    return OccupancyGrid(interpret_image(image, False, 0.65, 0.196), SCALE, IDENTITY)


DRAWN = {
    "solid walls": pixels(plan()),
    "hatched walls": pixels(plan(hatched=True)),
    "turned paper": turned(pixels(plan()), 8.0),
    "an uneven scan": squared(pixels(plan().resize((1300, 600))), 1.5),
}


@pytest.mark.parametrize("name", ["hatched walls", "an uneven scan", *slow("solid walls", "turned paper")])
def test_doors_that_are_drawn_shut_are_found_and_opened(name: str) -> None:
    grid = grid_of(DRAWN[name])
    closed = blocked_paths(grid, INSCRIBED)
    assert closed is not None
    assert closed.reached < 0.5
    assert len(closed.places) >= 8
    assert blocked_paths(without_thin_lines(grid, 4).grid, INSCRIBED) is None


def test_closed_doors_are_told_with_the_width_that_opens_them_all() -> None:
    grid = grid_of(DRAWN["solid walls"])
    closed = blocked_paths(grid, INSCRIBED)
    assert closed is not None
    opened = without_thin_lines(grid, closed.thinner).grid
    assert blocked_paths(opened, INSCRIBED) is None
    doors = [(x * SCALE, (900 - y) * SCALE) for x in (198, 488, 758, 1028) for y in (380, 520)]
    for x, y in doors:
        assert min(np.hypot(x - there[0], y - there[1]) for there in closed.places) < 1.5


def test_walls_stay_where_they_are() -> None:
    bare = grid_of(pixels(plan(furnished=False)))
    walls = without_thin_lines(bare, 4).grid.cells == OCCUPIED
    thick = np.asarray(plan(furnished=False)) == 0
    assert walls[thick[::-1]].mean() > 0.95
    assert without_thin_lines(grid_of(DRAWN["solid walls"]), 4).left_out.mean() > 0.005


def test_hatching_is_filled() -> None:
    cells = without_thin_lines(grid_of(DRAWN["hatched walls"]), 4).grid.cells[::-1]
    assert (cells[96:104, 400:600] == OCCUPIED).all()
    assert (cells[430:470, 120:580] == FREE).all()


def test_nothing_is_told_where_doors_are_open() -> None:
    opened = without_thin_lines(grid_of(DRAWN["solid walls"]), 4).grid
    assert blocked_paths(opened, INSCRIBED) is None


@pytest.mark.parametrize("degrees", [90.0, -90.0, 180.0])
def test_quarter_turns_lose_nothing(degrees: float) -> None:
    image = pixels(plan())
    back = turned(turned(image, degrees), -degrees)
    np.testing.assert_array_equal(back, image)
