"""Frames are found in whatever surrounds them."""

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import all as mav

from tests.support.mavlink.random_frames import frames
from thbridge.mavlink.wire.dialect import crc_extra, payload_of
from thbridge.mavlink.wire.frames.frame import LARGEST, V1, V2, Frame, checksum_of
from thbridge.mavlink.wire.frames.framer import DiscardedBytes, FrameFault, FrameParser, frame_of, parse_datagram

HEARTBEAT = Frame(255, 190, 7, 0, payload_of(mav.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)), 50)
NEXT = Frame(255, 190, 8, 0, HEARTBEAT.payload, 50)
OLD = Frame(255, 190, 7, 0, HEARTBEAT.payload, 50, V1)
SETUP = mav.MAVLink_setup_signing_message(1, 1, list(range(1, 33)), 5)
SECRET = Frame(255, 190, 9, 256, payload_of(SETUP), crc_extra(256))

chunks = st.lists(frames() | st.binary(min_size=1, max_size=40), max_size=8)


def as_bytes(chunk):
    return chunk.to_bytes() if isinstance(chunk, Frame) else chunk


def fed(pieces):
    framer = FrameParser()
    found = []
    for piece in pieces:
        found += framer.receive_data(piece)
        assert len(framer._held) < LARGEST
    return found + framer.end()


def good(found):
    return [item for item in found if isinstance(item, Frame)]


def size_of(found):
    return sum(item.size for item in found)


@given(st.lists(frames(), max_size=6))
def test_frames_in_a_row_come_back_whole_and_alone(said):
    assert parse_datagram(b"".join(frame.to_bytes() for frame in said)) == said


@given(st.lists(frames(), max_size=6))
def test_pymavlink_reads_the_same(said):
    data = b"".join(frame.to_bytes() for frame in said)
    theirs = mav.MAVLink(None).parse_buffer(data) or []
    ours = good(parse_datagram(data))
    assert [bytes(message.get_msgbuf()) for message in theirs] == [frame.to_bytes() for frame in ours]


@given(chunks, st.data())
def test_the_pieces_that_bytes_come_in_change_no_frame_and_lose_no_byte(said, data):
    stream = b"".join(as_bytes(chunk) for chunk in said)
    cuts = sorted(data.draw(st.lists(st.integers(0, len(stream)), max_size=10)))
    pieces = [stream[begin:end] for begin, end in zip([0, *cuts], [*cuts, len(stream)], strict=True)]
    whole, parts, single = fed([stream]), fed(pieces), fed([bytes((byte,)) for byte in stream])
    assert good(whole) == good(parts) == good(single)
    assert size_of(whole) == size_of(parts) == size_of(single) == len(stream)


@given(frames(), st.binary(max_size=300).filter(lambda data: V1 not in data and V2 not in data))
def test_garbage_around_a_frame_is_noise(frame, garbage):
    noise = [DiscardedBytes(len(garbage), FrameFault.GARBAGE)] if garbage else []
    assert parse_datagram(garbage + frame.to_bytes() + garbage) == [*noise, frame, *noise]


def test_a_frame_is_given_with_its_last_byte():
    framer = FrameParser()
    data = HEARTBEAT.to_bytes()
    assert framer.receive_data(data[:-1]) == []
    assert framer.receive_data(data[-1:]) == [HEARTBEAT]


def test_what_is_cut_off_is_noise_only_when_nothing_follows():
    framer = FrameParser()
    assert framer.receive_data(HEARTBEAT.to_bytes()[:-1]) == []
    assert framer.end() == [DiscardedBytes(HEARTBEAT.size - 1, FrameFault.CUT)]
    assert framer.receive_data(NEXT.to_bytes()) == [NEXT]


@pytest.mark.parametrize("place", range(HEARTBEAT.size))
def test_one_wrong_byte_anywhere_costs_no_frame_behind_it(place):
    spoiled = bytearray(HEARTBEAT.to_bytes())
    spoiled[place] ^= 0x55
    found = fed([bytes(spoiled) + NEXT.to_bytes()])
    assert good(found)[-1] == NEXT
    assert size_of(found) == HEARTBEAT.size + NEXT.size


