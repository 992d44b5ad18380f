"""The parameter protocol, rule by rule."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.mavlink.model_robot import ModelRobot
from tests.support.mavlink.model_station import Air, ModelStation
from thbridge.mavlink.values.vehicle_interface import DenialKind, Denied
from thbridge.mavlink.vehicle.parameter.protocol import VALUES_PER_TICK, ParameterProtocol
from thbridge.mavlink.wire.dialect import decoded, mav, payload_of

REAL32, INT32 = mav.MAV_PARAM_TYPE_REAL32, mav.MAV_PARAM_TYPE_INT32
DOES_NOT_EXIST, OUT_OF_RANGE = mav.MAV_PARAM_ERROR_DOES_NOT_EXIST, mav.MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE


class Field:
    """A robot's parameters, and two stations that read and change them."""

    def __init__(self, ardupilot=False, **air):
        self.robot = ModelRobot()
        self.told = []
        self.parameters = ParameterProtocol(self.robot, lambda _, sentence: self.told.append(sentence), ardupilot)
        self.stations = [ModelStation(255), ModelStation(254)]
        self.station, self.other = self.stations
        self.air = Air([self.parameters], self.stations, self.robot, **air)

    def send(self, message, ticks=1):
        """Say one message by the first station; what both heard within some ticks, as short as can be."""
        before = [len(station.heard) for station in self.stations]
        self.station.say(message)
        self.air.run(ticks)
        return [
            [short(message) for message in station.heard[start:]]
            for station, start in zip(self.stations, before, strict=True)
        ]


def short(message):
    match message.get_type():
        case "PARAM_VALUE":
            return (message.param_id, message.param_value)
        case "PARAM_ERROR":
            return (message.param_id, "error", message.error)
        case other:
            return other


@pytest.fixture
def field():
    return Field()


def read(name=b"", index=-1):
    return mav.MAVLink_param_request_read_message(1, 1, name, index)


def change(name, value, kind=REAL32):
    return mav.MAVLink_param_set_message(1, 1, name, value, kind)


LIST = mav.MAVLink_param_request_list_message(1, 1)


def test_the_whole_list_comes_in_order_with_number_and_count(field):
    field.send(LIST, 20)
    values = field.station.of("PARAM_VALUE")
    assert [(value.param_id, value.param_index) for value in values] == [(f"PARAM_{n:02}", n) for n in range(20)]
    assert {(value.param_count, value.param_type) for value in values} == {(20, REAL32)}
    assert field.other.heard == []


def test_a_list_does_not_flood_its_link(field):
    field.station.say(LIST)
    field.air.run(1)
    for _ in range(6):
        before = len(field.station.heard)
        field.air.run(1)
        assert len(field.station.heard) - before <= VALUES_PER_TICK


def test_two_lists_go_on_side_by_side(field):
    field.station.say(LIST)
    field.air.run(3)
    field.other.say(LIST)
    field.air.run(20)
    assert [len(station.of("PARAM_VALUE")) for station in field.stations] == [20, 20]


def test_a_list_that_is_asked_for_again_begins_again(field):
    field.send(LIST, 3)
    field.send(LIST, 20)
    assert [value.param_index for value in field.station.of("PARAM_VALUE")][-20:] == list(range(20))


def test_a_link_that_is_gone_gets_no_more_of_it(field):
    field.send(LIST, 2)
    field.parameters.forget(0)
    assert field.send(read(b"PARAM_00"), 5)[0] == [("PARAM_00", 0.0)]


def test_one_by_name_and_one_by_number(field):
    assert field.send(read(b"PARAM_03")) == [[("PARAM_03", 1.5)], []]
    assert field.send(read(index=3)) == [[("PARAM_03", 1.5)], []]
    assert field.send(read(b"PARAM_04", 3)) == [[("PARAM_03", 1.5)], []]


@pytest.mark.parametrize("message", [read(b"PARAM_99"), read(index=20), read(index=-2), read(b"")])
def test_one_that_is_not_there_is_an_error(field, message):
    (answer,), _ = field.send(message)
    assert answer[1:] == ("error", DOES_NOT_EXIST)
    error = field.station.of("PARAM_ERROR")[0]
    assert (error.target_system, error.param_index) == (255, message.param_index)


