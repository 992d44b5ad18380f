"""The mission protocol, rule by rule, against a station that follows the guide."""

import math
import struct

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from tests.support.mavlink.model_robot import ModelRobot
from tests.support.mavlink.model_station import Air, ModelStation, waypoint
from tests.support.mavlink.vehicle_with_stations import home_of
from thbridge.mavlink.values.options import GeoOrigin
from thbridge.mavlink.values.vehicle_interface import Denied, Target
from thbridge.mavlink.vehicle.geodesy import MapProjection
from thbridge.mavlink.vehicle.mission.downloads import DOWNLOAD_TIMEOUT
from thbridge.mavlink.vehicle.mission.protocol import ITEM_TIMEOUT, LONGEST, RETRIES, MissionProtocol
from thbridge.mavlink.vehicle.mission.run import MissionRun
from thbridge.mavlink.wire.dialect import decoded, mav, payload_of

ACCEPTED = mav.MAV_MISSION_ACCEPTED
FENCE, RALLY, ALL = mav.MAV_MISSION_TYPE_FENCE, mav.MAV_MISSION_TYPE_RALLY, mav.MAV_MISSION_TYPE_ALL
ORIGIN = GeoOrigin(52.0, 13.0, 34.0)
LATITUDE, LONGITUDE = 520000000, 130000000


def places(count):
    """So many waypoints, all different."""
    return [waypoint(LATITUDE + 100 * n, LONGITUDE - 100 * n) for n in range(count)]


def coordinates(items):
    return [(item[8], item[9]) for item in items]


class Field:
    """A robot's missions, and stations around it."""

    def __init__(self, stations=1, ardupilot=False, **air):
        self.robot = ModelRobot()
        self.told = []
        earth = MapProjection(ORIGIN)
        self.home = home_of(self.robot, earth)
        self.run_of = MissionRun(self.robot, self.home, earth, self.announce, ardupilot)
        self.missions = MissionProtocol(self.run_of, self.announce)
        attempts = air.pop("attempts", 1)
        self.stations = [ModelStation(255 - n, attempts=attempts) for n in range(stations)]
        self.station = self.stations[0]
        self.air = Air([self.missions], self.stations, self.robot, **air)

    def announce(self, severity, sentence):
        self.told.append(sentence)

    def run(self, ticks=500, until=None):
        self.air.run(ticks, until or (lambda: all(station.result is not None for station in self.stations)))

    def upload(self, items, station=None, **options):
        """Upload by a station; its result."""
        station = station or self.station
        station.upload(items, **options)
        self.air.run(500, lambda: station.result is not None)
        return station.result

    def download(self):
        self.station.download()
        self.run()
        return self.station.downloaded

    def send(self, message, station=None):
        """Say one message, and give the vehicle a tick to answer; what came back in it."""
        station = station or self.station
        heard = len(station.heard)
        station.say(message)
        self.air.run(1)
        return station.heard[heard:]

    @property
    def upload_goes_on(self):
        """Whether an item is asked for within the next half second."""
        before = len(self.station.of("MISSION_REQUEST_INT") + self.station.of("MISSION_REQUEST"))
        self.air.run(2 * ITEM_TIMEOUT)
        return len(self.station.of("MISSION_REQUEST_INT") + self.station.of("MISSION_REQUEST")) > before

    def answers(self, message):
        """What is answered to the first station, before it has travelled."""
        return [said.message for said in self.missions.handle_message(0, self.station.station, message)]

    @property
    def plan(self):
        return [(item.x, item.y) for item in self.run_of.plan]


@pytest.fixture
def field():
    return Field()


def count_message(count, kind=0):
    return mav.MAVLink_mission_count_message(1, 1, count, kind)


def item_message(seq, item):
    return mav.MAVLink_mission_item_int_message(1, 1, seq, *item)


def names(messages):
    return [message.get_type() for message in messages]


def test_a_plan_comes_back_as_it_was_sent(field):
    items = [
        *places(3),
        waypoint(0, 0, mav.MAV_CMD_NAV_DELAY, (1.5, math.nan, math.nan, math.nan), frame=2, z=math.nan),
    ]
    assert field.upload(items) == ACCEPTED
    sent = [(item[0], item[1], *item[3:]) for item in items]
    back = [(item[0], item[1], *item[3:]) for item in field.download()]
    assert str(back) == str(sent), "as text, because NaN is not equal to itself"


