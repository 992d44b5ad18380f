"""Modes, who is in command, and what is done when that station is lost."""

from dataclasses import replace

import pytest

from tests.support.mavlink.model_station import waypoint
from tests.support.mavlink.vehicle_with_stations import (
    ACCEPTED,
    BUSY,
    DENIED,
    HERE,
    SECOND,
    THEM,
    THERE,
    US,
    VehicleWithStations,
    acks,
    messages,
)
from thbridge.mavlink.values.options import AutopilotIdentity, Failsafe
from thbridge.mavlink.values.vehicle_interface import Denied
from thbridge.mavlink.wire.dialect import mav

REPOSITION = mav.MAV_CMD_DO_REPOSITION
PAUSE = mav.MAV_CMD_DO_PAUSE_CONTINUE
START = mav.MAV_CMD_MISSION_START
MOTIONS = [
    (mav.MAV_CMD_NAV_RETURN_TO_LAUNCH, []),
    (START, [0, 0]),
    (mav.MAV_CMD_DO_CHANGE_SPEED, [1, 0.5]),
    (mav.MAV_CMD_IMAGE_START_CAPTURE, [0, 0, 1]),
    (mav.MAV_CMD_USER_1, [1]),
    (mav.MAV_CMD_USER_2, []),
    (PAUSE, [1]),
]
HOLD, GUIDED, AUTO, RETURN, MANUAL = (4, 3), (6, 0), (4, 4), (4, 5), (1, 0)


def upload(rig, *items):
    """Give the vehicle a plan."""
    rig.hear(mav.MAVLink_mission_count_message(3, 1, len(items)))
    for number, item in enumerate(items):
        rig.hear(mav.MAVLink_mission_item_int_message(3, 1, number, *item))


def plan(rig, count=2):
    upload(rig, *(waypoint(524_000_000 + 1000 * n, 97_000_000) for n in range(1, count + 1)))


def send_about(rig, commanded_by="participant"):
    """Somebody else sends the robot about."""
    rig.robot.readings = replace(rig.robot.readings, under_way=True, commanded_by=commanded_by)
    rig.run(1)


# -- who is in command


def test_arming_takes_command_and_disarming_gives_it_back(rig):
    assert rig.arm() == [ACCEPTED]
    rig.run(1)
    assert rig.status.armed
    assert rig.disarm() == [ACCEPTED]
    rig.run(1)
    assert not rig.status.armed
    assert rig.robot.asked == [("take", US), ("halt",), ("release",)]


def test_arming_again_takes_nothing_again(armed):
    assert armed.arm() == [ACCEPTED]
    assert armed.robot.calls("take") == [("take", US)]


def test_arming_may_be_refused(rig):
    rig.robot.refusal = Denied("It is dead.")
    assert rig.arm() == [DENIED]
    assert not rig.status.armed
    assert rig.texts() == ["It is dead."]


@pytest.mark.parametrize(("command", "params"), MOTIONS)
def test_nobody_moves_a_robot_without_taking_command(rig, command, params):
    assert rig.long(command, *params) == [DENIED]
    assert rig.robot.asked == []
    assert rig.texts() == ["Commanded by participant: arm the robot to take command."]


@pytest.mark.parametrize(("command", "params"), MOTIONS)
def test_only_the_station_in_command_moves_a_robot(armed, command, params):
    before = list(armed.robot.asked)
    assert armed.long(command, *params, station=THEM) == [DENIED]
    assert armed.go(1, 1, station=THEM) == [DENIED]
    assert armed.robot.asked == before
    assert "Commanded by ground station 255." in armed.texts()


def test_another_station_takes_command_by_force_only(armed):
    assert armed.arm(THEM) == [DENIED]
    assert armed.go(1, 1) == [ACCEPTED]
    assert armed.arm(THEM, force=21196) == [ACCEPTED]
    armed.run(1)
    assert armed.go(1, 1) == [DENIED]
    assert armed.go(1, 1, station=THEM) == [ACCEPTED]


