from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from scipy.ndimage import label, rotate

from sim.common.geometry import IDENTITY, Pose2
from sim.common.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from sim.common.traversability import TraversabilityMap, crosses_itself, inside
from sim.robot.costmap.footprint import radii
from tests.support.slow import slow
from thbridge.files.map_files import FOOTPRINT, Map, read_map
from thbridge.files.resources import shipped
from thbridge.offline.arena import arena_of, outline_of, simplified
from thbridge.offline.map_survey import owners_of, survey
from thbridge.offline.room_finding import Labels, find_rooms, in_reading_order

INSCRIBED, CIRCUMSCRIBED = radii(np.array(FOOTPRINT))


def drawn_by_hand(name: str) -> tuple[OccupancyGrid, Labels]:
    """A map of the project, and the rooms that a person drew on its floor."""
    place = read_map(shipped().find("maps", name, Path()))
    owners = owners_of(place, TraversabilityMap.of(place.grid, INSCRIBED, CIRCUMSCRIBED))
    return place.grid, np.where(place.grid.cells == FREE, owners, 0).astype(np.int32)


def agreement(found: Labels, drawn: Labels) -> list[float]:
    """Intersection over union of each drawn room with the found one that holds most of it."""
    shares = []
    for number in range(1, int(drawn.max()) + 1):
        room = drawn == number
        counts = np.bincount(found[room], minlength=2)
        counts[0] = 0
        other = found == counts.argmax() if counts.any() else np.zeros_like(room)
        shares.append(float((room & other).sum() / (room | other).sum()))
    return shares


@pytest.mark.parametrize(
    ("name", "least"), [("arena8", 0.98), ("warehouse12", 0.98), ("practice", 0.98), ("office", 0.93)]
)
def test_rooms_are_those_that_a_person_drew(name: str, least: float) -> None:
    grid, drawn = drawn_by_hand(name)
    found = find_rooms(grid, INSCRIBED, CIRCUMSCRIBED)
    assert found.max() == drawn.max()
    assert min(agreement(found, drawn)) >= least


@pytest.mark.parametrize("name", ["arena8", "warehouse12"])
@pytest.mark.parametrize("angle", [90, 17, *slow(-40)])
def test_a_turned_map_has_the_same_rooms(name: str, angle: float) -> None:
    grid, drawn = drawn_by_hand(name)
    turned = rotate(grid.cells, angle, order=0, cval=UNKNOWN)
    # Thin walls turned by nearest cells get holes; a scan has walls without.
    turned[(rotate((grid.cells == OCCUPIED).astype(float), angle, order=1) > 0.25)] = OCCUPIED
    found = find_rooms(OccupancyGrid(turned, grid.resolution, IDENTITY), INSCRIBED, CIRCUMSCRIBED)
    rooms = rotate(drawn, angle, order=0, cval=0)
    assert found.max() == drawn.max()
    assert min(agreement(found, np.where(turned == FREE, rooms, 0))) >= 0.9


@pytest.mark.parametrize("name", ["arena8", "warehouse12", "office"])
@pytest.mark.parametrize("seed", [1, *slow(2, 3)])
def test_a_scan_with_specks_holes_and_ragged_walls_has_the_same_rooms(name: str, seed: int) -> None:
    grid, drawn = drawn_by_hand(name)
    chance = np.random.default_rng(seed)
    cells = np.full((grid.rows + 40, grid.cols + 40), UNKNOWN, dtype=np.int8)
    inner = cells[20:-20, 20:-20]
    inner[:] = grid.cells
    clearance = TraversabilityMap.of(grid, INSCRIBED, CIRCUMSCRIBED).clearance
    inner[(clearance <= 1.5 * grid.resolution) & (chance.random(inner.shape) < 0.3)] = OCCUPIED
    # None in a door, which it would block.
    inner[(clearance > 0.7) & (chance.random(inner.shape) < 0.002)] = OCCUPIED
    inner[(clearance > 0.7) & (chance.random(inner.shape) < 0.002)] = UNKNOWN
    found = find_rooms(OccupancyGrid(cells, grid.resolution, IDENTITY), INSCRIBED, CIRCUMSCRIBED)[20:-20, 20:-20]
    assert found.max() == drawn.max()
    # Where a door is as wide as the corridor, the dead end before it may go to the room.
    assert min(agreement(found, np.where(inner == FREE, drawn, 0))) >= 0.75


