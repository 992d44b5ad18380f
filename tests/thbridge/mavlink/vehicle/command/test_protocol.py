"""The command protocol: one final acknowledgement for everything, whoever asks whatever how often."""

import math
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.mavlink.vehicle_with_stations import (
    ACCEPTED,
    BUSY,
    CANCELLED,
    DENIED,
    FAILED,
    HERE,
    IN_PROGRESS,
    INT_ONLY,
    LONG_ONLY,
    NAN,
    NO_FRAME,
    SECOND,
    THEM,
    THERE,
    UNSUPPORTED,
    US,
    VehicleWithStations,
    acks,
    messages,
)
from thbridge.mavlink.values.options import AutopilotIdentity
from thbridge.mavlink.values.vehicle_interface import DenialKind, Denied
from thbridge.mavlink.wire.dialect import mav
from thbridge.mavlink.wire.extra_messages import CommandCancel
from thbridge.mavlink.wire.mode_numbers import Mode

REQUEST = mav.MAV_CMD_REQUEST_MESSAGE
REPOSITION = mav.MAV_CMD_DO_REPOSITION
WAYPOINT = mav.MAV_CMD_NAV_WAYPOINT
INTERVAL = mav.MAV_CMD_SET_MESSAGE_INTERVAL
PHOTOGRAPH = mav.MAV_CMD_IMAGE_START_CAPTURE
ATTITUDE = mav.MAVLINK_MSG_ID_ATTITUDE


def long_of(command, *params, confirmation=0):
    params = (*params, *[NAN] * (7 - len(params)))
    return mav.MAVLink_command_long_message(3, 1, command, confirmation, *params)


# -- any command at all

NUMBERS = st.sampled_from(sorted(mav.enums["MAV_CMD"])) | st.integers(0, 65535)
ANY = st.floats(width=32) | st.sampled_from([NAN, math.inf, -math.inf, 0.0, 1.0, -1.0, 2.0, 4.0, 435.0, 1e30, -2.0])
SEVEN = st.tuples(*[ANY] * 7)
ANY_LONG = st.builds(
    lambda n, c, p: mav.MAVLink_command_long_message(3, 1, n, c, *p), NUMBERS, st.integers(0, 3), SEVEN
)
ANY_INT = st.builds(
    lambda n, f, p, x, y: mav.MAVLink_command_int_message(3, 1, f, n, 0, 0, *p[:4], x, y, p[4]),
    NUMBERS,
    st.integers(0, 255),
    SEVEN,
    st.integers(-(2**31), 2**31 - 1),
    st.integers(-(2**31), 2**31 - 1),
)


@given(st.sampled_from(AutopilotIdentity), st.booleans(), st.lists(ANY_LONG | ANY_INT, min_size=1, max_size=4))
def test_whatever_is_sent_is_acknowledged_once_at_once_to_whom_it_came_from(identity, armed, sent):
    rig = VehicleWithStations(identity=identity)
    if armed:
        rig.arm()
    for message in sent:
        said = rig.hear(message)
        (ack,) = messages(said, "COMMAND_ACK")
        assert (ack.command, ack.target_system, ack.target_component) == (message.command, US.system, US.component)
        assert all(word.link == HERE for word in said)
        rig.run(2)


@given(st.lists(ANY_LONG | ANY_INT, min_size=1, max_size=30))
def test_what_takes_its_time_ends_once(sent):
    rig = VehicleWithStations()
    rig.arm()
    running = 0
    for message in sent:
        running += acks(rig.hear(message), message.command).count(IN_PROGRESS)
    if rig.robot.readings.leg is not None:
        rig.robot.arrive()
    final = [ack for ack in messages(rig.run(SECOND), "COMMAND_ACK") if ack.result != IN_PROGRESS]
    assert len(final) == running


# -- which carrier, which frame


@pytest.mark.parametrize("command", [REPOSITION, WAYPOINT])
def test_a_place_comes_by_command_int_only(armed, command):
    assert armed.long(command, 0, 1, 0, 0, 52.4, 9.7, 0) == [INT_ONLY]
    assert armed.robot.calls("go_to") == []