def test_who_takes_over_by_force_finds_the_robot_going_on(armed):
    armed.go(5, 5)
    armed.run(1)
    armed.arm(THEM, force=21196)
    assert armed.robot.calls("halt") == []
    assert armed.status.mode == "GUIDED"


def test_two_stations_of_the_same_system_are_two(armed):
    other = replace(US, component=230)
    assert armed.go(1, 1, station=other) == [DENIED]
    assert armed.go(1, 1, link=THERE) == [ACCEPTED], "the same station by another way"


@pytest.mark.parametrize("stop", ["hold", "pause", "disarm", "loiter"])
@pytest.mark.parametrize("who", [US, THEM])
def test_anybody_may_stop_a_robot(armed, stop, who):
    armed.go(9, 9)
    armed.run(2)
    match stop:
        case "hold":
            result = armed.mode(*HOLD, station=who)
        case "pause":
            result = armed.long(PAUSE, 0, station=who)
        case "disarm":
            result = armed.disarm(who)
        case "loiter":
            result = armed.long(mav.MAV_CMD_NAV_LOITER_UNLIM, station=who)
    assert result == [ACCEPTED]
    assert armed.robot.calls("halt")
    assert armed.status.mode == "HOLD"


def test_anybody_may_stop_a_robot_of_the_participant_s(rig):
    send_about(rig)
    assert rig.mode(*HOLD, station=THEM) == [ACCEPTED]
    assert rig.robot.asked == [("halt",)]


def test_a_command_that_was_taken_away_is_gone(armed):
    armed.go(5, 5)
    armed.robot.readings = replace(armed.robot.readings, commander=None, commanded_by="participant")
    armed.run(2 * SECOND)
    assert armed.go(1, 1) == [DENIED]
    assert "Commanded by participant now." in armed.texts()


def test_a_command_that_takes_some_ticks_to_be_granted_is_not_taken_for_lost(rig):
    before = rig.robot.readings
    rig.arm()
    granted, rig.robot.readings = rig.robot.readings, before
    rig.run(10)
    rig.robot.readings = granted
    rig.run(2 * SECOND)
    assert rig.go(1, 1) == [ACCEPTED]


@pytest.mark.parametrize("commander", [None, "ground station 255"])
def test_a_researcher_interrupts_and_gives_back(armed, commander):
    held = armed.robot.readings
    armed.robot.readings = replace(held, commander=commander, commanded_by="researcher")
    armed.run(3 * SECOND, beating=[US])
    assert armed.status.armed
    assert armed.go(1, 1) == [BUSY]
    armed.robot.readings = held
    armed.run(1)
    assert armed.go(1, 1) == [ACCEPTED]
    assert "Commanded by researcher just now." in armed.texts()


def test_who_takes_command_is_told_to_all(armed):
    assert armed.texts()[0] == "Commanded by ground station 255."


# -- modes


@pytest.mark.parametrize(
    ("identity", "numbers"),
    [
        (AutopilotIdentity.ARDUPILOT, [(4, 0), (15, 0), (0, 0)]),
        (AutopilotIdentity.GENERIC, [(4, 3), (6, 0), (1, 0)]),
        (AutopilotIdentity.GENERIC, [(4, 0), (15, 0), (0, 0)]),
    ],
)
def test_modes_are_set_by_their_numbers(identity, numbers):
    rig = VehicleWithStations(identity=identity)
    rig.arm()
    for number, name in zip(numbers, ["HOLD", "GUIDED", "MANUAL"], strict=True):
        assert rig.mode(*number) == [ACCEPTED]
        assert rig.status.mode == name


def test_a_mode_that_is_none_is_denied(armed):
    assert armed.mode(77) == [DENIED]
    assert armed.long(mav.MAV_CMD_DO_SET_MODE, 0, 4, 3) == [DENIED]
    assert armed.status.mode == "HOLD"


