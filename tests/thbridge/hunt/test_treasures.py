import pytest

from thbridge.hunt.treasures import TreasureKind, hide, same_name

KINDS = tuple(TreasureKind({"colour": "Red", "footprint": "Round"}, points, f"kind {points}") for points in range(4))


def test_every_kind_gets_an_equal_share_of_the_unit_interval():
    count = 4000
    hidden = hide(KINDS, [index / count for index in range(count)])
    assert [hidden.count(kind) for kind in KINDS] == [count // 4] * 4


def test_the_same_numbers_hide_the_same_and_a_kind_may_repeat():
    assert hide(KINDS, [0.0, 0.999999, 0.1]) == (KINDS[0], KINDS[3], KINDS[0])


@pytest.mark.parametrize("uniform", [1.0, -0.1, float("nan")])
def test_numbers_outside_the_unit_interval_are_refused(uniform):
    with pytest.raises(ValueError):
        hide(KINDS, [uniform])


def test_there_must_be_something_to_hide():
    with pytest.raises(ValueError):
        hide((), [0.5])


def test_names_compare_as_people_read_them():
    assert same_name("Orange  bottle ", "orange Bottle")
    assert same_name("Schlu\u0308ssel", "SCHL\u00dcSSEL")
    assert not same_name("Orange", "Orange Bottle")