@pytest.mark.parametrize("command", [mav.MAV_CMD_USER_1, mav.MAV_CMD_USER_2])
def test_what_has_seven_numbers_comes_by_command_long_only(armed, command):
    assert armed.int(command, 1) == [LONG_ONLY]
    assert armed.long(command, 1) == [ACCEPTED]


def test_most_commands_come_either_way(rig):
    assert rig.int(REQUEST, 148) == [ACCEPTED]
    assert rig.long(REQUEST, 148) == [ACCEPTED]


@pytest.mark.parametrize("frame", [2, 4, 13, 20, 255])
def test_an_unknown_frame_is_called_so(armed, frame):
    assert armed.int(REPOSITION, frame=frame, x=1, y=1) == [NO_FRAME]


@pytest.mark.parametrize("frame", [0, 3, 5, 6, 10, 11])
def test_every_global_frame_leads_to_the_same_point(armed, frame):
    # 100 m north and 50 m east of the origin, by the tables of WGS84 at 52.4 degrees.
    assert armed.int(REPOSITION, -1, 1, NAN, NAN, frame=frame, x=524_008_986, y=97_007_345) == [ACCEPTED]
    ((_, x, y, heading),) = armed.robot.calls("go_to")
    assert (x, y) == (pytest.approx(50.0, abs=0.1), pytest.approx(100.0, abs=0.1))
    assert heading is None


@pytest.mark.parametrize(
    ("frame", "point"),
    # The model stands at (1, 2) and looks east.
    [(1, (20.0, 10.0)), (7, (21.0, 12.0)), (8, (11.0, -18.0)), (9, (11.0, -18.0)), (12, (11.0, -18.0))],
)
def test_local_frames_count_from_the_origin_or_from_the_robot(armed, frame, point):
    assert armed.int(REPOSITION, frame=frame, x=100_000, y=200_000) == [ACCEPTED]
    assert armed.robot.calls("go_to")[0][1:3] == point


@pytest.mark.parametrize("place", [{}, {"x": 0, "y": 0}, {"y": 97_000_000}], ids=["none", "zeros", "half"])
def test_a_place_that_is_not_given_is_where_the_robot_is(armed, place):
    assert armed.int(REPOSITION, frame=0, **place) == [ACCEPTED]
    assert armed.robot.calls("go_to") == [("go_to", 1.0, 2.0, None)]


def test_a_place_beyond_a_pole_is_none(armed):
    assert armed.int(REPOSITION, frame=0, x=910_000_000, y=0) == [DENIED]
    assert "There is no such place on earth." in armed.texts()


# -- unknown, malformed


def test_the_manual_tells_every_command_that_is_known_and_no_other():
    manual = (Path(__file__).parents[5] / "docs" / "reference" / "mavlink-commands.md").read_text()
    told = {int(number) for number in re.findall(r"\b[A-Z][A-Z0-9_]+ \((\d+)\)", manual)}
    known = {number for number in mav.enums["MAV_CMD"] if VehicleWithStations().long(number) != [UNSUPPORTED]}
    assert told == known


@pytest.mark.parametrize("command", [21, 22, 84, 205, 280, 2500, 40001, 65535])
def test_what_is_not_known_is_unsupported(rig, command):
    assert rig.long(command) == [UNSUPPORTED]
    assert rig.int(command) == [UNSUPPORTED]


@pytest.mark.parametrize("value", [NAN, math.inf, -math.inf, -1.0, 0.5, 3e38])
@pytest.mark.parametrize(
    "command", [mav.MAV_CMD_COMPONENT_ARM_DISARM, mav.MAV_CMD_DO_PAUSE_CONTINUE, mav.MAV_CMD_DO_SET_MODE, INTERVAL]
)
def test_a_number_that_makes_no_sense_is_denied(armed, command, value):
    assert armed.long(command, *[value] * 7) in ([DENIED], [UNSUPPORTED])
    assert armed.status.armed


