"""Carrying a mission out, item by item, by a robot whose legs end when the test says so."""

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from tests.support.mavlink.model_robot import ModelRobot
from tests.support.mavlink.vehicle_with_stations import home_of
from thbridge.mavlink.values.options import GeoOrigin, VisitedRooms
from thbridge.mavlink.values.vehicle_interface import Denied, HelmLeg, LegState, Station
from thbridge.mavlink.vehicle.geodesy import MapProjection
from thbridge.mavlink.vehicle.mission.items import MissionItem
from thbridge.mavlink.vehicle.mission.run import MissionRun
from thbridge.mavlink.wire.dialect import mav

NAN = math.nan
NED = mav.MAV_FRAME_LOCAL_NED
NO_MISSION, NOT_STARTED, ACTIVE, PAUSED, COMPLETE = range(1, 6)
STATION = Station(255, 190)
SKIP = VisitedRooms.SKIP


def go(x, y, hold=0.0, yaw=NAN, **fields):
    """A waypoint, meters east and north."""
    place = {"x": round(y * 10000), "y": round(x * 10000)}
    return MissionItem(mav.MAV_CMD_NAV_WAYPOINT, NED, (hold, 0.0, 0.0, yaw), **place, **fields)


def do(command, *params, **fields):
    """Something to do that has no place."""
    return MissionItem(command, mav.MAV_FRAME_MISSION, (*params, *(0.0,) * (4 - len(params))), **fields)


class Tour:
    """A mission and the robot that carries it out."""

    def __init__(self, *items, ardupilot=False, start=True, visited_rooms=VisitedRooms.HALT):
        self.robot = ModelRobot()
        self.told = []
        self.said = []
        self.tick = 0
        origin = GeoOrigin(52.0, 13.0, 34.0)
        earth = MapProjection(origin)
        self.home = home_of(self.robot, earth)
        self.run = MissionRun(self.robot, self.home, earth, self.announce, ardupilot, visited_rooms)
        self.run.replace(tuple(items))
        if start:
            assert self.run.start() is None

    def announce(self, severity, sentence):
        self.told.append(sentence)

    def pass_(self, ticks=1):
        for _ in range(ticks):
            self.tick += 1
            self.said += [word.message for word in self.run.step(self.tick, self.robot.readings)]

    def arrive(self):
        """The robot sets out, arrives, and the mission takes notice."""
        self.pass_(2)
        self.robot.arrive()
        self.pass_()

    @property
    def reached(self):
        return [message.seq for message in self.said if message.get_type() == "MISSION_ITEM_REACHED"]

    @property
    def state(self):
        return self.run.current().mission_state

    @property
    def legs(self):
        return [call[1:3] for call in self.robot.asked if call[0] == "go_to"]


def test_waypoints_are_driven_to_one_after_the_other():
    tour = Tour(go(1, 2), go(3, 4))
    tour.pass_(10)
    assert tour.legs == [(1, 2)]
    tour.robot.arrive()
    tour.pass_(2)
    assert (tour.legs, tour.reached) == ([(1, 2), (3, 4)], [0])
    tour.robot.arrive()
    tour.pass_()
    assert (tour.reached, tour.state, tour.run.running) == ([0, 1], COMPLETE, False)
    assert tour.told == ["Mission complete."]


def test_a_change_of_item_is_told_at_once():
    tour = Tour(go(1, 2), go(3, 4))
    tour.arrive()
    current = [message for message in tour.said if message.get_type() == "MISSION_CURRENT"]
    assert [(message.seq, message.total, message.mission_state) for message in current] == [(1, 2, ACTIVE)]


@pytest.mark.parametrize(
    ("item", "point"),
    [
        (MissionItem(mav.MAV_CMD_NAV_WAYPOINT, NED, (0, 0, 0, NAN), x=10000, y=20000), (2, 1)),
        (replace(go(0, 0), frame=mav.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, x=520000000, y=130000000), (0, 0)),
        (replace(go(0, 0), frame=mav.MAV_FRAME_GLOBAL, x=520000899, y=130001457), (10.0, 10.0)),
    ],
)
def test_frames(item, point):
    tour = Tour(item)
    tour.pass_()
    assert tour.legs[0] == pytest.approx(point, abs=0.02)


@pytest.mark.parametrize(("yaw", "heading"), [(0, math.pi / 2), (90, 0), (180, -math.pi / 2), (NAN, None)])
def test_compass_degrees_become_the_maps_heading(yaw, heading):
    tour = Tour(go(1, 2, yaw=yaw))
    tour.pass_()
    assert tour.robot.asked[0][3] == (None if heading is None else pytest.approx(heading))


