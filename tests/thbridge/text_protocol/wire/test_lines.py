"""Framing, tokens and messages of the text protocol."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.text_protocol.wire.lines import (
    ROUTED,
    LineSplitter,
    OverlongLine,
    TextMessage,
    UnreadableText,
    encode_line,
    parse_line,
    tokens,
)

WORDS = st.text(st.characters(exclude_characters=" \t\n\r\x0b\x0c", codec="utf-8"), min_size=1, max_size=8)
MESSAGES = st.builds(TextMessage, st.sampled_from(sorted(ROUTED)), WORDS, WORDS, st.lists(WORDS, max_size=5).map(tuple))


def cut(data: bytes, places: list[int]) -> list[bytes]:
    """The bytes in segments, cut at these places (modulo their number)."""
    ends = sorted({place % (len(data) + 1) for place in places} | {0, len(data)})
    return [data[start:end] for start, end in pairwise(ends)]


def feed(segments: list[bytes], limit: int = 64) -> list[str | OverlongLine]:
    splitter = LineSplitter(limit)
    return [line for segment in segments for line in splitter.feed(segment)]


@given(MESSAGES)
def test_a_message_survives_the_wire(message: TextMessage) -> None:
    assert parse_line(message.line()) == message


@given(MESSAGES)
def test_a_line_ends_in_exactly_one_blank(message: TextMessage) -> None:
    assert message.line().endswith(" ")
    assert not message.line().endswith("  ")


def test_a_message_without_content_ends_in_one_blank_too() -> None:
    assert TextMessage("%%where", "TabUI", "SimR").line() == "%%where TabUI SimR "


def test_tokens_are_rejoined_by_single_blanks() -> None:
    message = parse_line(' %%error  TabUI\tHider   "3"  ')
    assert isinstance(message, TextMessage)
    assert message.line() == '%%error TabUI Hider "3" '


def test_send_is_unwrapped_to_the_inner_message() -> None:
    assert parse_line("%%send A B %%goto TabUI SimR 0 3 3 45") == TextMessage(
        "%%goto", "TabUI", "SimR", ("0", "3", "3", "45")
    )


@pytest.mark.parametrize(
    "line",
    [
        "",
        " ",
        "hello A B c",
        "%goto A B c",
        "%%gotox A B c",
        "%%GOTO A B c",
        "%%goto",
        "%%goto A",
        "%%send",
        "%%send A B",
        "%%send A B %%goto C",
        "%%setid A B",
        "%%ack A B",
        "%%ping A B",
    ],
)
def test_what_is_no_routed_message_is_unreadable(line: str) -> None:
    assert isinstance(parse_line(line), UnreadableText)


def test_an_unreadable_line_says_what_it_lacks() -> None:
    assert parse_line("%%goto  TabUI") == UnreadableText("%%goto TabUI", "it does not name a receiver")


@pytest.mark.parametrize("token", ["", " ", "two words", "line\nbreak", "tab\t", "\r"])
def test_a_message_refuses_a_token_that_would_break_its_line(token: str) -> None:
    with pytest.raises(ValueError, match="not one token"):
        TextMessage("%%error", "A", "B", (token,))
    with pytest.raises(ValueError, match="not one token"):
        TextMessage("%%error", "A", token)


def test_running_text_becomes_tokens() -> None:
    message = TextMessage.of("%%error", "A", "B", " no  path\nthere ")
    assert message.content == ("no", "path", "there")
    assert message.text == "no path there"


def test_only_ascii_white_space_parts_tokens() -> None:
    assert tokens("a\x0bb\x0cc d\u00a0e\u2003f\x85g") == ["a", "b", "c", "d\u00a0e\u2003f\x85g"]


def test_what_utf8_cannot_hold_is_replaced_when_sent() -> None:
    assert encode_line("caf\u00e9 \ud800 ") == b"caf\xc3\xa9 ? \n"


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