@pytest.mark.parametrize(("code", "name"), [(5, "RTL"), (6, None), (1, None)])
def test_standard_modes_are_set_where_there_are_such(armed, code, name):
    result = armed.long(mav.MAV_CMD_DO_SET_STANDARD_MODE, code)
    assert (result == [ACCEPTED]) == (name is not None)
    assert armed.status.mode == (name or "HOLD")


def test_what_nobody_commands_remembers_its_mode_and_does_not_move(rig):
    plan(rig)
    assert rig.mode(*AUTO) == [ACCEPTED]
    rig.run(SECOND)
    assert rig.status.mode == "AUTO"
    assert rig.robot.asked == []
    assert rig.texts() == ["Mode AUTO begins when the robot is armed."]
    rig.arm()
    rig.run(2)
    assert rig.robot.calls("go_to")
    assert rig.status.mode == "AUTO"


def test_a_mode_chosen_before_that_cannot_be_entered_is_hold(rig):
    rig.mode(*AUTO)
    assert rig.arm() == [ACCEPTED]
    rig.run(1)
    assert rig.status.mode == "HOLD"
    assert len(rig.texts()) >= 2


def test_return_drives_home(armed):
    assert armed.mode(*RETURN) == [ACCEPTED]
    assert armed.robot.calls("go_to") == [("go_to", 1.0, 2.0, 0.0)]
    assert armed.status.mode == "RTL"
    armed.robot.arrive()
    armed.run(2)
    assert "Arrived." in armed.texts()


def test_return_that_is_refused_changes_no_mode(armed):
    armed.mode(*GUIDED)
    armed.robot.refusal = Denied("No energy.")
    assert armed.mode(*RETURN) == [DENIED]
    assert armed.status.mode == "GUIDED"


def test_guided_again_does_not_stop_a_robot_under_way(armed):
    armed.go(5, 5)
    assert armed.mode(*GUIDED) == [ACCEPTED]
    assert armed.robot.calls("halt") == []


def test_a_robot_that_the_participant_sends_shows_guided_and_then_hold(rig):
    send_about(rig)
    assert (rig.status.mode, rig.status.armed) == ("GUIDED", True)
    rig.robot.readings = replace(rig.robot.readings, under_way=False)
    rig.run(1)
    assert (rig.status.mode, rig.status.armed) == ("HOLD", False)


def test_arming_lets_a_robot_go_on(rig):
    send_about(rig)
    rig.arm()
    assert rig.robot.calls("halt") == []


def test_pausing_remembers_where_it_was_bound_for(armed):
    armed.go(5, 6)
    assert armed.long(PAUSE, 0) == [ACCEPTED]
    armed.run(SECOND)
    assert armed.status.mode == "HOLD"
    assert armed.long(PAUSE, 0) == [ACCEPTED]
    assert armed.long(PAUSE, 1) == [ACCEPTED]
    assert [call[1:3] for call in armed.robot.calls("go_to")] == [(5.0, 6.0)] * 2
    assert armed.status.mode == "GUIDED"


def test_there_may_be_nothing_to_continue(armed):
    assert armed.long(PAUSE, 1) == [BUSY]
    armed.long(PAUSE, 0)
    assert armed.long(PAUSE, 1) == [BUSY]


def test_how_a_way_ended_is_told(armed):
    armed.go(5, 5)
    armed.run(1)
    armed.robot.fail("There is no way to the goal.")
    armed.run(1)
    assert armed.texts()[-1] == "There is no way to the goal."


# -- missions


def test_a_mission_runs_in_mode_auto_and_ends_in_hold(armed):
    plan(armed, 1)
    assert armed.mode(*AUTO) == [ACCEPTED]
    armed.run(2)
    assert armed.status.mode == "AUTO"
    armed.robot.arrive()
    armed.run(3)
    assert armed.status.mode == "HOLD"