def test_rovers_of_ardupilot_look_wherever_they_like():
    tour = Tour(go(0, 0), go(1, 2, yaw=0), ardupilot=True)
    tour.pass_(3)
    assert tour.robot.asked == [("go_to", 1, 2, None)]


def test_a_waypoint_is_reached_when_its_time_to_hold_is_over():
    tour = Tour(go(1, 2, hold=0.5))
    tour.arrive()
    tour.pass_(24)
    assert tour.reached == []
    tour.pass_()
    assert tour.reached == [0]


def test_loitering_without_a_place_is_where_the_robot_is():
    tour = Tour(MissionItem(mav.MAV_CMD_NAV_LOITER_TIME, mav.MAV_FRAME_GLOBAL, (1.0, 0.0, 0.0, NAN)))
    tour.pass_(50)
    assert (tour.legs, tour.reached) == ([], [])
    tour.pass_()
    assert tour.reached == [0]


def test_loitering_without_end_has_none():
    tour = Tour(replace(go(1, 2), command=mav.MAV_CMD_NAV_LOITER_UNLIM), go(3, 4))
    tour.arrive()
    tour.pass_(5000)
    assert (tour.legs, tour.state) == ([(1, 2)], ACTIVE)


@pytest.mark.parametrize("command", [mav.MAV_CMD_NAV_DELAY, mav.MAV_CMD_CONDITION_DELAY])
def test_delays(command):
    tour = Tour(do(command, 2.0), go(1, 2))
    tour.pass_(101)
    assert tour.legs == []
    tour.pass_()
    assert tour.legs == [(1, 2)]


def test_home_is_set_on_the_way():
    set_home = mav.MAV_CMD_DO_SET_HOME
    there = MissionItem(set_home, NED, (0.0,) * 4, x=40_000, y=30_000)
    tour = Tour(there, do(mav.MAV_CMD_NAV_RETURN_TO_LAUNCH), do(set_home, 1.0), do(mav.MAV_CMD_NAV_RETURN_TO_LAUNCH))
    tour.arrive()
    assert tour.legs == [(3, 4)]
    tour.robot.readings = replace(tour.robot.readings, base_in_map=Pose2(5.0, 6.0, 0.5))
    list(tour.home.step(tour.tick, tour.robot.readings))
    tour.pass_(3)
    assert tour.robot.asked[-1] == ("go_to", 5, 6, 0.5)
    assert tour.reached == [0, 1, 2]


def test_a_home_that_is_none_halts_the_mission():
    tour = Tour(MissionItem(mav.MAV_CMD_DO_SET_HOME, NED, (0.0,) * 4, x=990_000, y=0), go(1, 2))
    tour.pass_(2)
    assert (tour.legs, tour.state) == ([], PAUSED)
    assert tour.told == ["Mission halted at item 0. There the map has nothing."]


def test_returning_to_launch_is_going_home():
    tour = Tour(do(mav.MAV_CMD_NAV_RETURN_TO_LAUNCH))
    tour.arrive()
    assert (tour.robot.asked, tour.state) == ([("go_to", 1, 2, 0.0)], COMPLETE)


@pytest.mark.parametrize(
    ("item", "call"),
    [
        (do(mav.MAV_CMD_DO_CHANGE_SPEED, 1.0, 0.5, -1.0), ("limit_speed", 0.5)),
        (do(mav.MAV_CMD_DO_CHANGE_SPEED, 1.0, -2.0, -1.0), ("limit_speed", -2.0)),
        (do(mav.MAV_CMD_DO_CHANGE_SPEED, 1.0, -1.0, -1.0), None),
        (do(mav.MAV_CMD_DO_CHANGE_SPEED, 1.0, NAN, -1.0), None),
        (do(mav.MAV_CMD_IMAGE_START_CAPTURE, 0.0, 0.0, 1.0), ("photograph",)),
        (do(mav.MAV_CMD_USER_1, 3.0), ("identify", 3)),
        (do(mav.MAV_CMD_USER_2), ("leave",)),
    ],
)
def test_what_is_done_on_the_spot(item, call):
    tour = Tour(item)
    tour.pass_()
    assert tour.robot.asked == ([] if call is None else [call])
    assert (tour.reached, tour.state) == ([0], COMPLETE)


