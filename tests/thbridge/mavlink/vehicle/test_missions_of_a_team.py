"""Missions and parameters through hub and vehicles, with two ground stations at once."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.mavlink.model_station import Air, ModelStation, waypoint
from tests.support.mavlink.vehicle_with_stations import HEARTBEAT, OPTIONS, Game
from thbridge.mavlink.hub import Hub
from thbridge.mavlink.vehicle.vehicle import Vehicle
from thbridge.mavlink.wire.dialect import crc_extra, decoded, mav, payload_of
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.outgoing import LinkId, OutgoingMessage

NAN = float("nan")
HOLD, MISSION = (4, 3), (4, 4)
ACTIVE, PAUSED, COMPLETE = 3, 4, 5
AT_ORIGIN = (524000000, 97000000)


class Team:
    """Two robots behind one hub, which stations see as one part of a vehicle: what they hear is system 1's."""

    def __init__(self):
        self.robots = [Game(), Game()]
        self.hub = Hub([Vehicle(number, robot, OPTIONS) for number, robot in enumerate(self.robots, 1)], 5.0)
        for link in range(2):
            self.hub.open(LinkId(link), f"link {link}")

    def handle_message(self, link, sender, message):
        number = message.get_msgId()
        frame = Frame(sender.system, sender.component, 0, number, payload_of(message), crc_extra(number))
        return self._from_first(self.hub.receive(link, frame).replies)

    def step(self, tick, _):
        return self._from_first(self.hub.step(tick, [robot.readings for robot in self.robots]))

    def _from_first(self, sent):
        return [
            OutgoingMessage(decoded(s.frame.message_id, s.frame.payload), s.link) for s in sent if s.frame.system == 1
        ]


class Scene:
    """A team and two stations, which beat as stations do."""

    def __init__(self, **air):
        self.team = Team()
        self.robot = self.team.robots[0]
        self.one, self.other = self.stations = ModelStation(255, attempts=8), ModelStation(245, attempts=8)
        self.air = Air([self.team], self.stations, self.robot, **air)
        self.run(1)

    def run(self, ticks=50, until=lambda: False):
        for _ in range(ticks):
            if self.air.tick % 50 == 0:
                for station in self.stations:
                    station.say(HEARTBEAT)
            self.air.run(1)
            if until():
                return

    def command(self, station, number, *params):
        """Send a command; its result."""
        params = (*params, *[NAN] * (7 - len(params)))
        before = len(station.of("COMMAND_ACK"))
        station.say(mav.MAVLink_command_long_message(1, 1, number, 0, *params))
        self.run(2)
        return [ack.result for ack in station.of("COMMAND_ACK")[before:]]

    def upload(self, station, items):
        station.upload(items)
        self.run(4000, lambda: station.result is not None)
        return station.result

    def begin(self, station, items):
        """Upload a mission, arm, and start it as MAVSDK does."""
        assert self.upload(station, items) == mav.MAV_MISSION_ACCEPTED
        assert self.command(station, mav.MAV_CMD_COMPONENT_ARM_DISARM, 1) == [mav.MAV_RESULT_ACCEPTED]
        assert self.command(station, mav.MAV_CMD_DO_SET_MODE, 1, *MISSION) == [mav.MAV_RESULT_ACCEPTED]

    def mode(self, station):
        """As its last heartbeat has it."""
        mode = station.of("HEARTBEAT")[-1].custom_mode
        return mode >> 16 & 0xFF, mode >> 24

    def mission(self, station):
        """The number of the item and the state, as last told."""
        current = station.of("MISSION_CURRENT")[-1]
        return current.seq, current.mission_state

    def texts(self, station):
        return " ".join(text.text for text in station.of("STATUSTEXT"))


@pytest.fixture
def scene():
    return Scene()


def east(metres):
    """A waypoint so far east of the origin."""
    return waypoint(AT_ORIGIN[0], AT_ORIGIN[1] + round(metres * 147.2))


