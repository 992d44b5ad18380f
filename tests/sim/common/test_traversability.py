import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.ndimage import label

from sim.common.geometry import IDENTITY, Pose2
from sim.common.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from sim.common.traversability import CrowdedFloor, Point, Polygon, TraversabilityMap, area, crosses_itself, inside

L_SHAPE: Polygon = ((0.0, 0.0), (4.0, 0.0), (4.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0))
TENTHS = st.integers(-20, 80).map(lambda tenths: tenths / 10.0)
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
        reach = floor.reachable(Pose2(1.0, 1.0, 0.0))
        assert bool(reach[10, 30]) is passes

    def test_another_robot_in_the_gap_is_in_the_way(self) -> None:
        floor = floor_with_gap(8)
        for other, passes in ((Pose2(2.05, 0.9, 0.0), False), (Pose2(3.5, 1.5, 0.0), True)):
            crowd = CrowdedFloor(floor, [Pose2(1.0, 1.0, 0.0), other])
            assert crowd.reached(0, [(10, 30), (10, 8)]) == [passes, True]
            assert crowd.are_connected([(10, 30), (4, 5)]) is passes

    @pytest.mark.parametrize("start", [Pose2(2.05, 1.9, 0.0), Pose2(-3.0, 0.0, 0.0)])
    def test_from_where_no_robot_fits_nothing_is_reachable(self, start: Pose2) -> None:
        assert not floor_with_gap(8).reachable(start).any()
        assert CrowdedFloor(floor_with_gap(8), [start]).reached(0, [(10, 30), (10, 8)]) == [False, False]

    @given(st.integers(0, 2**32 - 1))
    def test_a_crowd_leaves_each_robot_what_it_does_when_all_cells_are_looked_at(self, seed: int) -> None:
        draw = np.random.default_rng(seed)
        cells = np.where(draw.random((24, 30)) < 0.06, OCCUPIED, FREE).astype(np.int8)
        floor = TraversabilityMap.of(
            OccupancyGrid(cells, 0.2, Pose2(-1.0, 2.0, 0.6)), inscribed=0.25, circumscribed=0.4
        )
        poses = [Pose2(*place, 0.0) for place in floor.grid.centres_of(draw.integers(0, (24, 30), (5, 2))).tolist()]
        everywhere = [(row, col) for row in range(24) for col in range(30)]
        x, y = floor.centres(floor.everywhere)
        close = [np.hypot(x - pose.x, y - pose.y) <= 0.65 for pose in poses]
        crowd = CrowdedFloor(floor, poses)
        for robot, pose in enumerate(poses):
            others = np.any([mask for other, mask in enumerate(close) if other != robot], axis=0)
            passable = (floor.clearance > floor.inscribed) & ~others
            areas = label(passable)[0]
            area = areas[floor.grid.cell_of(pose.x, pose.y)]
            assert crowd.reached(robot, everywhere) == ((areas == area) & passable).ravel().tolist()

    @given(st.floats(-3, 3), st.lists(st.tuples(TENTHS, TENTHS), min_size=3, max_size=6))
    def test_cells_in_a_polygon_are_those_of_the_whole_map(self, yaw: float, corners: list[Point]) -> None:
        floor = TraversabilityMap.of(OccupancyGrid(np.zeros((25, 31), np.int8), 0.2, Pose2(0.5, 1.0, yaw)), 0.2, 0.3)
        centres = floor.grid.centres_of(np.argwhere(np.ones((25, 31))))
        box, held = floor.held_by(tuple(corners))
        mask = np.zeros((25, 31), dtype=np.bool_)
        mask[box] = held
        assert mask.ravel().tolist() == inside(tuple(corners), *centres.T).tolist()


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
