"""Architects' plans: what closes doors is found and left out, hatching is filled, and walls stay as they are."""

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import ImageDraw

from sim.common.geometry import IDENTITY
from sim.common.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid, interpret_image
from tests.support.maps.floor_plans import SCALE, pixels, plan
from tests.support.slow import slow
from thbridge.offline.drawings import (
    blocked_paths,
    closed_to_outside,
    joined,
    reached_floor,
    squared,
    turned,
    without_thin_lines,
)
from thbridge.offline.room_finding import drivable_floor, find_rooms

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


def test_an_entrance_is_closed_and_no_robot_drives_on_the_paper() -> None:
    grid = grid_of(pixels(plan(entrance=True)))
    assert blocked_paths(grid, INSCRIBED) is not None
    opened = without_thin_lines(grid, 4).grid
    assert drivable_floor(opened, INSCRIBED)[20, 20]
    closed, openings = closed_to_outside(opened, INSCRIBED)
    ((x, y),) = openings
    assert np.hypot(x - 100 * SCALE, y - 450 * SCALE) < 1.0
    floor = drivable_floor(closed, INSCRIBED)
    assert floor[450, 650] and floor[200, 200] and not floor[20, 20]
    assert closed.cells[20, 20] == UNKNOWN
    assert find_rooms(closed, INSCRIBED, 0.3).max() == 8


def test_a_building_without_openings_or_without_paper_stays_as_it_is() -> None:
    for image in (pixels(plan()), pixels(plan(entrance=True))[100:800, 100:1200]):
        opened = without_thin_lines(grid_of(image), 4).grid
        closed, openings = closed_to_outside(opened, INSCRIBED)
        assert closed is opened
        assert openings == ()


def test_where_the_arcs_of_a_double_door_meet_nothing_is_left() -> None:
    cells = without_thin_lines(grid_of(pixels(plan(entrance=True))), 4).grid.cells[::-1]
    assert (cells[425:475, 90:135] == FREE).all()


def test_a_width_that_opens_the_doors_and_takes_no_wall_is_told() -> None:
    image = plan(furnished=False)
    pen = ImageDraw.Draw(image)
    for x in (100, 375, 650, 925):
        # A bath behind walls that are thinner than the others.
        pen.line((x + 80, 100, x + 80, 190, x, 190), fill=0, width=5)
        pen.rectangle((x + 77, 130, x + 83, 165), fill=255)
    closed = blocked_paths(grid_of(pixels(image)), INSCRIBED)
    assert closed is not None
    assert closed.thinner <= 4


def test_floor_out_of_reach_is_told_with_its_size() -> None:
    image = plan(furnished=False)
    ImageDraw.Draw(image).line((740, 380, 780, 380), fill=0, width=10)
    reached, parts = reached_floor(without_thin_lines(grid_of(pixels(image)), 4).grid, INSCRIBED)
    (((x, y), area),) = parts
    assert 0.8 < reached < 0.95
    assert np.hypot(x - 787 * SCALE, y - 660 * SCALE) < 0.5
    assert area == pytest.approx(39.0, abs=2.0)


def test_joined_pixels_have_their_mean_and_what_is_over_is_white() -> None:
    image = np.array([[0, 100, 40], [200, 100, 40], [8, 8, 255]], dtype=np.uint8)
    assert joined(image, 2).tolist() == [[100, 148], [132, 255]]
    assert joined(image, 1).tolist() == image.tolist()


@pytest.mark.parametrize("degrees", [90.0, -90.0, 180.0])
def test_quarter_turns_lose_nothing(degrees: float) -> None:
    image = pixels(plan())
    back = turned(turned(image, degrees), -degrees)
    np.testing.assert_array_equal(back, image)
