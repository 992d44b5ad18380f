"""pymavlink's `mavutil`, with which most scripts for drones are written: two of them at once, by UDP and by TCP."""

import math
from collections.abc import Iterator

import pytest
from pymavlink import mavwp

from tests.peers.mavutil_script import PATIENCE, Script, mav
from tests.peers.rover_session import degrees, metres, rovers
from tests.support.programs.ports import free_port, free_udp_port
from tests.support.programs.processes import Program, until

PARAMETER = "SIM_ODOM_ALPHA1"


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Script, Script, Program]]:
    udp, tcp = free_udp_port(), free_port()
    one = Script(f"udpin:127.0.0.1:{udp}", 255)
    ports = ("--identity", "ardupilot", "--tcp", f"127.0.0.1:{tcp}")
    with rovers(tmp_path_factory.mktemp("mavutil"), (udp,), *ports) as play:
        until("the robots to be reached", lambda: "MAVLink links of the robots" in play.text, [play])
        other = Script(f"tcp:127.0.0.1:{tcp}", 254)
        for script, system in ((one, 1), (other, 2)):
            script.beat()
            assert script.master.wait_heartbeat(timeout=PATIENCE) is not None
            script.follows(system)
            script.hears("HEARTBEAT")
        yield one, other, play
    for script in (one, other):
        script.master.close()


@pytest.fixture(scope="module")
def one(both: tuple[Script, Script, Program]) -> Script:
    return both[0]


def test_modes_are_changed_by_name(one: Script) -> None:
    assert {"MANUAL", "HOLD", "AUTO", "RTL", "GUIDED"} <= set(one.master.mode_mapping())
    one.arms()
    one.master.set_mode("GUIDED")
    one.is_in("GUIDED")
    one.master.set_mode("HOLD")
    one.is_in("HOLD")
    one.master.set_mode_rtl()
    one.is_in("RTL")
    one.master.arducopter_disarm()


def test_home_is_set_and_returned_to(one: Script) -> None:
    latitude, longitude = degrees(0.2, 0.7)
    place = (0, 0, 0, 0, round(latitude * 1e7), round(longitude * 1e7), 0)
    one.master.mav.command_int_send(1, 1, mav.MAV_FRAME_GLOBAL_INT, mav.MAV_CMD_DO_SET_HOME, 0, 0, *place)
    assert one.result(mav.MAV_CMD_DO_SET_HOME) == mav.MAV_RESULT_ACCEPTED
    told = one.hears("HOME_POSITION")
    assert (told.y, told.x) == pytest.approx((0.2, 0.7), abs=0.02)
    one.arms()
    one.master.set_mode_rtl()
    one.reaches(0.2, 0.7)
    one.master.arducopter_disarm()
    assert one.commands(mav.MAV_CMD_DO_SET_HOME, 1.0) == mav.MAV_RESULT_ACCEPTED  # here
    told = one.hears("HOME_POSITION")
    here = one.hears("LOCAL_POSITION_NED")
    assert (told.x, told.y) == pytest.approx((here.x, here.y), abs=0.02)
    off_the_map = (0, 0, 0, 0, round((latitude + 1.0) * 1e7), round(longitude * 1e7), 0)
    one.master.mav.command_int_send(1, 1, mav.MAV_FRAME_GLOBAL_INT, mav.MAV_CMD_DO_SET_HOME, 0, 0, *off_the_map)
    assert one.result(mav.MAV_CMD_DO_SET_HOME) == mav.MAV_RESULT_DENIED
    one.hears("STATUSTEXT", lambda told: "should stand" in told.text)


def test_parameters_are_fetched_one_and_all_and_set(one: Script) -> None:
    one.master.param_fetch_all()
    told = one.hears("PARAM_VALUE")
    seen = {told.param_index: told.param_id}
    while len(seen) < told.param_count:
        told = one.hears("PARAM_VALUE")
        seen[told.param_index] = told.param_id
    assert len(set(seen.values())) == told.param_count
    one.master.param_fetch_one(PARAMETER)
    before = one.hears("PARAM_VALUE", lambda told: told.param_id == PARAMETER).param_value
    one.master.param_set_send(PARAMETER, before * 2, mav.MAV_PARAM_TYPE_REAL32)
    after = one.hears("PARAM_VALUE", lambda told: told.param_id == PARAMETER).param_value
    assert after == pytest.approx(2 * before)