def test_parameters_that_are_not_used_may_be_anything_but_infinite(rig):
    assert rig.long(REQUEST, 148, NAN, 7, -3, NAN, 1e9, NAN) == [ACCEPTED]
    assert rig.long(REQUEST, 148, NAN, math.inf) == [DENIED]


# -- repetitions


def test_a_repetition_is_the_same_command(armed):
    (first,) = armed.hear(long_of(PHOTOGRAPH, 0, 0, 1))
    (again,) = armed.hear(long_of(PHOTOGRAPH, 0, 0, 1, confirmation=1))
    assert first.message.to_dict() == again.message.to_dict()
    assert len(armed.robot.calls("photograph")) == 1


def test_a_repetition_of_what_was_refused_is_refused_without_asking_again(armed):
    armed.robot.refusal = Denied("no", DenialKind.NOT_NOW)
    assert armed.long(PHOTOGRAPH, 0, 0, 1) == [BUSY]
    armed.robot.refusal = None
    assert armed.long(PHOTOGRAPH, 0, 0, 1, confirmation=1) == [BUSY]
    assert len(armed.robot.calls("photograph")) == 1


def test_a_repetition_whose_first_was_lost_is_done(armed):
    assert armed.long(PHOTOGRAPH, 0, 0, 1, confirmation=2) == [ACCEPTED]
    assert len(armed.robot.calls("photograph")) == 1


def test_other_parameters_make_another_command(armed):
    armed.long(INTERVAL, ATTITUDE, 100_000)
    armed.long(INTERVAL, ATTITUDE, 200_000, confirmation=1)
    assert messages(armed.hear(long_of(mav.MAV_CMD_GET_MESSAGE_INTERVAL, ATTITUDE)))[1].interval_us == 200_000


def test_a_copy_that_does_not_count_up_is_a_repetition_for_a_second(armed):
    assert armed.long(PHOTOGRAPH, 0, 0, 1) == armed.long(PHOTOGRAPH, 0, 0, 1) == [ACCEPTED]
    assert len(armed.robot.calls("photograph")) == 1
    armed.run(2 * SECOND)
    armed.long(PHOTOGRAPH, 0, 0, 1)
    assert len(armed.robot.calls("photograph")) == 2


def test_a_message_that_is_asked_for_again_is_told_again(rig):
    first, again = rig.hear(long_of(REQUEST, 148)), rig.hear(long_of(REQUEST, 148, confirmation=1))
    assert [message.get_type() for message in messages(first)] == ["COMMAND_ACK", "AUTOPILOT_VERSION"]
    assert [message.get_type() for message in messages(again)] == ["COMMAND_ACK", "AUTOPILOT_VERSION"]


@pytest.mark.parametrize("confirmation", [0, 1])
def test_to_go_on_is_not_refused_to_who_says_it_again(armed, confirmation):
    armed.go(4, 2)
    armed.run(1)
    armed.long(mav.MAV_CMD_DO_PAUSE_CONTINUE, 0)
    assert armed.long(mav.MAV_CMD_DO_PAUSE_CONTINUE, 1) == [ACCEPTED]
    assert armed.long(mav.MAV_CMD_DO_PAUSE_CONTINUE, 1, confirmation=confirmation) == [ACCEPTED]


@pytest.mark.parametrize(
    ("stop", "params"),
    [(mav.MAV_CMD_NAV_LOITER_UNLIM, ()), (mav.MAV_CMD_DO_PAUSE_CONTINUE, (0,)), (mav.MAV_CMD_DO_SET_MODE, (1, 4, 3))],
)
def test_no_stop_is_taken_for_one_that_was_before(armed, stop, params):
    armed.go(4, 2)
    assert armed.long(stop, *params) == [ACCEPTED]
    armed.go(5, 2)
    assert armed.long(stop, *params, confirmation=1) == [ACCEPTED]
    assert armed.status.mode == "HOLD"