def test_a_mission_from_upload_to_its_end(scene):
    scene.begin(scene.one, [east(1), east(2)])
    for place in (1.0, 2.0):
        scene.run(10)
        assert scene.robot.calls("go_to")[-1][1] == pytest.approx(place, abs=0.02)
        assert [scene.mode(station) for station in scene.stations] == [MISSION, MISSION]
        scene.robot.arrive()
    scene.run(100)
    for station in scene.stations:
        assert [message.seq for message in station.of("MISSION_ITEM_REACHED")] == [0, 1]
        assert (scene.mission(station), scene.mode(station)) == ((1, COMPLETE), HOLD)
        assert "Mission complete." in scene.texts(station)


def test_the_other_robot_has_a_plan_of_its_own(scene):
    scene.begin(scene.one, [east(1)])
    scene.run(10)
    assert scene.team.robots[1].asked == []


def test_a_mission_that_is_over_is_told_each_second(scene):
    scene.begin(scene.one, [east(1)])
    scene.run(10)
    scene.robot.arrive()
    scene.run(10)
    before = len(scene.other.of("MISSION_CURRENT"))
    scene.run(200)
    assert len(scene.other.of("MISSION_CURRENT")) - before == 4


def test_the_other_station_may_read_and_stop_but_not_change_what_is_under_way(scene):
    scene.begin(scene.one, [east(1), east(2)])
    scene.run(10)
    scene.other.download()
    scene.run(100, lambda: scene.other.result is not None)
    assert [item[9] for item in scene.other.downloaded] == [east(1)[9], east(2)[9]]
    assert scene.upload(scene.other, [east(5)]) == mav.MAV_MISSION_DENIED
    scene.other.say(mav.MAVLink_mission_set_current_message(1, 1, 1))
    scene.run(5)
    assert scene.mission(scene.other) == (0, ACTIVE)
    assert scene.command(scene.other, mav.MAV_CMD_DO_SET_MODE, 1, *HOLD) == [mav.MAV_RESULT_ACCEPTED]
    scene.run(60)
    assert (scene.mission(scene.one), scene.mode(scene.one)) == ((0, PAUSED), HOLD)
    assert scene.robot.asked[-1] == ("halt",)
    assert scene.upload(scene.other, [east(5)]) == mav.MAV_MISSION_ACCEPTED


def test_a_plan_for_a_mission_under_way_is_refused_before_it_is_sent(scene):
    scene.begin(scene.one, [east(1)])
    scene.other.say(mav.MAVLink_mission_count_message(1, 1, 2))
    scene.run(20)
    assert scene.other.of("MISSION_REQUEST_INT") == []
    assert [ack.type for ack in scene.other.of("MISSION_ACK")] == [mav.MAV_MISSION_DENIED]
    assert "Mission refused. A mission of ground station 255" in scene.texts(scene.other)


def test_a_plan_that_comes_while_a_mission_begins_is_refused_in_the_end(scene):
    assert scene.upload(scene.one, [east(1)]) == mav.MAV_MISSION_ACCEPTED
    scene.other.say(mav.MAVLink_mission_count_message(1, 1, 1))
    scene.run(2)
    scene.command(scene.one, mav.MAV_CMD_COMPONENT_ARM_DISARM, 1)
    scene.command(scene.one, mav.MAV_CMD_DO_SET_MODE, 1, *MISSION)
    scene.other.say(mav.MAVLink_mission_item_int_message(1, 1, 0, *east(5)))
    scene.run(20)
    assert [ack.type for ack in scene.other.of("MISSION_ACK")] == [mav.MAV_MISSION_DENIED]
    scene.robot.arrive()
    scene.run(10)
    assert scene.mission(scene.one) == (0, COMPLETE)


def test_pause_and_continue(scene):
    scene.begin(scene.one, [east(1), east(2)])
    scene.run(10)
    scene.robot.arrive()
    scene.run(10)
    assert scene.command(scene.one, mav.MAV_CMD_DO_PAUSE_CONTINUE, 0) == [mav.MAV_RESULT_ACCEPTED]
    scene.run(60)
    assert scene.mission(scene.one) == (1, PAUSED)
    assert scene.command(scene.one, mav.MAV_CMD_DO_PAUSE_CONTINUE, 1) == [mav.MAV_RESULT_ACCEPTED]
    scene.run(60)
    assert (scene.mission(scene.one), scene.mode(scene.one)) == ((1, ACTIVE), MISSION)


