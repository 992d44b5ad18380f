"""Submessages, parameters, names and services of RTPS: what is written is read, and other bytes are refused."""

import struct
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.ros2.qos import DeliveryReliability, Durability, QosProfile
from thbridge.ros2graph.values.graph import EndpointRole, NodeName
from thbridge.ros2graph.wire.rtps import ros_names
from thbridge.ros2graph.wire.rtps.correlation import (
    header_of,
    insert_header,
    related,
    related_request,
    sequence_of,
    split_header,
)
from thbridge.ros2graph.wire.rtps.discovery import EndpointData, ParticipantData, disposal, disposed_guid, is_disposed
from thbridge.ros2graph.wire.rtps.entities_info import NodeEntities, decode_entities, encode_entities
from thbridge.ros2graph.wire.rtps.guids import PARTICIPANT, reader_id, writer_id
from thbridge.ros2graph.wire.rtps.parameters import UdpAddress, decode_list, decode_payload
from thbridge.ros2graph.wire.rtps.ports import initial_addresses, metatraffic_port, reach_on_network
from thbridge.ros2graph.wire.rtps.submessages import (
    Acknowledgment,
    Data,
    DataFragment,
    FragmentRequest,
    Heartbeat,
    SampleGap,
    Submessage,
    decode_datagram,
    encode_acknowledgment,
    encode_data,
    encode_destination,
    encode_fragment_request,
    encode_fragments,
    encode_gap,
    encode_header,
    encode_heartbeat,
)

PREFIX, OTHER = b"prefix of us", b"another one."
READER, WRITER = reader_id(1), writer_id(2)
sequences = st.integers(1, 1 << 61)
sets = st.sets(st.integers(0, 255), max_size=256)
texts = st.text(st.characters(codec="utf-8", exclude_characters="\x00"), min_size=1, max_size=40)
names = st.from_regex(r"[A-Za-z0-9_]{1,20}", fullmatch=True)
qualities = st.builds(
    QosProfile,
    st.integers(1, 2**31),
    st.sampled_from(DeliveryReliability),
    st.sampled_from(Durability),
    st.none() | st.integers(0, 10**15),
)
addresses = st.lists(
    st.builds(UdpAddress, st.ip_addresses(v=4).map(str), st.integers(1, 65535)), max_size=4
)  # fmt: skip


def decoded(*submessages: bytes) -> list[Submessage]:
    return list(decode_datagram(b"".join((encode_header(OTHER), *submessages)), PREFIX)[2])


@given(sequences, sets, sequences, st.booleans())
def test_submessages_survive(sequence: int, bits: set[int], last: int, final: bool) -> None:
    first, last = min(sequence, last), max(sequence, last)
    numbers = sorted(sequence + bit for bit in bits)
    assert decoded(encode_heartbeat(READER, WRITER, first, last, 7, final=final)) == [
        Heartbeat(OTHER + WRITER, READER, first, last, 7, final)
    ]
    assert decoded(encode_acknowledgment(READER, WRITER, sequence, numbers, 8, final=final)) == [
        Acknowledgment(OTHER + READER, WRITER, sequence, numbers, 8, final)
    ]
    if numbers:
        (gap,) = decoded(encode_gap(READER, WRITER, numbers))
        assert isinstance(gap, SampleGap)
        assert [*range(gap.first, gap.base), *gap.others] == numbers
        wanted = sorted(1 + bit for bit in bits)
        assert decoded(encode_fragment_request(READER, WRITER, sequence, wanted, 9)) == [
            FragmentRequest(OTHER + READER, WRITER, sequence, wanted, 9)
        ]


@given(sequences, st.binary(max_size=300), st.integers(4, 100))
def test_samples_survive_whole_and_in_fragments(sequence: int, payload: bytes, size: int) -> None:
    inline = related(OTHER + READER, 5)
    (data,) = decoded(encode_data(WRITER, sequence, payload, 10**18, inline))
    assert isinstance(data, Data)
    assert (data.writer, data.sequence) == (OTHER + WRITER, sequence)
    # Samples are padded to 4 bytes, because the next submessage begins there.
    assert data.payload[: len(payload)] == payload
    assert len(data.payload) - len(payload) in range(4)
    assert related_request(data.inline) == (OTHER + READER, 5)
    joined = b""
    for each in decoded(*encode_fragments(WRITER, sequence, payload, 10**18, size, inline)):
        assert isinstance(each, DataFragment)
        assert (each.size, each.fragment_size, each.count) == (len(payload), size, 1)
        assert related_request(each.inline) == (OTHER + READER, 5)
        joined += each.payload[: min(size, len(payload) - len(joined))]
    assert joined == payload


def test_submessages_for_another_participant_are_skipped() -> None:
    heartbeat = encode_heartbeat(READER, WRITER, 1, 1, 1, final=True)
    assert decoded(encode_destination(OTHER), heartbeat) == []
    assert len(decoded(encode_destination(OTHER), heartbeat, encode_destination(PREFIX), heartbeat)) == 1


def test_both_byte_orders_and_unknown_submessages_are_read() -> None:
    body = READER + WRITER + struct.pack(">qqi", 3, 9, 4)
    big = struct.pack(">BBH", 7, 0, len(body)) + body
    assert decoded(b"\x80\x01\x04\x00abcd", big) == [Heartbeat(OTHER + WRITER, READER, 3, 9, 4, False)]


def test_a_submessage_of_size_0_reaches_to_the_end_of_the_datagram() -> None:
    data = encode_data(WRITER, 1, b"end!", 0)[12:]
    (found,) = decoded(data[:2] + bytes(2) + data[4:])
    assert isinstance(found, Data)
    assert found.payload == b"end!"


