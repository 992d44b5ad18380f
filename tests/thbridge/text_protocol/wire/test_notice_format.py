"""Notices between our own programs."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.text_protocol.wire.lines import TextMessage, UnreadableText, parse_line
from thbridge.text_protocol.wire.notice_format import JsonValue, Notice, is_notice, notice, parse_notice

JSON = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**53), 2**53)
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=8,
)


def test_a_notice_is_compact_ascii_without_a_blank() -> None:
    message = notice("SimR", "TabUI", "goal-failed", robot=0, reason="no path: café \\ closed")
    assert message.line() == (
        r'%%error SimR TabUI thbridge {"kind":"goal-failed","robot":0,'
        r'"reason":"no\u0020path:\u0020caf\u00e9\u0020\\\u0020closed"} '
    )


@given(st.text(), st.dictionaries(st.text().filter(lambda key: key != "kind"), JSON, max_size=4))
def test_a_notice_survives_the_wire(kind: str, fields: dict[str, JsonValue]) -> None:
    sent = notice("SimR", "TabUI", kind, **fields)
    received = parse_line(sent.line())
    assert received == sent
    assert parse_notice(received) == Notice("SimR", "TabUI", kind, fields)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{",
        "[]",
        "3",
        "{}",
        '{"kind":3}',
        '{"kind":"pose","x":NaN}',
        '{"kind":"pose","x":-Infinity}',
        '{"kind":"pose"} tail',
        '{"kind":"pose","x":' + "9" * 5000 + "}",
        "[" * 60_000,
        '{"kind":' * 8_000,
        r'{"kind":"GiveUp","game":"\ud800"}',
        r'{"kind":"GiveUp","games":[{"\udfff\ud800":1}]}',
    ],
    ids=lambda text: text[:24],
)
def test_a_broken_notice_is_unreadable(text: str) -> None:
    message = TextMessage.of("%%error", "A", "B", f"thbridge {text}")
    assert is_notice(message)
    assert isinstance(parse_notice(message), UnreadableText)


def test_a_surrogate_pair_is_a_character() -> None:
    message = parse_line(r'%%error A B thbridge {"kind":"say","text":"\ud83e\udd16"}')
    assert isinstance(message, TextMessage)
    found = parse_notice(message)
    assert isinstance(found, Notice)
    assert found.fields == {"text": "\N{ROBOT FACE}"}


@pytest.mark.parametrize("line", ['%%error A B "0;3"', "%%error A B", '%%goto A B thbridge {"kind":"pose"}'])
def test_other_messages_are_no_notices(line: str) -> None:
    message = parse_line(line)
    assert isinstance(message, TextMessage)
    assert not is_notice(message)
    assert isinstance(parse_notice(message), UnreadableText)


def test_what_json_cannot_hold_is_refused() -> None:
    with pytest.raises(ValueError, match="JSON"):
        notice("A", "B", "pose", x=float("nan"))
    with pytest.raises(ValueError, match="kind"):
        notice("A", "B", "pose", **{"kind": "other"})