def test_items_are_asked_for_in_order_and_acknowledged_once(field):
    field.upload(places(3))
    assert [message.seq for message in field.station.of("MISSION_REQUEST_INT")] == [0, 1, 2]
    assert len(field.station.of("MISSION_ACK")) == 1
    assert field.station.of("MISSION_REQUEST") == []


def test_what_is_said_in_a_transfer_is_addressed_to_its_station(field):
    field.upload(places(1))
    for name in ("MISSION_REQUEST_INT", "MISSION_ACK"):
        message = field.station.of(name)[0]
        assert (message.target_system, message.target_component) == (255, 190)


def test_a_new_plan_is_told_to_all():
    field = Field(stations=2)
    field.upload(places(2))
    assert field.stations[1].of("MISSION_CURRENT")[0].total == 2


def test_only_the_current_item_is_marked_as_current(field):
    field.upload(places(3))
    field.send(mav.MAVLink_mission_set_current_message(1, 1, 2))
    assert [item[2] for item in field.download()] == [0, 0, 1]


def test_an_item_that_does_not_come_is_asked_for_again_each_250_ms_and_then_given_up(field):
    field.send(count_message(2))
    field.air.run(400)
    requests = field.station.of("MISSION_REQUEST_INT") + field.station.of("MISSION_REQUEST")
    assert len(requests) == 1 + RETRIES
    assert field.station.of("MISSION_ACK")[-1].type == mav.MAV_MISSION_OPERATION_CANCELLED
    assert ITEM_TIMEOUT * 20 in range(250, 270)
    assert field.send(item_message(0, places(1)[0]))[0].type == mav.MAV_MISSION_ERROR, "nothing is under way any more"


def test_items_are_asked_for_again_after_250_ms_and_not_before(field):
    field.send(count_message(1))
    # It came just before this tick, and counts as come with the last one.
    field.air.run(ITEM_TIMEOUT - 2)
    assert len(field.station.of("MISSION_REQUEST_INT")) == 1
    field.air.run(1)
    assert len(field.station.of("MISSION_REQUEST_INT")) == 2


def test_who_sends_what_is_there_already_lives_and_is_waited_for(field):
    field.send(count_message(2))
    for _ in range(4):
        field.send(item_message(0, places(1)[0]))
        field.air.run((RETRIES - 1) * ITEM_TIMEOUT)
    assert field.upload_goes_on


def test_the_old_plan_stands_until_the_new_one_is_complete(field):
    field.upload(places(3))
    field.send(count_message(2))
    field.send(item_message(0, waypoint(1, 1)))
    assert field.plan == coordinates(places(3))
    field.air.run(400)
    assert field.plan == coordinates(places(3))


def test_an_item_that_comes_too_early_is_dropped_and_the_missing_one_asked_for(field):
    field.send(count_message(3))
    answer = field.send(item_message(2, places(3)[2]))
    assert [(message.get_type(), message.seq) for message in answer] == [("MISSION_REQUEST_INT", 0)]


def test_an_item_that_is_there_already_changes_nothing(field):
    field.send(count_message(2))
    field.send(item_message(0, places(1)[0]))
    assert field.send(item_message(0, waypoint(7, 7))) == []
    field.send(item_message(1, places(2)[1]))
    assert field.plan == coordinates(places(2))


def test_the_last_item_again_is_acknowledged_again(field):
    field.upload(places(2))
    answer = field.send(item_message(1, places(2)[1]))
    assert [message.type for message in answer] == [ACCEPTED]
    assert field.send(item_message(0, places(2)[0])) == []


def test_a_count_again_begins_again(field):
    field.send(count_message(2))
    field.send(item_message(0, waypoint(7, 7)))
    assert field.send(count_message(2))[0].seq == 0
    for seq, item in enumerate(places(2)):
        field.send(item_message(seq, item))
    assert field.plan == coordinates(places(2))


