"""ROS time goes on whatever becomes of whoever makes it."""

from thbridge.ros.remote.clock import CLOCK_TIMEOUT_NS, RosClock

SECOND = 1_000_000_000
WALL = 1_700_000_000 * SECOND


def test_without_a_simulation_it_is_the_walls():
    clock = RosClock(simulated=False)
    assert clock.runs
    assert clock.now(WALL) == WALL


def test_simulated_time_is_what_is_said():
    clock = RosClock(simulated=True)
    assert not clock.runs
    clock.receive(5 * SECOND, WALL)
    assert clock.runs
    assert clock.now(WALL + SECOND) == 5 * SECOND


def test_a_clock_that_stops_is_not_waited_for_long():
    clock = RosClock(simulated=True)
    clock.receive(5 * SECOND, WALL)
    assert clock.now(WALL + CLOCK_TIMEOUT_NS + 6 * SECOND) == 11 * SECOND
    assert [clock.stands(WALL + CLOCK_TIMEOUT_NS + passed) for passed in (0, 1)] == [False, True]


def test_it_never_goes_back_and_goes_on_after_the_clock_was_set_back():
    clock = RosClock(simulated=True)
    clock.receive(100 * SECOND, WALL)
    assert clock.now(WALL) == 100 * SECOND
    clock.receive(100 * SECOND - SECOND // 2, WALL)
    assert clock.now(WALL) == 100 * SECOND
    clock.receive(1 * SECOND, WALL)
    assert clock.now(WALL) == 100 * SECOND
    clock.receive(3 * SECOND, WALL)
    assert clock.now(WALL) == 102 * SECOND
