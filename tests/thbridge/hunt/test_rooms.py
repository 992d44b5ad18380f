import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.hunt.rooms import CORRIDOR, Room, RoomNames, all_rooms


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


def test_a_name_stands_beside_the_number_where_it_says_more():
    names = RoomNames.of([(1, "Kitchen"), (2, "Room 2"), (3, "room  3 "), (4, "4"), (5, ""), (6, "Room 5")])
    titles = ["the corridor", "room 1 (Kitchen)", "room 2", "room 3", "room 4", "room 5", "room 6 (Room 5)", "room 7"]
    assert [names.titled(room) for room in range(8)] == titles
    assert [names.name(room) for room in (1, 2, None)] == ["Kitchen", "", ""]


@given(st.integers(0, 99))
def test_without_names_a_room_is_said_as_ever(room):
    assert RoomNames.of([(room, str(Room(room)))]).titled(room) == str(Room(room))
