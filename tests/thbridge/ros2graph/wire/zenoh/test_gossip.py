"""Gossip of zenoh. The tests of the carrier send it to the library."""

from hypothesis import given
from hypothesis import strategies as st

from thbridge.ros2graph.wire.zenoh.gossip import cookie_of, gossip, init_request, open_request


def test_bytes_of_the_messages():
    assert init_request(bytes(range(16))) == bytes([19, 0, 0x01, 9, 0xF1, *range(16)])
    assert open_request(b"ab") == bytes([6, 0, 0x42, 10, 0, 2, *b"ab"])
    named = bytes([1, 7, 0, 1, 2, 0xBC, 0x0A, 2, 1, 5, *b"tcp/x", 0])
    assert gossip({"abc": "tcp/x"}) == bytes([len(named) + 5, 0, 0x25, 0, 0x5F, 1, len(named), *named])


@given(st.booleans(), st.binary(min_size=1, max_size=16), st.binary(max_size=300), st.binary(max_size=9))
def test_the_cookie_of_an_answer(has_sizes, peer, cookie, extensions):
    size = bytes([len(cookie)]) if len(cookie) < 128 else bytes([len(cookie) % 128 + 128, len(cookie) // 128])
    begin = bytes([0xE1 if has_sizes else 0xA1, 9, (len(peer) - 1) << 4 | 1, *peer, *([2, 255, 255] * has_sizes)])
    answer = begin + size + cookie
    assert cookie_of(answer + extensions) == cookie
    assert all(cookie_of(answer[:end]) is None for end in range(len(answer)))


@given(st.binary(max_size=40))
def test_other_bytes_never_fail(data):
    assert cookie_of(data) is None or data[0] & 0x3F == 0x21
