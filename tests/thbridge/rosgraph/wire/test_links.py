"""Both ends of a TCPROS connection, without a socket."""

import random
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.thbridge.rosgraph.wire.cut_streams import cut, places
from thbridge.rosgraph.wire.inbound import InboundLink
from thbridge.rosgraph.wire.links import (
    LinkEnded,
    LinkRefused,
    MessageReceived,
    PublisherAccepted,
    SendToPeer,
    ServiceFailed,
    ServiceHeader,
    ServiceRequested,
    SubscriberAccepted,
    TopicHeader,
)
from thbridge.rosgraph.wire.outbound import SubscriberLink
from thbridge.rosgraph.wire.tcpros import BODY_LIMIT, HEADER_LIMIT, REQUEST_LIMIT, decode_header, encode_header, frame

MD5 = "992ce8a1687cec8c8bd883ec73ca41d1"
SERVICE_MD5 = "937c9679a518e3a18d831e57125ea522"
CHATTER = TopicHeader("/chatter", "std_msgs/String", MD5, "string data\n", latched=True)
TRIGGER = ServiceHeader(
    "/trigger", "std_srvs/Trigger", SERVICE_MD5, "std_srvs/TriggerRequest", "std_srvs/TriggerResponse"
)


class OneOfEach:
    """Offers one topic and one service."""

    def topic(self, name):
        return CHATTER if name == CHATTER.name else None

    def service(self, name):
        return TRIGGER if name == TRIGGER.name else None


def inbound() -> InboundLink:
    return InboundLink("/us", OneOfEach())


def subscriber(kind: str = CHATTER.type, md5: str = MD5, topic: str = CHATTER.name) -> SubscriberLink:
    return SubscriberLink("/them", topic, kind, md5)


def caller(**fields: str) -> bytes:
    """A client's header."""
    return encode_header({"callerid": "/them", "service": TRIGGER.name, "md5sum": SERVICE_MD5, **fields})


def header_of(event) -> dict[str, str]:
    assert isinstance(event, SendToPeer)
    fields = decode_header(event.data[4:])
    assert isinstance(fields, dict)
    return fields


def told(link, data: bytes, where: list[int]) -> list:
    """The events of a stream, however cut; every request is answered with itself."""
    events = []
    for segment in cut(data, where):
        fresh = link.receive(segment)
        while fresh:
            events += fresh
            fresh = [
                after for each in fresh if isinstance(each, ServiceRequested) for after in link.respond(each.request)
            ]
    return events


# -- topics


def test_a_subscriber_hears_what_is_published_under_the_publishers_name():
    publisher, link = inbound(), subscriber()
    answer, subscribed = publisher.receive(link.opening())
    assert header_of(answer) == {
        "callerid": "/us",
        "latching": "1",
        "md5sum": MD5,
        "message_definition": "string data\n",
        "topic": "/chatter",
        "type": "std_msgs/String",
    }
    assert subscribed == SubscriberAccepted("/chatter", "/them")
    assert link.receive(answer.data + frame(b"one") + frame(b"")) == [
        PublisherAccepted("/us", CHATTER),
        MessageReceived(b"one"),
        MessageReceived(b""),
    ]


def test_who_takes_any_type_is_accepted_and_told_the_type():
    publisher, link = inbound(), subscriber("*", "*")
    answer, _ = publisher.receive(link.opening())
    assert link.receive(answer.data) == [PublisherAccepted("/us", CHATTER)]


@pytest.mark.parametrize(
    ("asking", "reason"),
    [
        (subscriber(md5="0" * 32), "md5 sum"),
        (subscriber(topic="/nothing"), "does not publish /nothing"),
    ],
)
def test_who_does_not_fit_is_told_why_on_both_sides(asking, reason):
    answer, refused = inbound().receive(asking.opening())
    assert reason in refused.reason
    assert header_of(answer) == {"error": refused.reason}
    assert asking.receive(answer.data) == [LinkRefused(refused.reason)]


def test_a_publisher_of_another_type_is_not_listened_to():
    theirs = encode_header({"callerid": "/us", "md5sum": "0" * 32, "type": "std_msgs/Int8"})
    (refused,) = subscriber().receive(theirs + frame(b"?"))
    assert "std_msgs/Int8" in refused.reason


@pytest.mark.parametrize("fields", [{"topic": "/chatter"}, {"md5sum": MD5}])
def test_a_header_without_what_it_needs_is_refused(fields):
    answer, refused = inbound().receive(encode_header(fields))
    assert header_of(answer)["error"] == refused.reason


def test_what_a_stranger_says_is_repeated_short_and_on_one_line():
    _, refused = inbound().receive(encode_header({"topic": "/a\n" * 10_000, "md5sum": MD5}))
    assert len(refused.reason) < 300
    assert "\n" not in refused.reason


def test_what_a_subscriber_says_later_is_neither_heard_nor_kept():
    publisher = inbound()
    publisher.receive(subscriber().opening())
    assert publisher.receive(b"\xff" * 1000) == []


# -- services


