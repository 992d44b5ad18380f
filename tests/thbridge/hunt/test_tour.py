import math
import subprocess
import sys
from itertools import permutations
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.files.map_times import read_map_times
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import CORRIDOR, Room, all_rooms
from thbridge.hunt.tour import MOST_ROOMS, NoTour, Tour, best_tour

ARENA = read_map_times(Path(__file__).parents[3] / "templates" / "original-2016" / "mapTimes")


def price(costs, at, order):
    total = 0.0
    for room in reversed(order):  # in the order of summing from the end, so that rounding is the same
        before = order[order.index(room) - 1] if order.index(room) else at
        total = costs.cost(before, room) + total
    return total


def by_brute_force(costs, at, unvisited, energy):
    """Most rooms, then least cost, then first in counting, among all orders of all subsets."""
    best = None
    for size in range(len(unvisited), 0, -1):
        for order in permutations(sorted(unvisited), size):
            cost = price(costs, at, order)
            if math.isfinite(cost) and cost <= energy and (best is None or (cost, order) < best):
                best = (cost, order)
        if best is not None:
            return Tour(best[1], best[0])
    return None


def test_the_cheapest_tour_of_the_2016_arena():
    tour = best_tour(ARENA, CORRIDOR, ARENA.rooms)
    assert [room.people for room in tour.rooms] == [3, 5, 2, 1, 4, 6, 7, 8]
    assert tour.cost == 130.0


def test_that_tour_is_the_only_one_of_its_cost():
    cheapest = [order for order in permutations(ARENA.rooms) if price(ARENA, CORRIDOR, order) <= 130.0]
    assert len(cheapest) == 1


matrices = st.integers(1, 6).flatmap(
    lambda rooms: st.lists(
        st.lists(st.sampled_from([1.0, 2.0, 3.0, 5.0, 99.0]), min_size=rooms + 1, max_size=rooms + 1),
        min_size=rooms + 1,
        max_size=rooms + 1,
    )
)


@given(rows=matrices, energy=st.sampled_from([0.0, 1.0, 4.0, 7.0, 12.0, math.inf]), data=st.data())
def test_it_finds_what_trying_everything_finds(rows, energy, data):
    costs = CostMatrix.of_map_times(tuple(map(tuple, rows)))
    places = (CORRIDOR, *costs.rooms)
    at = data.draw(st.sampled_from(places))
    unvisited = data.draw(st.sets(st.sampled_from(costs.rooms)))
    expected = by_brute_force(costs, at, unvisited - {at}, energy)
    found = best_tour(costs, at, unvisited, energy)
    if expected is None:
        assert isinstance(found, RequestRefused)
    else:
        assert found == expected


def test_too_little_energy_for_all_visits_as_many_as_it_can():
    tour = best_tour(ARENA, CORRIDOR, ARENA.rooms, 100.0)
    assert tour == by_brute_force(ARENA, CORRIDOR, ARENA.rooms, 100.0)
    assert tour.cost <= 100.0 and len(tour.rooms) == 6


def test_too_little_energy_for_one_room_names_both_numbers():
    refused = best_tour(ARENA, CORRIDOR, ARENA.rooms, 12.0)
    assert refused.reason == NoTour.NOT_ENOUGH_ENERGY
    assert "13" in refused.sentence and "12" in refused.sentence


def test_nothing_left_and_nowhere_to_go_are_told_apart():
    walled = CostMatrix.of_map_times(((99.0, 99.0), (99.0, 99.0)))
    assert best_tour(ARENA, Room(1), [Room(1)]).reason == NoTour.NOTHING_LEFT
    assert best_tour(walled, CORRIDOR, walled.rooms).reason == NoTour.NOT_REACHABLE


def test_more_rooms_than_the_table_holds_are_refused():
    count = MOST_ROOMS + 1
    costs = CostMatrix(((1.0,) * (count + 1),) * (count + 1))
    assert best_tour(costs, CORRIDOR, costs.rooms).reason == NoTour.TOO_MANY_ROOMS


def test_equal_tours_give_the_first_in_counting_without_listing_them_all():
    rooms = all_rooms(14)
    flat = CostMatrix(((1.0,) * 15,) * 15)
    assert best_tour(flat, CORRIDOR, reversed(rooms), 7.0).rooms == rooms[:7]


def test_the_suggestion_needs_no_compiler():
    # A compiler's first run would take longer than a person waits for an answer.
    code = "import sys, thbridge.hunt.tour; sys.exit('numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize("place", [Room(9), Room(40)])
def test_a_place_outside_the_matrix_is_the_callers_mistake(place):
    with pytest.raises(IndexError):
        best_tour(ARENA, CORRIDOR, [place])
