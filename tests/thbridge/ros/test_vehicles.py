"""Robots as MAVLink vehicles on the topics of mavros; rosbags judges the bytes."""

import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.ros.messages import pack, types, unpack
from thbridge.ros.messages.records import MavlinkFrame, VehicleState
from thbridge.ros.messages.stamps import stamp_ns

BYTES = st.integers(0, 255)
FRAMES = st.builds(
    MavlinkFrame,
    link=st.text(max_size=30),
    magic=st.sampled_from([254, 253]),
    incompat_flags=BYTES,
    compat_flags=BYTES,
    sequence=BYTES,
    system=BYTES,
    component=BYTES,
    message_id=st.integers(0, 2**24 - 1),
    checksum=st.integers(0, 2**16 - 1),
    payload=st.binary(max_size=255),
)
STATES = st.builds(VehicleState, system_status=BYTES)


@given(st.integers(0, 10**6), FRAMES)
def test_a_frame_is_what_mavros_says_of_it(tick: int, frame: MavlinkFrame):
    data = pack.mavlink(tick, frame)
    said = types.typestore().deserialize_ros1(data, "mavros_msgs/msg/Mavlink")
    assert said.header.frame_id == frame.link
    assert said.header.stamp.sec * 10**9 + said.header.stamp.nanosec == stamp_ns(tick)
    assert (said.framing_status, said.magic, said.len) == (said.FRAMING_OK, frame.magic, len(frame.payload))
    assert (said.incompat_flags, said.compat_flags) == (frame.incompat_flags, frame.compat_flags)
    assert (said.seq, said.sysid, said.compid) == (frame.sequence, frame.system, frame.component)
    assert (said.msgid, said.checksum, len(said.signature)) == (frame.message_id, frame.checksum, 0)
    # As libmavconn's converter: little-endian words, the last one filled up.
    assert said.payload64.astype("<u8").tobytes()[: said.len] == frame.payload
    assert len(said.payload64) == (said.len + 7) // 8


@given(FRAMES)
def test_a_frame_is_read_as_it_was_written(frame: MavlinkFrame):
    assert unpack.mavlink(pack.mavlink(5, frame)) == frame


@given(FRAMES, st.data())
def test_a_message_that_is_cut_off_is_none(frame: MavlinkFrame, data: st.DataObject):
    whole = pack.mavlink(5, frame)
    # Its end is the length of the signature, which is not read.
    cut = data.draw(st.integers(0, len(whole) - 5))
    with pytest.raises(ValueError, match="too early"):
        unpack.mavlink(whole[:cut])


def test_a_frame_that_was_damaged_or_cannot_be_is_none():
    frame = MavlinkFrame("a", 253, 0, 0, 1, 255, 190, 0, 7, bytes(9))
    whole = bytearray(pack.mavlink(0, frame))
    status = len(pack.header(0, "a"))
    whole[status] = 2
    with pytest.raises(ValueError, match="framing status 2"):
        unpack.mavlink(bytes(whole))
    whole[status], whole[status + 2] = 1, 17
    with pytest.raises(ValueError, match="17 bytes are not in 2 words"):
        unpack.mavlink(bytes(whole))


@given(st.binary(max_size=200))
def test_any_bytes_are_a_frame_or_refused(data: bytes):
    with contextlib.suppress(ValueError):
        unpack.mavlink(data)


@given(st.integers(0, 10**6), STATES)
def test_a_state_is_what_mavros_says_of_it(tick: int, state: VehicleState):
    said = types.typestore().deserialize_ros1(pack.vehicle_state(tick, state), "mavros_msgs/msg/State")
    for name in ("connected", "armed", "guided", "manual_input", "mode", "system_status"):
        assert getattr(said, name) == getattr(state, name)
