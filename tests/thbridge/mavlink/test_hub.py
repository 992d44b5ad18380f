"""Who hears what, and where it goes."""

from itertools import pairwise

import pytest

from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND, Twist
from thbridge.mavlink.hub import Hub
from thbridge.mavlink.values.vehicle_interface import RobotReadings, Station
from thbridge.mavlink.wire.dialect import crc_extra, mav, payload_of
from thbridge.mavlink.wire.frames.frame import Frame, missing_between
from thbridge.mavlink.wire.links import MOST_STATIONS, DropReason
from thbridge.mavlink.wire.outgoing import LinkId, OutgoingMessage

A, B, C = LinkId(0), LinkId(1), LinkId(2)
PATIENCE = 5.0
HEARTBEAT = mav.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)
READINGS = RobotReadings(Pose2(0, 0, 0), Twist(0, 0), None, 1, 1, True, False, False, None, "participant", None)


class Parrot:
    """A vehicle that notes what it hears, and answers pings where they came from."""

    def __init__(self, system):
        self.system = system
        self.heard = []
        self.forgotten = []
        self.says = []

    def handle_message(self, link, sender, message):
        self.heard.append((link, sender, message.get_type()))
        if isinstance(message, mav.MAVLink_ping_message):
            yield OutgoingMessage(message, link)

    def step(self, tick, readings):
        yield from self.says

    def forget(self, link):
        self.forgotten.append(link)


def frame_of(message, system, component=190, sequence=0):
    message_id = message.get_msgId()
    return Frame(system, component, sequence, message_id, payload_of(message), crc_extra(message_id))


def command(system, component=1):
    return mav.MAVLink_command_long_message(system, component, 400, 0, 1, 0, 0, 0, 0, 0, 0)


@pytest.fixture
def vehicles():
    return [Parrot(1), Parrot(2), Parrot(3)]


@pytest.fixture
def hub(vehicles):
    hub = Hub(vehicles, PATIENCE)
    for number, name in enumerate("abc"):
        hub.open(LinkId(number), name)
    return hub


def step(hub, tick=0):
    return hub.step(tick, [READINGS] * len(hub.vehicles))


def ticks(seconds):
    return round(seconds * TICKS_PER_SECOND)


def links_of(sent):
    return [one.link for one in sent]


def test_what_names_no_target_is_heard_by_all_vehicles(hub, vehicles):
    hub.receive(A, frame_of(HEARTBEAT, 255))
    assert all(vehicle.heard == [(A, Station(255, 190), "HEARTBEAT")] for vehicle in vehicles)


def test_what_names_a_vehicle_is_heard_by_that_one_and_goes_nowhere_else(hub, vehicles):
    hub.receive(B, frame_of(HEARTBEAT, 254))
    assert not hub.receive(A, frame_of(command(2), 255)).replies
    assert [len(vehicle.heard) for vehicle in vehicles] == [1, 2, 1]


@pytest.mark.parametrize(("component", "heard"), [(0, True), (1, True), (100, False)])
def test_what_names_another_component_is_not_the_vehicles(hub, vehicles, component, heard):
    hub.receive(A, frame_of(command(2, component), 255))
    assert bool(vehicles[1].heard) is heard


def test_a_frame_for_one_robot_is_heard_by_it_alone_whatever_it_names(hub, vehicles):
    hub.receive(B, frame_of(HEARTBEAT, 254))
    assert not hub.receive(A, frame_of(HEARTBEAT, 255), robot=2).replies
    assert [len(vehicle.heard) for vehicle in vehicles] == [1, 1, 2]


