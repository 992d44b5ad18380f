from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.common.geometry import IDENTITY
from sim.common.grid import OCCUPIED, OccupancyGrid
from tests.support.maps.small_arenas import FOUND, GRID
from thbridge.files.grid_files import write_grid
from thbridge.files.map_files import check_map, write_rooms
from thbridge.hunt.refusals import RequestRefused
from thbridge.offline.arena import cells_inside
from ui.model.arena.draft import ArenaDraft, ArenaPointer, ArenaTool, room_at
from ui.model.arena.floor import ArenaHandle


@pytest.fixture
def draft() -> ArenaDraft:
    assert [room.name for room in FOUND.rooms] == ["West", "Middle", "East"]
    return ArenaDraft(GRID, FOUND)


def refused(outcome: RequestRefused | None) -> str:
    assert outcome is not None
    return outcome.sentence


def names(draft: ArenaDraft) -> list[str]:
    return [room.name for room in draft.arena.rooms]


def test_a_name_is_given_once(draft: ArenaDraft) -> None:
    assert draft.rename(2, "  Tea   kitchen ") is None
    assert names(draft) == ["West", "Tea kitchen", "East"]
    assert refused(draft.rename(1, "East")) == "Another room is already called East."
    assert refused(draft.rename(1, " ")) == "A room needs a name."


def test_a_room_gets_another_number_and_those_between_move(draft: ArenaDraft) -> None:
    assert draft.renumber(3, 1) is None
    assert [(room.room.people, room.name) for room in draft.arena.rooms] == [(1, "East"), (2, "West"), (3, "Middle")]
    assert refused(draft.renumber(1, 4)) == "The number of a room must be from 1 to 3."


def test_a_removed_room_is_corridor_and_is_drawn_again_between_its_walls(draft: ArenaDraft) -> None:
    before = draft.arena.rooms[2]
    assert draft.remove_room(3) is None
    assert room_at(draft.arena, before.goal.x, before.goal.y) is None
    assert draft.draw_room((7.5, 2.15), (11.9, 7.9)) is None
    again = draft.arena.rooms[2]
    assert (again.room.people, again.name) == (3, "Room 3")
    assert np.array(again.region).min(axis=0) == pytest.approx(np.array(before.region).min(axis=0), abs=0.2)
    assert np.array(again.region).max(axis=0) == pytest.approx(np.array(before.region).max(axis=0), abs=0.2)


def test_a_room_is_cut_in_two_and_merged_again(draft: ArenaDraft) -> None:
    assert draft.cut_room((4.5, 5.0), (7.5, 5.0)) is None
    assert names(draft) == ["West", "Middle", "East", "Room 4"]
    assert {room_at(draft.arena, 6.0, 3.0), room_at(draft.arena, 6.0, 7.0)} == {2, 4}
    assert draft.merge_rooms(4, 2) is None
    assert names(draft) == ["West", "Middle", "East"]
    assert room_at(draft.arena, 6.0, 3.0) == room_at(draft.arena, 6.0, 7.0) == room_at(draft.arena, 6.0, 5.0) == 2


def test_rooms_are_merged_through_a_door_and_not_through_a_wall(draft: ArenaDraft) -> None:
    assert refused(draft.merge_rooms(2, 3)) == "No opening leads from room 2 to room 3."
    assert draft.merge_rooms(1, 2) is None
    assert names(draft) == ["West", "East"]
    assert room_at(draft.arena, 2.0, 7.0) == room_at(draft.arena, 6.0, 7.0) == 1


def test_what_cannot_be_is_refused_with_its_reason_and_changes_nothing(draft: ArenaDraft) -> None:
    before = draft.arena
    goal, start = draft.arena.rooms[0].goal, draft.arena.starts[0]
    region = draft.arena.rooms[0].region
    corner = ArenaHandle(1, max(range(len(region)), key=lambda index: sum(region[index])))
    assert "must stay in the room" in refused(draft.move(ArenaHandle(1), 6.0, 5.0))
    assert "A robot cannot turn" in refused(draft.move(ArenaHandle(1), 0.3, goal.y))
    assert "A robot cannot turn" in refused(draft.add_start(0.0, 0.0))
    assert "too near to the start pose of robot 1" in refused(draft.add_start(start.x + 0.2, start.y))
    assert "must be in a room" in refused(draft.cut_room((1.0, 1.0), (2.0, 1.0)))
    assert "no free floor" in refused(draft.draw_room((0.2, 3.0), (3.8, 7.0)))
    assert "overlap another room" in refused(draft.move(corner, 6.0, 7.5))
    assert "stay on the map" in refused(draft.move(corner, -3.0, 1.0))
    assert draft.arena == before
    assert not draft.can_undo


def test_faults_are_those_that_keep_games_from_being_played() -> None:
    cells = GRID.cells.copy()
    cells[20, 94:106] = OCCUPIED
    draft = ArenaDraft(OccupancyGrid(cells, 0.1, IDENTITY), FOUND)
    assert draft.floor.faults(draft.arena) == ("No path leads from the start of robot 1 to room 3 (East).",)
    for _ in FOUND.starts:
        draft.remove_start(0)
    assert draft.floor.faults(draft.arena) == ("There is no start pose yet.",)


