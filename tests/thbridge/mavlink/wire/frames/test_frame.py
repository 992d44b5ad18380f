"""Our frames and messages against pymavlink's own."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import all as mav

from thbridge.mavlink.wire.dialect import crc_extra, decoded, payload_of, target_of
from thbridge.mavlink.wire.frames.frame import Frame

SOME = [
    mav.MAVLink_heartbeat_message(10, 0, 1, 4, 4, 3),
    mav.MAVLink_param_value_message(b"A_NAME_OF_16_CHR", 1.5, 9, 300, 7),
    mav.MAVLink_battery_status_message(0, 0, 1, 2, list(range(10)), -1, -1, -1, 55, 0, 0, [1, 2, 3, 4], 0, 0),
    mav.MAVLink_command_long_message(3, 1, 400, 0, 1.0, math.inf, 0, 0, 0, 0, 0),
    mav.MAVLink_statustext_message(6, b"a sentence", 0, 0),
]


@pytest.mark.parametrize("message", SOME, ids=lambda message: message.msgname)
@given(st.integers(1, 255), st.integers(0, 255), st.integers(0, 255))
def test_a_frame_is_the_one_that_pymavlink_packs(message, system, component, sequence):
    packer = mav.MAVLink(None, system, component)
    packer.seq = sequence
    seed = crc_extra(message.get_msgId())
    frame = Frame(system, component, sequence, message.get_msgId(), payload_of(message), seed)
    assert frame.to_bytes() == message.pack(packer)


@pytest.mark.parametrize("message", SOME, ids=lambda message: message.msgname)
def test_a_payload_gives_its_message_back(message):
    again = decoded(message.get_msgId(), payload_of(message))
    assert again.to_dict() == message.to_dict()


def test_a_short_payload_is_filled_with_zeros_and_a_long_one_cut():
    heartbeat = SOME[0]
    assert decoded(0, payload_of(heartbeat)[:4]).type == 0
    assert decoded(0, payload_of(heartbeat) + b"more").to_dict() == heartbeat.to_dict()


def test_who_is_meant_is_in_the_message_or_else_everybody():
    assert target_of(SOME[3]) == (3, 1)
    assert target_of(SOME[0]) == (0, 0)