def test_jumps_are_repeated_as_often_as_they_say():
    tour = Tour(go(1, 1), do(mav.MAV_CMD_DO_JUMP, 0.0, 2.0), go(9, 9))
    for _ in range(4):
        tour.arrive()
        tour.pass_()
    assert tour.legs == [(1, 1)] * 3 + [(9, 9)]
    assert tour.state == COMPLETE


@pytest.mark.parametrize("how", ["select", "start"])
def test_who_goes_back_by_hand_has_all_jumps_again(how):
    tour = Tour(go(1, 1), do(mav.MAV_CMD_DO_JUMP, 0.0, 1.0), go(9, 9))
    for _ in range(2):
        tour.arrive()
        tour.pass_()
    tour.run.select(0) if how == "select" else tour.run.start(0)
    for _ in range(3):
        tour.arrive()
        tour.pass_()
    assert tour.legs == [(1, 1)] * 4 + [(9, 9)]


def test_the_end_of_another_leg_is_not_taken_for_that_of_the_own():
    tour = Tour(go(1, 2))
    old = HelmLeg(7, LegState.ARRIVED)
    tour.pass_()
    tour.robot.readings = replace(tour.robot.readings, leg=old)
    tour.pass_(5)
    assert (tour.state, tour.reached) == (ACTIVE, [])


def test_a_jump_without_end_goes_on_for_ever_and_takes_time():
    tour = Tour(do(mav.MAV_CMD_DO_JUMP, 0.0, -1.0))
    tour.pass_(1000)
    assert tour.state == ACTIVE


class TestFailure:
    @pytest.mark.parametrize("failing", ["refused", "on its way"])
    def test_it_halts_the_mission_and_says_why(self, failing):
        tour = Tour(go(1, 2), go(3, 4))
        if failing == "refused":
            tour.robot.refusal = Denied("Not enough energy.")
            tour.pass_()
        else:
            tour.pass_()
            tour.robot.fail("Not enough energy.")
            tour.pass_()
        assert (tour.run.running, tour.state, tour.run.current_item) == (False, PAUSED, 0)
        assert tour.told == ["Mission halted at item 0. Not enough energy."]
        assert tour.said[-1].mission_state == PAUSED
        assert tour.reached == []

    def test_a_failure_without_a_reason_is_put_into_words(self):
        tour = Tour(go(1, 2))
        tour.pass_()
        tour.robot.fail("")
        tour.pass_()
        assert tour.told == ["Mission halted at item 0. The robot did not get there."]

    def test_the_item_is_tried_again_when_the_mission_goes_on(self):
        tour = Tour(do(mav.MAV_CMD_IMAGE_START_CAPTURE, 0.0, 0.0, 1.0))
        tour.robot.refusal = Denied("No room here.")
        tour.pass_()
        tour.robot.refusal = None
        tour.run.start()
        tour.pass_()
        assert tour.state == COMPLETE


def test_a_pause_keeps_the_place_and_going_on_sets_out_again():
    tour = Tour(go(1, 2), go(3, 4))
    tour.arrive()
    tour.pass_()
    tour.run.pause()
    tour.pass_(50)
    assert (tour.state, tour.run.current_item) == (PAUSED, 1)
    tour.run.start()
    tour.pass_()
    assert tour.legs == [(1, 2), (3, 4), (3, 4)]


def test_an_item_that_does_not_continue_waits():
    tour = Tour(go(1, 2, autocontinue=False), go(3, 4))
    tour.arrive()
    assert (tour.run.running, tour.state, tour.run.current_item, tour.reached) == (False, PAUSED, 1, [0])


def test_ardupilot_always_goes_on():
    tour = Tour(go(0, 0), go(1, 2, autocontinue=False), go(3, 4, autocontinue=False), ardupilot=True)
    tour.arrive()
    tour.arrive()
    assert (tour.legs, tour.reached, tour.state) == ([(1, 2), (3, 4)], [1, 2], COMPLETE)


