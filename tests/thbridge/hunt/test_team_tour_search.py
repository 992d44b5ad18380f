"""Tours that the search finds: payable to the last bit, the same each time, nearly always the best."""

import itertools
import os
import subprocess
import sys
from fractions import Fraction
from math import inf

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.hunts.random_hunts import random_hunt
from tests.support.project import ROOT
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.rooms import all_rooms
from thbridge.hunt.team_tour import TourStart, best_team_tours
from thbridge.hunt.team_tour_search import search_team_tours
from thbridge.hunt.tour import Tour

PROGRAM = """
from tests.support.hunts.random_hunts import random_hunt
from thbridge.hunt.rooms import all_rooms
from thbridge.hunt.team_tour_search import search_team_tours

costs, starts = random_hunt(50, 3, 80.0, 4)
for tour in search_team_tours(costs, starts, all_rooms(50), 2.0):
    print([room.people for room in tour.rooms], tour.cost.hex())
"""


def value(tours):
    return sum(len(tour.rooms) for tour in tours), pytest.approx(sum(tour.cost for tour in tours))


def exactly_spent(costs, start, tour, visit):
    """Energy of a tour without any rounding."""
    if not tour.rooms:
        return Fraction(0)
    moves = [start.costs[tour.rooms[0].people], *(costs.cost(*pair) for pair in itertools.pairwise(tour.rooms))]
    return sum(map(Fraction, moves)) + Fraction(visit) * (len(moves) - 1)


@pytest.mark.parametrize(("rooms", "robots", "energy"), [(6, 1, 40.0), (8, 2, 30.0), (12, 2, 60.0), (12, 3, 25.0)])
def test_of_few_rooms_it_finds_the_best_tours_that_there_are(rooms, robots, energy):
    for seed in range(8):
        costs, starts = random_hunt(rooms, robots, energy, seed)
        found = search_team_tours(costs, starts, all_rooms(rooms), 2.0)
        assert value(found) == value(best_team_tours(costs, starts, all_rooms(rooms), 2.0)), seed


numbers = st.sampled_from([0.0, 0.1, 1.0, 2.7, 3.3, 1e6, inf])
teams = st.integers(1, 6).flatmap(
    lambda rooms: st.tuples(
        st.lists(st.lists(numbers, min_size=rooms + 1, max_size=rooms + 1), min_size=rooms + 1, max_size=rooms + 1),
        st.lists(
            st.tuples(
                st.lists(numbers, min_size=rooms + 1, max_size=rooms + 1),
                st.sampled_from([-1.0, 0.0, 0.1, 2.8, 3.3, 6.6, 9.9, 1e7, inf]),
            ),
            min_size=1,
            max_size=3,
        ),
    )
)


@given(team=teams, visit=st.sampled_from([0.0, 0.1, 1.0, 1e9]))
def test_robots_can_pay_for_their_tours_to_the_last_bit(team, visit):
    rows, robots = team
    costs = CostMatrix(tuple(map(tuple, rows)))
    starts = [TourStart(tuple(row), energy) for row, energy in robots]
    tours = search_team_tours(costs, starts, costs.rooms, visit)
    shared = [room for tour in tours for room in tour.rooms]
    assert len(shared) == len(set(shared))
    for start, tour in zip(starts, tours, strict=True):
        spent = exactly_spent(costs, start, tour, visit)
        assert not tour.rooms or start.energy == inf or spent <= Fraction(start.energy)
        assert tour.cost == pytest.approx(float(spent - Fraction(visit) * max(len(tour.rooms) - 1, 0)))


def test_what_costs_exactly_all_the_energy_is_paid():
    costs = CostMatrix(((9.0, 3.0, 9.0, 9.0), (9.0, 9.0, 4.5, 9.0), (9.0, 9.0, 9.0, 2.25), (9.0, 9.0, 9.0, 9.0)))
    start = TourStart(costs.rows[0], 3.0 + 4.5 + 2.25 + 2 * 0.5)
    assert search_team_tours(costs, [start], costs.rooms, 0.5) == (Tour(costs.rooms, 9.75),)


def test_fifty_rooms_are_shared_out_alike_in_every_process():
    def run(hash_seed: str) -> str:
        environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONHASHSEED": hash_seed}
        command = [sys.executable, "-c", PROGRAM]
        return subprocess.run(command, env=environment, capture_output=True, text=True, check=True, timeout=120).stdout

    told = run("1")
    assert told == run("2")
    assert told.count("\n") == 3 and told.count(",") > 30