def test_a_change_is_told_to_all(field):
    assert field.send(change(b"PARAM_03", 0.25)) == [[("PARAM_03", 0.25)]] * 2


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_what_is_no_number_is_refused_and_the_old_value_told(field, value):
    assert field.send(change(b"PARAM_03", value)) == [[("PARAM_03", "error", OUT_OF_RANGE), ("PARAM_03", 1.5)], []]
    assert field.robot.asked == []


@pytest.mark.parametrize(
    ("refusal", "error"),
    [
        (DenialKind.DENIED, OUT_OF_RANGE),
        (DenialKind.NOT_NOW, mav.MAV_PARAM_ERROR_PERMISSION_DENIED),
        (DenialKind.UNSUPPORTED, mav.MAV_PARAM_ERROR_READ_ONLY),
    ],
)
def test_what_the_robot_refuses_is_refused_with_its_reason(field, refusal, error):
    field.robot.refusal = Denied("It is at most 2.", refusal)
    assert field.send(change(b"PARAM_03", 9.0)) == [[("PARAM_03", "error", error), ("PARAM_03", 1.5)], []]
    assert field.told == ["It is at most 2."]


def test_none_can_be_made(field):
    assert field.send(change(b"NEW", 1.0)) == [[("NEW", "error", DOES_NOT_EXIST)], []]


def test_other_types_are_refused_because_their_bytes_are_no_float(field):
    assert field.send(change(b"PARAM_03", 1e-45, INT32)) == [[("PARAM_03", "error", 6), ("PARAM_03", 1.5)], []]


def test_other_types_of_ardupilot_are_numbers_too():
    field = Field(ardupilot=True)
    assert field.send(change(b"PARAM_03", 2.0, INT32))[0] == [("PARAM_03", 2.0)]


def test_what_others_change_is_told_to_all_within_a_second(field):
    field.air.run(50)
    field.robot.values["PARAM_07"] = 9.5
    field.air.run(50)
    assert [short(message) for message in field.other.heard] == [("PARAM_07", 9.5)]
    field.air.run(200)
    assert len(field.other.heard) == 1


def test_parameters_that_come_later_are_no_news(field):
    there, field.robot.values = field.robot.values, {}
    field.air.run(60)
    field.robot.values = there
    field.air.run(60)
    assert field.station.heard == []
    field.robot.values["PARAM_07"] = 9.5
    field.air.run(60)
    assert len(field.station.heard) == 1


def test_extended_parameters_are_refused_honestly(field):
    ext = mav.MAV_PARAM_EXT_TYPE_REAL32
    assert field.send(mav.MAVLink_param_ext_request_list_message(1, 1))[0] == ["PARAM_EXT_VALUE"]
    assert field.station.of("PARAM_EXT_VALUE")[0].param_count == 0
    field.send(mav.MAVLink_param_ext_request_read_message(1, 1, b"PARAM_03", -1))
    field.send(mav.MAVLink_param_ext_set_message(1, 1, b"PARAM_03", b"1.5", ext))
    acks = field.station.of("PARAM_EXT_ACK")
    assert [(ack.param_id, ack.param_result) for ack in acks] == [("PARAM_03", mav.PARAM_ACK_FAILED)] * 2


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32))
def test_with_a_third_of_everything_lost_a_station_that_asks_for_gaps_gets_all(seed):
    field = Field(seed=seed, loss=0.3, late=0.3)
    for _ in range(60):
        there = {value.param_index: value.param_value for value in field.station.of("PARAM_VALUE")}
        if len(there) == 20:
            break
        if there:
            for index in sorted(set(range(20)) - set(there))[:10]:
                field.station.say(read(index=index))
        else:
            field.station.say(LIST)
        field.air.run(50)
    assert there == {n: n / 2 for n in range(20)}


KINDS = [kind for kind in mav.mavlink_map.values() if kind.msgname.startswith("PARAM_")]


@settings(max_examples=60, deadline=None)
@given(st.sampled_from(KINDS), st.binary(max_size=160))
def test_no_message_whatever_its_bytes_breaks_anything(kind, payload):
    field = Field()
    message = decoded(kind.id, payload)
    for _ in range(2):
        for said in field.parameters.handle_message(0, field.station.station, message):
            payload_of(said.message)
    field.air.run(20)
