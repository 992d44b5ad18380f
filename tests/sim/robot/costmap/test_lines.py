"""Lines and polygons in cells."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sim.robot.costmap.lines import clear_line, fill_convex, line

cells = st.integers(-30, 30)


@given(cells, cells, cells, cells)
def test_a_line_has_both_ends_no_gap_and_keeps_within_a_cell_of_the_straight_line(row, col, row_end, col_end):
    along = line(row, col, row_end, col_end, 1000)
    assert along[0].tolist() == [row, col]
    assert along[-1].tolist() == [row_end, col_end]
    assert len(along) == max(abs(row_end - row), abs(col_end - col)) + 1
    assert (np.abs(np.diff(along, axis=0)).max(axis=1) == 1).all()
    length = math.hypot(row_end - row, col_end - col)
    if length > 0:
        off = (along[:, 0] - row) * (col_end - col) - (along[:, 1] - col) * (row_end - row)
        assert (np.abs(off) / length <= 1.0).all()


@given(cells, cells, st.integers(0, 40))
def test_a_line_is_cut_at_its_greatest_length_and_is_the_beginning_of_the_whole(row_end, col_end, longest):
    whole, cut = line(0, 0, row_end, col_end, 1000), line(0, 0, row_end, col_end, longest)
    assert np.array_equal(cut, whole[: len(cut)])
    assert np.hypot(*cut[-1]) <= longest + 1.0
    if np.hypot(row_end, col_end) <= longest:
        assert len(cut) == len(whole)


@given(cells, cells, cells, cells, st.integers(0, 70))
def test_clearing_a_line_clears_the_cells_of_the_line_and_tells_where(row, col, row_end, col_end, longest):
    costs = np.full((61, 67), 255, np.uint8)
    changed = np.array([*costs.shape, -1, -1])
    clear_line(costs, row + 30, col + 30, row_end + 30, col_end + 30, longest, changed)
    along = line(row, col, row_end, col_end, longest) + 30
    expected = np.full_like(costs, 255)
    expected[along[:, 0], along[:, 1]] = 0
    assert np.array_equal(costs, expected)
    assert changed.tolist() == [*along.min(axis=0), *(along.max(axis=0) + 1)]


@given(st.floats(5, 15), st.floats(5, 15), st.floats(1, 8), st.integers(3, 16), st.floats(0, 6))
def test_a_convex_polygon_is_filled_up_to_its_outline_and_not_beyond_it(x, y, radius, corners, turned):
    angles = turned + np.arange(corners) * math.tau / corners
    polygon = np.stack([x + radius * np.cos(angles), y + radius * np.sin(angles)], axis=1)
    costs = np.zeros((20, 20), np.uint8)
    fill_convex(costs, polygon, 9)
    inscribed = radius * math.cos(math.pi / corners)
    for (row, col), cost in np.ndenumerate(costs):
        off = math.hypot(col + 0.5 - x, row + 0.5 - y)
        if off < inscribed - 1.5:
            assert cost == 9
        if off > radius + 1.5:
            assert cost == 0