class TestVisitedRooms:
    """Items that lead into rooms which were visited already."""

    DONE = Denied("Room 3 has been visited already.", is_done=True)
    PICTURE = do(mav.MAV_CMD_IMAGE_START_CAPTURE, 0.0, 0.0, 1.0)

    def test_a_mission_halts_there(self):
        tour = Tour(go(1, 2), go(3, 4))
        tour.robot.refusal = self.DONE
        tour.pass_(5)
        assert (tour.state, tour.run.current_item) == (PAUSED, 0)
        assert tour.told == ["Mission halted at item 0. Room 3 has been visited already."]

    def test_or_it_skips_them_and_what_was_to_be_done_there_and_says_so(self):
        tour = Tour(go(1, 2), self.PICTURE, do(mav.MAV_CMD_USER_2), go(3, 4), self.PICTURE, visited_rooms=SKIP)
        tour.robot.refusal = self.DONE
        tour.pass_()
        tour.robot.refusal = None
        tour.pass_(3)
        tour.arrive()
        tour.pass_()
        assert tour.told == [
            "Mission item 0 skipped. Room 3 has been visited already.",
            "Mission item 1 skipped. It is for the room that was skipped.",
            "Mission item 2 skipped. It is for the room that was skipped.",
            "Mission complete.",
        ]
        assert [call[0] for call in tour.robot.asked] == ["go_to", "go_to", "photograph"]
        assert (tour.reached, tour.state) == ([3, 4], COMPLETE)

    def test_every_other_refusal_halts_it_all_the_same(self):
        tour = Tour(go(1, 2), go(3, 4), visited_rooms=SKIP)
        tour.robot.refusal = Denied("There is not enough energy.")
        tour.pass_(5)
        assert tour.told == ["Mission halted at item 0. There is not enough energy."]

    def test_a_round_in_which_nothing_is_left_halts(self):
        tour = Tour(go(1, 2), go(3, 4), do(mav.MAV_CMD_DO_JUMP, 0.0, -1.0), visited_rooms=SKIP)
        tour.arrive()
        tour.arrive()
        tour.robot.refusal = self.DONE
        tour.pass_(50)
        assert (tour.state, tour.run.current_item, len(tour.told)) == (PAUSED, 0, 3)
        assert tour.told[-1] == "Mission halted at item 0. Room 3 has been visited already."


class TestStart:
    def test_there_has_to_be_a_mission(self):
        tour = Tour(start=False)
        assert tour.run.start().sentence == "There is no mission."
        assert (tour.state, tour.run.current().total) == (NO_MISSION, 65535)

    def test_a_part_of_it(self):
        tour = Tour(go(0, 0), go(1, 1), go(2, 2), go(3, 3), start=False)
        assert tour.run.start(1, 2) is None
        tour.arrive()
        tour.arrive()
        assert (tour.legs, tour.state) == ([(1, 1), (2, 2)], COMPLETE)

    def test_the_end_of_a_part_is_not_that_of_another_plan(self):
        tour = Tour(go(0, 0), go(1, 1), start=False)
        tour.run.start(0, 0)
        tour.run.replace((go(0, 0), go(2, 2)))
        tour.arrive()
        assert (tour.run.current_item, tour.state) == (1, ACTIVE)

    @pytest.mark.parametrize(("first", "last"), [(2, None), (-1, None), (0, 2), (1, 0)])
    def test_parts_that_are_none_are_refused(self, first, last):
        tour = Tour(go(0, 0), go(1, 1), start=False)
        assert isinstance(tour.run.start(first, last), Denied)
        assert tour.state == NOT_STARTED

    def test_after_the_end_it_begins_again(self):
        tour = Tour(go(0, 0))
        tour.arrive()
        tour.run.start()
        tour.pass_()
        assert tour.legs == [(0, 0)] * 2


class TestSelect:
    def test_under_way_it_goes_there_now(self):
        tour = Tour(go(0, 0), go(1, 1), go(2, 2))
        tour.pass_(5)
        assert tour.run.select(2) is None
        tour.pass_()
        assert tour.legs == [(0, 0), (2, 2)]

    def test_at_rest_it_is_where_the_mission_will_begin(self):
        tour = Tour(go(0, 0), go(1, 1), start=False)
        tour.run.select(1)
        tour.pass_(5)
        assert tour.legs == []
        tour.run.start()
        tour.pass_()
        assert tour.legs == [(1, 1)]

    def test_after_the_end_the_mission_is_over_no_more(self):
        tour = Tour(go(0, 0), go(1, 1))
        tour.arrive()
        tour.arrive()
        tour.run.select(1)
        assert tour.state == PAUSED

    def test_what_is_no_item_is_refused(self):
        tour = Tour(go(0, 0))
        assert isinstance(tour.run.select(1), Denied)