def test_a_repetition_is_forgotten_in_time(armed):
    armed.long(PHOTOGRAPH, 0, 0, 1)
    armed.run(10 * SECOND, beating=[US])
    armed.long(PHOTOGRAPH, 0, 0, 1, confirmation=1)
    assert len(armed.robot.calls("photograph")) == 2


def test_another_station_s_command_is_no_repetition(armed):
    armed.long(INTERVAL, ATTITUDE, 100_000)
    assert armed.long(INTERVAL, ATTITUDE, 100_000, confirmation=1, link=THERE) == [ACCEPTED]
    get = long_of(mav.MAV_CMD_GET_MESSAGE_INTERVAL, ATTITUDE)
    assert messages(armed.hear(get, link=THERE))[1].interval_us == 100_000


# -- what takes its time


def test_a_way_is_in_progress_until_it_ends(armed):
    assert armed.go(4, 2, command=WAYPOINT) == [IN_PROGRESS]
    armed.robot.come(4.0)
    armed.run(1)
    armed.robot.come(1.0)
    told = messages(armed.run(3 * SECOND), "COMMAND_ACK")
    assert [(ack.result, ack.progress) for ack in told] == [(IN_PROGRESS, 75)] * 3
    armed.robot.arrive()
    assert acks(armed.run(1), WAYPOINT) == [ACCEPTED]
    assert acks(armed.run(2 * SECOND), WAYPOINT) == []


def test_a_way_that_fails_has_failed(armed):
    armed.go(4, 2, command=WAYPOINT)
    armed.robot.fail("a wall")
    assert acks(armed.run(1), WAYPOINT) == [FAILED]
    assert "A wall" in armed.texts()


def test_a_way_that_is_refused_never_begins(armed):
    armed.robot.refusal = Denied("not there")
    assert armed.go(4, 2, command=WAYPOINT) == [DENIED]
    assert acks(armed.run(2 * SECOND), WAYPOINT) == []


def test_the_same_command_while_it_runs_is_rejected_for_now(armed):
    armed.go(4, 2, command=WAYPOINT)
    assert armed.go(4, 2, command=WAYPOINT) == [BUSY]
    assert armed.go(9, 9, command=WAYPOINT) == [BUSY]
    assert len(armed.robot.calls("go_to")) == 1


def test_another_station_s_command_while_one_runs_is_its_own(armed):
    armed.go(4, 2, command=WAYPOINT)
    assert armed.go(4, 2, command=WAYPOINT, station=THEM) == [DENIED], "and not busy"
    armed.run(1)
    assert armed.go(5, 5, command=WAYPOINT, link=THERE) == [IN_PROGRESS]
    told = [word for word in armed.run(2 * SECOND) if word.message.get_type() == "COMMAND_ACK"]
    assert next((word.link, word.message.result) for word in told) == (HERE, CANCELLED)
    assert {word.link for word in told[1:]} == {THERE}


@pytest.mark.parametrize("how", ["hold", "elsewhere", "disarm"])
def test_a_way_that_is_broken_off_is_cancelled(armed, how):
    armed.go(4, 2, command=WAYPOINT)
    armed.run(1)
    match how:
        case "hold":
            armed.mode(4, 3, station=THEM)
        case "elsewhere":
            assert armed.go(7, 7) == [ACCEPTED]
        case "disarm":
            armed.disarm()
    assert acks(armed.run(1), WAYPOINT) == [CANCELLED]


def test_a_way_can_be_cancelled(armed):
    armed.go(4, 2, command=WAYPOINT)
    assert acks(armed.hear(CommandCancel(3, 1, WAYPOINT)), WAYPOINT) == [CANCELLED]
    assert armed.robot.calls("halt")
    assert armed.hear(CommandCancel(3, 1, WAYPOINT)) == []
    assert acks(armed.run(2 * SECOND), WAYPOINT) == []


def test_reposition_is_acknowledged_at_once_and_can_be_changed_under_way(armed):
    assert armed.go(4, 2) == [ACCEPTED]
    assert armed.go(5, 2) == [ACCEPTED]
    assert [call[1] for call in armed.robot.calls("go_to")] == [4.0, 5.0]


