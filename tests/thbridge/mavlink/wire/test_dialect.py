"""Every message of the dialect, packed and read as pymavlink does."""

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import all as mav

from thbridge.mavlink.wire.dialect import decoded, longest_payload, payload_of, target_of

# pymavlink's own tests' message has a field of one character, which pymavlink itself cannot pack when it is zero.
SPOKEN = sorted(set(mav.mavlink_map) - {mav.MAVLINK_MSG_ID_TEST_TYPES})


@given(st.sampled_from(SPOKEN), st.randoms(use_true_random=False))
def test_every_message_is_packed_and_read_as_pymavlink_does(message_id, chance):
    size = longest_payload(message_id)
    raw = chance.randbytes(chance.randint(1, size))
    message = decoded(message_id, raw)
    packer = mav.MAVLink(None)
    message.pack(packer)
    assert payload_of(message) == bytes(message.get_payload())
    frame = bytes(message.pack(packer))
    assert str(packer.decode(bytearray(frame))) == str(decoded(message_id, payload_of(message)))


def test_no_message_is_unknown_to_the_packer():
    for message_id in SPOKEN:
        message = decoded(message_id, b"")
        assert type(message) is mav.mavlink_map[message_id]
        assert payload_of(message) == b"\0"


def test_a_field_that_does_not_fit_is_an_error():
    with pytest.raises(struct.error):
        payload_of(mav.MAVLink_heartbeat_message(256, 0, 0, 0, 0, 3))
    with pytest.raises(struct.error):
        payload_of(mav.MAVLink_battery_status_message(0, 0, 1, 2, [1, 2], -1, -1, -1, 55))


def test_driving_by_hand_names_its_system_too():
    assert target_of(mav.MAVLink_manual_control_message(3, 0, 0, 0, 0, 0)) == (3, 0)
