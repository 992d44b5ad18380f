"""Small questions that every vehicle answers."""

import pytest

from tests.support.mavlink.vehicle_with_stations import HERE, SECOND, THERE, US, VehicleWithStations, messages
from thbridge.mavlink.wire.dialect import mav


@pytest.fixture
def rig():
    rig = VehicleWithStations()
    rig.run(SECOND)
    return rig


def stream(group, rate, start=1):
    return mav.MAVLink_request_data_stream_message(3, 1, group, rate, start)


def count(rig, kind, link):
    said = rig.run(10 * SECOND)
    return sum(
        word.message.get_type() == kind and word.link in (None, link) and link not in word.except_links for word in said
    )


def test_a_ping_is_answered_to_who_sent_it_and_an_answer_is_not(rig):
    (pong,) = messages(rig.hear(mav.MAVLink_ping_message(123, 7, 0, 0)))
    assert (pong.time_usec, pong.seq, pong.target_system, pong.target_component) == (123, 7, *_ids(US))
    assert rig.hear(mav.MAVLink_ping_message(123, 7, 3, 1)) == []


def test_the_time_is_told_to_who_asks_and_an_answer_is_not_answered(rig):
    (answer,) = messages(rig.hear(mav.MAVLink_timesync_message(0, 55)))
    assert (answer.tc1, answer.ts1) == (rig.tick * 20_000_000, 55)
    assert rig.hear(mav.MAVLink_timesync_message(99, 55)) == []


def test_the_map_stays_where_it_is_on_earth(rig):
    (origin,) = messages(rig.hear(mav.MAVLink_set_gps_global_origin_message(3, 1, 2, 3)))
    assert (origin.latitude, origin.longitude, origin.altitude) == (524_000_000, 97_000_000, 55_000)


def test_a_group_of_streams_has_a_rate_on_a_link(rig):
    assert rig.hear(stream(6, 10)) == []
    assert count(rig, "GLOBAL_POSITION_INT", HERE) == 100
    assert count(rig, "GLOBAL_POSITION_INT", THERE) == 50
    assert count(rig, "ATTITUDE", HERE) == 50


def test_all_groups_at_once_change_no_heartbeat(rig):
    rig.hear(stream(0, 4))
    assert count(rig, "SYS_STATUS", HERE) == pytest.approx(40, abs=2)
    assert count(rig, "HEARTBEAT", HERE) == 10


def test_a_group_can_be_stopped(rig):
    rig.hear(stream(0, 4, start=0))
    assert count(rig, "ATTITUDE", HERE) == 0
    assert count(rig, "HEARTBEAT", HERE) == 10


def test_an_unknown_group_changes_nothing(rig):
    rig.hear(stream(77, 50))
    assert count(rig, "ATTITUDE", HERE) == 50


def _ids(station):
    return station.system, station.component
