import dataclasses
from pathlib import Path

import numpy as np
import pytest

from sim.common.geometry import IDENTITY, Pose2
from sim.common.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from thbridge.files.map_files import Map, MapRoom, read_map
from thbridge.files.resources import shipped
from thbridge.hunt.rooms import CORRIDOR, Room
from thbridge.offline.map_survey import survey


def three_rooms(origin: Pose2 = IDENTITY) -> Map:
    """9 m x 4 m: room 1, a door of 1 m to room 2, one of 1.2 m to the corridor; room 3 is shut in."""
    cells = np.full((40, 90), FREE, dtype=np.int8)
    cells[[0, -1], :] = OCCUPIED
    cells[:, [0, -1]] = OCCUPIED
    cells[:, [30, 60]] = OCCUPIED
    cells[5:15, 30] = FREE
    cells[20:32, 60] = FREE
    cells[:, 75] = UNKNOWN
    rooms = [
        MapRoom(Room(number), name, tuple(map(origin.transform, box)), origin.compose(Pose2(x, 2.0, 0.0)))
        for number, name, box, x in (
            (1, "West", ((0.0, 0.0), (3.05, 0.0), (3.05, 4.0), (0.0, 4.0)), 1.5),
            (2, "Middle", ((3.05, 0.0), (6.05, 0.0), (6.05, 4.0), (3.05, 4.0)), 4.5),
            (3, "Shut", ((7.55, 0.0), (9.0, 0.0), (9.0, 4.0), (7.55, 4.0)), 8.2),
        )
    ]
    return Map("three", OccupancyGrid(cells, 0.1, origin), tuple(rooms), (origin.compose(Pose2(6.8, 2.0, 0.0)),), None)


@pytest.mark.parametrize("origin", [IDENTITY, Pose2(-3.0, 5.0, 0.7)])
def test_rooms_have_their_free_floor_and_the_doors_that_robots_fit_through(origin: Pose2) -> None:
    seen = survey(three_rooms(origin))
    doors = [[(door.room, door.beyond, round(door.width, 2)) for door in entry.doors] for entry in seen.rooms]
    inner, outer = (Room(1), Room(2), 1.0), (Room(2), CORRIDOR, 1.2)
    assert doors == [[inner], [inner, outer], []]
    at = origin.inverse().transform(np.array([[seen.rooms[1].doors[1].x, seen.rooms[1].doors[1].y]]))[0]
    assert at == pytest.approx([6.05, 2.6], abs=0.1)
    assert [entry.area for entry in seen.rooms] == pytest.approx(
        [29 * 0.38 + 0.1, 29 * 0.38 + 0.12, 13 * 0.38], abs=0.2
    )
    assert (seen.pairs, seen.reachable) == (9, 4)
    assert seen.free + seen.occupied + seen.unknown == pytest.approx(1.0)
    assert seen.unknown == pytest.approx(1 / 90)


@pytest.mark.parametrize("name", ["arena8", "office", "practice", "warehouse12"])
def test_every_room_of_the_maps_that_come_along_has_a_door_and_is_reached(name: str) -> None:
    seen = survey(read_map(shipped().find("maps", name, Path())))
    assert all(entry.doors for entry in seen.rooms)
    assert seen.reachable == seen.pairs == len(seen.rooms) ** 2


def test_a_robot_too_wide_for_a_door_finds_none_there() -> None:
    wide = ((0.7, 0.7), (-0.7, 0.7), (-0.7, -0.7), (0.7, -0.7))
    assert [entry.doors for entry in survey(three_rooms(), wide).rooms] == [(), (), ()]


def test_a_map_without_starts_has_ways_between_rooms_alone() -> None:
    seen = survey(dataclasses.replace(three_rooms(), starts=()))
    assert (seen.pairs, seen.reachable) == (6, 2)
