"""Frames and headers of TCPROS."""

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.thbridge.rosgraph.wire.cut_streams import cut, places
from thbridge.rosgraph.wire.tcpros import (
    FrameBuffer,
    MalformedHeader,
    OverlongFrame,
    decode_header,
    encode_header,
    frame,
)

LIMIT = 64
names = st.text(st.characters(exclude_characters="=", exclude_categories=["Cs"]), min_size=1).filter(
    lambda name: name == name.strip()
)
values = st.text(st.characters(exclude_categories=["Cs"]))


@given(st.dictionaries(names, values))
def test_a_header_comes_back(fields):
    encoded = encode_header(fields)
    assert struct.unpack_from("<I", encoded) == (len(encoded) - 4,)
    assert decode_header(encoded[4:]) == fields


def test_a_header_is_what_the_specification_shows():
    # https://wiki.ros.org/ROS/Connection%20Header
    assert encode_header({"topic": "/chatter", "callerid": "/a"}) == (
        b"\x21\x00\x00\x00\x0b\x00\x00\x00callerid=/a\x0e\x00\x00\x00topic=/chatter"
    )


def test_of_a_field_given_twice_the_last_counts():
    assert decode_header(frame(b"a=1") + frame(b"a=2")) == {"a": "2"}


def test_a_value_may_hold_equals_signs_and_letters_of_another_encoding():
    assert decode_header(frame(b"message_definition=int8 A=1 # 5\xb0")) == {
        "message_definition": "int8 A=1 # 5\N{REPLACEMENT CHARACTER}"
    }


@pytest.mark.parametrize("body", [b"\x01\x00", frame(b"abc"), frame(b""), struct.pack("<I", 9) + b"a=1"])
def test_what_is_no_header_is_told(body):
    assert isinstance(decode_header(body), MalformedHeader)


@given(st.binary())
def test_no_bytes_make_the_header_raise(body):
    decode_header(body)


@given(st.lists(st.binary(max_size=LIMIT)), places)
def test_frames_come_out_however_the_stream_is_cut(bodies, where):
    buffer = FrameBuffer()
    taken = []
    for segment in cut(b"".join(map(frame, bodies)), where):
        buffer.feed(segment)
        while (body := buffer.take(LIMIT)) is not None:
            taken.append(body)
        assert len(buffer) < LIMIT + 4
    assert taken == bodies
    assert len(buffer) == 0


def test_a_frame_beyond_the_limit_is_told_before_it_came():
    buffer = FrameBuffer()
    buffer.feed(struct.pack("<I", LIMIT + 1))
    assert buffer.take(LIMIT) == OverlongFrame(LIMIT + 1, LIMIT)
