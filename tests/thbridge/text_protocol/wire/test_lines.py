"""Framing, tokens and messages of the text protocol."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.text_protocol.wire.lines import ROUTED, TextMessage, UnreadableText, encode_line, parse_line, tokens

WORDS = st.text(st.characters(exclude_characters=" \t\n\r\x0b\x0c", codec="utf-8"), min_size=1, max_size=8)
MESSAGES = st.builds(TextMessage, st.sampled_from(sorted(ROUTED)), WORDS, WORDS, st.lists(WORDS, max_size=5).map(tuple))


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
