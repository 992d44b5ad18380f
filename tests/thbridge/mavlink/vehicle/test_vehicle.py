"""A vehicle as a whole: what it says by itself, and when it says nothing."""

from collections import Counter
from dataclasses import replace

import pytest

from tests.support.mavlink.vehicle_with_stations import HERE, SECOND, VehicleWithStations, messages
from thbridge.mavlink.values.options import AutopilotIdentity
from thbridge.mavlink.vehicle.parts import TextSeverity
from thbridge.mavlink.wire.dialect import decoded, mav, payload_of

ONCE_A_SECOND = {
    "HEARTBEAT",
    "SYS_STATUS",
    "SYSTEM_TIME",
    "GPS_RAW_INT",
    "MISSION_CURRENT",
    "BATTERY_STATUS",
    "NAMED_VALUE_INT",
}
ARDUPILOT_TOO = {"EKF_STATUS_REPORT"}
OFTEN = {"ATTITUDE", "GLOBAL_POSITION_INT", "LOCAL_POSITION_NED", "VFR_HUD"}


@pytest.mark.parametrize("identity", AutopilotIdentity)
def test_it_says_each_of_its_streams_at_its_rate_to_all_links(identity):
    rig = VehicleWithStations(identity=identity, position_rate=10.0)
    rig.run(SECOND)
    said = rig.run(10 * SECOND)
    counts = Counter(word.message.get_type() for word in said)
    slowly = ONCE_A_SECOND | (ARDUPILOT_TOO if identity is AutopilotIdentity.ARDUPILOT else set())
    assert counts == dict.fromkeys(slowly, 10) | dict.fromkeys(OFTEN, 100)
    assert all(word.link is None for word in said)
    assert {word.message.get_type() for word in said if word.to_inactive} == {"HEARTBEAT"}


def test_what_it_says_survives_the_wire():
    rig = VehicleWithStations()
    for message in messages(rig.run(SECOND)):
        again = decoded(message.get_msgId(), payload_of(message))
        assert payload_of(again) == payload_of(message)


def test_a_robot_that_does_not_answer_has_no_voice_until_it_answers_again():
    rig = VehicleWithStations()
    alive = rig.robot.readings
    rig.robot.readings = replace(alive, responsive=False)
    assert rig.run(3 * SECOND) == []
    assert rig.arm() == []
    rig.robot.readings = alive
    assert "HEARTBEAT" in {message.get_type() for message in messages(rig.run(SECOND))}
    assert rig.arm() == [0]


def test_a_heartbeat_tells_of_a_change_at_once():
    rig = VehicleWithStations()
    rig.run(SECOND)
    rig.arm()
    (beat,) = messages(rig.run(1), "HEARTBEAT")
    assert beat.base_mode & mav.MAV_MODE_FLAG_SAFETY_ARMED
    assert beat.system_status == mav.MAV_STATE_ACTIVE


def test_it_tells_who_commands():
    rig = VehicleWithStations()
    for readings, commander in (
        (rig.robot.readings, 0),
        (replace(rig.robot.readings, commanded_by="researcher"), -1),
    ):
        rig.robot.readings = readings
        (told, *_) = messages(rig.run(SECOND), "NAMED_VALUE_INT")
        assert (told.name, told.value) == ("COMMANDER", commander)
    rig = VehicleWithStations()
    rig.arm()
    (told, *_) = messages(rig.run(SECOND), "NAMED_VALUE_INT")
    assert told.value == 255


def test_status_says_whether_mavros_would_hear_it():
    rig = VehicleWithStations()
    assert rig.status.connected
    rig.robot.readings = replace(rig.robot.readings, responsive=False)
    rig.run(1)
    assert not rig.status.connected


@pytest.mark.parametrize(
    ("mode", "guided", "manual"),
    [((4, 3), False, False), ((6, 0), True, False), ((4, 5), True, False), ((1, 0), False, True)],
)
def test_status_says_what_mavros_makes_of_a_heartbeat(mode, guided, manual):
    rig = VehicleWithStations()
    rig.arm()
    rig.mode(*mode)
    *_, beat = messages(rig.run(SECOND), "HEARTBEAT")
    flags = (
        mav.MAV_MODE_FLAG_SAFETY_ARMED,
        mav.MAV_MODE_FLAG_GUIDED_ENABLED,
        mav.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED,
    )
    assert [bool(beat.base_mode & flag) for flag in flags] == [True, guided, manual]
    status = rig.status
    assert (status.armed, status.guided, status.manual_input) == (True, guided, manual)
    assert status.system_status == beat.system_status


def test_news_of_the_game_are_told_to_people():
    rig = VehicleWithStations()
    rig.robot.readings = replace(rig.robot.readings, announcements=("Robot 3 has reached room 4.",))
    rig.run(1)
    rig.robot.readings = replace(rig.robot.readings, announcements=())
    assert rig.texts() == ["Robot 3 has reached room 4."]


def test_what_the_participant_asks_for_is_more_than_news():
    rig = VehicleWithStations()
    rig.robot.readings = replace(rig.robot.readings, participant_requests=("The participant asks for robot 3 back.",))
    (told,) = [word.message for word in rig.run(1) if word.message.get_type() == "STATUSTEXT"]
    assert (told.severity, told.text.rstrip("\0")) == (TextSeverity.NOTICE, "The participant asks for robot 3 back.")


def test_a_link_that_is_gone_takes_its_rates_along():
    rig = VehicleWithStations()
    rig.long(mav.MAV_CMD_SET_MESSAGE_INTERVAL, mav.MAVLINK_MSG_ID_ATTITUDE, 20_000)
    rig.vehicle.forget(HERE)
    assert all(word.link is None and not word.except_links for word in rig.run(SECOND))
