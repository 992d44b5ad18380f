import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.common.observations import STANDSTILL, Neighbour
from sim.robot.global_planning.itinerary import (
    Itinerary,
    densified,
    executable,
    first_met,
    itineraries_of,
    keeps_separation,
    reached_index,
    relevant_neighbours,
    right_of_way,
    start_time,
    timed_itinerary,
)

SQUARE = np.array([[0.25, 0.25], [-0.25, 0.25], [-0.25, -0.25], [0.25, -0.25]])
NEAR = 0.8


def line(x0, y0, x1, y1, steps=40):
    return np.column_stack([np.linspace(x0, x1, steps + 1), np.linspace(y0, y1, steps + 1)])


def told(robot, itinerary):
    return Neighbour(robot, Pose2(*itinerary.points[0], 0.0), STANDSTILL, SQUARE, itinerary.points, itinerary.times)


def standing(robot, x, y):
    return Neighbour(robot, Pose2(x, y, 0.0), STANDSTILL, SQUARE, np.empty((0, 2)), np.empty(0))


def allowed(mine, others, index=0):
    place = mine.points[index]
    last = len(mine.points) - 1
    index, _, stands = right_of_way(mine.points, mine.times, index, last, *place, itineraries_of(others), NEAR)
    return index, stands


def test_the_one_with_the_earlier_time_goes_first_at_a_crossing():
    first, second = timed_itinerary(line(-2, 0, 2, 0), 0.0), timed_itinerary(line(0, -2, 0, 2), 3.0)
    assert allowed(first, [told(1, second)]) == (40, False)
    index, barred = allowed(second, [told(0, first)])
    assert not barred
    assert math.hypot(*second.points[index]) >= NEAR - 0.11
    assert second.points[index][1] < 0


def test_a_delay_of_the_first_does_not_change_the_order():
    first, second = timed_itinerary(line(-2, 0, 2, 0), 0.0), timed_itinerary(line(0, -2, 0, 2), 3.0)
    late = Itinerary(first.points[5:], first.times[5:])
    assert allowed(second, [told(0, late)])[0] < 20
    gone = Itinerary(first.points[32:], first.times[32:])
    assert allowed(second, [told(0, gone)])[0] == 40


@given(st.lists(st.tuples(st.floats(-3, 3), st.floats(-3, 3), st.booleans()), max_size=8))
@settings(max_examples=60, deadline=None)
def test_those_who_stand_far_from_a_place_do_not_bear_on_the_way_ahead(places):
    mine = timed_itinerary(line(-1, -1, 1, 0.5), 0.0)
    others = [
        told(k, timed_itinerary(line(x, y, 0, 0), 0.0)) if moves else standing(k, x, y)
        for k, (x, y, moves) in enumerate(places)
    ]
    bearing = relevant_neighbours(others, *mine.points[3], math.dist(mine.points[3], mine.points[30]) + NEAR)

    def barred(by):
        last, barring, stands = right_of_way(mine.points, mine.times, 3, 30, *mine.points[3], itineraries_of(by), NEAR)
        return last, by[barring].robot if barring >= 0 else None, stands

    assert barred(bearing) == barred(others)


def test_it_is_told_who_bars_the_way():
    first, second = timed_itinerary(line(-2, 0, 2, 0), 0.0), timed_itinerary(line(0, -2, 0, 2), 3.0)
    others = itineraries_of([standing(2, 9.0, 9.0), told(1, first)])
    assert right_of_way(second.points, second.times, 0, 40, *second.points[0], others, NEAR)[1] == 1
    assert (
        right_of_way(first.points, first.times, 0, 40, *first.points[0], itineraries_of([told(1, second)]), NEAR)[1]
        == -1
    )


def test_who_would_be_met_first_is_told():
    mine = timed_itinerary(line(-2, 0, 2, 0), 0.0)
    crossing = told(1, timed_itinerary(line(0, -2, 0, 2), 0.0))
    others = itineraries_of([standing(2, 9.0, 9.0), standing(3, 2.0, 0.0), crossing])
    assert first_met(mine.points, mine.times, others, NEAR) == 2


@given(st.lists(st.tuples(st.floats(-3, 3), st.floats(-3, 3), st.floats(-5, 5), st.booleans()), max_size=5))
@settings(max_examples=60, deadline=None)
def test_who_keeps_its_distance_meets_nobody(places):
    mine = timed_itinerary(line(-2, -1, 2, 0.5), 0.0)
    others = itineraries_of(
        [
            told(k, timed_itinerary(line(x, y, 0, 0), time)) if moves else standing(k, x, y)
            for k, (x, y, time, moves) in enumerate(places)
        ]
    )
    if keeps_separation(mine.points, mine.times, others, NEAR):
        assert first_met(mine.points, mine.times, others, NEAR) == -1


