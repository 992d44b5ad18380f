"""A ground station, and its trips, against robots whose every word is written here."""

import math

import pytest

from thbridge.mavlink.station.ground_station import (
    ACK_TIMEOUT,
    PROGRESS_TIMEOUT,
    TRIES,
    CommandAcked,
    CommandUnanswered,
    GroundStation,
    StationCommand,
    StationEvent,
    StatusTextReceived,
)
from thbridge.mavlink.station.trip import StationTrip, StationTripStage, TripOutcome
from thbridge.mavlink.values.conventions import ARRIVED
from thbridge.mavlink.values.vehicle_interface import Target
from thbridge.mavlink.wire.dialect import Message, crc_extra, decoded, mav, payload_of
from thbridge.mavlink.wire.frames.frame import Frame

ARM = mav.MAV_CMD_COMPONENT_ARM_DISARM
GO = mav.MAV_CMD_DO_REPOSITION
ACCEPTED, DENIED, IN_PROGRESS = mav.MAV_RESULT_ACCEPTED, mav.MAV_RESULT_DENIED, mav.MAV_RESULT_IN_PROGRESS


class Air:
    """A station, its clock, and what robots say to it."""

    def __init__(self) -> None:
        self.station = GroundStation()
        self.now = 100.0
        self.sequence = 0
        self.armed = 0

    def say(self, message: Message, system: int = 1) -> list[StationEvent]:
        number = message.get_msgId()
        frame = Frame(system, 1, self.sequence, number, payload_of(message), crc_extra(number) or 0)
        self.sequence = (self.sequence + 1) % 256
        return self.station.receive_frame(frame, self.now)

    def heartbeat(self, system: int = 1, armed: bool = False) -> None:
        flags = 1 | (mav.MAV_MODE_FLAG_SAFETY_ARMED if armed else 0)
        self.say(mav.MAVLink_heartbeat_message(10, 0, flags, 0, 4, 3), system)

    def ack(
        self, command: int, result: int, target: tuple[int, int] = (255, 190), system: int = 1
    ) -> list[StationEvent]:
        return self.say(mav.MAVLink_command_ack_message(command, result, 0, 0, *target), system)

    def text(self, text: str, severity: int = 6) -> list[StationEvent]:
        return self.say(mav.MAVLink_statustext_message(severity, text.encode()))

    def at(self, x: float, y: float, speed: float = 0.0) -> None:
        self.say(mav.MAVLink_local_position_ned_message(0, y, x, 0.0, speed, 0.0, 0.0))

    def heard(self) -> list[Message]:
        """What the station has said since."""
        messages = [decoded(frame.message_id, frame.payload) for frame in self.station.take_frames()]
        assert all(messages)
        return [message for message in messages if message is not None]

    def commands(self) -> list[Message]:
        return [message for message in self.heard() if message.msgname.startswith("COMMAND_")]


@pytest.fixture
def air() -> Air:
    return Air()


def test_a_heartbeat_a_second(air: Air) -> None:
    for step in range(31):
        air.station.advance(air.now + step / 10)
    assert [message.msgname for message in air.heard()] == ["HEARTBEAT"] * 4


def test_a_command_is_sent_again_until_it_is_given_up(air: Air) -> None:
    air.station.send_command(1, StationCommand(ARM, (1.0,)), air.now)
    events = []
    for step in range(1, 100):
        events += air.station.advance(air.now + step * 0.05)
    assert [command.confirmation for command in air.commands()] == list(range(TRIES))
    assert events == [CommandUnanswered(1, ARM)]


def test_an_answer_ends_it(air: Air) -> None:
    air.heartbeat()
    air.station.send_command(1, StationCommand(ARM, (1.0,)), air.now)
    assert air.ack(ARM, DENIED) == [CommandAcked(1, ARM, DENIED)]
    assert air.ack(ARM, DENIED) == []
    assert air.station.advance(air.now + 10.0) == []


