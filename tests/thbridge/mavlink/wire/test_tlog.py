"""What a telemetry log holds."""

import struct
from dataclasses import replace

from thbridge.mavlink.wire.dialect import crc_extra, mav, payload_of
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.frames.framer import parse_datagram
from thbridge.mavlink.wire.tlog import Tlog
from thbridge.mavlink.wire.traffic import Traffic


def frame_of(message, system, sequence=0):
    return Frame(system, 1, sequence, message.get_msgId(), payload_of(message), crc_extra(message.get_msgId()))


HEARTBEAT = frame_of(mav.MAVLink_heartbeat_message(10, 0, 1, 0, 4, 3), 1)
PING = frame_of(mav.MAVLink_ping_message(1, 1, 0, 0), 255, 77)


def read(data):
    """The records of a log: stamps and frames."""
    records = []
    while data:
        (stamp,) = struct.unpack(">Q", data[:8])
        size = 10 + data[9] + 2
        (frame,) = parse_datagram(data[8 : 8 + size])
        records.append((stamp, frame))
        data = data[8 + size :]
    return records


def said(robot, link, frame):
    return Traffic(robot, False, link, frame)


def heard(robot, link, frame):
    return Traffic(robot, True, link, frame)


def test_each_frame_is_behind_its_stamp():
    assert read(Tlog().records(1_020_000, [heard(0, "a", PING)])) == [(1_020_000, PING)]


def test_what_several_vehicles_heard_is_there_once():
    again = replace(PING)
    traffic = [heard(0, "a", PING), heard(1, "a", PING), heard(0, "b", again), heard(1, "b", again)]
    assert len(read(Tlog().records(0, traffic))) == 2


def test_what_went_to_several_links_is_there_once():
    traffic = [said(0, "a", HEARTBEAT), said(0, "b", replace(HEARTBEAT, sequence=9))]
    assert len(read(Tlog().records(0, traffic))) == 1


def test_what_is_said_twice_on_a_link_or_by_two_vehicles_is_there_twice():
    other = replace(HEARTBEAT, system=2)
    traffic = [said(0, "a", HEARTBEAT), said(0, "a", HEARTBEAT), said(1, "a", other)]
    assert [frame.system for _, frame in read(Tlog().records(0, traffic))] == [1, 1, 2]


def test_no_frame_is_missing_by_the_counts_of_a_log():
    log = Tlog()
    data = b""
    for tick in range(300):
        data += log.records(tick, [said(0, "ab"[tick % 2], replace(HEARTBEAT, sequence=tick // 2 % 256))])
    assert [frame.sequence for _, frame in read(data)] == [tick % 256 for tick in range(300)]


def test_a_tick_without_traffic_writes_nothing():
    assert Tlog().records(5, []) == b""
