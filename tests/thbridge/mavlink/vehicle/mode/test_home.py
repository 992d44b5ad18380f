"""Where a robot returns to: set by whoever may, where it can stand, and told to everybody."""

import math
from dataclasses import replace

import pytest

from sim.common.geometry import Pose2
from tests.support.mavlink.vehicle_with_stations import (
    ACCEPTED,
    BUSY,
    DENIED,
    NAN,
    NO_FRAME,
    OPTIONS,
    THEM,
    THERE,
    US,
    VehicleWithStations,
    messages,
)
from thbridge.mavlink.values.options import Failsafe
from thbridge.mavlink.vehicle.geodesy import GeoPoint, MapProjection
from thbridge.mavlink.wire.dialect import mav

SET_HOME = mav.MAV_CMD_DO_SET_HOME
RETURN = mav.MAV_CMD_NAV_RETURN_TO_LAUNCH
UNSET = 0x7FFFFFFF
EARTH = MapProjection(OPTIONS.origin)


def on_earth(x, y):
    """A point of the map, 1e-7 degrees."""
    place = EARTH.geo_point(x, y)
    return place.latitude, place.longitude


@pytest.fixture
def away(rig):
    """It is not where it started."""
    rig.robot.readings = replace(rig.robot.readings, base_in_map=Pose2(5.0, 6.0, 0.5))
    rig.run(1)
    return rig


def told(rig):
    """HOME_POSITION as it is told to everybody within a tick, and within that one alone."""
    words = [word for word in rig.run(1) if word.message.get_type() == "HOME_POSITION"]
    assert messages(rig.run(100), "HOME_POSITION") == []
    assert all(word.link is None and not word.to_inactive for word in words)
    return [(word.message.y, word.message.x) for word in words]


def home(rig):
    """Where it drives when it returns."""
    rig.arm(force=21196)
    assert rig.long(RETURN) == [ACCEPTED]
    return rig.robot.calls("go_to")[-1][1:]


def test_at_first_it_is_where_the_robot_started(away):
    _, told = messages(away.hear(mav.MAVLink_command_long_message(3, 1, 512, 0, 242, 0, 0, 0, 0, 0, 0)))
    assert (told.x, told.y, told.altitude, told.time_usec) == (2.0, 1.0, 55_000, away.tick * 20_000)
    assert EARTH.map_point(GeoPoint(told.latitude, told.longitude)) == pytest.approx((1.0, 2.0), abs=0.01)
    east = math.pi / 2  # from north
    assert (told.q[0], told.q[3]) == pytest.approx((math.cos(east / 2), math.sin(east / 2)))
    assert messages(away.heard, "HOME_POSITION") == [], "nobody has asked, and it has not changed"
    assert home(away) == (1.0, 2.0, 0.0)


HERE_AS_COMMANDS = {
    "long": lambda rig: rig.long(SET_HOME, 1),
    "int": lambda rig: rig.int(SET_HOME, 1, frame=3, x=0, y=0),
    "int, whatever its place": lambda rig: rig.int(SET_HOME, 1, frame=6, x=1_234, y=5_678),
    "no place": lambda rig: rig.int(SET_HOME, 0, frame=6),
    "half a place": lambda rig: rig.int(SET_HOME, 0, frame=6, x=500_000_000),
    "zeros": lambda rig: rig.int(SET_HOME, 0, frame=0, x=0, y=0),
    "zeros, long": lambda rig: rig.long(SET_HOME, 0, 0, 0, 0, 0, 0, 0),
    "nothing at all": lambda rig: rig.long(SET_HOME),
}


@pytest.mark.parametrize("way", HERE_AS_COMMANDS)
def test_where_the_robot_is_and_how_it_looks(away, way):
    assert HERE_AS_COMMANDS[way](away) == [ACCEPTED]
    assert told(away) == [(5.0, 6.0)]
    assert home(away) == (5.0, 6.0, 0.5)


