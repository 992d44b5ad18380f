import functools
import itertools
import math
import random
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from thbridge.files.map_times import read_map_times
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.rooms import CORRIDOR, Room, all_rooms
from thbridge.hunt.team_tour import MOST_ROOMS_OF_A_TEAM, TourStart, alternatives, best_score, best_team_tours
from thbridge.hunt.tour import MOST_ROOMS, Tour, best_tour

ARENA = read_map_times(Path(__file__).parents[3] / "templates" / "original-2016" / "mapTimes")


def price(costs, start, order):
    if not order:
        return 0.0
    return start.costs[order[0].people] + sum(costs.cost(*pair) for pair in itertools.pairwise(order))


def by_brute_force(costs, starts, rooms, visit, sent, first=None):
    """Number of rooms and energy of the best plan, by trying every assignment and every order; None without any.

    Where `first` is given, the tour of the robot `sent` begins in that room.
    """
    must = sent >= 0 and any(starts[sent].costs[room.people] <= starts[sent].energy for room in rooms)
    plans = []
    for owners in itertools.product(range(-1, len(starts)), repeat=len(rooms)):
        shares = [[room for room, owner in zip(rooms, owners, strict=True) if owner == at] for at in range(len(starts))]
        if must and not shares[sent]:
            continue
        prices = [
            min(
                price(costs, start, order) if first is None or at != sent or order[:1] == (first,) else math.inf
                for order in itertools.permutations(share)
            )
            for at, (start, share) in enumerate(zip(starts, shares, strict=True))
        ]
        if all(
            least + visit * max(len(share) - 1, 0) <= start.energy
            for least, share, start in zip(prices, shares, starts, strict=True)
        ):
            plans.append((-sum(map(len, shares)), sum(prices)))
    return min(plans, default=None)


numbers = st.sampled_from([1.0, 2.0, 3.0, 5.0, 8.0, math.inf])
teams = st.integers(1, 4).flatmap(
    lambda rooms: st.tuples(
        st.lists(st.lists(numbers, min_size=rooms + 1, max_size=rooms + 1), min_size=rooms + 1, max_size=rooms + 1),
        st.lists(
            st.tuples(st.lists(numbers, min_size=rooms + 1, max_size=rooms + 1), st.integers(0, 16)),
            min_size=1,
            max_size=3,
        ),
    )
)


@settings(deadline=None, max_examples=60)
@given(team=teams, visit=st.sampled_from([0.0, 1.0]))
def test_every_next_room_is_worth_the_best_plan_that_begins_with_it(team, visit):
    rows, robots = team
    costs = CostMatrix(tuple(map(tuple, rows)))
    starts = tuple(TourStart(tuple(row), float(energy)) for row, energy in robots)
    values = alternatives(costs, starts, costs.rooms, visit)
    for at in range(len(starts)):
        for room in costs.rooms:
            best = by_brute_force(costs, starts, costs.rooms, visit, at, room)
            value = values[at].get(room)
            assert (None if value is None else (-value.rooms, value.cost)) == best


def by_sets(costs, starts, rooms):
    """Number of rooms and energy of the best plan: dynamic programming over frozen sets, robot by robot."""

    @functools.cache
    def tour(robot, visited, last):
        if len(visited) == 1:
            return starts[robot].costs[last.people]
        before = visited - {last}
        return min(tour(robot, before, room) + costs.cost(room, last) for room in before)

    def least(robot, visited):
        spent = min((tour(robot, visited, room) for room in visited), default=0.0)
        return spent if spent <= starts[robot].energy else math.inf

    subsets = [frozenset(some) for size in range(len(rooms) + 1) for some in itertools.combinations(rooms, size)]
    payable = [{some: spent for some in subsets if (spent := least(at, some)) < math.inf} for at in range(len(starts))]
    plans = {frozenset(): 0.0}
    for of_robot in payable:
        joined = {}
        for done, spent in plans.items():
            for some, more in of_robot.items():
                if not done & some:
                    joined[done | some] = min(joined.get(done | some, math.inf), spent + more)
        plans = joined
    return min((-len(done), spent) for done, spent in plans.items())


@pytest.mark.parametrize(("rooms", "robots", "energy", "seed"), [(10, 2, 90.0, 1), (10, 3, 40.0, 2), (11, 3, 25.0, 3)])
def test_a_plan_of_many_rooms_is_that_of_an_independent_solver(rooms, robots, energy, seed):
    rng = random.Random(seed)
    places = [(rng.uniform(0, 30), rng.uniform(0, 20)) for _ in range(rooms + 1)]
    away = [[float(round(math.dist(one, other))) for other in places] for one in places]
    costs = CostMatrix(tuple(map(tuple, away)))
    starts = tuple(TourStart(tuple(away[rng.randrange(rooms + 1)]), energy) for _ in range(robots))
    tours = best_team_tours(costs, starts, all_rooms(rooms))
    assert (-sum(len(tour.rooms) for tour in tours), sum(tour.cost for tour in tours)) == by_sets(
        costs, starts, all_rooms(rooms)
    )