class TestHalting:
    """The robot does not drive on where the mission has no more use for it."""

    @pytest.fixture
    def tour(self):
        tour = Tour(go(0, 0), do(mav.MAV_CMD_NAV_DELAY, 1.0), do(mav.MAV_CMD_USER_2), go(3, 3))
        tour.pass_(5)
        return tour

    def test_a_robot_on_its_way_stands_still_to_wait(self, tour):
        tour.run.select(1)
        tour.pass_()
        assert tour.robot.asked[1:] == [("halt",)]

    def test_it_stands_still_when_the_plan_is_taken_away(self, tour):
        tour.run.replace(())
        assert tour.robot.asked[1:] == [("halt",)]

    def test_it_stands_still_when_another_item_fails(self, tour):
        tour.run.select(2)
        tour.robot.refusal = Denied("No treasure here.")
        tour.pass_()
        assert tour.robot.asked[1:] == [("leave",), ("halt",)]

    def test_it_needs_no_halt_to_go_elsewhere(self, tour):
        tour.run.select(3)
        tour.pass_()
        assert tour.robot.asked[1:] == [("go_to", 3, 3, None)]

    def test_nor_where_it_has_arrived(self, tour):
        tour.robot.arrive()
        tour.pass_(3)
        assert tour.robot.asked[1:] == []

    def test_nor_when_a_pause_has_halted_it(self, tour):
        tour.run.pause()
        tour.run.replace(())
        assert tour.robot.asked[1:] == []


class TestReplace:
    def test_a_plan_that_is_the_same_so_far_goes_on(self):
        tour = Tour(go(0, 0), go(1, 1), go(2, 2))
        tour.arrive()
        tour.pass_()
        tour.run.replace((go(0, 0), go(1, 1), go(7, 7)))
        tour.robot.arrive()
        tour.pass_(2)
        assert tour.legs == [(0, 0), (1, 1), (7, 7)]

    def test_another_plan_begins_at_its_beginning(self):
        tour = Tour(go(0, 0), go(1, 1))
        tour.arrive()
        tour.run.replace((go(7, 7), go(1, 1)))
        tour.pass_()
        assert tour.legs == [(0, 0), (7, 7)]
        assert tour.state == ACTIVE

    def test_a_paused_mission_stays_where_it_is(self):
        tour = Tour(go(0, 0), go(1, 1))
        tour.arrive()
        tour.run.pause()
        tour.run.replace((go(0, 0), go(1, 1), go(7, 7)))
        assert (tour.run.current_item, tour.state) == (1, PAUSED)

    def test_one_that_is_over_begins_anew_even_by_the_same_plan(self):
        tour = Tour(go(0, 0))
        tour.arrive()
        tour.run.replace((go(0, 0),))
        assert (tour.run.current_item, tour.state) == (0, NOT_STARTED)

    def test_no_plan_ends_the_mission(self):
        tour = Tour(go(0, 0))
        tour.pass_()
        tour.run.replace(())
        tour.pass_()
        assert (tour.run.running, tour.state) == (False, NO_MISSION)

    def test_only_who_commands_may_change_what_is_under_way(self):
        tour = Tour(go(0, 0))
        tour.robot.readings = replace(tour.robot.readings, commander=str(STATION))
        tour.pass_()
        assert tour.run.objection(STATION) is None
        assert tour.run.objection(Station(254, 190)).sentence == "A mission of ground station 255 is under way."
        tour.run.pause()
        assert tour.run.objection(Station(254, 190)) is None


ITEMS = st.one_of(
    st.builds(go, st.floats(-5, 5), st.floats(-5, 5), st.sampled_from([0.0, 0.1])),
    st.builds(lambda seconds: do(mav.MAV_CMD_NAV_DELAY, seconds), st.floats(0, 0.2)),
    st.builds(lambda to, repeats: do(mav.MAV_CMD_DO_JUMP, float(to), float(repeats)), st.just(0), st.integers(0, 2)),
    st.just(do(mav.MAV_CMD_USER_2)),
)


@settings(max_examples=60, deadline=None)
@given(st.lists(ITEMS, min_size=1, max_size=5), st.data())
def test_whatever_the_plan_each_waypoint_is_reached_before_the_next_is_driven_to(items, data):
    tour = Tour(*items)
    for _ in range(2000):
        legs = len(tour.legs)
        tour.pass_()
        if len(tour.legs) > legs:
            tour.pass_(data.draw(st.integers(0, 3)))
            tour.robot.arrive()
        if not tour.run.running:
            break
    assert tour.state == COMPLETE
    driven = [n for n in tour.reached if items[n].command == mav.MAV_CMD_NAV_WAYPOINT]
    assert tour.legs == [(round(items[n].y / 1e4, 2), round(items[n].x / 1e4, 2)) for n in driven]
