"""Participants of RTPS find each other and exchange samples, also over networks that lose and reorder datagrams."""

import struct
from collections.abc import Callable, Sequence
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.thbridge.ros2graph.wire.rtps.rtps_network import HOST, STAMP, RtpsNetwork
from thbridge.ros2.qos import DEFAULT, LATCHED, SENSOR_DATA, QosProfile
from thbridge.ros2.supports import MessageSupport, ServiceSupport
from thbridge.ros2graph.values.graph import NodeName
from thbridge.ros2graph.wire.rtps import participant as limits
from thbridge.ros2graph.wire.rtps import postponed, readers
from thbridge.ros2graph.wire.rtps.correlation import related, related_request
from thbridge.ros2graph.wire.rtps.dds_graph import DdsGraph
from thbridge.ros2graph.wire.rtps.discovery import LEASE_NS, EndpointData, ParticipantData, disposal
from thbridge.ros2graph.wire.rtps.entities_info import NodeEntities, encode_entities
from thbridge.ros2graph.wire.rtps.guids import (
    PARTICIPANT,
    PUBLICATIONS_WRITER,
    SPDP_WRITER,
    SUBSCRIPTIONS_WRITER,
    UNKNOWN,
    reader_id,
    writer_id,
)
from thbridge.ros2graph.wire.rtps.outbox import RESENT_BYTES, Destination, Outbox
from thbridge.ros2graph.wire.rtps.parameters import Parameter, UdpAddress
from thbridge.ros2graph.wire.rtps.participant import RtpsParticipant
from thbridge.ros2graph.wire.rtps.postponed import PostponedMessages
from thbridge.ros2graph.wire.rtps.readers import HeldBytes, ReceivedSample, RtpsReader
from thbridge.ros2graph.wire.rtps.ros_names import DISCOVERY_TOPIC, DISCOVERY_TYPE
from thbridge.ros2graph.wire.rtps.submessages import (
    Acknowledgment,
    DataFragment,
    FragmentRequest,
    Heartbeat,
    HeartbeatFragment,
    decode_datagram,
    encode_acknowledgment,
    encode_data,
    encode_fragments,
    encode_gap,
    encode_header,
    encode_heartbeat,
)
from thbridge.ros2graph.wire.rtps.writers import RtpsWriter

TOPIC = ("rt/chatter", "std_msgs::msg::dds_::String_")
SEVERAL = 40
DEEP = QosProfile(10 * SEVERAL)
STRANGER = b"\x01\x0fstranger00"
ASK = ServiceSupport("a/srv/Ask", "", MessageSupport("a/srv/Ask_Request", ""), MessageSupport("a/srv/Ask_Response", ""))


class Pair:
    """A writer and a reader of one topic, in two participants."""

    def __init__(self, network: RtpsNetwork, offered: QosProfile, wanted: QosProfile, size: int = 16_000) -> None:
        self.network = network
        self.first, self.second = network.join(0, size), network.join(1, size)
        self.got: list[bytes] = []
        self.writer = self.first.add_writer(*TOPIC, offered, b"", STAMP)
        self.reader = self.second.add_reader(*TOPIC, wanted, b"", self.hear, STAMP)

    def hear(self, sample: ReceivedSample) -> None:
        self.got.append(sample.payload)

    def write(self, payload: bytes) -> None:
        self.first.write(self.writer, payload, STAMP + self.network.now_ns)

    def meet(self) -> None:
        self.network.run(lambda: bool(self.writer.readers and self.reader.writers))
        self.network.settle()