def test_a_station_may_cancel(field):
    field.send(count_message(2))
    field.send(mav.MAVLink_mission_ack_message(1, 1, mav.MAV_MISSION_OPERATION_CANCELLED))
    field.air.run(100)
    assert len(field.station.of("MISSION_REQUEST_INT")) == 1


def test_what_is_said_of_fences_does_not_cancel_a_mission(field):
    field.send(count_message(2))
    field.send(mav.MAVLink_mission_ack_message(1, 1, mav.MAV_MISSION_ERROR, FENCE))
    assert field.upload_goes_on


def test_an_error_ends_the_upload_that_was_before_it(field):
    field.send(count_message(2))
    assert field.send(count_message(LONGEST + 1))[0].type == mav.MAV_MISSION_NO_SPACE
    assert not field.upload_goes_on


def test_who_has_said_nothing_for_long_reads_the_plan_anew(field):
    field.upload(places(1))
    field.send(mav.MAVLink_mission_request_list_message(1, 1, 0))
    field.run_of.replace(())
    field.air.run(DOWNLOAD_TIMEOUT - 2)
    assert field.send(mav.MAVLink_mission_request_int_message(1, 1, 0))[0].get_type() == "MISSION_ITEM_INT"
    field.air.run(DOWNLOAD_TIMEOUT + 1)
    assert field.send(mav.MAVLink_mission_request_int_message(1, 1, 0))[0].get_type() == "MISSION_ACK"


def test_who_reads_slowly_reads_the_plan_as_it_was(field):
    field.upload(places(3))
    field.send(mav.MAVLink_mission_request_list_message(1, 1, 0))
    field.run_of.replace(())
    for seq in range(3):
        field.air.run(DOWNLOAD_TIMEOUT - 2)
        (item,) = field.send(mav.MAVLink_mission_request_int_message(1, 1, seq))
        assert (item.get_type(), item.seq) == ("MISSION_ITEM_INT", seq)


def test_an_empty_plan_clears(field):
    field.upload(places(2))
    assert field.upload([]) == ACCEPTED
    assert field.download() == []


@pytest.mark.parametrize("kind", [0, ALL])
def test_clearing(field, kind):
    field.upload(places(2))
    field.station.clear(kind)
    field.run()
    assert (field.station.result, field.plan) == (ACCEPTED, [])
    assert field.station.of("MISSION_ACK")[-1].mission_type == kind
    assert field.station.of("MISSION_CURRENT")[-1].mission_state == mav.MISSION_STATE_NO_MISSION


@pytest.mark.parametrize("kind", [FENCE, RALLY])
class TestFenceAndRally:
    def test_there_is_none_to_be_read(self, field, kind):
        answer = field.send(mav.MAVLink_mission_request_list_message(1, 1, kind))
        assert [(message.count, message.mission_type) for message in answer] == [(0, kind)]
        field.upload(places(1))
        answer = field.send(mav.MAVLink_mission_request_int_message(1, 1, 0, kind))
        assert [message.type for message in answer] == [mav.MAV_MISSION_INVALID_SEQUENCE]

    def test_none_is_taken_but_an_empty_one(self, field, kind):
        assert field.send(count_message(0, kind))[0].type == ACCEPTED
        answer = field.send(count_message(2, kind))
        assert [(message.type, message.mission_type) for message in answer] == [(mav.MAV_MISSION_UNSUPPORTED, kind)]

    def test_clearing_leaves_the_mission(self, field, kind):
        field.upload(places(2))
        assert field.send(mav.MAVLink_mission_clear_all_message(1, 1, kind))[0].type == ACCEPTED
        assert len(field.plan) == 2


def test_a_plan_that_is_too_long_is_refused_at_once(field):
    assert field.upload(places(LONGEST + 1)) == mav.MAV_MISSION_NO_SPACE
    field.upload(places(LONGEST))
    field.run(2000)
    assert len(field.plan) == LONGEST


def test_reading_beyond_the_end_is_an_invalid_sequence(field):
    field.upload(places(2))
    answer = field.send(mav.MAVLink_mission_request_int_message(1, 1, 2))
    assert [message.type for message in answer] == [mav.MAV_MISSION_INVALID_SEQUENCE]


def test_a_list_cannot_be_read_in_part(field):
    answer = field.send(mav.MAVLink_mission_request_partial_list_message(1, 1, 0, 1))
    assert [message.type for message in answer] == [mav.MAV_MISSION_UNSUPPORTED]


