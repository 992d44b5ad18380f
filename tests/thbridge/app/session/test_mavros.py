"""MAVLink's frames as messages of mavros, and back."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.app.session.mavros import frame_in, frame_record
from thbridge.mavlink.wire.dialect import crc_extra, mav
from thbridge.mavlink.wire.frames.frame import SIGNED, V1, V2, Frame
from thbridge.mavlink.wire.traffic import Traffic
from thbridge.ros.messages import pack, unpack
from thbridge.ros.messages.records import MavlinkFrame

BYTES = st.integers(0, 255)


@st.composite
def frames(draw: st.DrawFn) -> Frame:
    message_id = draw(st.sampled_from(sorted(mav.mavlink_map)))
    version = V2 if message_id > 255 else draw(st.sampled_from([V1, V2]))
    flags = draw(BYTES) if version == V2 else 0
    numbers = (draw(BYTES), draw(BYTES), draw(BYTES), message_id)
    return Frame(*numbers, draw(st.binary(max_size=255)), crc_extra(message_id) or 0, version, 0, flags)


def heard(frame: Frame) -> MavlinkFrame:
    return unpack.mavlink(pack.mavlink(0, frame_record(Traffic(0, True, "a", frame)).frame))


@given(frames())
def test_a_frame_comes_back_from_its_topic(frame: Frame):
    assert frame_in(heard(frame)) == frame


def test_a_signature_is_left_behind():
    frame = Frame(1, 1, 0, 0, bytes(9), crc_extra(0) or 0)
    assert frame_in(heard(replace(frame, incompat_flags=SIGNED))) == frame


@pytest.mark.parametrize(
    ("wrong", "why"),
    [
        ({"magic": 252}, "the frame begins with 252"),
        ({"message_id": 0xFFFFFF}, "the MAVLink message 16777215 is unknown"),
        ({"checksum": 1}, "the checksum is 1, but should be"),
        ({"sequence": 9}, "the checksum is"),
    ],
)
def test_what_is_no_frame_is_refused(wrong: dict[str, int], why: str):
    frame = heard(Frame(1, 1, 0, 0, bytes(9), crc_extra(0) or 0))
    with pytest.raises(ValueError, match=why):
        frame_in(replace(frame, **wrong))
