import math

import pytest

from thbridge.hunt.costs import CostMatrix, energy_text
from thbridge.hunt.rooms import CORRIDOR, Room


def test_99_is_no_move_and_larger_numbers_are_costs():
    costs = CostMatrix.of_map_times(((99.0, 120.0, 98.0), (99.0, 99.0, 99.5), (99.0, 7.0, 99.0)))
    assert costs.cost(CORRIDOR, Room(1)) == 120.0
    assert costs.cost(Room(1), Room(2)) == 99.5
    assert math.isinf(costs.cost(Room(1), CORRIDOR))


def test_staying_is_no_move_whatever_is_written():
    costs = CostMatrix.of_map_times(((0.0, 5.0), (3.0, 0.0)))
    assert math.isinf(costs.cost(Room(1), Room(1)))
    assert costs.cost(Room(1), CORRIDOR) == 3.0


@pytest.mark.parametrize(
    "rows", [(), ((1.0,),), ((1.0, 2.0), (1.0,)), ((1.0, -2.0), (1.0, 1.0)), ((1.0, math.nan), (1.0, 1.0))]
)
def test_what_is_not_a_matrix_of_costs_is_refused(rows):
    with pytest.raises(ValueError):
        CostMatrix(rows)


def test_it_knows_its_rooms():
    costs = CostMatrix.of_map_times(((99.0, 5.0), (99.0, 99.0)))
    assert costs.rooms == (Room(1),)
    assert costs.has_place(CORRIDOR) and not costs.has_place(Room(2))


@pytest.mark.parametrize(
    ("energy", "words"), [(100.0, "100"), (12.5, "12.5"), (0.0, "0"), (0.074, "0.07"), (-3.0, "-3"), (1e6, "1000000")]
)
def test_energy_is_spoken_as_people_write_it(energy, words):
    assert energy_text(energy) == words