NAN = math.nan
BAD = {
    "a command that is not for rovers": (waypoint(1, 1, mav.MAV_CMD_NAV_TAKEOFF), mav.MAV_MISSION_UNSUPPORTED),
    "an unknown frame": (waypoint(1, 1, frame=99), mav.MAV_MISSION_UNSUPPORTED_FRAME),
    "a place without a frame": (waypoint(1, 1, frame=2), mav.MAV_MISSION_UNSUPPORTED_FRAME),
    "less than no time": (waypoint(1, 1, params=(-1.0, 0, 0, NAN)), mav.MAV_MISSION_INVALID_PARAM1),
    "no time to wait": (waypoint(0, 0, 93, (NAN, 0, 0, 0), 2), mav.MAV_MISSION_INVALID_PARAM1),
    "for ever": (waypoint(0, 0, 93, (math.inf, 0, 0, 0), 2), mav.MAV_MISSION_INVALID_PARAM1),
    "a negative radius": (waypoint(1, 1, params=(0, -1.0, 0, NAN)), mav.MAV_MISSION_INVALID_PARAM2),
    "half a repeat": (waypoint(0, 0, 177, (0, 0.5, 0, 0), 2), mav.MAV_MISSION_INVALID_PARAM2),
    "a jump out of the plan": (waypoint(0, 0, 177, (2, 1, 0, 0), 2), mav.MAV_MISSION_INVALID_PARAM1),
    "many pictures": (waypoint(0, 0, 2000, (0, 0, 5, 0), 2), mav.MAV_MISSION_INVALID_PARAM3),
    "an endless heading": (waypoint(1, 1, params=(0, 0, 0, math.inf)), mav.MAV_MISSION_INVALID_PARAM4),
    "beyond a pole": (waypoint(910000000, 1), mav.MAV_MISSION_INVALID_PARAM5_X),
    "nowhere": (waypoint(0, 0), mav.MAV_MISSION_INVALID_PARAM5_X),
    "beyond the earth": (waypoint(1, 1810000000), mav.MAV_MISSION_INVALID_PARAM6_Y),
}


@pytest.mark.parametrize("name", BAD)
def test_an_unfit_item_ends_the_upload_with_its_reason(field, name):
    item, result = BAD[name]
    field.upload(places(2))
    assert field.upload([places(1)[0], item]) == result
    assert field.plan == coordinates(places(2))
    assert len(field.told) == 1
    assert "item 1" in field.told[0]


GOOD = [
    *(waypoint(1, 1, frame=frame) for frame in (0, 1, 3, 5, 6, 10, 11)),
    waypoint(1, 1, 17),
    waypoint(0, 0, 19, (5.0, 0, 0, NAN)),
    waypoint(0, 0, 20, (0, 0, 0, 0), 2),
    waypoint(0, 0, 93, (2, -1, -1, -1), 2),
    waypoint(0, 0, 112, (2, 0, 0, 0), 2),
    waypoint(0, 0, 177, (0, -1, 0, 0), 2),
    waypoint(0, 0, 178, (1, 0.5, -1, 0), 2),
    waypoint(0, 0, 178, (1, -2, -1, 0), 2),
    waypoint(0, 0, 2000, (0, 0, 1, NAN), 2),
    waypoint(0, 0, 31010, (3, 0, 0, 0), 2),
    waypoint(0, 0, 31011, (0, 0, 0, 0), 2),
]


@pytest.mark.parametrize("item", GOOD, ids=lambda item: f"command {item[1]}, frame {item[0]}")
def test_what_rovers_do_is_taken(field, item):
    assert field.upload([item]) == ACCEPTED


