"""Line ends of texts that are edited."""

from hypothesis import given
from hypothesis import strategies as st

from ui.model.shared.line_ends import plain_lines, with_line_ends_of

TEXTS = st.lists(st.sampled_from(["a", "b: 1", "", "\u00a0", "\r\n", "\n", "\r", "\u2029"])).map("".join)


@given(TEXTS)
def test_a_text_that_was_not_edited_keeps_every_byte(read: str) -> None:
    assert with_line_ends_of(read, plain_lines(read)) == read


@given(TEXTS, TEXTS.map(plain_lines))
def test_what_was_typed_is_in_the_text(read: str, typed: str) -> None:
    assert plain_lines(with_line_ends_of(read, typed)) == typed


def test_lines_beside_an_edited_one_keep_their_ends() -> None:
    assert with_line_ends_of("a\r\nb\nc\r\nd\n", "a\nB\nnew\nc\nd\n") == "a\r\nB\nnew\r\nc\r\nd\n"