def test_on_a_link_of_one_robot_it_alone_hears_and_speaks(hub, vehicles):
    hub.open(C, "c", robot=1)
    assert not hub.receive(C, frame_of(HEARTBEAT, 255)).replies
    hub.receive(C, frame_of(command(1), 255, sequence=1))
    assert [len(vehicle.heard) for vehicle in vehicles] == [0, 1, 0]
    for vehicle in vehicles:
        vehicle.says = [OutgoingMessage(HEARTBEAT, to_inactive=True), OutgoingMessage(HEARTBEAT, C)]
    sent = step(hub)
    assert [one.frame.system for one in sent if one.link == C] == [2, 2]
    assert [one.frame.system for one in sent if one.link == A] == [1, 2, 3]


def test_on_a_link_of_one_robot_stations_and_those_elsewhere_hear_nothing_of_each_other(hub):
    # mavros takes whatever answers its TIMESYNC for its vehicle's clock, also another mavros.
    hub.open(C, "c", robot=1)
    timesync = mav.MAVLink_timesync_message(0, 5)
    for link, system in ((A, 255), (C, 254), (A, 255)):
        assert not hub.receive(link, frame_of(timesync, system)).replies
    assert not hub.receive(A, frame_of(command(254, 190), 255)).replies
    assert not hub.receive(C, frame_of(command(255, 190), 254)).replies


def test_an_answer_goes_to_the_link_its_question_came_from_also_when_another_has_the_same_station(hub):
    hub.receive(B, frame_of(HEARTBEAT, 255))
    hub.receive(A, frame_of(HEARTBEAT, 255))
    ping = mav.MAVLink_ping_message(1, 1, 2, 1)
    assert links_of(hub.receive(B, frame_of(ping, 255)).replies) == [B]
    assert links_of(hub.receive(A, frame_of(ping, 255)).replies) == [A]


def test_stations_hear_of_each_other(hub):
    hub.receive(A, frame_of(HEARTBEAT, 255))
    sent = hub.receive(B, frame_of(HEARTBEAT, 254)).replies
    assert [(one.link, one.frame) for one in sent] == [(A, frame_of(HEARTBEAT, 254))]


def test_what_one_station_says_to_another_goes_to_where_that_was_heard(hub, vehicles):
    for link, system in ((A, 255), (B, 254), (C, 253)):
        hub.receive(link, frame_of(HEARTBEAT, system))
    before = [len(vehicle.heard) for vehicle in vehicles]
    assert links_of(hub.receive(A, frame_of(command(254, 0), 255)).replies) == [B]
    assert links_of(hub.receive(A, frame_of(command(254, 190), 255)).replies) == [B]
    assert links_of(hub.receive(A, frame_of(command(254, 7), 255)).replies) == []
    assert links_of(hub.receive(A, frame_of(command(77, 0), 255)).replies) == []
    assert [len(vehicle.heard) for vehicle in vehicles] == before


def test_two_stations_with_the_same_ids_both_get_what_is_meant_for_them(hub):
    hub.receive(A, frame_of(HEARTBEAT, 255))
    hub.receive(B, frame_of(HEARTBEAT, 255))
    assert links_of(hub.receive(C, frame_of(command(255, 190), 254)).replies) == [A, B]


def test_nobody_hears_themselves_on_another_link(hub):
    hub.receive(A, frame_of(HEARTBEAT, 255))
    hub.receive(B, frame_of(HEARTBEAT, 255))
    assert not hub.receive(A, frame_of(HEARTBEAT, 255)).replies


def test_two_links_that_are_joined_elsewhere_make_no_circle(hub):
    """Somebody brings everything from B to C and back."""
    hub.receive(B, frame_of(HEARTBEAT, 253))
    hub.receive(C, frame_of(HEARTBEAT, 252))
    waiting = hub.receive(A, frame_of(HEARTBEAT, 255)).replies
    rounds = 0
    while waiting:
        rounds += 1
        assert rounds < 5
        waiting = [
            after
            for one in waiting
            for after in hub.receive({B: C, C: B}[one.link], one.frame).replies
            if after.link != A
        ]
    assert not hub.receive(A, frame_of(HEARTBEAT, 255)).replies


