"""All planners keep what their seam promises; each is told from the others by an example."""

from math import inf

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.hunts.random_hunts import random_hunt
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.planners import PLANNERS
from thbridge.hunt.rooms import CORRIDOR, all_rooms
from thbridge.hunt.team_planner import TeamPlanner
from thbridge.hunt.team_tour import TourStart, best_team_tours, paid_tour
from thbridge.hunt.tour import Tour, best_tour

planners = st.sampled_from(TeamPlanner)


def value(tours):
    return -sum(len(tour.rooms) for tour in tours), sum(tour.cost for tour in tours)


def numbered(tours):
    return [[room.people for room in tour.rooms] for tour in tours]


@given(
    planner=planners,
    rooms=st.integers(0, 7),
    robots=st.integers(1, 3),
    energy=st.sampled_from([0.0, 12.0, 30.0, 60.0, 500.0, inf]),
    visit=st.sampled_from([0.0, 2.0]),
    seed=st.integers(0, 10**6),
    data=st.data(),
)
def test_tours_can_be_paid_share_no_room_and_are_no_better_than_the_best(
    planner, rooms, robots, energy, visit, seed, data
):
    costs, starts = random_hunt(max(rooms, 1), robots, energy, seed)
    sent = data.draw(st.integers(-1, robots - 1))
    tours = PLANNERS[planner](costs, starts, all_rooms(rooms), visit, sent)
    shared = [room for tour in tours for room in tour.rooms]
    assert len(shared) == len(set(shared)) and set(shared) <= set(all_rooms(rooms))
    assert len(tours) == robots
    for start, tour in zip(starts, tours, strict=True):
        paid = paid_tour(costs, start, tour.rooms, visit)
        assert (tour.rooms, tour.cost) == (paid.rooms, pytest.approx(paid.cost))
    most, least = value(best_team_tours(costs, starts, all_rooms(rooms), visit, sent))
    assert value(tours) >= (most, least - 1e-9)
    if sent >= 0 and any(starts[sent].can_pay(room) for room in all_rooms(rooms)):
        assert tours[sent].rooms


@settings(deadline=None, max_examples=50)
@given(planner=planners, seed=st.integers(0, 10**6), energy=st.sampled_from([20.0, 40.0, 500.0]))
def test_no_room_is_left_that_the_last_robot_could_still_pay_for(planner, seed, energy):
    costs, starts = random_hunt(6, 2, energy, seed)
    tours = PLANNERS[planner](costs, starts, costs.rooms, 2.0)
    left = set(costs.rooms) - {room for tour in tours for room in tour.rooms}
    for start, tour in zip(starts, tours, strict=True):
        for room in left:
            longer = (*tour.rooms, room)
            assert len(paid_tour(costs, start, longer, 2.0).rooms) < len(longer)


# Rooms 1, 2, 3 in a row to the right of the corridor at 2, 3 and 8; room 4 at -2.5.
LINE = (0.0, 2.0, 3.0, 8.0, -2.5)
ROW = CostMatrix(tuple(tuple(abs(a - b) for b in LINE) for a in LINE))


def at(place: float, energy: float = 100.0) -> TourStart:
    return TourStart(tuple(abs(place - room) for room in LINE), energy)


@pytest.mark.parametrize(
    ("planner", "tours"),
    [
        # From 0 and from 7.
        ("joint", [[4, 1, 2], [3]]),
        # Robot 1 has spent 2, so robot 2 goes to 3; robot 2 has spent 1 and goes from there to 2; then robot 1 to 4.
        ("nearest", [[1, 4], [3, 2]]),
        # 7 to 8 costs 1, 0 to 2 costs 2, 2 to 3 costs 1, 3 to -2.5 costs 5.5.
        ("greedy", [[1, 2, 4], [3]]),
        # Robot 1 alone: 4, 1, 2, 3. Robot 2 alone: 3, 2, 1, 4. In turns by what they have spent.
        ("tour", [[4, 1], [3, 2]]),
        # 3 for 1, then 1 for 2, then 2 behind it for 1, then 4: before 1 it adds 2.5 + 4.5 - 2, behind 2 it adds 5.5.
        ("auction", [[4, 1, 2], [3]]),
    ],
)
def test_each_planner_shares_a_row_of_rooms_in_its_own_way(planner, tours):
    assert numbered(PLANNERS[TeamPlanner(planner)](ROW, (at(0.0), at(7.0)), ROW.rooms)) == tours


def test_the_lowest_bid_may_put_a_room_between_two_others():
    tours = PLANNERS[TeamPlanner.AUCTION](ROW, (at(-3.0),), ROW.rooms)
    assert numbered(tours) == [[4, 1, 2, 3]]
    # Only rooms 3 and 1: 1 is nearer, and 3 comes behind it; from 9 room 3 is nearer, and 1 comes behind.
    assert numbered(PLANNERS[TeamPlanner.AUCTION](ROW, (at(9.0),), [ROW.rooms[0], ROW.rooms[2]])) == [[3, 1]]


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10**6), energy=st.sampled_from([25.0, 60.0, 500.0]))
def test_a_robot_alone_goes_by_its_own_tour_as_in_2016(seed, energy):
    costs, (start,) = random_hunt(6, 1, energy, seed)
    whole = CostMatrix((start.costs, *costs.rows[1:]))
    (tour,) = PLANNERS[TeamPlanner.TOUR](costs, (start,), costs.rooms, 2.0)
    own = best_tour(whole, CORRIDOR, costs.rooms, energy, 2.0)
    if not isinstance(own, Tour):
        own = Tour((), 0.0)  # Not even the nearest room can be paid for.
    assert (len(tour.rooms), tour.cost) == (len(own.rooms), pytest.approx(own.cost))


def test_nearest_means_nearest():
    for seed in range(20):
        costs, starts = random_hunt(8, 2, 60.0, seed)
        for sent in (0, 1):
            first = PLANNERS[TeamPlanner.NEAREST](costs, starts, costs.rooms, 2.0, sent)[sent].rooms[0]
            assert starts[sent].costs[first.people] == min(starts[sent].costs[1:])


def test_joint_tours_of_many_rooms_are_searched_for_and_still_send_whom_they_shall():
    costs, starts = random_hunt(20, 2, 60.0, 3)
    beside = TourStart(tuple(1e3 if place else 0.0 for place in range(21)), 2e3)
    tours = PLANNERS[TeamPlanner.JOINT](costs, [*starts, beside], costs.rooms, 2.0, sent=2)
    assert len(tours[2].rooms) >= 1
    assert sum(len(tour.rooms) for tour in tours) >= 18