# -- messages


def test_a_message_can_be_asked_for(rig):
    for number in (0, 1, 2, 24, 30, 31, 32, 33, 42, 49, 74, 147, 148, 242, 245, 300, 395, 397, 436, 437):
        ack, message = messages(rig.hear(long_of(REQUEST, number)))
        assert (ack.result, message.get_msgId()) == (ACCEPTED, number)


def test_a_message_that_is_unknown_or_has_nothing_to_say_is_not_promised(rig):
    assert rig.long(REQUEST, 259) == [UNSUPPORTED]
    assert rig.long(REQUEST, 16_000_000) == [UNSUPPORTED]
    assert rig.long(REQUEST, mav.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT) == [BUSY]


@pytest.mark.parametrize("identity", AutopilotIdentity)
def test_modes_are_told_one_by_one_or_all_at_once(identity):
    rig = VehicleWithStations(identity=identity)
    together = messages(rig.hear(long_of(REQUEST, 435, 0)))[1:]
    one_by_one = [messages(rig.hear(long_of(REQUEST, 435, place)))[1] for place in range(1, len(Mode) + 1)]
    assert [mode.to_dict() for mode in together] == [mode.to_dict() for mode in one_by_one]
    assert [mode.mode_index for mode in together] == [1, 2, 3, 4, 5]
    assert {mode.number_modes for mode in together} == {5}
    assert len({mode.custom_mode for mode in together}) == 5
    assert rig.long(REQUEST, 435, 6) == [DENIED]


@pytest.mark.parametrize(
    ("command", "kind"),
    [
        (mav.MAV_CMD_GET_HOME_POSITION, "HOME_POSITION"),
        (mav.MAV_CMD_REQUEST_PROTOCOL_VERSION, "PROTOCOL_VERSION"),
        (mav.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES, "AUTOPILOT_VERSION"),
    ],
)
def test_older_ways_to_ask_for_a_message(rig, command, kind):
    ack, message = messages(rig.hear(long_of(command, 1)))
    assert (ack.result, message.get_type()) == (ACCEPTED, kind)


def test_a_link_has_its_own_rates(rig):
    assert rig.long(INTERVAL, ATTITUDE, 20_000) == [ACCEPTED]
    assert rig.long(INTERVAL, ATTITUDE, -1, link=THERE) == [ACCEPTED]
    said = [word for word in rig.run(SECOND) if word.message.get_type() == "ATTITUDE"]
    assert [word.link for word in said].count(HERE) == SECOND
    others = [word for word in said if word.link is None]
    assert len(others) == 5
    assert all(word.except_links == {HERE, THERE} for word in others)


def test_an_interval_is_told_turned_off_and_forgotten(rig):
    def told(link=HERE):
        _, interval = messages(rig.hear(long_of(mav.MAV_CMD_GET_MESSAGE_INTERVAL, ATTITUDE), link=link))
        return interval.interval_us

    assert told() == 200_000
    rig.long(INTERVAL, ATTITUDE, 1)
    assert told() == 20_000, "never faster than a tick"
    rig.long(INTERVAL, ATTITUDE, -1)
    assert (told(), told(THERE)) == (-1, 200_000)
    rig.long(INTERVAL, ATTITUDE, 0)
    assert told() == 200_000


@given(st.floats(0.0, width=32, allow_infinity=False))
def test_any_interval_can_be_told(microseconds):
    rig = VehicleWithStations()
    assert rig.long(INTERVAL, ATTITUDE, microseconds) == [ACCEPTED]
    _, interval = messages(rig.hear(long_of(mav.MAV_CMD_GET_MESSAGE_INTERVAL, ATTITUDE)))
    assert 20_000 <= interval.interval_us < 2**31


def test_what_is_not_streamed_has_no_interval(rig):
    assert rig.long(INTERVAL, 259, 1000) == [UNSUPPORTED]
    _, interval = messages(rig.hear(long_of(mav.MAV_CMD_GET_MESSAGE_INTERVAL, 259)))
    assert interval.interval_us == 0


