"""Attachments of messages: the bytes of rmw_zenoh since 0.2.4."""

from hypothesis import given
from hypothesis import strategies as st

from thbridge.ros2graph.wire.zenoh.attachments import Attachment

NUMBERS = st.integers(-(1 << 63), (1 << 63) - 1)


def test_bytes_of_an_attachment():
    assert Attachment(1, 2, bytes(range(16))).write() == bytes(
        [1, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 16, *range(16)]
    )


@given(NUMBERS, NUMBERS, st.binary(min_size=16, max_size=16))
def test_a_written_attachment_is_read_again(number, time_ns, gid):
    attachment = Attachment(number, time_ns, gid)
    assert Attachment.read(attachment.write()) == attachment


@given(st.binary(max_size=40).filter(lambda data: len(data) != 33 or data[16] != 16))
def test_other_bytes_are_none(data):
    assert Attachment.read(data) is None
