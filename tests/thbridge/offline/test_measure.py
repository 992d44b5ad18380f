import math
from pathlib import Path

import pytest
from scipy.stats import spearmanr

from sim.parameters import RobotParameters, WorldParameters
from thbridge.files.map_files import read_map
from thbridge.files.map_times import read_map_times
from thbridge.files.resources import shipped
from thbridge.hunt.rooms import Room
from thbridge.offline.measure import MeasurementSetup, RoomTrip, TripResult, by_pair, drive, trips


def course(seed: int = 1) -> MeasurementSetup:
    place = read_map(shipped().find("maps", "arena8", Path()))
    return MeasurementSetup(place, WorldParameters(), RobotParameters(localization="truth"), seed)


def test_every_room_is_driven_to_from_every_other_place() -> None:
    found = list(trips(course().place, runs=2))
    assert len(set(found)) == len(found) == 2 * (8 + 8 * 7)
    assert all(trip.start != trip.goal and not trip.goal.is_corridor for trip in found)


def test_a_trip_takes_what_its_way_takes_and_the_same_again() -> None:
    near, far = RoomTrip(Room(7), Room(6), 0), RoomTrip(Room(3), Room(4), 0)
    first = drive(course(), near)
    assert first.refusal is None
    assert first.seconds is not None
    assert drive(course(), near) == first
    assert drive(course(seed=2), far) != drive(course(), far)
    longer = drive(course(), far).seconds
    assert longer is not None
    assert longer > 1.3 * first.seconds


def test_runs_from_the_corridor_leave_from_different_starts() -> None:
    one, other = (drive(course(), RoomTrip(Room(0), Room(6), run)).seconds for run in (0, 3))
    assert one is not None and other is not None
    assert abs(one - other) > 1.0


def test_trips_that_fail_are_told_apart_from_those_that_arrive() -> None:
    done = [
        TripResult(RoomTrip(Room(1), Room(2), 1), 12.0, None),
        TripResult(RoomTrip(Room(2), Room(1), 0), None, "no way"),
        TripResult(RoomTrip(Room(1), Room(2), 0), 10.0, None),
    ]
    there, back = by_pair(done)
    assert (there.seconds, there.mean) == ((10.0, 12.0), 11.0)
    assert there.deviation == pytest.approx(math.sqrt(2.0))
    assert (back.seconds, back.mean, back.refusals) == ((), None, ("no way",))


@pytest.mark.slow
def test_times_rank_like_those_of_2016() -> None:
    driven = MeasurementSetup(course().place, WorldParameters(), RobotParameters(), 1)
    measured = by_pair(drive(driven, trip) for trip in trips(driven.place, 1))
    costs = read_map_times(shipped().find("templates", "original-2016", Path()) / "mapTimes")
    pairs = [(times.mean, costs.cost(times.start, times.goal)) for times in measured]
    assert len(pairs) == 64
    assert all(mean is not None for mean, _ in pairs)
    assert spearmanr(*zip(*pairs, strict=True)).statistic >= 0.85
