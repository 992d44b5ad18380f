from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from ui.model.watching.curves import MAX_LINE_POINTS, Curve, as_steps, broken

TIMES = st.lists(st.floats(0.0, 100.0), max_size=60)


@given(times=TIMES, most=st.integers(4, 20))
def test_memory_is_bounded_times_rise_and_the_newest_stays(times: list[float], most: int) -> None:
    curve = Curve(most=most)
    kept: list[float] = []
    for time in times:
        curve.append(time, -time)
        if not kept or time >= kept[-1]:
            kept.append(time)
        rows = curve.rows()
        assert len(rows) == len(curve) <= most
        assert (np.diff(rows[:, 0]) >= 0.0).all()
        assert rows[-1].tolist() == [kept[-1], -kept[-1]]
        assert set(rows[:, 0].tolist()) <= set(kept)


def test_the_newer_half_stays_as_it_was() -> None:
    curve = Curve(most=100)
    for time in range(101):
        curve.append(float(time), 0.0)
    assert curve.rows()[-51:, 0].tolist() == [float(time) for time in range(50, 101)]


@given(values=st.lists(st.floats(0.0, 1e3), min_size=1, max_size=200))
def test_peaks_survive_thinning(values: list[float]) -> None:
    curve = Curve(peaks=True, most=8)
    for time, value in enumerate(values):
        curve.append(float(time), value)
    assert curve.rows()[:, 1].max() == max(values)


def test_rows_until_a_time_include_it() -> None:
    curve = Curve()
    for time in (0.0, 1.0, 2.0):
        curve.append(time, 10.0 * time)
    assert curve.rows(1.0).tolist() == [[0.0, 0.0], [1.0, 10.0]]
    assert len(curve.rows(-1.0)) == 0


def test_a_line_has_few_points_and_is_the_same_while_it_does_not_grow() -> None:
    curve = Curve(3)
    for time in range(3 * MAX_LINE_POINTS):
        curve.append(float(time), float(time), -float(time), 0.0)
    line = curve.path(np.inf)
    assert len(line) <= MAX_LINE_POINTS
    assert curve.path(np.inf) is line
    assert curve.path(4.0).tolist() == [[float(t), -float(t)] for t in range(5)]


@given(
    count=st.integers(1, 3 * MAX_LINE_POINTS),
    cuts=st.lists(st.floats(-10.0, 4000.0), max_size=5).map(sorted),
    since=st.floats(-10.0, 100.0),
)
def test_no_line_leads_over_a_cut(count: int, cuts: list[float], since: float) -> None:
    curve = Curve(2)
    for time in range(count):
        curve.append(float(time), float(time), 0.0)
    line = curve.path(np.inf, since, cuts)
    for before, after in pairwise(line[:, 0].tolist()):
        assert np.isnan(before) or np.isnan(after) or not any(before < cut <= after for cut in cuts)
    if len(line):
        assert not np.isnan(line[[0, -1]]).any()


@given(
    times=st.lists(st.floats(0.0, 100.0), unique=True, max_size=20).map(sorted),
    gaps=st.lists(st.floats(-10.0, 110.0), max_size=5).map(sorted),
)
def test_a_gap_is_empty_and_all_else_stays(times: list[float], gaps: list[float]) -> None:
    rows = np.column_stack((times, np.arange(len(times), dtype=np.float64))).reshape(-1, 2)
    told = broken(rows, gaps)
    assert np.array_equal(told[~np.isnan(told[:, 1])], rows)
    assert (np.diff(told[:, 0]) >= 0.0).all()
    between = [gap for gap in gaps if len(times) and times[0] < gap <= times[-1]]
    assert told[np.isnan(told[:, 1]), 0].tolist() == between


@given(times=st.lists(st.floats(0.0, 100.0), unique=True, max_size=20).map(sorted), end=st.floats(-10.0, 200.0))
def test_steps_hold_each_sample_until_the_next_and_the_last_until_the_end(times: list[float], end: float) -> None:
    rows = np.column_stack((times, np.arange(len(times)))).reshape(-1, 2)
    steps = as_steps(rows, end)
    until = [*times[1:], max(times[-1], end)] if times else []
    expected = [
        each for n, (begin, last) in enumerate(zip(times, until, strict=True)) for each in ((begin, n), (last, n))
    ]
    assert [tuple(step) for step in steps.tolist()] == expected
