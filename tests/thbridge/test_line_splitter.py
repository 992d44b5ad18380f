"""Lines of a byte stream: no cut of it and no length of a line makes a difference."""

from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from thbridge.line_splitter import LineSplitter, OverlongLine


def cut(data: bytes, places: list[int]) -> list[bytes]:
    """The bytes in segments, cut at these places (modulo their number)."""
    ends = sorted({place % (len(data) + 1) for place in places} | {0, len(data)})
    return [data[start:end] for start, end in pairwise(ends)]


def feed(segments: list[bytes], limit: int = 64) -> list[str | OverlongLine]:
    splitter = LineSplitter(limit)
    return [line for segment in segments for line in splitter.feed(segment)]


def test_lines_end_in_lf_or_crlf_and_several_may_share_a_segment() -> None:
    assert feed([b"one\ntwo\r\n\r\n\nthr", b"ee\r", b"\nrest"]) == ["one", "two", "", "", "three"]


def test_bytes_that_are_not_utf8_are_replaced() -> None:
    assert feed([b"a\xff\xfeb\n"]) == ["a\ufffd\ufffdb"]


def test_a_character_may_be_cut_in_two() -> None:
    assert feed([b"caf\xc3", b"\xa9\n"]) == ["caf\u00e9"]


def test_a_line_of_exactly_the_limit_is_read_and_one_byte_more_is_not() -> None:
    assert feed([b"x" * 64 + b"\n" + b"y" * 65 + b"\nz\n"]) == ["x" * 64, OverlongLine(65), "z"]


LINES = st.lists(st.binary(max_size=100) | st.sampled_from([b"%%ack ", b"x" * 63 + b"\r", b"y" * 65]), max_size=6)


@given(LINES.map(b"\n".join), st.lists(st.integers(0, 500), max_size=10))
def test_how_a_stream_is_cut_makes_no_difference(data: bytes, places: list[int]) -> None:
    whole = feed([data])
    assert feed(cut(data, places)) == whole
    assert feed([bytes([byte]) for byte in data]) == whole


@given(LINES.map(b"\n".join), st.binary(max_size=20).filter(lambda tail: b"\n" not in tail))
def test_a_truncated_line_is_never_handed_out(data: bytes, tail: bytes) -> None:
    assert feed([data + b"\n" + tail]) == feed([data + b"\n"])


def test_an_endless_line_takes_no_memory() -> None:
    splitter = LineSplitter(64)
    for _ in range(1000):
        assert splitter.feed(b"x" * 1024) == []
        assert len(splitter._held) <= 64
    assert splitter.feed(b"\n%%ack \n") == [OverlongLine(1_024_000), "%%ack "]