def test_a_part_of_a_mission(scene):
    scene.begin(scene.one, [east(1), east(2), east(3), east(4)])
    scene.run(5)
    assert scene.command(scene.one, mav.MAV_CMD_MISSION_START, 2, 2) == [mav.MAV_RESULT_ACCEPTED]
    scene.run(5)
    assert scene.robot.calls("go_to")[-1][1] == pytest.approx(3.0, abs=0.02)
    scene.robot.arrive()
    scene.run(60)
    assert scene.mission(scene.one) == (2, COMPLETE)


def test_the_current_item_is_set_by_message_or_command(scene):
    scene.begin(scene.one, [east(1), east(2), east(3)])
    scene.one.say(mav.MAVLink_mission_set_current_message(1, 1, 1))
    scene.run(5)
    assert (scene.mission(scene.one), scene.mission(scene.other)) == ((1, ACTIVE), (1, ACTIVE))
    assert scene.command(scene.one, mav.MAV_CMD_DO_SET_MISSION_CURRENT, 2) == [mav.MAV_RESULT_ACCEPTED]
    scene.run(5)
    assert scene.robot.calls("go_to")[-1][1] == pytest.approx(3.0, abs=0.02)
    assert scene.command(scene.one, mav.MAV_CMD_DO_SET_MISSION_CURRENT, 3) == [mav.MAV_RESULT_DENIED]


def test_an_item_that_fails_holds_the_robot_and_says_why(scene):
    scene.begin(scene.one, [east(1), east(2)])
    scene.run(10)
    scene.robot.fail("There is no way.")
    scene.run(100)
    assert (scene.mission(scene.other), scene.mode(scene.other)) == ((0, PAUSED), HOLD)
    assert "Mission halted at item 0. There is no way." in scene.texts(scene.other)


def test_clearing_what_is_under_way_halts_the_robot(scene):
    scene.begin(scene.one, [east(1)])
    scene.run(10)
    scene.one.clear()
    scene.run(60)
    assert scene.one.result == mav.MAV_MISSION_ACCEPTED
    assert scene.robot.asked[-1] == ("halt",)
    assert scene.mode(scene.one) == HOLD


def test_a_mission_that_begins_with_waiting_does_not_go_on_driving(scene):
    scene.begin(scene.one, [east(1)])
    scene.run(10)
    delay = waypoint(0, 0, mav.MAV_CMD_NAV_DELAY, (1.0, 0, 0, 0), frame=2)
    assert scene.upload(scene.one, [delay, east(2)]) == mav.MAV_MISSION_ACCEPTED
    scene.run(10)
    assert scene.robot.asked[-1] == ("halt",)
    scene.run(60)
    assert scene.robot.asked[-1][0] == "go_to"


def test_a_changed_parameter_is_told_to_both_and_read_by_each(scene):
    scene.one.say(mav.MAVLink_param_set_message(1, 1, b"PARAM_03", 0.25, mav.MAV_PARAM_TYPE_REAL32))
    scene.run(2)
    for station in scene.stations:
        (value,) = station.of("PARAM_VALUE")
        assert (value.param_id, value.param_value) == ("PARAM_03", 0.25)
        station.say(mav.MAVLink_param_request_list_message(0, 0))
    scene.run(20)
    every = 1 + 3 + len(scene.robot.values)  # The change, the vehicle's own, the robot's.
    assert [len(station.of("PARAM_VALUE")) for station in scene.stations] == [every, every]


@settings(max_examples=8, deadline=None)
@given(st.integers(0, 2**32))
def test_two_stations_that_send_plans_at_once_over_lossy_links_both_come_through(seed):
    scene = Scene(seed=seed, loss=0.3, late=0.3)
    plans = {scene.one: [east(n) for n in range(4)], scene.other: [east(-n) for n in range(5)]}
    done = []
    for station, plan in plans.items():
        station.upload(plan)
    for _ in range(200):
        scene.run(50)
        for station, plan in plans.items():
            if station.result == mav.MAV_MISSION_ACCEPTED and station not in done:
                done.append(station)
            elif station.result is not None and station not in done:
                station.upload(plan)
        if len(done) == 2:
            break
    assert len(done) == 2
    scene.one.download()
    scene.run(4000, lambda: scene.one.result is not None)
    assert [item[9] for item in scene.one.downloaded] in [[item[9] for item in plan] for plan in plans.values()]
