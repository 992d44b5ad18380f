"""The pace of a game: real time beside simulated time, and the lag of a machine too slow for its rate."""

import asyncio
from itertools import accumulate

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.common.observations import TICK, TICKS_PER_SECOND
from thbridge.timing.pace_meter import TOLERANCE, GamePace, PaceMeter, PaceState, _simplified, real_time
from thbridge.timing.pacer import Pacer


def measured(monkeypatch: pytest.MonkeyPatch, meter: PaceMeter, took: dict[int, float], ticks: range) -> GamePace:
    """Run ticks at the rate of real time on a clock of its own; some take long, or are paused before."""

    async def run() -> None:
        for tick in ticks:
            state = meter.measure(tick, pacer)
            if tick % TICKS_PER_SECOND == 0 or state.step > TOLERANCE:
                meter.keep()
            now[0] += took.get(tick, 0.001)
            await pacer.wait()

    async def sleep(seconds: float) -> None:
        now[0] += seconds

    now = [1000.0]
    monkeypatch.setattr(asyncio, "sleep", sleep)
    meter._clock = lambda: now[0]
    pacer = Pacer(1.0, lambda: now[0])
    asyncio.run(run())
    return meter.pace()


def test_a_machine_that_keeps_pace_has_no_lag_and_a_straight_course(monkeypatch: pytest.MonkeyPatch) -> None:
    pace = measured(monkeypatch, PaceMeter(), {}, range(500))
    assert pace.wall == pytest.approx(499 * TICK, abs=TICK)
    assert (pace.most_lag, pace.late) == (0.0, 0.0)
    assert len(pace.course) == 2


def test_a_stall_is_a_lag_for_good_and_a_short_one_is_made_up_for(monkeypatch: pytest.MonkeyPatch) -> None:
    pace = measured(monkeypatch, PaceMeter(), {120: 0.5, 300: 4.0}, range(500))
    assert pace.most_lag == pytest.approx(4.0, abs=0.1)
    assert pace.late == pytest.approx(4.5, abs=0.1)
    # The half second was made up for, and the four were not.
    assert real_time(pace.course, 5.0) == pytest.approx(5.0, abs=TOLERANCE)
    assert real_time(pace.course, 9.0) == pytest.approx(13.0, abs=TOLERANCE + 0.04)
    # Just before the stall nothing is late yet.
    assert real_time(pace.course, 300 * TICK) == pytest.approx(6.0, abs=TOLERANCE)
    assert real_time(pace.course, 301 * TICK) == pytest.approx(10.0, abs=TOLERANCE + 0.04)


def test_a_game_that_goes_on_keeps_its_lag_and_leaves_out_the_time_between(monkeypatch: pytest.MonkeyPatch) -> None:
    first = PaceMeter()
    measured(monkeypatch, first, {60: 3.0}, range(150))
    second = PaceMeter()
    second.go_on([(0, PaceState()), (61, PaceState(4.22, 3.0, 3.0, 3.0, 3.0)), (149, first.state)])
    pace = measured(monkeypatch, second, {200: 2.0}, range(150, 400))
    assert pace.most_lag == pytest.approx(5.0, abs=0.1)
    assert pace.wall == pytest.approx(399 * TICK + 5.0, abs=0.1)
    assert real_time(pace.course, 3.0) == pytest.approx(6.0, abs=0.1)


@given(
    steps=st.lists(st.tuples(st.integers(1, 50), st.floats(0.0, 0.1) | st.floats(0.0, 30.0)), min_size=1, max_size=200)
)
def test_a_course_is_within_its_tolerance_of_all_that_was_measured(steps: list[tuple[int, float]]) -> None:
    ticks = accumulate(step for step, _ in steps)
    points = [(tick * TICK, wall) for tick, wall in zip(ticks, accumulate(wall for _, wall in steps), strict=True)]
    course = _simplified(points)
    assert {*course} <= {*points}
    assert [course[0], course[-1]] == [points[0], points[-1]]
    for simulated, wall in points:
        assert real_time(course, simulated) == pytest.approx(wall, abs=TOLERANCE + 1e-6)


def test_there_is_no_real_time_before_the_first_point_and_after_the_last() -> None:
    assert real_time([], 1.0) is None
    assert real_time([(1.0, 5.0), (2.0, 7.0)], 0.5) is None
    assert real_time([(1.0, 5.0), (2.0, 7.0)], 2.5) is None
    assert real_time([(1.0, 5.0)], 1.0) == 5.0