def test_mission_start_runs_it_from_an_item_on(armed):
    plan(armed, 3)
    assert armed.long(START, 1, 0) == [ACCEPTED]
    armed.run(2)
    (current,) = messages(armed.hear(mav.MAVLink_command_long_message(3, 1, 512, 0, 42, 0, 0, 0, 0, 0, 0)))[1:]
    assert (current.seq, current.mission_state) == (1, mav.MISSION_STATE_ACTIVE)
    assert armed.long(START, 9, 0) == [DENIED]


def test_mission_start_with_zeros_goes_on_where_it_was(armed):
    plan(armed, 2)
    assert armed.long(START, 0, 0) == [ACCEPTED]
    armed.run(2)
    armed.robot.arrive()
    armed.run(3)
    armed.mode(*HOLD)
    assert armed.long(START, 0, 0) == [ACCEPTED]
    armed.run(2)
    first, second, again = armed.robot.calls("go_to")
    assert again == second != first


def test_auto_without_a_mission_is_refused(armed):
    armed.mode(*GUIDED)
    assert armed.mode(*AUTO) == [BUSY]
    assert armed.status.mode == "GUIDED"


def test_leaving_auto_pauses_the_mission_and_going_back_goes_on(armed):
    plan(armed, 2)
    armed.mode(*AUTO)
    armed.run(2)
    armed.robot.arrive()
    armed.run(3)
    assert armed.mode(*HOLD, station=THEM) == [ACCEPTED]
    armed.run(5)
    ways = len(armed.robot.calls("go_to"))
    assert armed.mode(*AUTO) == [ACCEPTED]
    armed.run(2)
    second = armed.robot.calls("go_to")[-1]
    assert (len(armed.robot.calls("go_to")), second) == (ways + 1, armed.robot.calls("go_to")[1])


def test_pause_and_continue_hold_for_missions(armed):
    plan(armed, 2)
    armed.mode(*AUTO)
    armed.run(2)
    armed.long(PAUSE, 0)
    armed.run(2)
    assert armed.long(PAUSE, 1) == [ACCEPTED]
    armed.run(2)
    assert armed.status.mode == "AUTO"
    assert len(armed.robot.calls("go_to")) == 2


def test_the_current_item_can_be_chosen_by_command(armed):
    plan(armed, 3)
    assert armed.long(mav.MAV_CMD_DO_SET_MISSION_CURRENT, 2) == [ACCEPTED]
    assert armed.long(mav.MAV_CMD_DO_SET_MISSION_CURRENT, 9) == [DENIED]
    armed.mode(*AUTO)
    assert armed.long(mav.MAV_CMD_DO_SET_MISSION_CURRENT, 1, station=THEM) == [DENIED]


def test_what_the_participant_began_ends_when_a_mission_begins(rig):
    plan(rig)
    send_about(rig)
    rig.arm()
    rig.mode(*AUTO)
    assert rig.robot.calls("halt")


# -- a station that is lost


def lost(rig):
    """Let time pass without a heartbeat."""
    rig.run(6 * SECOND)


def test_a_station_that_is_heard_stays_in_command(armed):
    armed.go(5, 5)
    armed.run(20 * SECOND, beating=[US])
    assert armed.status.armed
    assert armed.robot.calls("halt") == []


def test_another_component_s_heartbeat_speaks_for_the_station(armed):
    armed.run(20 * SECOND, beating=[replace(US, component=1)])
    assert armed.status.armed


def test_another_station_s_heartbeat_does_not(armed):
    armed.run(20 * SECOND, beating=[THEM])
    assert not armed.status.armed


def test_a_lost_station_s_robot_stops(armed):
    armed.go(5, 5)
    lost(armed)
    assert armed.robot.asked[-2:] == [("halt",), ("release",)]
    assert armed.status.mode == "HOLD"
    assert "Ground station 255 is lost: the robot stops." in armed.texts()


def test_or_it_goes_home_and_is_the_participant_s_at_once():
    rig = VehicleWithStations(failsafe=Failsafe.HOME)
    rig.arm()
    rig.go(5, 5)
    lost(rig)
    assert rig.robot.asked[-2:] == [("go_to", 1.0, 2.0, 0.0), ("release",)]
    rig.run(1)
    assert rig.status.mode == "RTL"
    rig.robot.arrive()
    rig.run(1)
    assert rig.status.mode == "HOLD"


