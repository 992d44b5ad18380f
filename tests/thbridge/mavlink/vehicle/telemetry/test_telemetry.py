"""What is said of a robot is what it believes of itself."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.common.observations import Twist
from tests.support.mavlink.model_robot import AT_REST, ModelRobot
from tests.support.mavlink.vehicle_with_stations import OPTIONS, home_of
from thbridge.mavlink.values.options import AutopilotIdentity
from thbridge.mavlink.values.vehicle_interface import HelmLeg, LegState
from thbridge.mavlink.vehicle.component_files.metadata_files import MetadataFiles
from thbridge.mavlink.vehicle.geodesy import GeoPoint, MapProjection
from thbridge.mavlink.vehicle.telemetry.capabilities import Capabilities
from thbridge.mavlink.vehicle.telemetry.telemetry import Telemetry, TelemetryState, default_streams
from thbridge.mavlink.wire.dialect import decoded, mav, payload_of
from thbridge.mavlink.wire.mode_numbers import Mode

EARTH = MapProjection(OPTIONS.origin)
GYRO_ACCEL_MAG_GPS = 0b100111


def telemetry(identity=AutopilotIdentity.GENERIC):
    home = home_of(ModelRobot(), EARTH)
    particulars = Capabilities(3, identity, EARTH, MetadataFiles(ModelRobot()))
    mission_current = mav.MAVLink_mission_current_message(0)
    return Telemetry(particulars, identity, EARTH, home.position, lambda: mission_current)


def standing(mode=Mode.HOLD, armed=False, tick=100, **readings):
    return TelemetryState(tick, replace(AT_REST, **readings), mode, armed, commander=0)


def said(number, now, identity=AutopilotIdentity.GENERIC):
    message = telemetry(identity).message(number, now)
    assert message is not None
    return decoded(number, payload_of(message))


COORDINATE, SPEED, ANGLE = st.floats(-1000, 1000), st.floats(-3, 3), st.floats(-math.pi, math.pi, exclude_max=True)
MOVING = st.builds(
    lambda x, y, theta, v, w: standing(base_in_map=Pose2(x, y, theta), twist=Twist(v, w)),
    COORDINATE,
    COORDINATE,
    ANGLE,
    SPEED,
    SPEED,
)


@given(MOVING)
def test_positions_agree_with_the_estimate(now):
    pose, twist = now.readings.base_in_map, now.readings.twist
    local, world = said(32, now), said(33, now)
    assert (local.x, local.y) == (pytest.approx(pose.y, abs=1e-4), pytest.approx(pose.x, abs=1e-4))
    assert EARTH.map_point(GeoPoint(world.lat, world.lon)) == pytest.approx((pose.x, pose.y), abs=0.02)
    east, north = twist.linear * math.cos(pose.theta), twist.linear * math.sin(pose.theta)
    assert (local.vx, local.vy) == (pytest.approx(north, abs=1e-5), pytest.approx(east, abs=1e-5))
    assert (world.vx / 100, world.vy / 100) == (pytest.approx(north, abs=0.006), pytest.approx(east, abs=0.006))
    assert (world.alt, world.relative_alt) == (55_000, 0)


@pytest.mark.parametrize(("theta", "compass"), [(0.0, 90), (math.pi / 2, 0), (-math.pi, 270), (-math.pi / 2, 180)])
def test_headings_are_from_north_clockwise(theta, compass):
    now = standing(base_in_map=Pose2(0, 0, theta), twist=Twist(0.0, 0.5))
    attitude, quaternion = said(30, now), said(31, now)
    assert math.degrees(attitude.yaw) % 360 == pytest.approx(compass, abs=1e-3)
    assert attitude.yawspeed == -0.5
    assert math.degrees(2 * math.atan2(quaternion.q4, quaternion.q1)) % 360 == pytest.approx(compass, abs=1e-3)
    assert said(33, now).hdg == compass * 100
    assert said(74, now).heading == compass


@given(MOVING)
def test_a_course_is_where_it_moves_also_backwards(now):
    gps = said(24, now)
    twist = now.readings.twist
    assert gps.vel == round(abs(twist.linear) * 100)
    behind = 180.0 if twist.linear < 0 else 0.0
    turn = (gps.cog - said(33, now).hdg) / 100
    assert turn % 360 == pytest.approx(behind)
    assert 0 < gps.yaw <= 36_000


def test_a_robot_that_is_lost_has_no_fix_and_is_not_well():
    assert said(24, standing()).fix_type == mav.GPS_FIX_TYPE_3D_FIX
    assert said(24, standing(lost=True)).fix_type == mav.GPS_FIX_TYPE_NO_FIX
    well, lost = said(1, standing()), said(1, standing(lost=True))
    for bits in (well.onboard_control_sensors_present, well.onboard_control_sensors_health):
        assert bits & GYRO_ACCEL_MAG_GPS == GYRO_ACCEL_MAG_GPS
        assert bits & mav.MAV_SYS_STATUS_PREARM_CHECK
    assert not lost.onboard_control_sensors_health & mav.MAV_SYS_STATUS_SENSOR_GPS
    for told in (well, lost):
        assert not told.onboard_control_sensors_present & mav.MAV_SYS_STATUS_GEOFENCE
        assert told.onboard_control_sensors_health & mav.MAV_SYS_STATUS_GEOFENCE  # there is none that is breached
    assert said(0, standing(lost=True)).system_status == mav.MAV_STATE_CRITICAL


@pytest.mark.parametrize(
    ("energy", "capacity", "remaining", "charge"),
    [
        (100.0, 100.0, 100, 1),
        (25.0, 50.0, 50, 1),
        (10.0, 100.0, 10, 2),
        (0.0, 100.0, 0, 3),
        (-1.0, 100.0, 0, 3),
        (5.0, 0.0, -1, 3),
        (5.0, math.inf, -1, 3),
    ],
)
def test_energy_is_the_battery(energy, capacity, remaining, charge):
    now = standing(energy=energy, capacity=capacity)
    battery = said(147, now)
    assert (battery.battery_remaining, battery.charge_state) == (remaining, charge)
    assert said(1, now).battery_remaining == remaining
    assert battery.voltages_ext == [0, 0, 0, 0]


@pytest.mark.parametrize(
    ("identity", "autopilot", "numbers"),
    [
        (AutopilotIdentity.ARDUPILOT, 3, [4, 15, 10, 11, 0]),
        (AutopilotIdentity.GENERIC, 0, [0x3040000, 0x60000, 0x4040000, 0x5040000, 0x10000]),
    ],
)
def test_a_heartbeat_shows_identity_and_mode(identity, autopilot, numbers):
    for mode, number in zip(Mode, numbers, strict=True):
        beat = said(0, standing(mode, armed=True), identity)
        assert (beat.type, beat.autopilot, beat.custom_mode) == (mav.MAV_TYPE_GROUND_ROVER, autopilot, number)
        assert beat.base_mode & mav.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
        assert beat.system_status == mav.MAV_STATE_ACTIVE
    rest = said(0, standing(), identity)
    assert not rest.base_mode & mav.MAV_MODE_FLAG_SAFETY_ARMED
    assert rest.system_status == mav.MAV_STATE_STANDBY


def test_a_goal_is_told_while_there_is_one():
    bound = standing(goal_in_map=Pose2(4.0, 6.0, 1.0), leg=HelmLeg(1, LegState.UNDER_WAY, 7.0))
    for number in (62, 85, 87):
        assert telemetry().message(number, standing()) is None
    assert (said(85, bound).x, said(85, bound).y) == (6.0, 4.0)
    there = said(87, bound)
    assert EARTH.map_point(GeoPoint(there.lat_int, there.lon_int)) == pytest.approx((4.0, 6.0), abs=0.01)
    assert said(62, bound).wp_dist == 7


def test_its_estimate_is_well_unless_it_is_lost():
    armable = mav.EKF_PRED_POS_HORIZ_ABS | mav.EKF_POS_HORIZ_ABS
    assert said(193, standing()).flags & armable == armable
    assert not said(193, standing(lost=True)).flags & armable
    assert not said(193, standing()).flags & mav.EKF_CONST_POS_MODE


def test_time_is_the_simulation_s():
    assert said(30, standing(tick=50)).time_boot_ms == 1000
    assert said(2, standing(tick=50)).time_unix_usec == 0
    assert said(30, standing(tick=2**40)).time_boot_ms < 2**32, "49 days later it begins anew"


def test_what_it_says_it_can_do():
    capabilities = said(148, standing()).capabilities
    assert capabilities & 4, "MAVSDK sends no mission without it"
    assert capabilities & 32, "stations ask for no files without it"
    assert not capabilities & (16384 | 32768), "no fences, rally points"


def test_position_may_be_told_never():
    streams = default_streams(0.0, AutopilotIdentity.GENERIC)
    assert streams[30] == streams[33] == 0
    assert streams[0] == 50