def test_a_mission_goes_up_comes_down_and_is_driven(one: Script) -> None:
    loader = mavwp.MAVWPLoader(1, 1)
    for east, north in ((0.0, 0.0), (0.0, 0.8), (0.3, 0.4)):  # the first is home, as ArduPilot has it
        loader.add_latlonalt(*degrees(east, north), 0.0)
    one.master.waypoint_count_send(loader.count())
    for seq in range(loader.count()):
        asked = one.hears("MISSION_REQUEST|MISSION_REQUEST_INT")
        assert asked.seq == seq
        item = loader.wp(seq)
        x, y, first = round(item.x * 1e7), round(item.y * 1e7), int(seq == 0)
        one.master.mav.mission_item_int_send(1, 1, seq, item.frame, item.command, first, 1, 0, 0, 0, 0, x, y, 0)
    assert one.hears("MISSION_ACK").type == mav.MAV_MISSION_ACCEPTED
    one.master.waypoint_request_list_send()
    assert one.hears("MISSION_COUNT").count == loader.count()
    for seq in range(loader.count()):
        one.master.waypoint_request_send(seq)  # the old form, without _INT
        item = one.hears("MISSION_ITEM", lambda told, seq=seq: told.seq == seq)
        assert (item.x, item.y) == pytest.approx((loader.wp(seq).x, loader.wp(seq).y), abs=1e-5)  # 32-bit floats
    one.master.mav.mission_ack_send(1, 1, mav.MAV_MISSION_ACCEPTED)
    one.arms()
    one.master.set_mode_auto()
    assert one.result(mav.MAV_CMD_MISSION_START) == mav.MAV_RESULT_ACCEPTED
    one.hears("MISSION_ITEM_REACHED", lambda told: told.seq == 2)
    one.reaches(0.3, 0.4)
    one.master.waypoint_clear_all_send()
    assert one.hears("MISSION_ACK").type == mav.MAV_MISSION_ACCEPTED
    one.master.arducopter_disarm()


def test_two_stations_command_a_robot_each_and_the_second_may_only_stop_the_firsts(
    both: tuple[Script, Script, Program],
) -> None:
    one, other, _ = both
    one.arms()
    other.arms()
    one.master.set_mode("GUIDED")
    one.is_in("GUIDED")
    latitude, longitude = degrees(0.0, -2.0)
    goal = (-1, 1, 0, math.nan, round(latitude * 1e7), round(longitude * 1e7), 0)
    one.master.mav.command_int_send(1, 1, mav.MAV_FRAME_GLOBAL_INT, mav.MAV_CMD_DO_REPOSITION, 0, 0, *goal)
    assert one.result(mav.MAV_CMD_DO_REPOSITION) == mav.MAV_RESULT_ACCEPTED
    other.follows(1)
    other.master.mav.command_int_send(1, 1, mav.MAV_FRAME_GLOBAL_INT, mav.MAV_CMD_DO_REPOSITION, 0, 0, *goal)
    assert other.result(mav.MAV_CMD_DO_REPOSITION) == mav.MAV_RESULT_DENIED
    other.hears("STATUSTEXT", lambda told: "255" in told.text)  # who is in command
    assert other.commands(mav.MAV_CMD_DO_PAUSE_CONTINUE, 0.0) == mav.MAV_RESULT_ACCEPTED
    one.hears("LOCAL_POSITION_NED", lambda told: math.hypot(told.vx, told.vy) < 0.02)
    for script, system in ((one, 1), (other, 2)):
        script.follows(system)
        script.master.arducopter_disarm()
        script.hears("HEARTBEAT", lambda told: not told.base_mode & mav.MAV_MODE_FLAG_SAFETY_ARMED)


def test_global_position_is_the_local_one_on_earth(one: Script) -> None:
    globe = one.hears("GLOBAL_POSITION_INT")
    local = one.hears("LOCAL_POSITION_NED")
    assert metres(globe.lat / 1e7, globe.lon / 1e7) == pytest.approx((local.y, local.x), abs=0.02)
