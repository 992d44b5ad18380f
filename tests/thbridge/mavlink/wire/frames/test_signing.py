"""Signatures, ours and pymavlink's against each other."""

import hashlib

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import all as mav

from tests.support.mavlink.random_frames import frames
from thbridge.mavlink.wire.dialect import payload_of
from thbridge.mavlink.wire.frames.frame import V1, V2, Frame
from thbridge.mavlink.wire.frames.framer import frame_of
from thbridge.mavlink.wire.frames.signing import (
    EPOCH,
    FIRST_TIMESTAMP_TOLERANCE,
    LATEST,
    MAX_STREAMS,
    InvalidKey,
    KnownTimestamps,
    RejectedFrame,
    SignatureFault,
    SignatureTimestamps,
    Signing,
    SigningKey,
    parse_key,
)

KEY = SigningKey(bytes(range(32)))
NOW = 1_763_000_000.0
UNITS = int((NOW - EPOCH) * 100_000)
HEARTBEAT = mav.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)
FRAME = Frame(255, 190, 7, 0, payload_of(HEARTBEAT), 50)


def ours(link_id=3, key=KEY):
    return Signing(key, link_id, SignatureTimestamps())


def theirs(timestamp=UNITS, system=255, component=190, link_id=0, key=KEY):
    peer = mav.MAVLink(None, system, component)
    peer.signing.secret_key = key.secret
    peer.signing.sign_outgoing = True
    peer.signing.timestamp = timestamp
    peer.signing.link_id = link_id
    return peer


def said(peer):
    return frame_of(bytes(HEARTBEAT.pack(peer)))


def test_pymavlink_believes_us():
    peer, signing = theirs(), ours()
    for _ in range(3):
        message = peer.decode(bytearray(signing.sign(FRAME, NOW)))
        assert message.get_signed()
        assert message.get_link_id() == 3
    assert peer.signing.goodsig_count == 3


@given(frames())
def test_we_believe_pymavlink_and_the_frame_is_as_it_was(frame):
    wrapped = frame_of(ours().sign(frame, NOW))
    unwrapped = ours().verify(wrapped, NOW)
    assert (unwrapped.payload, unwrapped.message_id, unwrapped.version) == (frame.payload, frame.message_id, V2)
    assert (unwrapped.incompat_flags, unwrapped.signature) == (0, b"")


def test_we_believe_pymavlink():
    peer, signing = theirs(), ours()
    frame = said(peer)
    assert signing.verify(frame, NOW) == frame.unsigned()


def test_what_is_not_signed_is_refused():
    assert ours().verify(FRAME, NOW) == RejectedFrame(SignatureFault.UNSIGNED)
    radio = mav.MAVLink_radio_status_message(1, 1, 1, 1, 1, 1, 1)
    frame = Frame(51, 68, 0, radio.get_msgId(), payload_of(radio), radio.crc_extra)
    assert ours().verify(frame, NOW) == RejectedFrame(SignatureFault.UNSIGNED)


def test_another_key_is_refused():
    assert ours().verify(said(theirs(key=SigningKey(b"k" * 32))), NOW) == RejectedFrame(SignatureFault.WRONG)