def payloads(count: int, size: int = 8) -> list[bytes]:
    return [at.to_bytes(4, "little") * (size // 4) for at in range(1, count + 1)]


@given(st.integers(0, 2**32), st.sampled_from([0.0, 0.1, 0.3]), st.sampled_from([8, 3000]))
def test_reliable_samples_arrive_once_and_in_order(seed: int, loss: float, size: int) -> None:
    network = RtpsNetwork(loss, seed)
    pair = Pair(network, DEEP, DEEP, size=1400)
    pair.meet()
    for payload in payloads(SEVERAL, size):
        pair.write(payload)
        if payload[0] % 8 == 0:
            network.tick()
    network.run(lambda: len(pair.got) == SEVERAL)
    for _ in range(100):
        network.tick()
    assert pair.got == payloads(SEVERAL, size)
    assert pair.second.held.held == 0
    assert network.faults == []


class ReaderFromNow(RtpsReader):
    """Reader that skips all samples of the first heartbeat, as Cyclone DDS does."""

    def on_heartbeat(self, message: Heartbeat) -> None:
        if message.writer in self._writers and self._writers[message.writer].next is None:
            message = replace(message, first=message.last + 1)
        super().on_heartbeat(message)


@given(st.integers(0, 2**32), st.sampled_from([0.1, 0.3]))
def test_all_samples_after_the_match_arrive_if_readers_skip_those_of_the_first_heartbeat(
    seed: int, loss: float
) -> None:
    network = RtpsNetwork(loss, seed)
    pair = Pair(network, DEEP, DEEP)
    pair.reader.__class__ = ReaderFromNow
    pair.write(b"lost")
    network.run(lambda: bool(pair.writer.readers))
    for payload in payloads(SEVERAL):
        pair.write(payload)
        if payload[0] % 8 == 0:
            network.tick()
    network.run(lambda: len(pair.got) >= SEVERAL)
    assert pair.got == payloads(SEVERAL)


@given(st.integers(0, 2**32))
def test_best_effort_samples_arrive_in_order_and_at_most_once(seed: int) -> None:
    network = RtpsNetwork(0.3, seed)
    pair = Pair(network, SENSOR_DATA, SENSOR_DATA, size=1400)
    pair.meet()
    for payload in payloads(SEVERAL, 3000):
        pair.write(payload)
        network.tick()
    numbers = [int.from_bytes(each[:4], "little") for each in pair.got]
    assert numbers == sorted(set(numbers))
    assert set(pair.got) <= set(payloads(SEVERAL, 3000))


@pytest.mark.parametrize("loss", [0.0, 0.3])
def test_late_readers_get_the_last_samples_of_a_latched_writer_only(loss: float) -> None:
    network = RtpsNetwork(loss, seed=3)
    pair = Pair(network, QosProfile(2, durability=LATCHED.durability), LATCHED)
    for payload in payloads(5):
        pair.write(payload)
    volatile: list[ReceivedSample] = []
    pair.second.add_reader(*TOPIC, DEFAULT, b"", volatile.append, STAMP)
    network.run(lambda: len(pair.got) == 2)
    assert pair.got == payloads(5)[3:]
    pair.meet()
    network.run(lambda: len(pair.writer.readers) == 2)
    pair.write(b"live")
    network.run(lambda: bool(volatile))
    assert [each.payload for each in volatile] == [b"live"]


def test_a_slow_reader_loses_old_samples_and_never_blocks_the_writer() -> None:
    network = RtpsNetwork()
    pair = Pair(network, DEFAULT, DEFAULT)
    pair.meet()
    come_back = network.leave(pair.second)
    for payload in payloads(100):
        pair.write(payload)
    network.settle()
    come_back()
    network.run(lambda: pair.got[-1:] == payloads(100)[-1:])
    assert pair.got == payloads(100)[-DEFAULT.depth :]


def test_requests_make_a_writer_send_a_limited_amount_per_tick() -> None:
    network = RtpsNetwork()
    pair = Pair(network, DEEP, DEEP)
    pair.meet()
    for _ in range(10):
        pair.write(bytes(1 << 20))
    pair.first.drain()
    sent = 0
    for count in range(1000, 1050):
        request = encode_acknowledgment(pair.reader.id, pair.writer.id, 1, range(1, 11), count, final=False)
        pair.first.receive(encode_header(pair.second.prefix) + request, HOST, network.now_ns, STAMP)
        sent += sum(len(datagram) for _, datagram in pair.first.drain())
    assert RESENT_BYTES / 2 < sent < 1.1 * RESENT_BYTES


def test_samples_above_their_lifespan_are_not_sent_again() -> None:
    network = RtpsNetwork()
    first = network.join(0)
    writer = first.add_writer(*TOPIC, QosProfile(5, durability=LATCHED.durability, lifespan_ns=10**9), b"", STAMP)
    first.write(writer, b"old.", STAMP - 2 * 10**9)
    first.write(writer, b"new.", STAMP)
    second, got = network.join(1), []
    second.add_reader(*TOPIC, LATCHED, b"", lambda sample: got.append(sample.payload), STAMP)
    network.run(lambda: bool(got))
    assert got == [b"new."]


@pytest.mark.parametrize(
    ("offered", "wanted", "fits"),
    [(DEFAULT, SENSOR_DATA, True), (SENSOR_DATA, DEFAULT, False), (LATCHED, DEFAULT, True), (DEFAULT, LATCHED, False)],
)
def test_endpoints_match_if_the_offer_satisfies_the_request(
    offered: QosProfile, wanted: QosProfile, fits: bool
) -> None:
    network = RtpsNetwork()
    pair = Pair(network, offered, wanted)
    network.run(lambda: len(list(pair.first.endpoints())) == len(list(pair.second.endpoints())) == 1)
    network.settle()
    assert (bool(pair.writer.readers), bool(pair.reader.writers)) == (fits, fits)


def test_endpoints_of_another_type_do_not_match() -> None:
    network = RtpsNetwork()
    pair = Pair(network, DEFAULT, DEFAULT)
    pair.second.add_reader(TOPIC[0], "other::msg::dds_::Type_", DEFAULT, b"", pair.hear, STAMP)
    pair.meet()
    network.run(lambda: len(list(pair.first.endpoints())) == 2)
    assert list(pair.writer.readers) == [pair.reader.guid]


def test_a_removed_endpoint_and_a_participant_that_leaves_are_forgotten_soon() -> None:
    network = RtpsNetwork()
    pair = Pair(network, DEFAULT, DEFAULT)
    pair.meet()
    pair.second.remove(pair.reader, STAMP)
    network.settle()
    assert list(pair.writer.readers) == list(pair.first.endpoints()) == []
    pair.first.leave()
    network.settle()
    network.leave(pair.first)
    network.run(lambda: not pair.second.has_peer(pair.first.prefix), 30)


def test_a_silent_participant_is_forgotten_after_its_lease_and_a_restarted_one_is_found() -> None:
    network = RtpsNetwork()
    pair = Pair(network, DEFAULT, DEFAULT)
    pair.meet()
    network.leave(pair.second)
    third, got = network.join(2), []
    third.add_reader(*TOPIC, DEFAULT, b"", lambda sample: got.append(sample.payload), STAMP)
    network.run(lambda: len(pair.writer.readers) == 2)
    pair.write(b"both")
    network.run(lambda: got == [b"both"])
    start_ns = network.now_ns
    network.run(lambda: len(pair.writer.readers) == 1)
    assert network.now_ns - start_ns <= LEASE_NS
    assert not pair.first.has_peer(pair.second.prefix)


def test_a_participant_that_announces_itself_too_rarely_but_answers_is_not_forgotten() -> None:
    network = RtpsNetwork()
    pair = Pair(network, DEFAULT, DEFAULT)
    pair.meet()
    for _ in range(2 * LEASE_NS // limits.TICK_NS):
        network.now_ns += limits.TICK_NS
        pair.first.tick(network.now_ns)
        network.settle()
    assert pair.first.has_peer(pair.second.prefix)


def test_acknowledgments_are_requested_only_after_the_last_sample_of_a_stream() -> None:
    network = RtpsNetwork()
    pair = Pair(network, DEFAULT, DEFAULT)
    pair.meet()
    for payload in payloads(SEVERAL):
        pair.write(payload)
        network.tick()
        assert not pair.writer.has_acknowledged(pair.reader.guid, 1)
    network.run(lambda: pair.writer.has_acknowledged(pair.reader.guid, SEVERAL), 3)
    assert pair.got == payloads(SEVERAL)


def test_a_thousand_endpoints_need_few_datagrams() -> None:
    network = RtpsNetwork()
    first, second = network.join(0), network.join(1)
    for at in range(1000):
        first.add_writer(f"rt/topic{at}", TOPIC[1], DEFAULT, bytes(80), STAMP)
    sent = 0
    for _ in range(100):
        network.now_ns += limits.TICK_NS
        for one, other in ((first, second), (second, first)):
            one.tick(network.now_ns)
            for _, datagram in one.drain():
                sent += datagram[20:21] != b"\x09"  # Announcements to ports without participant begin with a time.
                other.receive(datagram, HOST, network.now_ns, STAMP)
    assert len(list(second.endpoints())) == 1000
    assert sent < 100


def test_directed_samples_reach_only_their_participants() -> None:
    network = RtpsNetwork()
    pair = Pair(network, DEFAULT, DEFAULT)
    third, got = network.join(2), []
    third.add_reader(*TOPIC, DEFAULT, b"", lambda sample: got.append(sample.payload), STAMP)
    network.run(lambda: len(pair.writer.readers) == 2)
    network.settle()
    pair.first.write(pair.writer, b"one.", STAMP, only=frozenset({third.prefix}))
    pair.first.write(pair.writer, b"all.", STAMP)
    network.run(lambda: len(got) == 2)
    assert (got, pair.got) == ([b"one.", b"all."], [b"all."])


class ReaderOfFirstFragments(RtpsReader):
    """Reader that knows the inline quality of service only from the fragment that arrives first, as Fast DDS does."""

    first: dict[int, Sequence[Parameter]]

    def on_fragment(self, message: DataFragment) -> None:
        inline = self.first.setdefault(message.sequence, message.inline)
        super().on_fragment(replace(message, inline=inline))


@given(st.integers(0, 2**32), st.sampled_from([0.1, 0.3]))
def test_responses_name_their_request_whichever_fragment_arrives_first(seed: int, loss: float) -> None:
    network = RtpsNetwork(loss, seed)
    server = network.join(0, 1400)
    writer = server.add_writer(*TOPIC, DEEP, b"", STAMP)
    clients = network.join(1, 1400), network.join(2, 1400)
    got: list[list[tuple[bytes, object]]] = [[], []]
    for client, heard in zip(clients, got, strict=True):

        def hear(sample: ReceivedSample, heard: list[tuple[bytes, object]] = heard) -> None:
            heard.append((sample.payload, related_request(sample.inline)))

        reader = client.add_reader(*TOPIC, DEEP, b"", hear, STAMP)
        reader.__class__, reader.first = ReaderOfFirstFragments, {}
    network.run(lambda: len(writer.readers) == 2)
    expected: list[list[tuple[bytes, object]]] = [[], []]
    for at, payload in enumerate(payloads(SEVERAL // 2, 3000)):
        to, guid = at % 2, clients[at % 2].prefix + writer_id(1)
        expected[to].append((payload, (guid, at)))
        server.write(writer, payload, STAMP + network.now_ns, related(guid, at), frozenset({clients[to].prefix}))
    network.run(lambda: [len(each) for each in got] == [len(each) for each in expected])
    assert got == expected


# Untrusted datagrams.


def announced(prefix: bytes, port: int = 9999) -> bytes:
    """A datagram of a participant that announces itself."""
    address = [UdpAddress(HOST, port)]
    data = ParticipantData(prefix + PARTICIPANT, b"\x01\x0f", address, address, 10**9, b"")
    return encode_header(prefix) + encode_data(SPDP_WRITER, 1, data.encode(), 0)


def alone() -> RtpsParticipant:
    """A participant, with a reader that has heard of a stranger's writer."""
    participant = RtpsNetwork().join(0)
    participant.add_reader(*TOPIC, DEFAULT, b"", lambda sample: None, STAMP)
    assert participant.receive(announced(STRANGER), HOST, 0, STAMP) is None
    endpoint = EndpointData(STRANGER + writer_id(1), *TOPIC, DEFAULT, b"")
    heartbeat = encode_heartbeat(UNKNOWN, PUBLICATIONS_WRITER, 1, 1, 1, final=True)
    data = encode_data(PUBLICATIONS_WRITER, 1, endpoint.encode(), 0)
    assert participant.receive(encode_header(STRANGER) + heartbeat + data, HOST, 0, STAMP) is None
    participant.drain()
    assert participant.endpoint(endpoint.guid) == endpoint
    return participant


@given(st.data())
def test_damaged_datagrams_never_raise(data: st.DataObject) -> None:
    participant = alone()
    writer = writer_id(1)
    datagram = bytearray(
        encode_header(STRANGER)
        + encode_heartbeat(UNKNOWN, writer, 1, 9, 1, final=False)
        + encode_data(writer, 1, b"hello", STAMP)
        + b"".join(encode_fragments(writer, 2, bytes(50), STAMP, 20))
        + encode_data(SPDP_WRITER, 2, disposal(STRANGER + PARTICIPANT)[1], 0, disposal(STRANGER + PARTICIPANT)[0])
    )
    for _ in range(data.draw(st.integers(1, 6))):
        datagram[data.draw(st.integers(20, len(datagram) - 1))] = data.draw(st.integers(0, 255))
    cut = data.draw(st.integers(0, len(datagram)))
    participant.receive(bytes(datagram[:cut]), HOST, 0, STAMP)
    participant.receive(bytes(datagram), HOST, 0, STAMP)
    participant.receive(data.draw(st.binary(max_size=100)), HOST, 0, STAMP)
    participant.tick(1)
    for outgoing in participant.drain():
        assert len(outgoing.datagram) < 65_000


def test_participants_without_endpoints_make_room_for_others() -> None:
    participant = alone()
    for at in range(limits.MOST_PEERS + 5):
        assert participant.receive(announced(b"peer" + at.to_bytes(8, "big")), HOST, 0, STAMP) is None
    assert participant.has_peer(STRANGER)
    assert not participant.has_peer(b"peer" + bytes(8))
    assert participant.has_peer(b"peer" + (limits.MOST_PEERS + 4).to_bytes(8, "big"))


def test_the_number_of_participants_is_limited(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "MOST_PEERS", 1)
    assert "more than 1" in (alone().receive(announced(b"another peer"), HOST, 0, STAMP) or "")


def test_no_participant_stays_for_ever_without_a_sign_of_life() -> None:
    participant, address = RtpsNetwork().join(0), [UdpAddress(HOST, 9999)]
    data = ParticipantData(STRANGER + PARTICIPANT, b"\x01\x0f", address, address, None, b"")
    participant.receive(encode_header(STRANGER) + encode_data(SPDP_WRITER, 1, data.encode(), 0), HOST, 0, STAMP)
    participant.tick(limits.LONGEST_LEASE_NS)
    assert participant.has_peer(STRANGER)
    participant.tick(limits.LONGEST_LEASE_NS + 1)
    assert not participant.has_peer(STRANGER)


def test_thousands_of_requests_and_heartbeats_in_a_datagram_get_one_answer() -> None:
    participant = alone()
    writer = participant.add_writer(*TOPIC, DEFAULT, b"", STAMP)
    endpoint = EndpointData(STRANGER + reader_id(1), *TOPIC, DEFAULT, b"")
    heartbeat = encode_heartbeat(UNKNOWN, SUBSCRIPTIONS_WRITER, 1, 1, 1, final=True)
    data = encode_data(SUBSCRIPTIONS_WRITER, 1, endpoint.encode(), 0)
    participant.receive(encode_header(STRANGER) + heartbeat + data, HOST, 0, STAMP)
    participant.drain()
    for _ in range(10):
        participant.write(writer, bytes(1000), STAMP)
    assert sum(len(each.datagram) for each in participant.drain()) > 10_000
    requests = (encode_acknowledgment(reader_id(1), writer.id, 1, range(1, 11), at, final=False) for at in range(900))
    beats = (encode_heartbeat(UNKNOWN, writer_id(1), 1, 1 << 40, at, final=False) for at in range(900))
    for many in (requests, beats):
        participant.receive(encode_header(STRANGER) + b"".join(many), HOST, 0, STAMP)
        assert 0 < sum(len(each.datagram) for each in participant.drain()) < 12_000


@given(st.lists(st.integers(0, 30), max_size=4))
def test_no_participant_fills_the_places_of_those_that_wait_for_an_answer(counts: list[int]) -> None:
    most, answers = 20, 5
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(postponed, "MOST_POSTPONED", most)
        patch.setattr(postponed, "MOST_ANSWERS", answers)
        waiting = PostponedMessages()
        for sender, count in enumerate(counts):
            for sequence in range(count):
                waiting.add(FragmentRequest(bytes([sender]) + bytes(15), writer_id(1), sequence, [1], 1))
        got = [0 for _ in counts]
        while taken := waiting.take():
            assert len(taken) <= answers
            for each in taken:
                assert isinstance(each, FragmentRequest)
                got[each.reader[0]] += 1
    assert sum(got) == min(most, sum(counts))
    for mine, wanted in zip(got, counts, strict=True):
        assert mine >= min(wanted, most // len(counts))


def test_participants_are_answered_in_turn() -> None:
    waiting = PostponedMessages()
    for sender in range(2):
        for sequence in range(postponed.MOST_ANSWERS):
            waiting.add(HeartbeatFragment(bytes([sender]) + bytes(15), UNKNOWN, sequence, 1))
    assert {each.writer[0] for each in waiting.take()[:2]} == {0, 1}


def test_a_goodbye_in_the_name_of_another_participant_has_no_effect() -> None:
    network = RtpsNetwork()
    pair = Pair(network, DEEP, DEEP)
    pair.meet()
    inline, key = disposal(pair.first.prefix + PARTICIPANT)
    goodbye = encode_header(pair.first.prefix) + encode_data(SPDP_WRITER, 2, key, 0, inline, key=True)
    for at in range(100):
        pair.second.receive(goodbye, HOST, network.now_ns, STAMP)
        pair.write(payloads(100)[at])
        network.tick()
    assert pair.got == payloads(100)


@pytest.mark.parametrize("loser", ["first", "second"])
def test_participants_find_each_other_again_if_only_one_has_lost_the_other(loser: str) -> None:
    network = RtpsNetwork()
    pair = Pair(network, DEEP, DEEP)
    back: list[bytes] = []
    writer = pair.second.add_writer("rt/back", TOPIC[1], LATCHED, b"", STAMP)
    reader = pair.first.add_reader("rt/back", TOPIC[1], DEEP, b"", lambda sample: back.append(sample.payload), STAMP)
    pair.meet()
    network.run(lambda: bool(writer.readers and reader.writers))
    pair.write(b"old.")
    pair.second.write(writer, b"1st.", STAMP)
    network.run(lambda: bool(pair.got and back))
    lost, losing = (pair.second, pair.first) if loser == "first" else (pair.first, pair.second)
    inline, key = disposal(lost.prefix + PARTICIPANT)
    goodbye = encode_header(lost.prefix) + encode_data(SPDP_WRITER, 2, key, 0, inline, key=True)
    losing.receive(goodbye, HOST, network.now_ns, STAMP)
    losing.tick(network.now_ns + limits.GOODBYE_NS + 1)
    assert not losing.has_peer(lost.prefix)
    pair.meet()
    network.run(lambda: bool(writer.readers and reader.writers), 200)
    pair.write(b"new.")
    pair.second.write(writer, b"2nd.", STAMP)
    network.run(lambda: len(pair.got) > 1 and len(back) > 1, 200)
    assert (pair.got, back) == ([b"old.", b"new."], [b"1st.", b"2nd."])


def test_the_number_of_endpoints_is_limited(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "MOST_ENDPOINTS", 5)
    participant = alone()
    for at in range(2, 10):
        endpoint = EndpointData(STRANGER + reader_id(at), *TOPIC, DEFAULT, b"")
        heartbeat = encode_heartbeat(UNKNOWN, SUBSCRIPTIONS_WRITER, 1, at - 1, at, final=True)
        data = encode_data(SUBSCRIPTIONS_WRITER, at - 1, endpoint.encode(), 0)
        fault = participant.receive(encode_header(STRANGER) + heartbeat + data, HOST, 0, STAMP)
        participant.drain()
    assert len(list(participant.endpoints())) == 5
    assert "more than 5" in (fault or "")


def test_a_participant_cannot_announce_endpoints_of_another_one() -> None:
    participant = alone()
    endpoint = EndpointData(b"another peer" + writer_id(7), *TOPIC, DEFAULT, b"")
    data = encode_data(PUBLICATIONS_WRITER, 2, endpoint.encode(), 0)
    assert "another participant" in (participant.receive(encode_header(STRANGER) + data, HOST, 0, STAMP) or "")


def test_bytes_that_wait_are_limited() -> None:
    held = HeldBytes(limit=1000)
    reader = RtpsReader(bytes(12) + reader_id(1), SENSOR_DATA, Outbox(1000), held, lambda sample: None)
    writers = [STRANGER + writer_id(at) for at in range(1, 60)]
    for writer in writers:
        reader.match(writer, SENSOR_DATA, Destination(UdpAddress(HOST, 1), bytes(12)), 1)
        pieces = encode_fragments(writer[-4:], 1, bytes(100), STAMP, 30)[:-1]
        for each in decode_datagram(encode_header(STRANGER) + b"".join(pieces), bytes(12))[2]:
            assert isinstance(each, DataFragment)
            reader.on_fragment(each)
        assert held.held <= 1000
    assert held.held > 900
    for writer in writers:
        reader.unmatch(writer)
    assert held.held == 0


def test_missing_fragments_are_requested_when_they_are_announced() -> None:
    participant = alone()
    writer = writer_id(1)
    heartbeat = encode_heartbeat(UNKNOWN, writer, 1, 1, 1, final=True)
    pieces = encode_fragments(writer, 1, bytes(100), STAMP, 10)
    body = UNKNOWN + writer + struct.pack("<iIIi", 0, 1, 8, 1)
    announced_fragments = struct.pack("<BBH", 0x13, 1, len(body)) + body
    participant.drain()
    participant.receive(
        b"".join((encode_header(STRANGER), heartbeat, pieces[0], pieces[3], announced_fragments)), HOST, 0, STAMP
    )
    requests = [
        each
        for outgoing in participant.drain()
        for each in decode_datagram(outgoing.datagram, STRANGER)[2]
        if isinstance(each, FragmentRequest)
    ]
    assert requests[-1].missing == [2, 3, 5, 6, 7, 8]


def asked_in_a_second(participant: RtpsParticipant, start_ns: int) -> list[tuple[int, tuple[int, list[int]]]]:
    """Requests to the stranger's writer: the milliseconds since the start, the number of a sample, what is missing."""
    asked = []
    for since_ns in range(0, 1_000_000_000, limits.TICK_NS):
        participant.tick(start_ns + since_ns)
        for outgoing in participant.drain():
            for each in decode_datagram(outgoing.datagram, STRANGER)[2]:
                if isinstance(each, Acknowledgment | FragmentRequest) and each.writer == writer_id(1):
                    number = each.base if isinstance(each, Acknowledgment) else each.sequence
                    asked.append((since_ns // 1_000_000, (number, list(each.missing))))
    return asked


def test_what_was_sent_before_something_that_has_arrived_is_requested_without_a_heartbeat() -> None:
    participant = alone()
    writer = writer_id(1)
    heartbeat = encode_heartbeat(UNKNOWN, writer, 1, 0, 1, final=True)
    whole = encode_data(writer, 2, b"2nd.", STAMP)
    pieces = encode_fragments(writer, 4, bytes(100), STAMP, 10)
    participant.receive(b"".join((encode_header(STRANGER), heartbeat, whole, *pieces[:5:2])), HOST, 0, STAMP)
    participant.drain()
    expected = [(ms, each) for ms in (100, 200, 400, 800) for each in ((1, [1, 3]), (4, [2, 4]))]
    assert asked_in_a_second(participant, 0) == expected
    gap = encode_gap(UNKNOWN, writer, [1, 3])
    participant.receive(b"".join((encode_header(STRANGER), gap, *pieces)), HOST, 1000, STAMP)
    assert asked_in_a_second(participant, 1000) == []


def test_what_a_heartbeat_has_announced_is_requested_again_until_it_comes() -> None:
    participant = alone()
    writer = writer_id(1)
    begin, announcement = (encode_heartbeat(UNKNOWN, writer, 1, last, 1 + last, final=True) for last in range(2))
    participant.receive(encode_header(STRANGER) + begin + announcement, HOST, 0, STAMP)
    participant.drain()
    assert asked_in_a_second(participant, 0) == [(ms, (1, [1])) for ms in (100, 200, 400, 800)]
    participant.receive(encode_header(STRANGER) + encode_data(writer, 1, b"1st.", STAMP), HOST, 1000, STAMP)
    assert asked_in_a_second(participant, 1000) == []


class WriterWithoutHeartbeats(RtpsWriter):
    """Writer that sends no heartbeat for seconds, as Fast DDS does."""

    def tick(self, now_ns: int) -> bool:
        return False


def test_a_client_asks_for_a_response_that_was_lost() -> None:
    network = RtpsNetwork()
    first, second = (
        DdsGraph(network.join(number), lambda: STAMP, lambda: None, network.faults.append) for number in range(2)
    )
    replies: list[Callable[[bytes], None]] = []
    got: list[bytes] = []
    first.serve(NodeName("/", "server"), "/ask", ASK, lambda data, gid, reply: replies.append(reply))
    client = second.client(NodeName("/", "client"), "/ask", ASK)
    network.run(lambda: client.has_server)
    for writer in first.participant._writers.values():
        writer.__class__ = WriterWithoutHeartbeats
    client.call(b"\0\1\0\0", got.append)
    network.run(lambda: bool(replies))
    come_back = network.leave(second.participant)
    replies[0](b"\0\1\0\0answer..")
    network.settle()
    come_back()
    network.run(lambda: bool(got), 40)


def test_writers_are_asked_only_while_something_is_expected() -> None:
    participant = alone()
    reader = participant.add_reader(*TOPIC, DEFAULT, b"", lambda sample: None, STAMP)
    heartbeat = encode_heartbeat(UNKNOWN, writer_id(1), 1, 0, 1, final=True)
    participant.receive(encode_header(STRANGER) + heartbeat, HOST, 0, STAMP)
    participant.drain()
    participant.expect(reader, expects=True)
    assert asked_in_a_second(participant, 0) == [(ms, (0, [])) for ms in (100, 200, 400, 800)]
    participant.expect(reader, expects=False)
    assert asked_in_a_second(participant, 0) == []


def test_samples_that_are_too_large_are_not_assembled() -> None:
    participant = alone()
    (fragment,) = encode_fragments(writer_id(1), 1, bytes(10), STAMP, 10)
    size_at = len(fragment) - 12 - 4
    huge = fragment[:size_at] + (readers.LARGEST_SAMPLE + 1).to_bytes(4, "little") + fragment[size_at + 4 :]
    participant.receive(encode_header(STRANGER) + huge, HOST, 0, STAMP)
    assert participant.held.held == 0


def test_a_participant_cannot_name_the_endpoints_of_another_one() -> None:
    network = RtpsNetwork()
    first, liar, other = (network.join(number) for number in range(3))
    graph = DdsGraph(first, lambda: STAMP, lambda: None, network.faults.append)
    victim, own = (each.add_writer(*TOPIC, DEFAULT, b"", STAMP) for each in (other, liar))
    info = liar.add_writer(DISCOVERY_TOPIC, DISCOVERY_TYPE, LATCHED, b"", STAMP)
    nodes = [NodeEntities(NodeName("/", "liar"), [], [victim.guid, own.guid])]
    liar.write(info, encode_entities(liar.guid, nodes), STAMP)
    network.run(lambda: graph.node_of(own.guid) == "/liar")
    assert graph.node_of(victim.guid) == victim.guid.hex()
