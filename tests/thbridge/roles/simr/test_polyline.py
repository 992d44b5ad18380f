import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from thbridge.roles.simr.polyline import needed_points

lines = st.integers(1, 40).flatmap(lambda count: arrays(np.float64, (count, 2), elements=st.floats(-9, 9, width=32)))


def distance(point, start, end):
    along = end - start
    share = 0.0 if not along.any() else min(1.0, max(0.0, (point - start) @ along / (along @ along)))
    return np.hypot(*(point - start - share * along))


@given(lines, st.floats(0.01, 5.0))
def test_no_point_is_farther_off_than_allowed_and_both_ends_stay(points, tolerance):
    few = points[needed_points(points, tolerance)]
    assert (few[0] == points[0]).all()
    assert (few[-1] == points[-1]).all()
    for point in points:
        assert min(distance(point, a, b) for a, b in zip(few, [*few[1:], few[-1]], strict=True)) <= tolerance + 1e-9


def test_a_straight_line_is_its_ends():
    points = np.column_stack([np.linspace(0, 9, 91), np.zeros(91)])
    assert np.flatnonzero(needed_points(points, 0.02)).tolist() == [0, 90]


def test_a_way_out_and_back_keeps_where_it_turns():
    points = np.array([[0, 0], [1, 0], [2, 0], [1, 0], [0, 0.0]])
    assert np.flatnonzero(needed_points(points, 0.02)).tolist() == [0, 2, 4]