@given(st.binary(max_size=200))
def test_other_bytes_raise_value_errors_only(data: bytes) -> None:
    for function in (ParticipantData.decode, EndpointData.decode, decode_entities, split_header):
        with suppress(ValueError):
            function(data)
    with suppress(ValueError):
        list(decode_payload(b"\x00\x03\x00\x00" + data))
    with suppress(ValueError):
        decoded(data)


@given(addresses, addresses, st.none() | st.integers(0, 10**17), st.binary(max_size=50))
def test_participants_survive(
    metatraffic: list[UdpAddress], default: list[UdpAddress], lease_ns: int | None, user_data: bytes
) -> None:
    data = ParticipantData(PREFIX + PARTICIPANT, b"\x01\x10", metatraffic, default, lease_ns, user_data)
    assert ParticipantData.decode(data.encode()) == data


@given(texts, texts, qualities, st.binary(max_size=100), st.booleans())
def test_endpoints_survive(topic: str, type_name: str, qos: QosProfile, user_data: bytes, writes: bool) -> None:
    if not writes:
        qos = QosProfile(qos.depth, qos.reliability, qos.durability)
    data = EndpointData(PREFIX + (WRITER if writes else READER), topic, type_name, qos, user_data)
    found = EndpointData.decode(data.encode())
    assert (found.guid, found.topic, found.type, found.qos, found.user_data) == (
        (data.guid, topic, type_name, qos, user_data)
    )  # fmt: skip
    assert found.is_writer == writes


@pytest.mark.parametrize("entity", [PARTICIPANT, READER])
def test_disposals_name_what_is_gone(entity: bytes) -> None:
    inline, key = disposal(PREFIX + entity)
    parameters, _ = decode_list(inline, "<")
    assert is_disposed(parameters)
    assert disposed_guid(parameters, b"") == disposed_guid([], key) == PREFIX + entity


@given(st.lists(st.tuples(names, names, st.integers(0, 3), st.integers(0, 3)), max_size=5))
def test_lists_of_nodes_survive(nodes: list[tuple[str, str, int, int]]) -> None:
    entities = [
        NodeEntities(NodeName(f"/{space}", name), [PREFIX + READER] * reads, [PREFIX + WRITER] * writes)
        for space, name, reads, writes in nodes
    ]
    assert decode_entities(encode_entities(PREFIX + PARTICIPANT, entities)) == entities


def test_a_list_of_nodes_has_the_form_of_rmw_dds_common() -> None:
    message = encode_entities(bytes(16), [NodeEntities(NodeName("/", "me"), [], [bytes(range(16))])])
    assert message == (
        b"\x00\x01\x00\x00" + bytes(16) + b"\x01\x00\x00\x00"
        b"\x02\x00\x00\x00/\x00\x00\x00" + b"\x03\x00\x00\x00me\x00\x00" + bytes(4) + b"\x01\x00\x00\x00"
    ) + bytes(range(16))


@given(st.binary(min_size=8, max_size=8), st.integers(0, 2**62), st.binary(max_size=40))
def test_headers_of_cyclone_survive(key: bytes, sequence: int, body: bytes) -> None:
    message = b"\x00\x01\x00\x00" + body
    header, rest = split_header(insert_header(message, header_of(key, sequence)))
    assert (header[:8], sequence_of(header), rest) == (key, sequence, message)


def test_a_message_that_refers_to_nothing_has_no_related_request() -> None:
    assert related_request([]) is None
    parameters, _ = decode_list(related(bytes(16), 3), "<")
    assert related_request(parameters) is None


@pytest.mark.parametrize(
    ("topic", "is_writer", "found"),
    [
        ("rt/chatter", True, (EndpointRole.PUBLISHER, "/chatter")),
        ("rt/a/b", False, (EndpointRole.SUBSCRIPTION, "/a/b")),
        ("rq/addRequest", False, (EndpointRole.SERVER, "/add")),
        ("rq/addRequest", True, (EndpointRole.CLIENT, "/add")),
        ("rr/addReply", True, None),
        ("rt/new\nline", True, None),
        ("ros_discovery_info", True, None),
    ],
)
def test_names_say_the_roles(topic: str, is_writer: bool, found: tuple[EndpointRole, str] | None) -> None:
    assert ros_names.role_and_name(topic, is_writer=is_writer) == found


def test_types_and_hashes_are_read() -> None:
    assert ros_names.type_of("nav_msgs::srv::dds_::GetMap_Request_") == "nav_msgs/srv/GetMap_Request"
    assert ros_names.type_of("HelloWorld") is None
    type_hash = "RIHS01_" + "0a" * 32
    assert ros_names.hash_of(b"clientid=1;" + ros_names.hash_data(type_hash) + b"\x00") == type_hash
    assert ros_names.hash_of(b"typehash=RIHS01_zz;") == ""


def test_ports_are_those_of_the_standard() -> None:
    assert metatraffic_port(0, 0) == 7410
    assert metatraffic_port(11, 2) == 7400 + 250 * 11 + 14
    assert initial_addresses(0, "192.168.1.2") == [UdpAddress("239.255.0.1", 7400)]
    assert {each.host for each in initial_addresses(0, "127.0.0.1")} == {"127.0.0.1"}


def test_on_a_network_the_sending_address_is_preferred() -> None:
    several = [UdpAddress("127.0.0.1", 1), UdpAddress("172.17.0.1", 2), UdpAddress("192.168.1.9", 3)]
    assert reach_on_network(several, "192.168.1.9") == several[2]
    assert reach_on_network(several, "10.0.0.1") == several[1]
    assert reach_on_network(several[:1], "10.0.0.1") is None