@given(st.integers(0, 13 * 8 - 1))
def test_any_other_bit_in_a_signature_is_refused(bit):
    frame = said(theirs())
    spoiled = bytearray(frame.signature)
    spoiled[bit // 8] ^= 1 << bit % 8
    forged = Frame(255, 190, frame.sequence, 0, frame.payload, 50, V2, 1, 0, bytes(spoiled))
    assert ours().verify(forged, NOW) == RejectedFrame(SignatureFault.WRONG)


def test_another_payload_under_a_signature_is_refused():
    frame = said(theirs())
    forged = Frame(255, 190, frame.sequence, 0, b"\x01" + frame.payload[1:], 50, V2, 1, 0, frame.signature)
    assert ours().verify(forged, NOW) == RejectedFrame(SignatureFault.WRONG)


def test_a_frame_counts_once():
    signing, frame = ours(), said(theirs())
    signing.verify(frame, NOW)
    assert signing.verify(frame, NOW) == RejectedFrame(SignatureFault.REPEATED)


def test_a_frame_of_one_link_is_not_believed_again_on_another():
    timestamps, frame = SignatureTimestamps(), said(theirs())
    Signing(KEY, 0, timestamps).verify(frame, NOW)
    assert Signing(KEY, 1, timestamps).verify(frame, NOW) == RejectedFrame(SignatureFault.REPEATED)


def test_an_older_frame_behind_a_newer_is_refused_but_streams_do_not_mix():
    signing, peer = ours(), theirs()
    first, second = said(peer), said(peer)
    assert signing.verify(second, NOW) == second.unsigned()
    assert signing.verify(first, NOW) == RejectedFrame(SignatureFault.REPEATED)
    other = said(theirs(UNITS, component=191))
    assert signing.verify(other, NOW) == other.unsigned()
    elsewhere = said(theirs(UNITS, link_id=1))
    assert signing.verify(elsewhere, NOW) == elsewhere.unsigned()


@pytest.mark.parametrize(
    ("late", "refused"), [(FIRST_TIMESTAMP_TOLERANCE, False), (FIRST_TIMESTAMP_TOLERANCE + 1, True)]
)
def test_a_new_sender_may_be_a_minute_late(late, refused):
    assert isinstance(ours().verify(said(theirs(UNITS - late)), NOW), RejectedFrame) is refused


def test_after_a_restart_nothing_is_accepted_again():
    before, peer = SignatureTimestamps(), theirs()
    first, second = said(peer), said(peer)
    assert Signing(KEY, 0, before).verify(first, NOW) == first.unsigned()
    again = Signing(KEY, 0, SignatureTimestamps(before.known))
    assert again.verify(first, NOW + 1) == RejectedFrame(SignatureFault.REPEATED)
    assert again.verify(second, NOW + 1) == second.unsigned()
    new = said(theirs(UNITS, component=191))
    assert again.verify(new, NOW + 1) == new.unsigned()


def test_where_nothing_is_known_of_earlier_programs_only_what_is_signed_after_the_start_is_accepted():
    timestamps = SignatureTimestamps(None, not_before=NOW)
    assert Signing(KEY, 0, timestamps).verify(said(theirs(UNITS - 1)), NOW + 5) == RejectedFrame(SignatureFault.BEFORE)
    assert isinstance(Signing(KEY, 0, timestamps).verify(said(theirs(UNITS)), NOW + 5), Frame)


def test_a_restart_with_many_senders_has_room_for_new_ones_and_accepts_nothing_again():
    late = FIRST_TIMESTAMP_TOLERANCE
    streams = {(link, system, 190): UNITS - late - 1 for link in range(4) for system in range(1, 250)}
    timestamps = SignatureTimestamps(KnownTimestamps(UNITS, {**streams, (9, 9, 190): UNITS - late}))
    assert timestamps.known.streams == {(9, 9, 190): UNITS - late}
    assert timestamps.check((0, 1, 190), UNITS - late - 1, NOW) is SignatureFault.OLD


def test_a_known_sender_may_be_later_than_that_by_our_clock():
    signing, peer = ours(), theirs()
    signing.verify(said(peer), NOW)
    assert isinstance(signing.verify(said(peer), NOW + 120), Frame)


def test_a_wrong_signature_teaches_no_time():
    signing = ours()
    signing.verify(said(theirs(UNITS + 10 * FIRST_TIMESTAMP_TOLERANCE, key=SigningKey(b"k" * 32))), NOW)
    assert isinstance(signing.verify(said(theirs()), NOW), Frame)


def test_we_sign_later_than_anything_that_was_believed():
    signing, ahead = ours(), UNITS + 10 * FIRST_TIMESTAMP_TOLERANCE
    signing.verify(said(theirs(ahead)), NOW)
    stamp = int.from_bytes(frame_of(signing.sign(FRAME, NOW)).signature[1:7], "little")
    assert stamp == ahead + 1
    assert theirs(ahead).decode(bytearray(signing.sign(FRAME, NOW))).get_signed()


def test_no_two_timestamps_are_equal_even_when_the_clock_stands_or_goes_back():
    timestamps = SignatureTimestamps()
    used = [timestamps.next(now) for now in (NOW, NOW, NOW - 3600, NOW, NOW + 1, NOW)]
    assert used == sorted(set(used))
    assert used[0] == UNITS


def test_a_clock_before_2015_signs_all_the_same():
    assert SignatureTimestamps().next(0.0) == 1


def test_the_end_of_all_timestamps_is_not_believed():
    signing = ours()
    assert signing.verify(said(theirs((1 << 48) - 1)), NOW) == RejectedFrame(SignatureFault.FAR_AHEAD)
    assert isinstance(signing.verify(said(theirs(LATEST)), NOW), Frame)
    assert signing.sign(FRAME, NOW)


def test_senders_without_end_are_not_remembered():
    signing, peer = ours(), theirs()
    for number in range(MAX_STREAMS):
        peer.srcSystem, peer.srcComponent = number // 256 + 1, number % 256
        assert isinstance(signing.verify(said(peer), NOW), Frame)
    peer.srcSystem = 200
    assert signing.verify(said(peer), NOW) == RejectedFrame(SignatureFault.CROWDED)
    peer.srcSystem = 1
    assert isinstance(signing.verify(said(peer), NOW), Frame)


def test_a_frame_of_version_1_is_signed_as_one_of_version_2():
    old = Frame(255, 190, 7, 0, FRAME.payload, 50, V1)
    assert theirs().decode(bytearray(ours().sign(old, NOW))).get_signed()


@pytest.mark.parametrize(
    ("content", "secret"),
    [
        (bytes(range(32)), bytes(range(32))),
        (b"sesame", hashlib.sha256(b"sesame").digest()),
        (b"sesame\n", hashlib.sha256(b"sesame").digest()),
        (b"open sesame\r\n", hashlib.sha256(b"open sesame").digest()),
        # 31 characters and their end of line are 32 bytes, and yet a passphrase.
        (b"p" * 31 + b"\n", hashlib.sha256(b"p" * 31).digest()),
        (b"p" * 32, hashlib.sha256(b"p" * 32).digest()),
        ("Schlüssel\n".encode(), hashlib.sha256("Schlüssel".encode()).digest()),
        (bytes(range(32)).hex().encode() + b"\n", bytes(range(32))),
    ],
)
def test_a_key_is_raw_or_hexadecimal_or_the_hash_of_a_passphrase(content, secret):
    assert parse_key(content) == SigningKey(secret)


@pytest.mark.parametrize("content", [b"", b"\n", b"  \n", bytes(31), bytes(range(1, 34)), b"two\nlines\n"])
def test_what_is_no_key_is_refused(content):
    assert isinstance(parse_key(content), InvalidKey)


def test_the_text_of_a_key_does_not_show_it():
    assert str(KEY.secret) not in repr(KEY)
    assert repr(KEY) == "SigningKey()"