def test_or_it_stops_when_it_cannot_go_home():
    rig = VehicleWithStations(failsafe=Failsafe.HOME)
    rig.arm()
    rig.robot.refusal = Denied("No energy.")
    lost(rig)
    assert rig.robot.asked[-2:] == [("halt",), ("release",)]
    assert rig.texts()[-3:-1] == ["Ground station 255 is lost: the robot goes home.", "No energy."]


def test_or_it_carries_on_until_its_mission_is_over():
    rig = VehicleWithStations(failsafe=Failsafe.CONTINUE)
    rig.arm()
    plan(rig, 1)
    rig.mode(*AUTO)
    lost(rig)
    assert rig.status.mode == "AUTO"
    assert rig.robot.calls("release") == []
    rig.robot.arrive()
    rig.run(3)
    assert rig.robot.calls("release") == [("release",)]
    assert "Ground station 255 is lost: the robot carries on." in rig.texts()


def test_a_station_that_comes_back_while_its_mission_goes_on_is_still_in_command():
    rig = VehicleWithStations(failsafe=Failsafe.CONTINUE)
    rig.arm()
    plan(rig, 1)
    rig.mode(*AUTO)
    lost(rig)
    rig.run(2 * SECOND, beating=[US])
    rig.robot.arrive()
    rig.run(3)
    assert rig.robot.calls("release") == []


def test_a_way_that_is_carried_on_comes_to_its_end():
    rig = VehicleWithStations(failsafe=Failsafe.CONTINUE)
    rig.arm()
    rig.go(5, 5, command=mav.MAV_CMD_NAV_WAYPOINT)
    lost(rig)
    rig.robot.arrive()
    assert acks(rig.run(1), mav.MAV_CMD_NAV_WAYPOINT) == [ACCEPTED]
    assert (rig.status.mode, rig.status.armed) == ("HOLD", False)


def test_every_loss_is_told():
    rig = VehicleWithStations(failsafe=Failsafe.CONTINUE)
    rig.arm()
    plan(rig, 1)
    rig.mode(*AUTO)
    lost(rig)
    rig.run(2 * SECOND, beating=[US])
    lost(rig)
    assert rig.texts().count("Ground station 255 is lost: the robot carries on.") == 2


def test_a_station_that_comes_back_too_late_has_to_arm_again(armed):
    armed.go(5, 5)
    lost(armed)
    armed.run(3 * SECOND, beating=[US])
    assert armed.go(1, 1) == [DENIED]
    assert armed.arm() == [ACCEPTED]
    assert armed.go(1, 1) == [ACCEPTED]


def test_a_lost_station_does_not_stop_what_a_researcher_does(armed):
    armed.robot.readings = replace(armed.robot.readings, commander=None, commanded_by="researcher", under_way=True)
    lost(armed)
    assert armed.robot.calls("halt") == []
    assert armed.robot.calls("release") == [("release",)]


def test_nor_does_its_mission_go_on_behind_a_researcher_s_back(armed):
    plan(armed, 1)
    armed.mode(*AUTO)
    armed.run(1)
    armed.robot.readings = replace(armed.robot.readings, commanded_by="researcher", under_way=True)
    lost(armed)
    ask = mav.MAVLink_command_long_message(3, 1, 512, 0, mav.MAVLINK_MSG_ID_MISSION_CURRENT, 0, 0, 0, 0, 0, 0)
    (current,) = messages(armed.hear(ask), "MISSION_CURRENT")
    assert current.mission_state == mav.MISSION_STATE_PAUSED
    assert armed.robot.calls("halt") == []


def test_the_link_that_was_closed_does_not_matter(armed):
    armed.vehicle.forget(HERE)
    armed.run(3 * SECOND, beating=[US])
    assert armed.go(1, 1, link=THERE) == [ACCEPTED]