class TestOldForms:
    def test_a_station_that_only_knows_them_can_send_a_plan(self, field):
        field.send(count_message(1))
        field.air.run(200, lambda: field.station.of("MISSION_REQUEST") != [])
        item = (6, 16, 0, 1, 0, 0, 0, NAN, 52.0, 13.0, 0)
        answer = field.send(mav.MAVLink_mission_item_message(1, 1, 0, *item))
        assert answer[0].type == ACCEPTED
        assert field.plan == [(520000000, 130000000)]

    def test_who_does_not_know_them_is_asked_in_the_new_form_again(self, field):
        field.send(count_message(1))
        field.air.run(200, lambda: field.station.of("MISSION_REQUEST") != [])
        answer = field.send(mav.MAVLink_mission_ack_message(1, 1, mav.MAV_MISSION_UNSUPPORTED))
        assert names(answer) == ["MISSION_REQUEST_INT"]
        field.air.run((RETRIES - 1) * ITEM_TIMEOUT)
        assert field.upload_goes_on

    def test_who_asks_in_one_form_is_answered_in_it(self, field):
        field.upload(places(1))
        (old,) = field.send(mav.MAVLink_mission_request_message(1, 1, 0))
        assert (old.get_type(), old.x, old.y) == ("MISSION_ITEM", 52.0, 13.0)
        (new,) = field.send(mav.MAVLink_mission_request_int_message(1, 1, 0))
        assert (new.get_type(), new.x, new.y) == ("MISSION_ITEM_INT", LATITUDE, LONGITUDE)

    def test_metres_are_floats_in_them(self, field):
        field.send(count_message(1))
        field.send(mav.MAVLink_mission_item_message(1, 1, 0, 1, 16, 0, 1, 0, 0, 0, NAN, 2.5, -1.25, 0))
        assert field.plan == [(25000, -12500)]

    @pytest.mark.parametrize("bad", [NAN, math.inf, 1e9])
    def test_a_place_that_is_no_number_is_refused(self, field, bad):
        field.send(count_message(1))
        answer = field.send(mav.MAVLink_mission_item_message(1, 1, 0, 6, 16, 0, 1, 0, 0, 0, NAN, 52.0, bad, 0))
        assert answer[0].type == mav.MAV_MISSION_INVALID_PARAM6_Y


class TestTwoStations:
    def test_another_one_is_denied_while_one_sends(self):
        field = Field(stations=2)
        one, other = field.stations
        field.send(count_message(2), one)
        assert field.send(count_message(1), other)[0].type == mav.MAV_MISSION_DENIED
        assert field.send(mav.MAVLink_mission_clear_all_message(1, 1), other)[0].type == mav.MAV_MISSION_DENIED
        assert field.send(item_message(0, places(1)[0]), other)[0].type == mav.MAV_MISSION_DENIED
        for seq, item in enumerate(places(2)):
            field.send(item_message(seq, item), one)
        assert field.plan == coordinates(places(2))

    def test_equal_ids_on_two_links_are_two_stations(self):
        field = Field(stations=2)
        one, other = field.stations
        other.station = one.station
        field.send(count_message(2), one)
        assert field.send(count_message(1), other)[0].type == mav.MAV_MISSION_DENIED

    def test_both_read_at_once(self):
        field = Field(stations=2)
        field.upload(places(9))
        for station in field.stations:
            station.download()
        field.run()
        assert [coordinates(station.downloaded) for station in field.stations] == [coordinates(places(9))] * 2

    def test_who_reads_goes_on_with_the_plan_as_it_was(self):
        field = Field(stations=2)
        field.upload(places(1))
        field.send(mav.MAVLink_mission_request_list_message(1, 1, 0), field.stations[1])
        field.upload([waypoint(7, 7)])
        (item,) = field.send(mav.MAVLink_mission_request_int_message(1, 1, 0), field.stations[1])
        assert (item.x, item.y) == (LATITUDE, LONGITUDE)

    def test_who_has_sent_a_plan_reads_that_one(self):
        field = Field()
        field.upload(places(2))
        field.send(mav.MAVLink_mission_request_list_message(1, 1, 0))
        field.upload([waypoint(7, 7)])
        (item,) = field.send(mav.MAVLink_mission_request_int_message(1, 1, 0))
        assert (item.x, item.y) == (7, 7)

    def test_a_link_that_is_gone_frees_the_robot(self):
        field = Field(stations=2)
        field.send(count_message(2), field.stations[0])
        field.missions.forget(0)
        assert field.upload(places(1), field.stations[1]) == ACCEPTED

    def test_who_reads_on_a_link_goes_on_when_another_one_is_gone(self):
        field = Field(stations=2)
        field.upload(places(1))
        field.send(mav.MAVLink_mission_request_list_message(1, 1, 0))
        field.run_of.replace(())
        field.missions.forget(1)
        (item,) = field.send(mav.MAVLink_mission_request_int_message(1, 1, 0))
        assert item.get_type() == "MISSION_ITEM_INT"


