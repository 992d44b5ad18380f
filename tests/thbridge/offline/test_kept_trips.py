"""Trips that a stopped measurement has driven."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim.common.geometry import IDENTITY, Pose2
from sim.common.grid import OccupancyGrid
from sim.parameters import RobotParameters, WorldParameters
from thbridge.files.errors import BadFile
from thbridge.files.map_files import Map, MapRoom
from thbridge.hunt.rooms import Room
from thbridge.offline.kept_trips import KeptTrips, digest_of, kept_path
from thbridge.offline.measure import MeasurementSetup, RoomTrip, TripResult

FIRST = TripResult(RoomTrip(Room(0), Room(1), 0), 12.340000000000002, None)
SECOND = TripResult(RoomTrip(Room(1), Room(2), 3), None, "no way to the goal")


def course() -> MeasurementSetup:
    grid = OccupancyGrid(np.zeros((4, 5), np.int8), 0.5, IDENTITY)
    room = MapRoom(Room(1), "West", ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0)), Pose2(0.5, 0.5, 0.0))
    place = Map("small", grid, (room,), (Pose2(1.0, 1.0, 0.0),), None)
    return MeasurementSetup(place, WorldParameters(), RobotParameters(), 1)


@pytest.fixture
def result(tmp_path: Path) -> Path:
    """The file of a measurement, next to which two trips are kept."""
    with KeptTrips(tmp_path / "mapTimes", "same") as kept:
        kept.add(FIRST)
        kept.add(SECOND)
    return tmp_path / "mapTimes"


def test_a_killed_measurement_goes_on_with_all_whole_lines(result: Path) -> None:
    """At every byte at which its writer may have been killed."""
    whole = kept_path(result).read_bytes()
    lines = whole.splitlines(keepends=True)
    for end in range(len(whole)):
        kept_path(result).write_bytes(whole[:end])
        with KeptTrips(result, "same") as kept:
            assert not kept.done or end >= len(lines[0]) + len(lines[1]) - 1
            kept.add(SECOND)
        with KeptTrips(result, "same") as kept:
            expected = {SECOND.trip: SECOND} | ({FIRST.trip: FIRST} if end >= len(whole) - len(lines[2]) - 1 else {})
            assert kept.done == expected
            assert not kept.dropped


def test_trips_with_other_settings_are_dropped(result: Path) -> None:
    with KeptTrips(result, "other") as kept:
        assert kept.dropped
        assert kept.done == {}
    assert not kept_path(result).exists()


def test_whatever_trips_depend_on_changes_the_digest() -> None:
    one = course()
    place = one.place
    cells = place.grid.cells.copy()
    cells[0, 0] = 100
    others = [
        replace(one, place=replace(place, grid=replace(place.grid, cells=cells))),
        replace(one, place=replace(place, starts=(Pose2(1.0, 1.0, 0.1),))),
        replace(one, place=replace(place, rooms=(replace(place.rooms[0], goal=Pose2(0.6, 0.5, 0.0)),))),
        replace(one, world=replace(one.world, footprint=((0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2)))),
        replace(one, robot=replace(one.robot, localization="ekf")),
        replace(one, seed=2),
    ]
    digests = {digest_of(each, {"thbridge": "1"}) for each in others} | {digest_of(one, {"thbridge": "2"})}
    assert len(digests - {digest_of(one, {"thbridge": "1"})}) == len(others) + 1
    assert digest_of(replace(one, place=replace(place, name="renamed")), {}) == digest_of(one, {})


def test_a_folder_that_cannot_be_written_is_named_before_driving(tmp_path: Path) -> None:
    with pytest.raises(BadFile, match=r"mapTimes\.trips: it cannot be written"):
        KeptTrips(tmp_path / "none" / "mapTimes", "same")
