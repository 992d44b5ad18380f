import json
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.credentials import key_line
from thbridge.line_splitter import LINE_LIMIT
from thbridge.recording.bag.options import Compression
from thbridge.recording.bag.records import (
    MAGIC,
    U32,
    BagConnection,
    bag_header,
    chunk_record,
    connection_record,
    message_head,
    time_bytes,
)
from thbridge.sockets.keys import SingleKey
from thbridge.watching.wire import (
    MISTAKES,
    STATUS,
    BagStreamReader,
    BrokenStream,
    SessionMessage,
    WatcherAdmitted,
    WatcherRequest,
    WatcherSession,
    WatchRefusal,
    WatchStatus,
    parse_status,
)

TOPICS = [
    BagConnection(0, "/tf", "tf2_msgs/TFMessage", "0" * 32, "x", "/thbridge", False),
    BagConnection(1, "/map", "nav_msgs/OccupancyGrid", "1" * 32, "y=z", "/thbridge", True),
    BagConnection(2, STATUS, "std_msgs/String", "2" * 32, "string data\n", None, None),
]
MESSAGES = st.lists(
    st.tuples(st.sampled_from(TOPICS), st.integers(0, 2**32 * 10**9 - 1), st.binary(max_size=50)), max_size=8
)


def stream(messages, chunked=True) -> bytes:
    """What a session says of these; all in one chunk, or bare."""
    pieces = [connection_record(topic) for topic in TOPICS]
    for topic, stamp, data in messages:
        pieces += [message_head(topic.number), time_bytes(stamp), U32.pack(len(data)), data]
    records = b"".join(pieces)
    return MAGIC + bag_header(0, 0, 0) + (chunk_record(records, Compression.NONE) if chunked else records)


def said(messages) -> list[SessionMessage]:
    return [SessionMessage(topic.topic, topic.msgtype, stamp, data) for topic, stamp, data in messages]


@given(MESSAGES, st.booleans(), st.lists(st.integers(0, 6000), max_size=5))
def test_what_a_session_says_is_heard_however_it_is_cut(messages, chunked, cuts):
    data, reader, heard = stream(messages, chunked), BagStreamReader(), []
    ends = [*sorted(min(cut, len(data)) for cut in cuts), len(data)]
    for start, end in zip([0, *ends], ends, strict=False):
        heard += reader.feed(data[start:end])
    assert heard == said(messages)


def test_byte_by_byte():
    messages = [(TOPICS[0], 1_500_000_000, b"one"), (TOPICS[1], 1_600_000_000, b"")]
    reader = BagStreamReader()
    heard = [item for byte in stream(messages) for item in reader.feed(bytes([byte]))]
    assert heard == said(messages)


@given(MESSAGES, st.integers(0, 400))
def test_what_is_cut_off_is_not_heard_in_part(messages, lost):
    data = stream(messages, chunked=False)
    heard = BagStreamReader().feed(data[: len(data) - min(lost, len(data))])
    assert heard == said(messages)[: len(heard)]


@given(st.binary(max_size=200), st.booleans())
def test_garbage_breaks_a_stream_once_or_is_waited_out(garbage, begins_well):
    reader = BagStreamReader()
    heard = [*reader.feed((MAGIC if begins_well else b"") + garbage), *reader.feed(garbage)]
    assert len(heard) <= 1
    assert all(isinstance(item, BrokenStream) for item in heard)


@pytest.mark.parametrize(
    "data",
    [
        b"HTTP/1.1 404\r\n\r\n",
        MAGIC + struct.pack("<I", 2**31),
        MAGIC + chunk_record(b"", Compression.BZ2),
        MAGIC + message_head(TOPICS[0].number) + time_bytes(1) + U32.pack(0),
        MAGIC + chunk_record(b"\1\0\0\0", Compression.NONE),
    ],
    ids=["another protocol", "a record without end", "packed", "a message of no connection", "a chunk of nonsense"],
)
def test_what_is_no_stream_is_told(data):
    reader = BagStreamReader()
    heard = [item for start in range(0, len(data), 7) for item in reader.feed(data[start : start + 7])]
    assert [type(item) for item in heard] == [BrokenStream]
    assert reader.feed(stream([(TOPICS[0], 1, b"")])) == []