@pytest.mark.parametrize(
    ("axis", "result"),
    [
        ("y", mav.MAV_MISSION_INVALID_PARAM5_X),
        ("x", mav.MAV_MISSION_INVALID_PARAM6_Y),
        (None, mav.MAV_MISSION_INVALID),
    ],
)
def test_a_place_to_which_the_robot_cannot_get_is_refused_at_once_with_the_item(field, axis, result):
    assert field.upload(places(2)) == ACCEPTED
    before = field.plan
    # 100 units of 1e-7 degrees are a meter north, and less than one west.
    far = waypoint(LATITUDE + 900, LONGITUDE)
    field.robot.barred[0, 10] = Denied("There is no floor.", axis=axis)
    assert field.upload([*places(2), far, *places(1)]) == result
    assert field.told == ["Mission refused: in item 2, there is no floor."]
    assert field.plan == before


@pytest.mark.parametrize("ardupilot", [False, True])
def test_the_place_of_ardupilots_home_is_of_no_account(ardupilot):
    field = Field(ardupilot=ardupilot)
    field.robot.barred[0, 0] = Denied("There is no floor.", axis="x")
    accepted = field.upload([waypoint(LATITUDE, LONGITUDE), waypoint(LATITUDE + 900, LONGITUDE)]) == ACCEPTED
    assert accepted is ardupilot


class TestPartOfAPlan:
    def write(self, field, first, last, *items):
        answer = field.send(mav.MAVLink_mission_write_partial_list_message(1, 1, first, last))
        for item in items:
            assert answer[0].get_type() == "MISSION_REQUEST_INT"
            answer = field.send(item_message(answer[0].seq, item))
        return answer[0].type

    def test_it_takes_the_place_of_what_was_there(self, field):
        field.upload(places(4))
        assert self.write(field, 1, 2, waypoint(7, 7), waypoint(8, 8)) == ACCEPTED
        assert field.plan == [coordinates(places(4))[0], (7, 7), (8, 8), coordinates(places(4))[3]]

    def test_an_end_beyond_the_plan_is_its_end(self, field):
        field.upload(places(2))
        assert self.write(field, 1, 2, waypoint(7, 7)) == ACCEPTED
        assert len(field.plan) == 2

    def test_it_cannot_begin_beyond_the_plan(self, field):
        field.upload(places(2))
        assert self.write(field, 2, 3) == mav.MAV_MISSION_INVALID_SEQUENCE


class TestArduPilot:
    def test_the_first_item_is_home_whatever_is_sent(self):
        field = Field(ardupilot=True)
        assert field.upload([waypoint(0, 0, frame=0), *places(2)]) == ACCEPTED
        home = field.download()[0]
        # The robot's home is 1 m east and 2 m north of the origin.
        assert (home[0], home[1]) == (0, 16)
        assert home[8] == pytest.approx(LATITUDE + 180, abs=1)
        assert home[9] == pytest.approx(LONGITUDE + 146, abs=1)

    def test_home_can_be_read_where_there_is_no_plan(self):
        field = Field(ardupilot=True)
        (count,) = field.send(mav.MAVLink_mission_request_list_message(1, 1))
        assert count.count == 0
        (home,) = field.send(mav.MAVLink_mission_request_message(1, 1, 0))
        assert (home.seq, home.command) == (0, 16)
        assert home.x == pytest.approx(52.0, abs=1e-3)
        (refused,) = field.send(mav.MAVLink_mission_request_message(1, 1, 1))
        assert refused.type == mav.MAV_MISSION_INVALID_SEQUENCE

    def test_it_moves_with_home_and_the_plan_is_the_same(self):
        field = Field(ardupilot=True)
        field.upload([waypoint(0, 0, frame=0), *places(2)])
        before, plan = field.download()[0], field.run_of.plan_id
        field.run_of.start()
        field.air.run(3)
        assert field.home.set_to(Target(1.0, 12.0)) is None
        after = field.download()[0]
        assert (after[8] - before[8], after[9]) == (pytest.approx(899, abs=2), before[9])  # 10 m north
        field.upload([waypoint(0, 0, frame=0), *places(2)])
        assert (field.run_of.plan_id, field.run_of.current_item, field.run_of.running) == (plan, 1, True)

    def test_home_alone_is_no_mission(self):
        field = Field(ardupilot=True)
        field.upload([waypoint(0, 0, frame=3)])
        assert field.station.of("MISSION_CURRENT")[-1].mission_state == mav.MISSION_STATE_NO_MISSION
        assert field.run_of.start() is not None

    def test_home_does_not_count_and_is_not_driven_to(self):
        field = Field(ardupilot=True)
        field.upload([waypoint(0, 0, frame=0), *places(2)])
        assert field.station.of("MISSION_CURRENT")[-1].total == 2
        field.run_of.start()
        field.air.run(3)
        assert field.robot.asked == [("go_to", 0.0, 0.0, None)]
        assert field.station.of("MISSION_ITEM_REACHED") == []