def test_a_client_gets_the_answer_and_the_connection_ends():
    server = inbound()
    (answer,) = server.receive(caller())
    assert header_of(answer) == {
        "callerid": "/us",
        "md5sum": SERVICE_MD5,
        "request_type": "std_srvs/TriggerRequest",
        "response_type": "std_srvs/TriggerResponse",
        "service": "/trigger",
        "type": "std_srvs/Trigger",
    }
    assert server.receive(frame(b"do")) == [ServiceRequested("/trigger", b"do")]
    response, ended = server.respond(b"done")
    assert isinstance(ended, LinkEnded)
    assert response == SendToPeer(b"\x01" + frame(b"done"))


def test_a_failure_reaches_the_client_as_its_sentence():
    server = inbound()
    server.receive(caller(md5sum="*") + frame(b""))
    response, _ = server.respond(ServiceFailed("the door is shut"))
    assert response == SendToPeer(b"\x00" + frame(b"the door is shut"))


def test_a_persistent_client_asks_again_and_again_but_one_thing_at_a_time():
    server = inbound()
    _, first = server.receive(caller(persistent="1") + frame(b"1") + frame(b"2"))
    assert first == ServiceRequested("/trigger", b"1")
    assert server.respond(b"")[1:] == [ServiceRequested("/trigger", b"2")]
    assert len(server.respond(b"")) == 1
    assert server.receive(frame(b"3")) == [ServiceRequested("/trigger", b"3")]


def test_a_probe_gets_the_header_and_no_more():
    answer, ended = inbound().receive(caller(probe="1", md5sum="*"))
    assert header_of(answer)["type"] == "std_srvs/Trigger"
    assert isinstance(ended, LinkEnded)


def test_a_client_of_another_type_or_service_is_refused():
    assert "error" in header_of(inbound().receive(caller(md5sum="0" * 32))[0])
    assert "error" in header_of(inbound().receive(caller(service="/nothing"))[0])


def test_an_answer_without_a_question_goes_nowhere():
    assert inbound().respond(b"42") == []


def test_a_client_that_floods_while_it_waits_is_cut_off():
    server = inbound()
    server.receive(caller(persistent="1") + frame(b""))
    events = []
    for _ in range(40):
        events += server.receive(b"\x00" * (REQUEST_LIMIT // 32))
    assert [type(event) for event in events] == [LinkEnded]


# -- any bytes


@given(st.lists(st.binary(max_size=50), max_size=5), places)
def test_a_publishers_stream_means_the_same_however_it_is_cut(messages, where):
    answer = encode_header({"callerid": "/us", "md5sum": MD5, "type": CHATTER.type})
    stream = answer + b"".join(map(frame, messages))
    said = TopicHeader(CHATTER.name, CHATTER.type, MD5, "")  # the stream's header tells no more
    assert told(subscriber(), stream, where) == [PublisherAccepted("/us", said), *map(MessageReceived, messages)]


@given(st.lists(st.binary(max_size=50), max_size=5), places)
def test_a_clients_stream_means_the_same_however_it_is_cut(requests, where):
    stream = caller(persistent="true") + b"".join(map(frame, requests))
    assert told(inbound(), stream, where) == told(inbound(), stream, [])


LINKS = [inbound, subscriber]
STREAMS = [
    subscriber().opening(),
    caller(persistent="1") + frame(b"one") + frame(b"two"),
    encode_header({"callerid": "/us", "md5sum": MD5, "type": CHATTER.type}) + frame(b"one") + frame(b"two"),
]


@pytest.mark.parametrize("made", LINKS)
@given(data=st.binary(), where=places)
def test_no_bytes_make_a_link_raise(made, data, where):
    told(made(), data, where)


@pytest.mark.parametrize("made", LINKS)
@given(which=st.sampled_from(STREAMS), seed=st.integers(), where=places)
def test_nor_do_real_ones_with_faults(made, which, seed, where):
    dice = random.Random(seed)
    data = bytearray(which)
    for _ in range(dice.randint(1, 8)):
        match dice.randrange(3):
            case 0 if data:
                data[dice.randrange(len(data))] = dice.randrange(256)
            case 1 if data:
                at = dice.randrange(len(data))
                del data[at : at + dice.randrange(9)]
            case _:
                at = dice.randrange(len(data) + 1)
                data[at:at] = dice.randbytes(dice.randrange(9))
    told(made(), bytes(data), where)


@pytest.mark.parametrize("made", LINKS)
@pytest.mark.parametrize("length", [HEADER_LIMIT + 1, 2**32 - 1])
def test_a_header_that_claims_to_be_huge_ends_the_link_at_once(made, length):
    (ended,) = made().receive(struct.pack("<I", length))
    assert isinstance(ended, LinkEnded)


def test_so_does_a_message_or_a_request():
    header = encode_header({"callerid": "/us", "md5sum": MD5, "type": CHATTER.type})
    assert isinstance(subscriber().receive(header + struct.pack("<I", BODY_LIMIT + 1))[-1], LinkRefused)
    assert isinstance(inbound().receive(caller() + struct.pack("<I", REQUEST_LIMIT + 1))[-1], LinkEnded)
