import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.common.geometry import IDENTITY, Pose2
from sim.common.grid import FREE, OCCUPIED, UNKNOWN, MapMode, OccupancyGrid, interpret_image

SHADES = np.arange(256, dtype=np.uint8).reshape(1, 256)


def grid_of(cells: list[list[int]], resolution: float = 0.5, origin: Pose2 = IDENTITY) -> OccupancyGrid:
    return OccupancyGrid(np.array(cells, dtype=np.int8), resolution, origin)


class TestOccupancyGrid:
    def test_row_zero_is_at_the_origin(self) -> None:
        grid = grid_of([[0, 0], [100, -1]], resolution=0.5, origin=Pose2(-1.0, 2.0, 0.0))
        assert grid.centre_of(0, 0) == (-0.75, 2.25)
        assert grid.value_at(-0.75, 2.75) == OCCUPIED
        assert grid.value_at(-0.25, 2.75) == UNKNOWN

    def test_outside_is_unknown_even_just_below_the_origin(self) -> None:
        grid = grid_of([[0]], origin=IDENTITY)
        assert grid.cell_of(-0.01, -0.01) == (-1, -1)
        assert grid.value_at(-0.01, 0.1) == UNKNOWN

    @pytest.mark.parametrize("x", [math.nan, math.inf, -math.inf, 1e300])
    def test_no_cell_holds_a_point_that_is_endlessly_far(self, x: float) -> None:
        assert grid_of([[0]]).value_at(x, 0.1) == UNKNOWN
        assert grid_of([[0]]).value_at(0.1, x) == UNKNOWN

    def test_a_turned_origin_turns_the_grid(self) -> None:
        grid = grid_of([[0, 100]], resolution=1.0, origin=Pose2(3.0, 1.0, math.pi / 2))
        # Columns run along the grid's x axis, which points along the world's y axis.
        assert grid.centre_of(0, 1) == pytest.approx((2.5, 2.5))
        assert grid.value_at(2.5, 2.5) == OCCUPIED

    @given(
        st.integers(0, 39),
        st.integers(0, 59),
        st.floats(-50, 50),
        st.floats(-50, 50),
        st.floats(-math.pi, 3.1415),
        st.floats(0.01, 2.0),
    )
    def test_a_cell_holds_its_own_centre(
        self, row: int, col: int, x: float, y: float, yaw: float, resolution: float
    ) -> None:
        grid = OccupancyGrid(np.zeros((40, 60), dtype=np.int8), resolution, Pose2(x, y, yaw))
        assert grid.cell_of(*grid.centre_of(row, col)) == (row, col)
        cell = np.array([[row, col]])
        centre = grid.centres_of(cell)
        assert centre[0] == pytest.approx(grid.centre_of(row, col))
        assert (grid.cells_of(centre) == cell).all()

    def test_a_map_in_use_cannot_be_drawn_on(self) -> None:
        cells = np.zeros((2, 2), dtype=np.int8)
        grid = OccupancyGrid(cells, 0.1, IDENTITY)
        cells[0, 0] = OCCUPIED
        assert grid.cells[0, 0] == FREE
        with pytest.raises(ValueError, match="read-only"):
            grid.cells[0, 0] = OCCUPIED

    def test_equality_is_by_value(self) -> None:
        assert grid_of([[0, 100]]) == grid_of([[0, 100]])
        assert hash(grid_of([[0, 100]])) == hash(grid_of([[0, 100]]))
        assert grid_of([[0, 100]]) != grid_of([[0, 0]])
        assert grid_of([[0]], resolution=0.1) != grid_of([[0]])

    @pytest.mark.parametrize("resolution", [0.0, -1.0, math.nan, math.inf])
    def test_a_cell_has_a_size(self, resolution: float) -> None:
        with pytest.raises(ValueError, match="resolution"):
            grid_of([[0]], resolution=resolution)


def read_by_ros(value: float, negate: bool, occ_th: float, free_th: float, mode: MapMode) -> int:
    """One gray pixel, worked through by hand in the order map_server has it."""
    if negate:
        value = 255 - value
    if mode == "raw":
        return int(value) if value < 128 else int(value) - 256
    occ = (255 - value) / 255.0
    if occ > occ_th:
        return 100
    if occ < free_th:
        return 0
    if mode == "trinary":
        return -1
    return int(1 + 98 * (occ - free_th) / (occ_th - free_th))


class TestInterpretImage:
    @pytest.mark.parametrize("mode", ["trinary", "scale", "raw"])
    @pytest.mark.parametrize("negate", [False, True])
    def test_every_shade_reads_as_in_ros(self, mode: MapMode, negate: bool) -> None:
        cells = interpret_image(SHADES, negate, 0.65, 0.196, mode)
        assert cells[0].tolist() == [read_by_ros(shade, negate, 0.65, 0.196, mode) for shade in range(256)]

    def test_what_map_saver_writes(self) -> None:
        assert interpret_image(np.array([[0, 205, 254]], dtype=np.uint8), False, 0.65, 0.196).tolist() == [[100, -1, 0]]

    def test_the_top_of_the_picture_is_the_last_row(self) -> None:
        picture = np.array([[0, 0], [254, 254]], dtype=np.uint8)
        assert interpret_image(picture, False, 0.65, 0.196).tolist() == [[0, 0], [100, 100]]

    def test_alpha_counts_as_a_colour_in_trinary_only(self) -> None:
        transparent_black = np.zeros((1, 1, 4), dtype=np.uint8)
        opaque_black = np.array([[[0, 0, 0, 255]]], dtype=np.uint8)
        # (0 + 0 + 0 + 255) / 4 is dark still, but less so.
        assert interpret_image(opaque_black, False, 0.8, 0.1).tolist() == [[-1]]
        assert interpret_image(opaque_black, False, 0.8, 0.1, "scale").tolist() == [[100]]
        assert interpret_image(transparent_black, False, 0.8, 0.1).tolist() == [[100]]

    def test_transparent_between_the_thresholds_is_unknown_in_scale(self) -> None:
        grey = np.array([[[128, 128, 128, 0], [128, 128, 128, 255]]], dtype=np.uint8)
        unknown, half = interpret_image(grey, False, 0.65, 0.196, "scale")[0]
        assert unknown == UNKNOWN
        assert 0 < half < 100

    def test_colours_are_averaged(self) -> None:
        yellow = np.array([[[255, 255, 0]]], dtype=np.uint8)
        assert interpret_image(yellow, False, 0.65, 0.4).tolist() == [[0]]