def test_items_that_belong_to_no_mission_are_left_to_others(field):
    guided = (6, 16, 2, 1, 0, 0, 0, NAN, LATITUDE, LONGITUDE, 0)
    assert field.send(item_message(0, guided)) == []


LOSSY = {"loss": 0.3, "repeats": 0.1, "late": 0.3, "attempts": 8}
KINDS = [kind for kind in mav.mavlink_map.values() if kind.msgname.startswith("MISSION_")]


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32), st.integers(0, 12), st.booleans())
@example(2494, 2, False)  # The vehicle gives up, its word of it is lost, and then the item comes.
def test_with_a_third_of_everything_lost_plans_arrive_whole(seed, count, ardupilot):
    field = Field(seed=seed, ardupilot=ardupilot, **LOSSY)
    field.upload([waypoint(5, 5)])
    field.run(8000)
    # What is still on its way of one transfer would be taken for the next one's: they have no numbers. A count that was
    # overtaken begins one that nobody goes on with.
    field.air.run((RETRIES + 2) * ITEM_TIMEOUT)
    before, new = field.plan, coordinates(places(count))
    field.station.upload(places(count))
    for _ in range(400):
        field.run(20)
        assert field.plan[ardupilot:] in (before[ardupilot:], new[ardupilot:]), (
            "the old plan or the new, nothing between"
        )
        if field.station.result is not None:
            break
    assert field.station.result == ACCEPTED
    assert field.plan[ardupilot:] == new[ardupilot:]
    field.station.download()
    field.run(8000)
    assert coordinates(field.station.downloaded)[ardupilot:] == new[ardupilot:]


@settings(max_examples=30, deadline=None)
@given(st.data())
def test_no_message_whatever_its_numbers_breaks_anything(data):
    field = Field(stations=2)
    for _ in range(30):
        kind = data.draw(st.sampled_from(KINDS))
        payload = data.draw(st.binary(max_size=kind.unpacker.size))
        station = data.draw(st.sampled_from(field.stations))
        station.say(decoded(kind.id, payload))
        field.air.run(data.draw(st.sampled_from([1, 14])))
    assert len(field.run_of.plan) <= LONGEST


class TestPlanIds:
    """Fields that the dialect does not know yet, at the end of three messages: read here from their bytes."""

    def test_one_id_in_acknowledgement_count_and_current(self, field):
        field.answers(count_message(1))
        ack, current = field.answers(item_message(0, places(1)[0]))
        (count,) = field.answers(mav.MAVLink_mission_request_list_message(1, 1))
        ids = {payload_of(message)[-4:] for message in (ack, current, count)}
        assert ids == {struct.pack("<I", field.run_of.plan_id)}

    def test_equal_plans_have_equal_ids_and_others_have_others(self, field):
        ids = []
        for items in ([], places(2), places(3), places(2), [places(1)[0], waypoint(7, 7)]):
            field.upload(items)
            ids.append(field.run_of.plan_id)
        assert ids[0] == 0
        assert ids[1] == ids[3]
        assert len(set(ids)) == 4
