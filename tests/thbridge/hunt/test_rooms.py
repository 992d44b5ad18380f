import pytest

from thbridge.hunt.rooms import CORRIDOR, Room, all_rooms


def test_room_1_of_people_is_0_on_the_wire():
    assert Room.of_wire(0) == Room(1)
    assert Room(1).wire == 0
    assert Room.of_wire(7).people == 8


def test_the_corridor_is_0_to_people_and_has_no_word_on_the_wire():
    assert Room(0) == CORRIDOR
    assert CORRIDOR.is_corridor
    with pytest.raises(ValueError, match="corridor"):
        _ = CORRIDOR.wire


@pytest.mark.parametrize("build", [Room.of_wire, Room])
def test_no_room_is_below_zero(build):
    with pytest.raises(ValueError):
        build(-1)


def test_all_rooms_leave_the_corridor_out():
    assert [room.people for room in all_rooms(3)] == [1, 2, 3]
    assert [str(room) for room in (CORRIDOR, *all_rooms(1))] == ["the corridor", "room 1"]