def test_doors_follow_from_outlines_and_walls(draft: ArenaDraft) -> None:
    def between() -> list[tuple[int, int]]:
        return sorted((door.room.people, door.beyond.people) for door in draft.floor.doors(draft.arena))

    assert between() == [(1, 0), (1, 2), (2, 0), (3, 0)]
    draft.remove_room(2)
    assert between() == [(1, 0), (1, 0), (2, 0)]


class TestPointer:
    @pytest.fixture
    def pointer(self, draft: ArenaDraft) -> ArenaPointer:
        return ArenaPointer(draft)

    def test_a_start_is_dragged_and_shown_on_its_way(self, pointer: ArenaPointer) -> None:
        start = pointer.draft.arena.starts[1]
        pointer.press(start.x, start.y, 0.2)
        assert pointer.handle == ArenaHandle(0, 1)
        pointer.drag(start.x, 0.0)
        assert "A robot cannot turn" in pointer.refusal
        pointer.drag(10.0, 1.0)
        assert (pointer.shown.starts[1].x, pointer.draft.arena.starts[1].x) == (10.0, start.x)
        pointer.release()
        assert pointer.draft.arena.starts[1].x == 10.0
        pointer.draft.undo()
        assert pointer.draft.arena == FOUND

    def test_a_press_in_a_room_chooses_it_and_its_corners_can_be_held(self, pointer: ArenaPointer) -> None:
        x, y = pointer.draft.arena.rooms[2].region[0]
        pointer.press(9.0, 7.0, 0.2)
        pointer.release()
        assert (pointer.chosen, pointer.draft.can_undo) == (3, False)
        pointer.press(x, y, 0.2)
        pointer.drag(x + 0.3, y + 0.3)
        pointer.release()
        assert pointer.draft.arena.rooms[2].region[0] == pytest.approx((x + 0.3, y + 0.3))

    def test_a_stroke_draws_or_cuts_a_room_and_chooses_the_new_one(self, pointer: ArenaPointer) -> None:
        pointer.tool = ArenaTool.CUT
        pointer.press(2.0, 2.5, 0.2)
        pointer.drag(2.0, 7.5)
        assert pointer.stroke == ((2.0, 2.5), (2.0, 7.5))
        pointer.release()
        assert (len(pointer.draft.arena.rooms), pointer.chosen, pointer.stroke) == (4, 4, None)
        pointer.tool = ArenaTool.START
        pointer.press(11.0, 1.0, 0.2)
        assert pointer.draft.arena.starts[-1].x == 11.0

    def test_what_is_gone_is_chosen_no_more(self, pointer: ArenaPointer) -> None:
        pointer.choose(3)
        pointer.change(lambda: pointer.draft.remove_room(3))
        assert pointer.handle is None


POINTS = st.tuples(st.floats(0.0, 12.0), st.floats(0.0, 8.0))
CHANGES = st.one_of(
    st.tuples(st.just("draw_room"), POINTS, POINTS),
    st.tuples(st.just("cut_room"), POINTS, POINTS),
    st.tuples(st.just("merge_rooms"), st.integers(1, 3), st.integers(1, 3)),
    st.tuples(st.just("remove_room"), st.integers(1, 3)),
    st.tuples(st.just("renumber"), st.integers(1, 3), st.integers(0, 4)),
)


@settings(max_examples=25, deadline=None)
@given(st.lists(CHANGES, min_size=1, max_size=6))
def test_whatever_is_done_stays_sound_and_can_be_undone(changes: list[tuple]) -> None:
    draft = ArenaDraft(GRID, FOUND)
    draft.saved()
    for name, *arguments in changes:
        if name in {"draw_room", "cut_room"} or all(number <= len(draft.arena.rooms) for number in arguments[:2]):
            getattr(draft, name)(*arguments)
    after = draft.arena
    held = [cells_inside(room.region, draft.floor.map) for room in after.rooms]
    assert np.sum(held, axis=0).max(initial=0) <= 1, "no cell has two rooms"
    assert [room.room.people for room in after.rooms] == list(range(1, len(after.rooms) + 1))
    assert len({room.name for room in after.rooms}) == len(after.rooms)
    assert all(room.holds(room.goal.x, room.goal.y) for room in after.rooms)
    while draft.can_undo:
        draft.undo()
    assert draft.arena == FOUND
    assert not draft.dirty
    while draft.can_redo:
        draft.redo()
    assert draft.arena == after


def test_the_goal_of_a_cut_room_is_in_it_where_the_line_runs_through_centres_of_cells(draft: ArenaDraft) -> None:
    assert draft.cut_room((0.0, 0.0), (6.5, 6.25)) is None
    assert all(room.holds(room.goal.x, room.goal.y) for room in draft.arena.rooms)


def test_what_is_drawn_is_a_map_without_fault(draft: ArenaDraft, tmp_path: Path) -> None:
    draft.cut_room((4.5, 5.0), (7.5, 5.0))
    draft.merge_rooms(1, 2)
    write_grid(tmp_path, GRID)
    write_rooms(tmp_path, draft.arena.rooms, draft.arena.starts)
    found = check_map(tmp_path)
    if not draft.floor.faults(draft.arena):
        assert found.errors == ()