def test_an_answer_to_somebody_else_is_none(air: Air) -> None:
    air.heartbeat()
    air.heartbeat(2)
    air.station.send_command(1, StationCommand(ARM, (1.0,)), air.now)
    assert air.ack(ARM, ACCEPTED, (255, 1)) == []
    assert air.ack(ARM, ACCEPTED, (245, 190)) == []
    assert air.ack(ARM, ACCEPTED, system=2) == []
    assert air.ack(ARM, ACCEPTED, (0, 0)) == [CommandAcked(1, ARM, ACCEPTED)]


def test_what_is_in_progress_is_waited_for_and_not_sent_again(air: Air) -> None:
    air.heartbeat()
    air.station.send_command(1, StationCommand(ARM), air.now)
    assert air.ack(ARM, IN_PROGRESS) == []
    air.heard()
    assert air.station.advance(air.now + PROGRESS_TIMEOUT - 0.1) == []
    assert air.commands() == []
    assert air.station.advance(air.now + PROGRESS_TIMEOUT) == [CommandUnanswered(1, ARM)]


def test_frames_that_did_not_come_are_counted(air: Air) -> None:
    air.sequence = 254
    for gap in (0, 3, 0):
        air.sequence += gap
        air.heartbeat()
    robot = air.station.robots[1]
    assert (robot.frames, robot.lost) == (3, 3)


def test_whoever_shows_no_heartbeat_is_no_robot(air: Air) -> None:
    air.at(1.0, 2.0)
    assert air.station.robots == {}


def test_positions_are_east_and_north(air: Air) -> None:
    air.heartbeat()
    air.at(1.5, -2.5, 0.25)
    robot = air.station.robots[1]
    assert (robot.x, robot.y, robot.speed) == (1.5, -2.5, 0.25)
    assert math.isnan(robot.energy)


@pytest.mark.parametrize("length", [3, 49, 50, 51, 99, 100, 120])
def test_a_long_text_comes_in_pieces(air: Air, length: int) -> None:
    air.heartbeat()
    text = ("0123456789" * 12)[:length]
    pieces = [text[start : start + 50] for start in range(0, length + 1, 50)] if length >= 50 else [text]
    number = 7 if length >= 50 else 0
    events = []
    for place, piece in enumerate(pieces):
        events += air.say(mav.MAVLink_statustext_message(6, piece.encode(), number, place))
    assert events == [StatusTextReceived(1, 6, text)]


# Trips

THERE = Target(3.0, -2.0, math.pi / 2)


class Journey:
    """A trip of robot 1."""

    def __init__(self, air: Air, keep: bool = False) -> None:
        self.air = air
        self.trip = StationTrip(air.station, 1, THERE, keep, air.now)

    def advance(self, seconds: float) -> None:
        for _ in range(round(seconds / 0.1)):
            self.air.now += 0.1
            self.take(self.air.station.advance(self.air.now))

    def take(self, events: list[StationEvent]) -> None:
        self.trip.advance(events, self.air.now)

    def set_out(self) -> None:
        self.air.heartbeat(armed=True)
        self.take([])
        self.take(self.air.ack(ARM, ACCEPTED))
        self.take(self.air.ack(GO, ACCEPTED))
        assert self.trip.stage is StationTripStage.UNDER_WAY
        self.air.heard()


def test_a_trip(air: Air) -> None:
    journey = Journey(air)
    journey.advance(1.0)
    air.heartbeat()
    journey.take([])
    (arm,) = air.commands()
    assert (arm.command, arm.param1, arm.target_system) == (ARM, 1.0, 1)
    journey.take(air.ack(ARM, ACCEPTED))
    (go,) = air.commands()
    assert (go.command, go.frame, go.x, go.y) == (GO, mav.MAV_FRAME_LOCAL_NED, -20000, 30000)
    assert go.param4 == pytest.approx(0.0)
    air.heartbeat(armed=True)
    journey.take(air.ack(GO, ACCEPTED))
    air.at(0.0, 2.0, 0.5)
    assert journey.trip.remaining == pytest.approx(5.0)
    journey.take(air.text(ARRIVED))
    (disarm,) = air.commands()
    assert (disarm.command, disarm.param1) == (ARM, 0.0)
    assert journey.trip.outcome is None
    journey.take(air.ack(ARM, ACCEPTED))
    assert journey.trip.outcome == TripOutcome("")