def test_a_length_that_reaches_over_the_next_frames_costs_none_of_them():
    spoiled = bytearray(HEARTBEAT.to_bytes())
    spoiled[1] = 255
    framer = FrameParser()
    assert framer.receive_data(bytes(spoiled) + NEXT.to_bytes()) == []
    assert (
        framer.receive_data(NEXT.to_bytes() * 20) == [DiscardedBytes(HEARTBEAT.size, FrameFault.CHECKSUM)] + [NEXT] * 21
    )


def test_flags_that_nobody_knows_are_refused_and_compat_flags_are_not():
    strange = Frame(255, 190, 7, 0, HEARTBEAT.payload, 50, incompat_flags=2)
    assert parse_datagram(strange.to_bytes()) == [DiscardedBytes(strange.size, FrameFault.FLAGS)]
    kind = Frame(255, 190, 7, 0, HEARTBEAT.payload, 50, compat_flags=0x80)
    assert parse_datagram(kind.to_bytes()) == [kind]


def test_a_signature_comes_with_its_frame():
    signed = Frame(255, 190, 7, 0, HEARTBEAT.payload, 50, incompat_flags=1, signature=bytes(range(13)))
    assert parse_datagram(signed.to_bytes() + NEXT.to_bytes()) == [signed, NEXT]


def test_an_unknown_message_is_one_piece_of_noise():
    unknown = Frame(255, 190, 7, 54_321, b"\xfd\xfe" * 20, 0)
    assert crc_extra(54_321) is None
    assert parse_datagram(unknown.to_bytes() * 2) == [DiscardedBytes(unknown.size, FrameFault.UNKNOWN)] * 2


def test_a_message_of_version_1_is_never_longer_than_we_know_it_and_one_of_version_2_may_be():
    long = Frame(255, 190, 7, 0, HEARTBEAT.payload + b"more", 50)
    assert parse_datagram(long.to_bytes()) == [long]
    old = Frame(255, 190, 7, 0, HEARTBEAT.payload + b"more", 50, V1)
    assert parse_datagram(old.to_bytes()) == [DiscardedBytes(old.size, FrameFault.LENGTH)]
    assert parse_datagram(OLD.to_bytes()) == [OLD]


def test_a_signing_key_does_not_get_in():
    assert parse_datagram(SECRET.to_bytes() + NEXT.to_bytes()) == [DiscardedBytes(SECRET.size, FrameFault.SECRET), NEXT]


def test_one_frame_is_one_frame():
    assert frame_of(HEARTBEAT.to_bytes()) == HEARTBEAT
    assert frame_of(HEARTBEAT.to_bytes() * 2) is None
    assert frame_of(HEARTBEAT.to_bytes() + b"x") is None
    assert frame_of(SECRET.to_bytes()) is None
    assert frame_of(b"") is None


@pytest.mark.parametrize("flood", [b"\xfd", b"\xfe", b"\xfd\xfd\x00", b"\xfd\xff\x01", b"\xfe\x09", b"\xfd\xfe"])
def test_a_flood_of_magic_bytes_is_noise_and_leaves_the_next_frame_alone(flood):
    found = fed([flood * 2000, HEARTBEAT.to_bytes(), b"\0" * LARGEST])
    assert good(found) == [HEARTBEAT]


def test_work_is_in_proportion_to_the_bytes(monkeypatch):
    """Counted in bytes whose checksum is taken: at most one longest frame for each byte that comes in."""
    summed = []
    monkeypatch.setattr(
        "thbridge.mavlink.wire.frames.framer.checksum_of",
        lambda head, seed: summed.append(len(head)) or checksum_of(head, seed),
    )
    worst = bytes((V2, 255, 0, 0, 0, 1, 1, 0, 0, 0))
    for size in (10_000, 20_000):
        summed.clear()
        fed([(worst * (size // len(worst)))])
        assert sum(summed) <= size / len(worst) * LARGEST


def test_random_bytes_hold_no_frame():
    noise = random.Random(1).randbytes(300_000)
    found = fed([noise[place : place + 1500] for place in range(0, len(noise), 1500)])
    assert good(found) == []
    assert size_of(found) == len(noise)
