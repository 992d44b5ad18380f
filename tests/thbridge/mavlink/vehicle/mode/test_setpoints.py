"""Sticks and setpoints."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.common.observations import STANDSTILL, Twist
from tests.support.mavlink.vehicle_with_stations import ACCEPTED, SECOND, THEM, US, VehicleWithStations
from thbridge.mavlink.values.options import AutopilotIdentity
from thbridge.mavlink.wire.dialect import mav

POSITION, VELOCITY, POSITION_YAW = 0b1101_1111_1000, 0b1101_1100_0111, 0b1001_1111_1000
VELOCITY_RATE, RATE = 0b0101_1100_0111, 0b0101_1111_1111
NED, OFFSET, BODY = 1, 7, 8
GUIDED, MANUAL = (6, 0), (1, 0)
NO_AXIS = 0x7FFF


@pytest.fixture
def rig():
    rig = VehicleWithStations()
    rig.arm()
    rig.run(1)
    return rig


def stick(rig, x=0, r=0, y=0, station=US, target=3):
    return rig.hear(mav.MAVLink_manual_control_message(target, x, y, 500, r, 0), station)


def setpoint(rig, mask, x=0.0, y=0.0, vx=0.0, vy=0.0, yaw=0.0, rate=0.0, frame=NED, station=US):
    message = mav.MAVLink_set_position_target_local_ned_message(
        0, 3, 1, frame, mask, x, y, 0, vx, vy, 0, 0, 0, 0, yaw, rate
    )
    return rig.hear(message, station)


def driven(rig):
    return [call[1] for call in rig.robot.calls("drive")]


# -- sticks


def test_a_stick_drives_in_mode_manual(rig):
    rig.mode(*MANUAL)
    stick(rig, x=500, r=250)
    assert driven(rig) == [Twist(0.5, -0.25)], "to the right is clockwise"


@pytest.mark.parametrize("mode", [(4, 3), GUIDED])
def test_a_stick_is_passed_over_in_other_modes(rig, mode):
    rig.mode(*mode)
    stick(rig, x=500)
    stick(rig, x=500, station=THEM)
    assert driven(rig) == []
    assert rig.texts() == ["Commanded by ground station 255."], "and nobody is told that theirs is in vain"


def test_a_stick_for_another_robot_is_not_ours(rig):
    rig.mode(*MANUAL)
    stick(rig, x=500, target=4)
    stick(rig, x=500, target=0)
    assert driven(rig) == []


def test_only_the_commander_s_stick_drives(rig):
    rig.mode(*MANUAL)
    stick(rig, x=500, station=THEM)
    assert driven(rig) == []
    assert "Commanded by ground station 255." in rig.texts()


def test_a_stick_that_falls_silent_stops_the_robot_within_half_a_second(rig):
    rig.mode(*MANUAL)
    stick(rig, x=1000)
    rig.run(SECOND // 2 - 1)
    assert set(driven(rig)) == {Twist(1.0, 0.0)}
    rig.run(1)
    assert driven(rig)[-2:] == [Twist(1.0, 0.0), STANDSTILL]
    drives = len(driven(rig))
    rig.run(SECOND)
    assert len(driven(rig)) == drives


def test_an_axis_that_is_not_there(rig):
    rig.mode(*MANUAL)
    stick(rig, x=NO_AXIS)
    assert driven(rig) == []
    stick(rig, x=100, y=1000, r=NO_AXIS)
    assert driven(rig) == [Twist(0.1, -1.0)]


@given(st.integers(-(2**15), 2**15 - 1), st.integers(-(2**15), 2**15 - 1))
def test_a_stick_is_never_beyond_the_fastest(x, r):
    rig = VehicleWithStations()
    rig.arm()
    rig.mode(*MANUAL)
    stick(rig, x=x, r=r)
    assert all(abs(twist.linear) <= 1.0 and abs(twist.angular) <= 1.0 for twist in driven(rig))


def test_a_radio_steers_by_channel_one_and_drives_by_three(rig):
    rig.mode(*MANUAL)
    rig.hear(mav.MAVLink_rc_channels_override_message(3, 1, 1750, 0, 1250, 0, 0, 0, 0, 0))
    rig.hear(mav.MAVLink_rc_channels_override_message(3, 1, 65535, 0, 2000, 0, 0, 0, 0, 0))
    rig.hear(mav.MAVLink_rc_channels_override_message(3, 1, 65535, 0, 65535, 0, 0, 0, 0, 0))
    assert driven(rig) == [Twist(-0.5, -0.5), Twist(1.0, 0.0)]


def test_a_radio_that_is_released_stops_the_robot(rig):
    released = mav.MAVLink_rc_channels_override_message(3, 1, 0, 0, 0, 0, 0, 0, 0, 0)
    rig.mode(*MANUAL)
    rig.hear(released)
    assert driven(rig) == []
    rig.hear(mav.MAVLink_rc_channels_override_message(3, 1, 1500, 0, 2000, 0, 0, 0, 0, 0))
    rig.hear(released)
    assert driven(rig) == [Twist(1.0, 0.0), STANDSTILL]


def test_what_is_said_to_ardupilot_by_hand_holds_for_three_seconds():
    rig = VehicleWithStations(identity=AutopilotIdentity.ARDUPILOT)
    rig.arm()
    rig.mode(0)
    stick(rig, x=1000)
    rig.run(3 * SECOND - 1, beating=(US,))
    assert set(driven(rig)) == {Twist(1.0, 0.0)}
    rig.run(1)
    assert driven(rig)[-1] == STANDSTILL
    rig.mode(15)
    setpoint(rig, VELOCITY, vx=0.5, frame=BODY)
    rig.run(3 * SECOND - 1, beating=(US,))
    assert driven(rig)[-1] == Twist(0.5, 0.0)
    rig.run(1)
    assert driven(rig)[-1] == STANDSTILL


# -- setpoints


@pytest.mark.parametrize("mode", [(4, 3), MANUAL])
def test_setpoints_are_passed_over_unless_guided(rig, mode):
    rig.mode(*mode)
    setpoint(rig, POSITION, x=1, y=1)
    setpoint(rig, VELOCITY, vx=1)
    assert rig.robot.calls("go_to") == driven(rig) == []


def test_only_the_commander_s_setpoints_are_followed(rig):
    rig.mode(*GUIDED)
    setpoint(rig, POSITION, x=1, y=1, station=THEM)
    assert rig.robot.calls("go_to") == []
    assert "Commanded by ground station 255." in rig.texts()


def test_a_position_is_gone_to_once_however_often_it_is_said(rig):
    rig.mode(*GUIDED)
    for _ in range(20):
        setpoint(rig, POSITION, x=10.0, y=20.0)
        rig.run(2)
    assert rig.robot.calls("go_to") == [("go_to", 20.0, 10.0, None)]
    rig.robot.arrive()
    rig.run(2)
    setpoint(rig, POSITION, x=10.0, y=20.0)
    setpoint(rig, POSITION, x=11.0, y=20.0)
    assert len(rig.robot.calls("go_to")) == 2


def test_a_position_that_failed_is_tried_again(rig):
    rig.mode(*GUIDED)
    setpoint(rig, POSITION, x=10.0, y=20.0)
    rig.robot.fail("blocked")
    rig.run(1)
    setpoint(rig, POSITION, x=10.0, y=20.0)
    assert len(rig.robot.calls("go_to")) == 2


def test_a_position_may_bring_a_heading(rig):
    rig.mode(*GUIDED)
    setpoint(rig, POSITION_YAW, x=1.0, y=1.0, yaw=math.pi / 2)
    assert rig.robot.calls("go_to")[0][3] == pytest.approx(0.0, abs=1e-6)


def test_a_place_on_earth_is_a_position_too(rig):
    rig.mode(*GUIDED)
    where = (524_000_000, 97_000_000, 0.0)
    message = mav.MAVLink_set_position_target_global_int_message(0, 3, 1, 6, POSITION, *where, *[0.0] * 8)
    rig.hear(message)
    assert rig.robot.calls("go_to") == [("go_to", 0.0, 0.0, None)]


def test_a_velocity_in_the_robot_s_frame_drives_it_so(rig):
    rig.mode(*GUIDED)
    setpoint(rig, VELOCITY_RATE, vx=0.5, vy=0.3, rate=0.4, frame=BODY)
    (twist,) = driven(rig)
    assert (twist.linear, twist.angular) == (pytest.approx(0.5), pytest.approx(-0.4))


def test_a_rate_alone_turns_on_the_spot(rig):
    rig.mode(*GUIDED)
    setpoint(rig, RATE, vx=9.0, rate=-0.4)
    (twist,) = driven(rig)
    assert (twist.linear, twist.angular) == (0.0, pytest.approx(0.4))


def test_a_rate_beside_a_velocity_of_nothing_turns_on_the_spot_in_any_frame(rig):
    # As mavros says what is published on setpoint_velocity/cmd_vel: by default along the map's axes.
    rig.mode(*GUIDED)
    setpoint(rig, VELOCITY_RATE, rate=-0.4)
    (twist,) = driven(rig)
    assert (twist.linear, twist.angular) == (0.0, pytest.approx(0.4))


def test_a_velocity_in_the_map_s_frame_turns_the_robot_to_it(rig):
    rig.mode(*GUIDED)
    # The model looks east; north is to its left.
    setpoint(rig, VELOCITY, vx=0.5)
    (twist,) = driven(rig)
    assert twist.linear == pytest.approx(0.0, abs=1e-6)
    assert twist.angular == 1.0
    rig.robot.readings = replace(rig.robot.readings, base_in_map=Pose2(0, 0, math.pi / 2))
    rig.run(1)
    assert driven(rig)[-1].linear == pytest.approx(0.5)
    setpoint(rig, VELOCITY)
    assert driven(rig)[-1] == STANDSTILL


def test_a_velocity_that_falls_silent_ends_within_half_a_second(rig):
    rig.mode(*GUIDED)
    setpoint(rig, VELOCITY, vy=0.5)
    rig.run(SECOND)
    assert driven(rig)[SECOND // 2 - 1] != STANDSTILL
    assert driven(rig)[SECOND // 2 :] == [STANDSTILL]


def test_a_stop_ends_a_velocity(rig):
    rig.mode(*GUIDED)
    setpoint(rig, VELOCITY, vy=0.5)
    rig.mode(4, 3, station=THEM)
    before = driven(rig)
    rig.run(SECOND)
    assert driven(rig) == before


@given(
    st.integers(0, 0xFFFF), st.integers(0, 255), st.lists(st.floats(width=32), min_size=11, max_size=11), st.booleans()
)
def test_no_setpoint_asks_for_what_is_no_number(mask, frame, values, globally):
    rig = VehicleWithStations()
    rig.arm()
    rig.mode(*GUIDED)
    kind = mav.MAVLink_set_position_target_local_ned_message
    if globally:
        kind = mav.MAVLink_set_position_target_global_int_message
        values = [2**31 - 1, -(2**31), *values[2:]]
    rig.hear(kind(0, 3, 1, frame, mask, *values))
    rig.run(2)
    for _, *numbers in rig.robot.calls("go_to"):
        assert all(number is None or math.isfinite(number) for number in numbers)
    assert all(math.isfinite(twist.linear) and math.isfinite(twist.angular) for twist in driven(rig))


def test_what_is_asked_by_setpoints_is_not_acknowledged(rig):
    assert rig.mode(*GUIDED) == [ACCEPTED]
    assert setpoint(rig, POSITION) == []