@pytest.mark.parametrize("refused", [None, WatchRefusal('{"request":', "no")])
def test_a_status_comes_out_as_it_went_in(refused):
    status = WatchStatus(True, 0.5, 1.25, 3, 7, refused, 4)
    assert parse_status(SessionMessage(STATUS, "std_msgs/String", 1, status.data())) == status


def test_only_the_doors_own_topic_tells_a_status():
    data = WatchStatus(True, 0.5, 1.25, 3, 7).data()
    assert parse_status(SessionMessage("/hunt/wizard", "std_msgs/String", 1, data)) is None
    assert parse_status(SessionMessage(STATUS, "std_msgs/String", 1, b"\0\0\0\0{")) is None


# What watchers say


def wish(text: str) -> WatcherRequest:
    return WatcherRequest(text, json.loads(text))


def test_wishes_are_lines():
    guest = WatcherSession()
    assert guest.admitted
    assert list(guest.feed(b'{"request":"Pau')) == []
    events = list(guest.feed(b'se"}\n{"request":"Die","fields":{"robot":1}}\r\n'))
    assert events == [wish('{"request":"Pause"}'), wish('{"request":"Die","fields":{"robot":1}}')]


def test_a_key_comes_first():
    guest = WatcherSession(SingleKey("secret").identify)
    assert not guest.admitted
    assert list(guest.feed(key_line("secret") + b"{}\n")) == [WatcherAdmitted(), wish("{}")]
    assert guest.admitted
    assert not guest.rejected


@pytest.mark.parametrize("first", [key_line("Secret"), key_line("pépère"), b'{"key":1}\n', b'{"request":"Pause"}\n'])
def test_without_the_key_nobody_gets_in(first):
    guest = WatcherSession(SingleKey("secret").identify)
    (refusal,) = guest.feed(first + key_line("secret"))
    assert isinstance(refusal, WatchRefusal)
    assert "key" in refusal.reason
    assert guest.rejected
    assert not guest.admitted


def test_a_key_that_nobody_wants_does_no_harm():
    guest = WatcherSession()
    assert list(guest.feed(key_line("secret"))) == []
    assert not guest.rejected


def test_who_begins_in_another_language_is_sent_away_at_once():
    # A web page can make a browser post whatever it likes to a port of this machine.
    guest = WatcherSession()
    events = list(guest.feed(b'POST / HTTP/1.1\r\nHost: localhost\r\n\r\n{"request":"Die","fields":{"robot":0}}\n'))
    assert [type(event) for event in events] == [WatchRefusal]
    assert guest.rejected


def test_who_goes_on_and_on_is_sent_away_and_who_makes_a_mistake_is_not():
    guest = WatcherSession()
    for _ in guest.feed(b'{"request":"Pause"}\n' + b"nonsense\n" * (MISTAKES - 1) + b'{"request":"Pause"}\n'):
        pass
    assert not guest.rejected
    guest.granted()
    assert len(list(guest.feed(b"nonsense\n" * 2 * MISTAKES))) == MISTAKES
    assert guest.rejected


@pytest.mark.parametrize(
    "line", [b"[]", b"7", b'{"a":NaN}', b'{"a":1e999}', b'{"a":"\\ud800"}', b"[" * 60_000, b"\xff", b""]
)
def test_what_is_no_object_is_told_with_its_beginning(line):
    guest = WatcherSession()
    events = list(guest.feed(b"{}\n" + line + b"\n"))
    assert events[1] == WatchRefusal(line.decode(errors="replace")[:80], "the line is not a JSON object")
    assert not guest.rejected


def test_a_line_that_is_too_long_is_told_and_not_kept():
    guest = WatcherSession()
    (_, refusal, wished) = guest.feed(b"{}\n" + b"x" * 10 * LINE_LIMIT + b"\n{}\n")
    assert refusal == WatchRefusal("", "the line is too long")
    assert wished == wish("{}")


@given(st.lists(st.binary(max_size=40), max_size=10))
def test_no_bytes_surprise_a_guest(pieces):
    guest = WatcherSession()
    for piece in pieces:
        for event in guest.feed(piece):
            assert isinstance(event, WatcherRequest | WatchRefusal)