def test_the_wanted_number_of_rooms_are_the_largest() -> None:
    grid, drawn = drawn_by_hand("warehouse12")
    found = find_rooms(grid, INSCRIBED, CIRCUMSCRIBED, wanted=4)
    areas = np.sort(np.bincount(drawn.ravel())[1:])
    assert found.max() == 4
    assert np.bincount(found.ravel())[1:].min() >= areas[-4] * 0.98


def test_an_opening_wider_than_any_door_parts_no_rooms() -> None:
    cells = np.full((220, 660), FREE, dtype=np.int8)
    cells[:, :2] = cells[:, -2:] = cells[:2] = cells[-2:] = OCCUPIED
    for opening, rooms in ((30, 2), (80, 1)):
        cells[:, 218:222] = cells[:, 438:442] = OCCUPIED
        cells[110 - opening // 2 : 110 + opening // 2] = np.where(np.arange(660) % 658 < 2, OCCUPIED, FREE)
        assert find_rooms(OccupancyGrid(cells, 0.25, IDENTITY), INSCRIBED, CIRCUMSCRIBED).max() == rooms


def test_unknown_space_is_no_floor_and_a_map_without_floor_has_no_rooms() -> None:
    nothing = OccupancyGrid(np.full((50, 50), UNKNOWN, dtype=np.int8), 0.1, IDENTITY)
    assert find_rooms(nothing, INSCRIBED, CIRCUMSCRIBED).max() == 0


def test_white_paper_around_a_plan_is_no_room() -> None:
    grid, drawn = drawn_by_hand("arena8")
    paper = OccupancyGrid(np.pad(grid.cells, 60, constant_values=FREE), grid.resolution, IDENTITY)
    assert find_rooms(paper, INSCRIBED, CIRCUMSCRIBED).max() == drawn.max()


def test_rooms_are_numbered_as_one_reads() -> None:
    labels = np.zeros((10, 10), dtype=np.int32)
    labels[6:9, 7:9], labels[7:10, 1:4], labels[1:3, 2:9] = 1, 2, 3
    ordered = in_reading_order(labels)
    assert [ordered[8, 2], ordered[7, 7], ordered[2, 2]] == [1, 2, 3]


@pytest.mark.parametrize("name", ["practice", "office", *slow("arena8", "warehouse12")])
@pytest.mark.parametrize("origin", [Pose2(3.0, -2.0, 0.6), *slow(IDENTITY)])
def test_an_arena_is_playable(name: str, origin: Pose2) -> None:
    cells = drawn_by_hand(name)[0]
    grid = OccupancyGrid(cells.cells, cells.resolution, origin)
    found = find_rooms(grid, INSCRIBED, CIRCUMSCRIBED)
    arena = arena_of(grid, found, 5, ["Kitchen"])
    assert [room.name for room in arena.rooms[:2]] == ["Kitchen", "Room 2"]
    assert len(arena.starts) == 5
    place = Map(name, grid, arena.rooms, arena.starts, None)
    assert all(place.room_at(start.x, start.y) is None for start in arena.starts)
    seen = survey(place)
    assert seen.reachable == seen.pairs == len(arena.rooms) ** 2
    assert all(entry.doors for entry in seen.rooms)


@settings(max_examples=60, deadline=None)
@given(arrays.arrays(np.bool_, st.tuples(st.integers(1, 12), st.integers(1, 12))))
def test_an_outline_holds_exactly_the_cells_it_is_of(cells: np.ndarray) -> None:
    pieces, _ = label(cells)
    piece = pieces == 1
    if not piece.any():
        return
    outline = outline_of(piece)
    rows, cols = np.indices(piece.shape)
    held = inside(tuple(outline), cols + 0.5, rows + 0.5)
    assert (held >= piece).all()
    assert not crosses_itself(tuple(outline))
    holes, _ = label(np.pad(~piece, 1, constant_values=True))
    outside = (holes == holes[0, 0])[1:-1, 1:-1]
    assert not (held & outside).any()
    assert simplified(outline, 0.0)[0] == outline[0]


def test_a_goal_is_not_behind_a_gap_that_is_hardly_wider_than_a_robot() -> None:
    cells = np.full((120, 120), OCCUPIED, dtype=np.int8)
    cells[2:40, 2:118] = cells[44:118, 2:118] = FREE
    cells[40:44, 20:44] = FREE
    for number, gap in enumerate((40, 17)):
        cells[44 + gap : 118, 50:60] = OCCUPIED
        labels = np.zeros(cells.shape, dtype=np.int32)
        labels[44:118, 2:118] = 1
        (room,) = arena_of(OccupancyGrid(cells, 0.05, IDENTITY), labels, 1).rooms
        assert (room.goal.x > 60 * 0.05) == (number == 0)