@given(team=teams, visit=st.sampled_from([0.0, 1.0]), data=st.data())
def test_the_plan_is_as_good_as_the_best_of_all(team, visit, data):
    rows, robots = team
    costs = CostMatrix(tuple(map(tuple, rows)))
    starts = tuple(TourStart(tuple(row), float(energy)) for row, energy in robots)
    sent = data.draw(st.integers(-1, len(starts) - 1))
    tours = best_team_tours(costs, starts, costs.rooms, visit, sent)
    shared = [room for tour in tours for room in tour.rooms]
    assert len(shared) == len(set(shared))
    assert [tour.cost for tour in tours] == [
        pytest.approx(price(costs, start, tour.rooms)) for start, tour in zip(starts, tours, strict=True)
    ]
    most, least = by_brute_force(costs, starts, costs.rooms, visit, sent)
    assert (-len(shared), sum(tour.cost for tour in tours)) == (most, pytest.approx(least))


@settings(deadline=None, max_examples=50)
@given(energy=st.floats(0.0, 200.0), at=st.sampled_from((CORRIDOR, *ARENA.rooms)), visit=st.sampled_from([0.0, 4.0]))
def test_one_robot_plans_a_tour_as_good_as_its_own(energy, at, visit):
    rooms = [room for room in ARENA.rooms if room != at]
    (tour,) = best_team_tours(ARENA, (TourStart(ARENA.rows[at.people], energy),), rooms, visit)
    own = best_tour(ARENA, at, rooms, energy, visit)
    if isinstance(own, Tour):
        assert (len(tour.rooms), tour.cost) == (len(own.rooms), own.cost)
    else:
        assert tour == Tour((), 0.0)


def test_a_room_beside_another_robot_is_left_to_it():
    far, near = 9.0, 1.0
    # Two rooms beside each other; robot 2 stands before room 1, robot 1 far from both and nearer to room 1.
    costs = CostMatrix(((far, far, far), (far, math.inf, 20.0), (far, 20.0, math.inf)))
    starts = (TourStart((far, 6.0, 7.0), 50.0), TourStart((far, near, 9.0), 50.0))
    first, second = best_team_tours(costs, starts, costs.rooms)
    assert (first.rooms, second.rooms) == ((Room(2),), (Room(1),))


def test_the_robot_to_be_sent_goes_somewhere_even_if_others_do_it_for_less():
    costs = CostMatrix(((9.0, 9.0, 9.0), (9.0, math.inf, 2.0), (9.0, 2.0, math.inf)))
    starts = (TourStart((9.0, 9.0, 9.0), 50.0), TourStart((9.0, 1.0, 1.0), 50.0))
    assert best_team_tours(costs, starts, costs.rooms)[0].rooms == ()
    assert len(best_team_tours(costs, starts, costs.rooms, sent=0)[0].rooms) == 1


def test_a_robot_whose_energy_is_below_zero_keeps_no_other_one_from_going():
    costs = CostMatrix(((9.0, 9.0, 9.0), (9.0, math.inf, 2.0), (9.0, 2.0, math.inf)))
    spent, fresh = TourStart((0.0, 0.0, 0.0), -1.0), TourStart((9.0, 1.0, 1.0), 50.0)
    first, second = best_team_tours(costs, (spent, fresh), costs.rooms)
    assert (first.rooms, len(second.rooms)) == ((), 2)


def test_more_rooms_than_can_be_shared_out_are_the_callers_mistake():
    flat = CostMatrix(((1.0,) * (MOST_ROOMS + 2),) * (MOST_ROOMS + 2))
    start = TourStart(flat.rows[0], 9.0)
    with pytest.raises(ValueError, match=f"for at most {MOST_ROOMS_OF_A_TEAM} rooms, but there are 17"):
        best_team_tours(flat, (start, start), all_rooms(MOST_ROOMS_OF_A_TEAM + 1))
    with pytest.raises(ValueError, match=f"at most {MOST_ROOMS} rooms"):
        best_team_tours(flat, (start,), all_rooms(MOST_ROOMS + 1))
    assert len(best_team_tours(flat, (start,), all_rooms(14))[0].rooms) == 9


@given(team=teams, visit=st.sampled_from([0.0, 1.0]), data=st.data())
def test_the_best_score_is_that_of_the_best_of_all_assignments(team, visit, data):
    rows, robots = team
    costs = CostMatrix(tuple(map(tuple, rows)))
    rooms = costs.rooms
    points = {room: data.draw(st.sampled_from([10, 20, 30])) for room in rooms}
    starts = [TourStart(tuple(row), float(energy)) for row, energy in robots]
    best = 0
    for owners in itertools.product(range(-1, len(starts)), repeat=len(rooms)):
        shares = [[room for room, owner in zip(rooms, owners, strict=True) if owner == at] for at in range(len(starts))]
        least = [
            min(price(costs, start, order) for order in itertools.permutations(share)) + visit * len(share)
            for start, share in zip(starts, shares, strict=True)
        ]
        if all(spent <= start.energy for spent, start in zip(least, starts, strict=True)):
            best = max(best, sum(points[room] for share in shares for room in share))
    assert best_score(costs, starts, points, visit) == best
