"""Vehicles inside a session: what ground stations say is an input, and what vehicles do for it comes with the ticks."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from sim.common.observations import TICKS_PER_SECOND
from sim.inputs import KillRobot
from tests.support.bags.drawn_team import snapshots
from tests.support.bags.remembering_recorder import RememberingRecorder
from thbridge.app.compose.recording import build_publisher, build_record
from thbridge.app.compose.robots import build_simr
from thbridge.app.compose.session import Programs, SessionRecording, open_session
from thbridge.app.compose.setting import read_setting
from thbridge.app.play import PLAY
from thbridge.app.session.broadcast import Broadcast
from thbridge.app.session.input_records import from_record, to_record
from thbridge.app.session.inputs import FrameReceived, HeartbeatsSent, LinkClosed, LinkOpened
from thbridge.app.session.recording import BagRecorder, TlogRecorder
from thbridge.app.session.session import Session, SessionOutlets, TickRecord
from thbridge.mavlink.files.tlog import TlogFile
from thbridge.mavlink.wire.dialect import crc_extra, mav, payload_of
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.outgoing import VehicleStatus
from thbridge.mavlink.wire.traffic import OutgoingFrame
from thbridge.roles.keeper.requests.wizard import WizardState
from thbridge.ros.messages import unpack
from thbridge.ros.messages.stamps import stamp_ns
from thbridge.ros.publisher import RosMessage
from thbridge.study.mavlink import MavlinkSection
from thbridge.study.study_file import Study

WITH_VEHICLES = replace(Study(), mavlink=MavlinkSection(on=True))
HEARTBEAT = mav.MAVLink_heartbeat_message(mav.MAV_TYPE_GCS, mav.MAV_AUTOPILOT_INVALID, 0, 0, 0, 3)
FRAME = Frame(255, 190, 7, HEARTBEAT.id, payload_of(HEARTBEAT), crc_extra(HEARTBEAT.id) or 0)


@pytest.fixture
def transmitted() -> list[OutgoingFrame]:
    return []


@pytest.fixture
def session(transmitted: list[OutgoingFrame]) -> Session:
    setting = read_setting(WITH_VEHICLES, Path())
    outlets = SessionOutlets(transmit=transmitted.extend)
    return open_session(setting, Programs(build_simr(setting)), outlets=outlets)


def steps(session: Session, ticks: int) -> list[TickRecord]:
    return [session.step() for _ in range(ticks)]


def test_links_and_frames_are_inputs_of_the_next_tick(session: Session):
    link = session.links.open_link("a")
    session.links.receive_frame(link, FRAME, 1)
    session.links.close_link(link)
    session.links.close_link(link)
    inputs = session.step().inputs
    assert inputs == (LinkOpened(link, "a"), FrameReceived(link, "a", FRAME, 1), LinkClosed(link, "a"))
    assert tuple(from_record(to_record(item)) for item in inputs) == inputs
    assert session.step().inputs == ()


def test_a_link_of_one_robot_is_recorded_as_such(session: Session):
    link = session.links.open_link("a", 1)
    (opened,) = session.step().inputs
    assert opened == LinkOpened(link, "a", 1)
    assert from_record(to_record(opened)) == opened


def test_what_vehicles_drop_is_not_recorded(session: Session):
    link = session.links.open_link("a")
    ours, setup = replace(FRAME, system=1, component=1), mav.MAVLink_setup_signing_message(1, 1, list(range(32)), 5)
    secret = replace(FRAME, message_id=setup.id, payload=payload_of(setup), seed=setup.crc_extra)
    session.step()
    for frame in (ours, secret):
        outcome = session.links.receive_frame(link, frame)
        assert outcome.dropped is not None
        assert not outcome.replies
    tick_record = session.step()
    assert tick_record.inputs == ()
    assert not any(traffic.incoming for traffic in tick_record.traffic)


def test_people_read_in_the_bag_what_came(session: Session):
    link = session.links.open_link("udp 127.0.0.1:14550")
    session.links.receive_frame(link, FRAME)
    told = [to_record(item) for item in session.step().inputs]
    assert [(record.sender, record.line) for record in told] == [
        ("udp 127.0.0.1:14550", "a link is opened"),
        ("udp 127.0.0.1:14550", "HEARTBEAT of 255/190"),
    ]


def test_what_a_vehicle_hears_and_says_is_told_with_the_tick_it_acts_in(session: Session):
    session.step()
    link = session.links.open_link("a")
    session.links.receive_frame(link, FRAME)
    heard = [traffic for traffic in session.step().traffic if traffic.incoming]
    assert [(traffic.robot, traffic.link, traffic.frame) for traffic in heard] == [(0, "a", FRAME), (1, "a", FRAME)]
    assert not any(traffic.incoming for traffic in session.step().traffic)


def test_heartbeats_go_out_on_every_link_once_a_second_and_are_told(session: Session, transmitted: list[OutgoingFrame]):
    links = [session.links.open_link("a"), session.links.open_link("b")]
    tick_records = steps(session, TICKS_PER_SECOND)
    beats = [sent for sent in transmitted if sent.frame.message_id == HEARTBEAT.id]
    assert sorted((sent.link, sent.frame.system) for sent in beats) == [(link, n) for link in links for n in (1, 2)]
    assert [sent.frame for sent in transmitted] == [
        item.frame for tick_record in tick_records for item in tick_record.traffic
    ]
    assert len(tick_records[-1].vehicles) == 2


def test_frames_of_links_or_for_robots_that_there_are_not_change_nothing(session: Session):
    link = session.links.open_link("a")
    session.links.close_link(link)
    session.step()
    assert not session.links.receive_frame(link, FRAME).replies
    assert session.step().inputs == ()
    link = session.links.open_link("a")
    assert not session.links.receive_frame(link, FRAME, 2).replies
    assert not any(traffic.incoming for traffic in session.step().traffic)


def test_what_vehicles_hear_and_say_goes_to_the_topics_of_mavros(session: Session):
    messages: list[RosMessage] = []
    setting = read_setting(WITH_VEHICLES, Path())

    class Ear:
        def take(self, tick: int, said: Sequence[RosMessage]) -> None:
            messages.extend(said)

    publisher = build_publisher(setting)
    ear = BagRecorder(Broadcast(publisher, build_record(setting, PLAY, [], ""), setting.map.grid, [Ear()]))
    session.step()
    link, graph = session.links.open_link("a"), session.links.open_link("ros")
    session.links.receive_frame(link, FRAME, 1)
    session.links.receive_frame(graph, FRAME, 0)
    tick_records = []
    for _ in range(2 * TICKS_PER_SECOND):
        tick_records += steps(session, 1)
        ear.record(tick_records[-1])
    by_topic = defaultdict(list)
    for message in messages:
        by_topic[message.topic.name].append(message)
    (first,), (second,) = by_topic["/robot1/mavlink/to"], by_topic["/robot2/mavlink/to"]
    assert first.foreign  # A client of the graph said it there already.
    assert not second.foreign
    assert unpack.mavlink(second.data).link == "a"
    assert unpack.mavlink(second.data).checksum == FRAME.checksum
    said = [unpack.mavlink(message.data) for message in by_topic["/robot2/mavlink/from"]]
    frames = [
        item.frame
        for tick_record in tick_records
        for item in tick_record.traffic
        if item.robot == 1 and not item.incoming
    ]
    assert [(frame.sequence, frame.payload) for frame in said] == [(frame.sequence, frame.payload) for frame in frames]
    assert len(by_topic["/robot1/mavros/state"]) >= 2
    announced = {topic.name for topic in publisher.topics}
    assert set(by_topic) <= announced


def test_states_are_said_when_they_change_and_every_second():
    tape = RememberingRecorder()
    recorder = BagRecorder(tape)
    rest, armed = (
        VehicleStatus(True, False, False, False, "HOLD", 4),
        VehicleStatus(True, True, True, False, "GUIDED", 4),
    )
    (snapshot,) = snapshots(2, 1)
    for tick in range(1, 102):
        states = (rest, armed) if tick > 30 else (rest, rest)
        recorder.record(TickRecord(tick, (), snapshot, (), (), (), WizardState(), None, (), states))
    assert [record.robot for record in tape.records] == [0, 1, 1, 0, 1, 0, 1]
    assert tape.records[2].mode == "GUIDED"


def test_a_telemetry_log_has_all_traffic_with_the_stamps_of_the_bag(tmp_path: Path):
    setting = read_setting(WITH_VEHICLES, Path())
    simr = build_simr(setting)
    log = tmp_path / "hunt.tlog"
    with TlogFile(log) as file:
        recorders = [TlogRecorder(file)]
        session = open_session(setting, Programs(simr), SessionRecording(recorders))
        session.step()
        session.links.receive_frame(session.links.open_link("a"), FRAME)
        tick_record = session.step()
    assert tick_record.snapshot is not None
    first = (stamp_ns(tick_record.snapshot.tick) // 1000).to_bytes(8, "big") + FRAME.to_bytes()
    assert log.read_bytes().startswith(first)


def test_where_robots_are_no_vehicles_there_is_no_link():
    setting = read_setting(Study(), Path())
    session = open_session(setting, Programs(build_simr(setting)))
    with pytest.raises(ValueError, match="not MAVLink vehicles"):
        session.links.open_link("a")


def test_between_two_ticks_that_are_long_apart_vehicles_say_that_they_are_there(
    session: Session, transmitted: list[OutgoingFrame]
):
    link = session.links.open_link("a")
    steps(session, 60)
    transmitted.clear()
    session.keep_alive()
    session.keep_alive()
    assert [(sent.link, sent.frame.system) for sent in transmitted] == [(link, 1), (link, 2)] * 2
    assert {sent.frame.message_id for sent in transmitted} == {HEARTBEAT.id}
    said = [sent.frame for sent in transmitted]
    tick_record = session.step()
    assert tick_record.inputs == (HeartbeatsSent(), HeartbeatsSent())
    assert [traffic.frame for traffic in tick_record.traffic][:4] == said
    sequences = [traffic.frame.sequence for traffic in tick_record.traffic if traffic.robot == 0]
    assert sequences == list(range(sequences[0], sequences[0] + len(sequences)))


def test_a_robot_that_does_not_answer_says_nothing_between_ticks_either(
    session: Session, transmitted: list[OutgoingFrame]
):
    session.links.open_link("a")
    session.ask("researcher", KillRobot(0))
    steps(session, TICKS_PER_SECOND + 5)
    transmitted.clear()
    session.keep_alive()
    assert [sent.frame.system for sent in transmitted] == [2]