def test_a_station_that_moves_is_reached_where_it_is(hub):
    hub.receive(A, frame_of(HEARTBEAT, 255))
    hub.receive(C, frame_of(HEARTBEAT, 254))
    step(hub, ticks(PATIENCE) + 1)
    hub.receive(B, frame_of(HEARTBEAT, 255))
    assert links_of(hub.receive(C, frame_of(command(255, 190), 254)).replies) == [B]


def test_a_link_that_is_closed_is_gone(hub, vehicles):
    hub.receive(A, frame_of(HEARTBEAT, 255))
    hub.close(A)
    hub.close(A)
    assert vehicles[0].forgotten == [A]
    assert not hub.receive(A, frame_of(HEARTBEAT, 255)).replies
    assert not hub.receive(B, frame_of(command(255, 190), 254)).replies
    assert [hub.link(link) is None for link in (A, B, C)] == [True, False, False]


def test_a_vehicles_own_id_from_outside_is_counted_and_heard_by_nobody(hub, vehicles):
    hub.receive(B, frame_of(HEARTBEAT, 254))
    vehicles[0].says = [OutgoingMessage(HEARTBEAT, to_inactive=True)]
    for one in step(hub):
        assert not hub.receive(one.link, one.frame).replies
    assert [vehicle.heard for vehicle in vehicles] == [[(B, Station(254, 190), "HEARTBEAT")]] * 3
    assert [hub.link(link).dropped for link in (A, B, C)] == [{DropReason.OURS: 1}] * 3


def test_a_robots_companion_has_its_system_id_and_is_somebody(hub, vehicles):
    companion = Station(1, 191)
    sent = hub.receive(A, frame_of(command(1), companion.system, companion.component)).replies
    assert sent == []
    assert [vehicle.heard for vehicle in vehicles] == [[(A, companion, "COMMAND_LONG")], [], []]
    assert links_of(hub.receive(B, frame_of(command(1, 191), 255)).replies) == [A]
    assert links_of(hub.receive(B, frame_of(command(1), 255)).replies) == []


def test_nobody_is_called_0(hub, vehicles):
    hub.receive(A, frame_of(HEARTBEAT, 0))
    assert vehicles[0].heard == []
    assert hub.link(A).dropped == {DropReason.BROADCAST_SENDER: 1}


def test_a_signing_key_is_told_to_nobody(hub, vehicles):
    hub.receive(B, frame_of(HEARTBEAT, 254))
    before = hub.take_traffic()
    setup = mav.MAVLink_setup_signing_message(0, 0, list(range(32)), 5)
    assert not hub.receive(A, frame_of(setup, 255)).replies
    assert before
    assert hub.take_traffic() == ()
    assert hub.link(A).dropped == {DropReason.SECRET: 1}


def test_a_message_that_nobody_knows_is_counted(hub):
    assert not hub.receive(A, Frame(255, 190, 0, 54_321, b"x", 0)).replies
    assert hub.link(A).dropped == {DropReason.UNKNOWN: 1}


def test_whoever_makes_up_senders_is_not_heard_and_others_are(hub, vehicles):
    for component in range(256):
        for system in (255, 254):
            hub.receive(A, frame_of(HEARTBEAT, system, component))
    assert len(vehicles[0].heard) == MOST_STATIONS
    assert hub.link(A).dropped == {DropReason.CROWDED: 512 - MOST_STATIONS}
    hub.receive(B, frame_of(HEARTBEAT, 253))
    assert vehicles[0].heard[-1] == (B, Station(253, 190), "HEARTBEAT")


def test_who_has_been_silent_for_long_makes_room(hub, vehicles):
    for component in range(MOST_STATIONS):
        hub.receive(A, frame_of(HEARTBEAT, 255, component))
    step(hub, ticks(PATIENCE) + 1)
    hub.receive(A, frame_of(HEARTBEAT, 254))
    assert vehicles[0].heard[-1] == (A, Station(254, 190), "HEARTBEAT")