@pytest.mark.parametrize(
    ("frame", "x", "y"),
    [(frame, *on_earth(3.0, -4.0)) for frame in (0, 3, 5, 6, 10, 11)] + [(1, -40_000, 30_000), (7, -100_000, -20_000)],
)
def test_a_place_that_is_given(away, frame, x, y):
    assert away.int(SET_HOME, 0, 0, 0, 0, frame=frame, x=x, y=y) == [ACCEPTED]
    assert told(away) == [pytest.approx((3.0, -4.0), abs=0.01)]
    assert home(away) == (pytest.approx(3.0, abs=0.02), pytest.approx(-4.0, abs=0.02), None)


def test_the_origin_of_the_local_frame_is_a_place(away):
    assert away.int(SET_HOME, 0, frame=1, x=0, y=0) == [ACCEPTED]
    assert told(away) == [(0.0, 0.0)]


def test_command_long_has_degrees_good_to_decimetres(away):
    latitude, longitude = on_earth(3.0, -4.0)
    assert away.long(SET_HOME, 0, 0, 0, NAN, latitude / 1e7, longitude / 1e7, 0) == [ACCEPTED]
    assert told(away) == [pytest.approx((3.0, -4.0), abs=0.4)]


def test_a_place_that_is_given_has_no_heading(away):
    away.int(SET_HOME, 0, frame=1, x=0, y=0)
    (home,) = messages(away.run(1), "HOME_POSITION")
    assert all(math.isnan(value) for value in home.q)


@pytest.mark.parametrize("frame", [2, 4, 99])
def test_an_unknown_frame_is_called_so(away, frame):
    assert away.int(SET_HOME, 0, frame=frame, x=10, y=10) == [NO_FRAME]


@pytest.mark.parametrize("params", [(2,), (-1,), (0.5,), (0, 0, 0, 0, 91.0, 0), (0, 0, 0, 0, 3.4e38, -3.4e38)])
def test_what_makes_no_sense_is_denied(away, params):
    assert away.long(SET_HOME, *params) == [DENIED]
    assert told(away) == []


def test_where_the_robot_cannot_stand_is_no_home(away):
    assert away.int(SET_HOME, 0, frame=1, x=990_000, y=0) == [DENIED]
    assert "There the map has nothing." in away.texts()
    assert told(away) == []
    assert home(away) == (1.0, 2.0, 0.0)


def test_a_robot_that_is_lost_is_nowhere(away):
    away.robot.readings = replace(away.robot.readings, lost=True)
    away.run(1)
    assert away.long(SET_HOME, 1) == [BUSY]
    assert away.int(SET_HOME, 0, frame=1, x=0, y=0) == [ACCEPTED]


def test_anybody_sets_it_until_a_station_commands_and_then_that_one_alone(away):
    assert away.long(SET_HOME, 1, station=THEM, link=THERE) == [ACCEPTED]
    away.arm(US)
    assert away.long(SET_HOME, 1, station=THEM, link=THERE) == [DENIED]
    assert "Commanded by ground station 255." in away.texts()
    assert away.long(SET_HOME, 1) == [ACCEPTED]


def test_a_repetition_is_no_other_home(away):
    away.long(SET_HOME, 1)
    away.robot.readings = replace(away.robot.readings, base_in_map=Pose2(7.0, 8.0, 0.5))
    away.run(10)
    assert away.long(SET_HOME, 1, confirmation=1) == [ACCEPTED]
    assert home(away) == (5.0, 6.0, 0.5)


def test_a_way_home_goes_on_to_where_home_was(away):
    home(away)
    away.long(SET_HOME, 1)
    away.run(3)
    assert len(away.robot.calls("go_to")) == 1


def test_a_lost_station_s_robot_goes_to_the_new_one():
    rig = VehicleWithStations(failsafe=Failsafe.HOME)
    rig.arm()
    rig.int(SET_HOME, 0, frame=1, x=40_000, y=30_000)
    rig.run(300)
    assert rig.robot.calls("go_to") == [("go_to", 3.0, 4.0, None)]
