import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.common.geometry import IDENTITY, Pose2
from sim.common.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from sim.common.traversability import Polygon, TraversabilityMap, area, crosses_itself, inside

L_SHAPE: Polygon = ((0.0, 0.0), (4.0, 0.0), (4.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0))
HOURGLASS: Polygon = ((0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0))


def floor_with_gap(width: int) -> TraversabilityMap:
    """4 m x 2 m of cells of 0.1 m, a wall across with a gap so many cells wide."""
    cells = np.full((20, 40), FREE, dtype=np.int8)
    cells[:, 20] = OCCUPIED
    cells[5 : 5 + width, 20] = FREE
    return TraversabilityMap.of(OccupancyGrid(cells, 0.1, IDENTITY), inscribed=0.25, circumscribed=0.35)


class TestFloor:
    def test_the_border_and_the_unknown_are_no_floor(self) -> None:
        cells = np.array([[FREE, FREE, FREE, FREE, UNKNOWN]], dtype=np.int8)
        floor = TraversabilityMap.of(OccupancyGrid(cells, 1.0, IDENTITY), 0.25, 0.35)
        assert floor.clearance.tolist() == [[1.0, 1.0, 1.0, 1.0, 0.0]]
        assert floor.clearance_at(Pose2(9.0, 0.5, 0.0)) == 0.0

    @pytest.mark.parametrize(("width", "passes"), [(4, False), (5, True), (7, True)])
    def test_a_robot_passes_a_gap_that_is_wider_than_itself(self, width: int, passes: bool) -> None:
        floor = floor_with_gap(width)
        reach = floor.reachable(Pose2(1.0, 1.0, 0.0), np.zeros((20, 40), dtype=np.bool_))
        assert bool(reach[10, 30]) is passes

    def test_another_robot_in_the_gap_is_in_the_way(self) -> None:
        floor = floor_with_gap(8)
        there = floor.obstructed_by(Pose2(2.05, 0.9, 0.0))
        assert not floor.reachable(Pose2(1.0, 1.0, 0.0), there)[10, 30]
        away = floor.obstructed_by(Pose2(3.5, 1.5, 0.0))
        assert floor.reachable(Pose2(1.0, 1.0, 0.0), away)[10, 30]

    @pytest.mark.parametrize("start", [Pose2(2.05, 1.9, 0.0), Pose2(-3.0, 0.0, 0.0)])
    def test_from_where_no_robot_fits_nothing_is_reachable(self, start: Pose2) -> None:
        assert not floor_with_gap(8).reachable(start, np.zeros((20, 40), dtype=np.bool_)).any()


class TestPolygons:
    def test_inside_of_a_corner(self) -> None:
        x, y = np.array([0.5, 3.5, 2.0, -0.1]), np.array([2.5, 0.5, 2.0, 0.5])
        assert inside(L_SHAPE, x, y).tolist() == [True, True, False, False]

    def test_area_and_crossings(self) -> None:
        assert area(L_SHAPE) == 6.0
        assert area(L_SHAPE[::-1]) == 6.0
        assert not crosses_itself(L_SHAPE)
        assert crosses_itself(HOURGLASS)

    @given(st.floats(0.1, 50), st.floats(-100, 100), st.floats(-100, 100), st.integers(3, 12))
    def test_a_regular_polygon_holds_its_inscribed_circle_and_no_more_than_the_other(
        self, radius: float, x: float, y: float, corners: int
    ) -> None:
        turns = [2 * math.pi * corner / corners for corner in range(corners)]
        polygon = tuple((x + radius * math.cos(turn), y + radius * math.sin(turn)) for turn in turns)
        around = np.linspace(0.0, 2 * math.pi, 50)
        within, beyond = 0.99 * radius * math.cos(math.pi / corners), 1.01 * radius
        assert inside(polygon, x + within * np.cos(around), y + within * np.sin(around)).all()
        assert not inside(polygon, x + beyond * np.cos(around), y + beyond * np.sin(around)).any()
        assert area(polygon) == pytest.approx(corners / 2 * radius**2 * math.sin(2 * math.pi / corners), rel=1e-6)