def test_no_interval_but_minus_one_is_negative(rig):
    assert rig.long(INTERVAL, ATTITUDE, -2) == [DENIED]
    assert rig.long(INTERVAL, ATTITUDE, -0.5) == [DENIED]


def test_heartbeats_keep_their_second(rig):
    assert rig.long(INTERVAL, 0, -1) == [DENIED]
    assert rig.long(INTERVAL, 0, 100_000) == [DENIED]
    assert rig.long(INTERVAL, 0, 1_000_000) == [ACCEPTED]
    assert rig.long(INTERVAL, 0, 0) == [ACCEPTED], "as it is at first"
    assert len(messages(rig.run(10 * SECOND), "HEARTBEAT")) == 10


# -- the rest of the table


@pytest.mark.parametrize(
    ("speed", "asked"), [(0.5, [0.5]), (-1.0, []), (NAN, []), (-2.0, [-1.0])], ids=["a", "no", "none", "default"]
)
def test_a_speed_is_set_kept_or_given_back(armed, speed, asked):
    assert armed.long(mav.MAV_CMD_DO_CHANGE_SPEED, 1, speed, -1, 0) == [ACCEPTED]
    assert [call[1] for call in armed.robot.calls("limit_speed")] == asked


@pytest.mark.parametrize(("kind", "speed"), [(1, 0.0), (1, -3.0), (2, 0.5), (-1, 0.5)])
def test_a_speed_that_is_none_of_a_rover_is_denied(armed, kind, speed):
    assert armed.long(mav.MAV_CMD_DO_CHANGE_SPEED, kind, speed) == [DENIED]


def test_reposition_brings_its_speed_and_heading(armed):
    assert armed.int(REPOSITION, 0.4, 1, NAN, math.pi / 2, frame=1, x=0, y=0) == [ACCEPTED]
    assert armed.robot.calls("limit_speed") == [("limit_speed", 0.4)]
    assert armed.robot.calls("go_to") == [("go_to", 0.0, 0.0, pytest.approx(0.0, abs=1e-6))]


def test_to_ardupilot_a_heading_of_zero_is_none():
    rig = VehicleWithStations(identity=AutopilotIdentity.ARDUPILOT)
    rig.arm()
    rig.int(REPOSITION, -1, 1, 0, 0.0, frame=3, x=524_000_000, y=97_000_000)
    assert rig.robot.calls("go_to") == [("go_to", 0.0, 0.0, None)]


def test_reposition_without_leave_to_change_the_mode_changes_none(armed):
    armed.mode(1)
    assert armed.int(REPOSITION, -1, 0, frame=1, x=0, y=0) == [DENIED]
    assert armed.status.mode == "MANUAL"


def test_what_a_robot_in_a_game_does_not_do_is_denied_with_a_reason(armed):
    assert armed.long(mav.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1) == [DENIED]
    assert len(armed.texts()) == 2


def test_the_game_s_own_deeds_are_the_robot_s(armed):
    assert armed.long(PHOTOGRAPH, 0, 0, 1) == [ACCEPTED]
    assert armed.long(mav.MAV_CMD_USER_1, 7) == [ACCEPTED]
    assert armed.long(mav.MAV_CMD_USER_2) == [ACCEPTED]
    assert armed.robot.asked[-3:] == [("photograph",), ("identify", 7), ("leave",)]
    assert armed.long(PHOTOGRAPH, 0, 1, 0) == [ACCEPTED]
    assert armed.long(PHOTOGRAPH, 0, 1, 5) == [DENIED]


@pytest.mark.parametrize(
    ("refusal", "result"),
    [(DenialKind.DENIED, DENIED), (DenialKind.NOT_NOW, BUSY), (DenialKind.UNSUPPORTED, UNSUPPORTED)],
)
def test_a_refusal_is_told_in_both_languages(armed, refusal, result):
    armed.robot.refusal = Denied("Not enough energy.", refusal)
    assert armed.go(3, 3) == [result]
    assert "Not enough energy." in armed.texts()