def test_a_robot_that_stands_bars_the_way():
    assert allowed(timed_itinerary(line(-2, 0, 2, 0), 0.0), [standing(1, 0.0, 0.3)])[1]


def test_one_who_is_near_already_may_leave_but_not_come_nearer():
    mine = timed_itinerary(line(0, 0, 2, 0), 0.0)
    assert allowed(mine, [standing(1, -0.5, 0.0)]) == (40, False)
    assert allowed(mine, [standing(1, 0.5, 0.0)]) == (0, True)


def test_clear_compares_equal_times():
    mine = timed_itinerary(line(-2, 0, 2, 0), 0.0)
    crossing = line(0, -2, 0, 2)
    assert not keeps_separation(
        mine.points, mine.times, itineraries_of([told(1, timed_itinerary(crossing, 0.0))]), NEAR
    )
    assert keeps_separation(mine.points, mine.times, itineraries_of([told(1, timed_itinerary(crossing, 4.0))]), NEAR)
    assert not keeps_separation(mine.points, mine.times, itineraries_of([standing(1, 1.0, 0.5)]), NEAR)
    # It stays at its end for good, so whoever comes by later is in conflict too.
    assert not keeps_separation(
        mine.points, mine.times, itineraries_of([told(1, timed_itinerary(line(2, -9, 2, 9), 0.0))]), NEAR
    )


def test_a_robot_that_others_have_yet_to_pass_counts_from_before_them():
    late = timed_itinerary(line(-2, 0, 2, 0), 5.0)
    assert start_time(60.0, 0.0, 0.2, itineraries_of([told(1, late)]), NEAR) == 5.0
    assert start_time(60.0, 0.0, 3.0, itineraries_of([told(1, late)]), NEAR) == 60.0


def test_progress_goes_forward_only():
    points = line(0, 0, 4, 0)
    assert reached_index(points, 2, 0.52, 0.1) == 5
    assert reached_index(points, 9, 0.52, 0.1) == 9


def test_a_wait_is_passed_through_when_nobody_has_to_be_waited_for():
    points = np.array([[0.0, 0.0], [0.1, 0.0], [0.1, 0.0], [0.2, 0.0]])
    assert reached_index(points, 0, 0.1, 0.0) == 2


def test_densifying_keeps_waits_and_times():
    dense = densified(Itinerary(np.array([[0, 0], [0.35, 0], [0.35, 0], [0.35, 0.1]]), np.array([0, 1, 5, 6.0])))
    assert np.hypot(*np.diff(dense.points, axis=0).T).max() <= 0.1 + 1e-9
    assert (np.diff(dense.times) > 0).all()
    assert dense.times[[0, 4, 5, 6]] == pytest.approx([0, 1, 5, 6])


def test_itineraries_that_keep_their_distance_can_be_driven_to_the_end():
    first, second = timed_itinerary(line(-2, 0, 2, 0), 0.0), timed_itinerary(line(0, -2, 0, 2), 3.0)
    for mine, other in ((first, second), (second, first)):
        assert executable(mine.points, mine.times, itineraries_of([told(1, other)]), NEAR)


def test_two_that_bar_each_others_next_point_cannot_both_be_driven():
    """Each leaves where the other comes nearer by a little less than it may, and a little later."""
    first = Itinerary(line(0, 0, 0.3, 0.1, 3), np.array([0.0, 0.4, 0.8, 1.2]))
    second = Itinerary(line(0.25, 0.85, 0.0, 0.75, 3), np.array([-0.2, 0.2, 0.6, 1.0]))
    assert allowed(first, [told(1, second)])[0] < 3
    assert not executable(first.points, first.times, itineraries_of([told(1, second)]), NEAR)
    assert executable(first.points, first.times, itineraries_of([standing(1, 0.0, 2.0)]), NEAR)


def test_an_itinerary_past_a_robot_that_stands_cannot_be_driven():
    mine = timed_itinerary(line(-2, 0, 2, 0), 0.0)
    assert not executable(mine.points, mine.times, itineraries_of([standing(1, 0.0, 0.3)]), NEAR)
    assert executable(mine.points, mine.times, itineraries_of([]), NEAR)
