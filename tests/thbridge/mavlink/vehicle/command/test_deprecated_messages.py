"""Messages that were there before the commands for the same."""

import pytest

from tests.support.mavlink.vehicle_with_stations import ACCEPTED, DENIED, OPTIONS, THEM, US, acks, messages
from thbridge.mavlink.vehicle.geodesy import MapProjection
from thbridge.mavlink.wire.dialect import mav

EARTH = MapProjection(OPTIONS.origin)


def set_home(rig, x, y, station=US):
    """SET_HOME_POSITION with a point of the map; what everybody hears of home then. The rest of it is of no account."""
    place = EARTH.geo_point(x, y)
    return set_home_on_earth(rig, place.latitude, place.longitude, station)


def set_home_on_earth(rig, latitude, longitude, station=US):
    fields = (0, 7, 7, 7, [1, 0, 0, 0], 7, 7, 7)
    assert rig.hear(mav.MAVLink_set_home_position_message(3, latitude, longitude, *fields), station) == []
    return [(told.y, told.x) for told in messages(rig.run(1), "HOME_POSITION")]


def test_the_older_message_sets_modes_too(armed):
    said = armed.hear(mav.MAVLink_set_mode_message(3, 1, 6 << 16))
    assert acks(said, mav.MAVLINK_MSG_ID_SET_MODE) == [ACCEPTED]
    assert armed.status.mode == "GUIDED"
    assert acks(armed.hear(mav.MAVLink_set_mode_message(3, 1, 999)), mav.MAVLINK_MSG_ID_SET_MODE) == [DENIED]
    assert acks(armed.hear(mav.MAVLink_set_mode_message(3, 1, 4 << 16 | 4 << 24)), mav.MAVLINK_MSG_ID_SET_MODE) != [0]
    assert "There is no mission." in armed.texts()


def item(current, frame=6, x=524_000_000, y=97_000_000):
    return mav.MAVLink_mission_item_int_message(3, 1, 0, frame, 16, current, 1, 0, 0, 0, 0, x, y, 0)


def test_a_guided_item_is_gone_to(armed):
    (ack,) = messages(armed.hear(item(current=2)))
    assert (ack.get_type(), ack.type, ack.target_system) == ("MISSION_ACK", mav.MAV_MISSION_ACCEPTED, US.system)
    old = mav.MAVLink_mission_item_message(3, 1, 0, 3, 16, 2, 1, 0, 0, 0, 0, 52.4, 9.7, 0)
    assert messages(armed.hear(old))[0].type == mav.MAV_MISSION_ACCEPTED
    first, second = armed.robot.calls("go_to")
    assert first == ("go_to", 0.0, 0.0, None)
    assert second[1:3] == pytest.approx((0.0, 0.0), abs=0.4), "as good as 32-bit floats are"


def test_a_guided_item_of_another_station_or_frame_is_denied(armed):
    assert messages(armed.hear(item(current=2), THEM))[0].type == mav.MAV_MISSION_DENIED
    assert "Commanded by ground station 255." in armed.texts()
    assert messages(armed.hear(item(current=2, frame=1)))[0].type == mav.MAV_MISSION_DENIED
    assert "Only a latitude and a longitude can be gone to this way." in armed.texts()
    assert armed.robot.calls("go_to") == []


@pytest.mark.parametrize("bad", [float("nan"), float("inf")])
def test_a_guided_item_at_no_place_is_denied(armed, bad):
    old = mav.MAVLink_mission_item_message(3, 1, 0, 3, 16, 2, 1, 0, 0, 0, 0, 52.4, bad, 0)
    assert messages(armed.hear(old))[0].type == mav.MAV_MISSION_DENIED
    assert armed.robot.calls("go_to") == []


def test_the_operator_s_control_is_the_command(rig):
    def change(request, station=US):
        (said,) = rig.hear(mav.MAVLink_change_operator_control_message(3, request, 0, b""), station)
        rig.run(1)
        return said.message.gcs_system_id, said.message.control_request, said.message.ack

    assert change(0) == (255, 0, 0)
    assert rig.go(1, 1) == [ACCEPTED]
    assert change(0, THEM) == (245, 0, 3)
    assert "Commanded by ground station 255." in rig.texts()
    assert change(1, THEM) == (245, 1, 0)
    assert rig.go(1, 1) == [ACCEPTED], "who is not in command has nothing to give back"
    assert change(1) == (255, 1, 0)
    assert rig.robot.calls("release")


def test_home_is_set_to_a_place(rig):
    assert set_home(rig, 3.0, -4.0) == [pytest.approx((3.0, -4.0), abs=0.01)]


def test_home_at_zeros_is_where_the_robot_is(rig):
    assert set_home(rig, 3.0, -4.0) != [(1.0, 2.0)]
    assert set_home_on_earth(rig, 0, 0) == [(1.0, 2.0)]


def test_what_is_no_home_is_told(rig):
    assert set_home(rig, 99.0, 0.0) == []
    assert rig.texts() == ["There the map has nothing."]


def test_who_is_not_in_command_sets_no_home(armed):
    assert set_home(armed, 3.0, -4.0, THEM) == []
    assert "Commanded by ground station 255." in armed.texts()
