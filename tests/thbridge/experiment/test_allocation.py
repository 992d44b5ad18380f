"""Orders and places: balanced at any size, whoever drops out."""

from collections import Counter

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.experiment.allocation.latin_square import balanced_latin_square, cyclic_latin_square, is_balanced
from thbridge.experiment.allocation.places import Allocation, NoPlace, Place


@pytest.mark.parametrize("conditions", range(1, 9))
def test_a_balanced_square_has_each_condition_at_each_place_and_behind_each_other_equally_often(conditions):
    orders = balanced_latin_square(conditions)
    assert len(orders) == (conditions if conditions % 2 == 0 or conditions == 1 else 2 * conditions)
    assert all(sorted(order) == list(range(conditions)) for order in orders)
    assert is_balanced(orders)


@pytest.mark.parametrize("conditions", range(3, 9))
def test_a_plain_square_has_places_only(conditions):
    orders = cyclic_latin_square(conditions)
    assert {tuple(sorted(column)) for column in zip(*orders, strict=True)} == {tuple(range(conditions))}
    assert not is_balanced(orders)


@given(
    cells=st.integers(1, 6),
    conditions=st.integers(1, 8),
    quota=st.integers(1, 8),
    seed=st.integers(0, 2**31),
    in_block=st.integers(1, 3),
    fates=st.lists(st.sampled_from(["valid", "dropped", "under way", "drops later"]), max_size=120),
)
def test_places_stay_balanced_whoever_drops_out(cells, conditions, quota, seed, in_block, fates):
    orders = len(balanced_latin_square(conditions))
    dealing = Allocation(cells, orders, quota, seed, in_block)
    valid: set[int] = set()
    under_way: set[int] = set()
    for fate in fates:
        if fate == "drops later" and under_way:
            under_way.remove(max(under_way))
            continue
        place = dealing.next(valid, under_way)
        if isinstance(place, NoPlace):
            assert len(valid | under_way) == dealing.size
            assert (place is NoPlace.FULL) == (not under_way)
            break
        assert place == dealing.place(place.number)
        if fate != "dropped":
            (valid if fate == "valid" else under_way).add(place.number)
        if valid | under_way != set(range(len(valid | under_way))):
            continue  # What opened again is taken first by those who come.
        held = Counter(dict.fromkeys(range(cells), 0))
        held.update(dealing.place(number).cell for number in valid | under_way)
        assert max(held.values()) - min(held.values()) <= in_block
        for cell in range(cells):
            taken = Counter(dict.fromkeys(range(orders), 0))
            taken.update(dealing.place(n).order for n in valid | under_way if dealing.place(n).cell == cell)
            assert max(taken.values()) - min(taken.values()) <= 1


@given(cells=st.integers(1, 6), orders=st.integers(1, 14), quota=st.integers(1, 20), seed=st.integers(0, 2**31))
def test_a_full_experiment_has_each_cell_as_often_as_wanted(cells, orders, quota, seed):
    dealing = Allocation(cells, orders, quota, seed)
    places = [dealing.place(number) for number in range(dealing.size)]
    assert set(Counter(place.cell for place in places).values()) == {quota}
    assert dealing.next(set(range(dealing.size)), set()) is NoPlace.FULL


def test_a_place_that_opened_again_goes_to_the_next_person():
    dealing = Allocation(2, 2, 3, 7)
    assert dealing.next({0, 1, 3}, {4}) == dealing.place(2)


def test_another_seed_deals_otherwise():
    def dealt(seed: int) -> list[Place]:
        return [Allocation(4, 4, 4, seed).place(number) for number in range(16)]

    assert dealt(1) == dealt(1) != dealt(2)