def test_who_keeps_the_command_does_not_give_it_back(air: Air) -> None:
    journey = Journey(air, keep=True)
    journey.set_out()
    journey.take(air.text(ARRIVED))
    assert journey.trip.outcome == TripOutcome("")
    assert air.commands() == []


def test_a_robot_that_stands_where_it_was_sent_has_arrived_though_it_does_not_say_so(air: Air) -> None:
    journey = Journey(air, keep=True)
    journey.set_out()
    air.at(3.1, -2.1)
    journey.advance(2.5)
    assert journey.trip.outcome is None
    journey.advance(1.0)
    assert journey.trip.outcome == TripOutcome("")


def test_a_refusal_is_told_in_the_robots_own_words(air: Air) -> None:
    journey = Journey(air)
    air.heartbeat()
    journey.take([])
    journey.take(air.ack(ARM, ACCEPTED))
    journey.take(air.ack(GO, DENIED))
    journey.take(air.text("Robot 1 has not enough energy.", 4))
    journey.advance(1.0)
    journey.take(air.ack(ARM, ACCEPTED))
    assert journey.trip.outcome == TripOutcome("Robot 1 has not enough energy.")


def test_a_refusal_without_words_is_told_by_its_code(air: Air) -> None:
    journey = Journey(air)
    air.heartbeat()
    journey.take([])
    journey.take(air.ack(ARM, mav.MAV_RESULT_TEMPORARILY_REJECTED))
    air.heard()
    journey.advance(1.0)
    assert journey.trip.outcome == TripOutcome("robot 1 refuses to change its commander (temporarily rejected)")
    assert air.commands() == []


def test_a_way_that_fails(air: Air) -> None:
    journey = Journey(air, keep=True)
    journey.set_out()
    journey.take(air.text("Commanded by ground station 255.", 5))
    journey.take(air.text("No path: the goal is inside a wall.", 4))
    journey.advance(1.0)
    assert journey.trip.outcome == TripOutcome("No path: the goal is inside a wall.")


def test_a_robot_that_is_not_there(air: Air) -> None:
    journey = Journey(air)
    air.heartbeat(2)
    journey.advance(7.0)
    assert journey.trip.outcome == TripOutcome("robot 1 sends nothing; robots that send: 2")


def test_a_robot_that_does_not_answer(air: Air) -> None:
    journey = Journey(air)
    air.heartbeat()
    journey.advance(ACK_TIMEOUT * TRIES + 2.0)
    assert journey.trip.outcome == TripOutcome("robot 1 does not answer", unanswered=True)


def test_a_robot_that_falls_silent_on_its_way(air: Air) -> None:
    journey = Journey(air, keep=True)
    journey.set_out()
    journey.advance(6.0)
    assert journey.trip.outcome == TripOutcome("robot 1 no longer sends heartbeats")


def test_a_robot_that_is_taken_away(air: Air) -> None:
    journey = Journey(air, keep=True)
    journey.set_out()
    air.heartbeat(armed=False)
    journey.advance(1.5)
    assert journey.trip.outcome is None
    air.heartbeat(armed=False)
    journey.advance(1.0)
    assert journey.trip.outcome == TripOutcome("another client now commands robot 1")


def test_giving_up_stops_the_robot_even_if_the_command_was_to_be_kept(air: Air) -> None:
    journey = Journey(air, keep=True)
    journey.set_out()
    journey.trip.give_up(air.now)
    (disarm,) = air.commands()
    assert (disarm.command, disarm.param1) == (ARM, 0.0)
    journey.take(air.ack(ARM, ACCEPTED))
    assert journey.trip.outcome == TripOutcome("given up")