def test_sequence_numbers_count_by_vehicle_and_link(hub, vehicles):
    hub.receive(A, frame_of(HEARTBEAT, 255))
    vehicles[0].says = [OutgoingMessage(HEARTBEAT), OutgoingMessage(HEARTBEAT, to_inactive=True)]
    vehicles[1].says = [OutgoingMessage(HEARTBEAT, A)]
    sent = [one for tick in range(300) for one in step(hub, tick)]
    for link, system in ((A, 1), (A, 2), (B, 1), (C, 1)):
        counts = [one.frame.sequence for one in sent if (one.link, one.frame.system) == (link, system)]
        assert counts[0] == 0
        assert all((earlier + 1) % 256 == later for earlier, later in pairwise(counts))


def test_a_link_that_is_opened_again_counts_from_0(hub, vehicles):
    vehicles[0].says = [OutgoingMessage(HEARTBEAT, to_inactive=True)]
    step(hub)
    hub.open(A, "a")
    assert {one.link: one.frame.sequence for one in step(hub)} == {A: 0, B: 1, C: 1}


def test_a_link_sleeps_until_somebody_is_heard_and_when_they_are_not_any_more(hub, vehicles):
    vehicles[0].says = [OutgoingMessage(HEARTBEAT)]
    assert step(hub) == []
    hub.receive(A, frame_of(HEARTBEAT, 255))
    assert links_of(step(hub, 1)) == [A]
    assert links_of(step(hub, ticks(PATIENCE))) == [A]
    assert step(hub, ticks(PATIENCE) + 1) == []


def test_a_link_may_be_left_out(hub, vehicles):
    for link, system in ((A, 255), (B, 254)):
        hub.receive(link, frame_of(HEARTBEAT, system))
    vehicles[0].says = [OutgoingMessage(HEARTBEAT, except_links=frozenset({A}))]
    assert links_of(step(hub)) == [B]


def test_gaps_in_a_senders_count_are_lost_frames(hub):
    for sequence in (250, 251, 255, 0, 3):
        hub.receive(A, frame_of(HEARTBEAT, 255, sequence=sequence))
    hub.receive(A, frame_of(HEARTBEAT, 254, sequence=100))
    report = hub.link(A)
    assert (report.received, report.lost, report.sent) == (6, 5, 0)
    assert str(report) == "a: 6 frames received, 5 lost in transmission, 0 sent"


@pytest.mark.parametrize(
    ("last", "now", "missing"), [(0, 1, 0), (255, 0, 0), (0, 3, 2), (254, 1, 2), (5, 5, 0), (5, 4, 0), (0, 128, 127)]
)
def test_what_comes_twice_or_late_is_no_gap(last, now, missing):
    assert missing_between(last, now) == missing


def test_what_goes_out_is_counted(hub, vehicles):
    hub.receive(A, frame_of(HEARTBEAT, 255))
    hub.receive(B, frame_of(HEARTBEAT, 254))
    vehicles[0].says = [OutgoingMessage(HEARTBEAT)]
    step(hub)
    assert [hub.link(link).sent for link in (A, B, C)] == [2, 1, 0]


def test_traffic_has_what_vehicles_heard_and_said_and_nothing_between_stations(hub, vehicles):
    hub.receive(A, frame_of(HEARTBEAT, 255))
    hub.receive(B, frame_of(HEARTBEAT, 254))
    hub.take_traffic()
    hub.receive(A, frame_of(command(254, 0), 255))
    ping = frame_of(mav.MAVLink_ping_message(1, 1, 2, 1), 255)
    hub.receive(A, ping)
    traffic = hub.take_traffic()
    assert [(one.robot, one.incoming, one.link) for one in traffic] == [(1, True, "a"), (1, False, "a")]
    assert traffic[0].frame == ping
    assert hub.take_traffic() == ()
