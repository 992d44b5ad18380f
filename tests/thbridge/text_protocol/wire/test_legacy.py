"""The legacy-2016 dialect: its lines to the letter, and what is understood from them."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.text_protocol.wire.legacy import (
    AskTreasure,
    FoundTreasure,
    GotoRoom,
    LegacyValue,
    NameTreasure,
    PointsAwarded,
    RoomReached,
    SnapTreasure,
    TreasureImage,
    decode,
)
from thbridge.text_protocol.wire.lines import TextMessage, UnreadableText, parse_line, tokens

LINES: list[tuple[LegacyValue, str]] = [
    (GotoRoom(1, 4), "%%goto TabUI SimR 1 4 4 45 "),
    (RoomReached(1, 4), '%%error SimR TabUI "1;4" '),
    (AskTreasure(4), '%%error TabUI Hider "4" '),
    (
        FoundTreasure(4, (("Colour", "Orange"), ("Footprint", "Round and Large"))),
        '%%found Hider TabUI 4 4 "(Colour: Orange) (Footprint: Round and Large)" ',
    ),
    (SnapTreasure(4), "%%snap TabUI Hider 4 "),
    (TreasureImage(4, "rsz_t1.jpg"), "%%image Hider TabUI 4 rsz_t1.jpg "),
    (NameTreasure(4, "Orange Bottle"), '%%found TabUI Hider "4,Orange Bottle '),
    (PointsAwarded(10), "%%score Hider TabUI ,10 "),
    (PointsAwarded(-30), "%%score Hider TabUI ,-30 "),
]


@pytest.mark.parametrize(("value", "line"), LINES)
def test_a_value_is_said_as_in_2016(value: LegacyValue, line: str) -> None:
    assert value.message().line() == line


@pytest.mark.parametrize(("value", "line"), LINES)
def test_a_line_of_2016_is_understood(value: LegacyValue, line: str) -> None:
    message = parse_line(line)
    assert isinstance(message, TextMessage)
    assert decode(message) == value


def test_the_double_blank_of_the_2016_question_makes_no_difference() -> None:
    message = parse_line('%%error TabUI Hider  "3"')
    assert isinstance(message, TextMessage)
    assert decode(message) == AskTreasure(3)


ROOMS = st.integers(0, 99)
PHRASES = st.lists(st.from_regex(r"[A-Za-zäöü0-9_£-]{1,8}", fullmatch=True), min_size=1, max_size=4).map(" ".join)
LABELS = st.sampled_from(["Colour", "Footprint", "Weight", "Country of origin"])
VALUES = st.one_of(
    st.builds(GotoRoom, ROOMS, ROOMS),
    st.builds(RoomReached, ROOMS, ROOMS),
    st.builds(AskTreasure, ROOMS),
    st.builds(FoundTreasure, ROOMS, st.lists(st.tuples(LABELS, PHRASES), max_size=3).map(tuple)),
    st.builds(SnapTreasure, ROOMS),
    st.builds(TreasureImage, ROOMS, st.from_regex(r"[a-z0-9_]{1,8}\.jpg", fullmatch=True)),
    st.builds(NameTreasure, ROOMS, PHRASES),
    st.builds(PointsAwarded, st.integers(-999, 999)),
)


@given(VALUES)
def test_every_value_survives_the_wire(value: LegacyValue) -> None:
    message = parse_line(value.message().line())
    assert isinstance(message, TextMessage)
    assert decode(message) == value


def test_parentheses_in_a_footprint_are_text() -> None:
    value = FoundTreasure(0, (("Colour", "Blue (dark)"), ("Footprint", "Round (and) Large")))
    assert decode(value.message()) == value


def test_a_closing_quotation_mark_that_a_newer_program_sends_is_not_part_of_the_name() -> None:
    assert decode(TextMessage.of("%%found", "TabUI", "Hider", '"4,Orange Bottle"')) == NameTreasure(4, "Orange Bottle")


@pytest.mark.parametrize(
    "line",
    [
        "%%goto TabUI SimR 0 3 4 45",
        "%%goto TabUI SimR 0 3 3 90",
        "%%goto TabUI SimR 0 3 3",
        "%%goto TabUI SimR 0 3.0 3.0 45",
        "%%goto TabUI SimR -1 3 3 45",
        "%%goto TabUI SimR ١ 3 3 45",
        "%%goto TabUI SimR 0 9999999999 9999999999 45",
        "%%error SimR TabUI",
        '%%error SimR TabUI "1;"',
        '%%error SimR TabUI "1;4',
        "%%error SimR TabUI something went wrong",
        "%%found Hider TabUI 3 3",
        '%%found Hider TabUI 3 4 "(Colour: C) (Footprint: F)"',
        "%%found TabUI Hider Orange Bottle",
        "%%snap TabUI Hider",
        "%%snap TabUI Hider 3 4",
        "%%image Hider TabUI 3",
        "%%image Hider TabUI 3 my picture.jpg",
        "%%image Hider TabUI 3 ../secret.jpg",
        "%%image Hider TabUI 3 C:\\secret.jpg",
        "%%image Hider TabUI 3 ..",
        "%%score Hider TabUI 10",
        "%%score Hider TabUI ,ten",
        "%%where TabUI SimR 0",
    ],
)
def test_other_lines_are_unreadable_in_this_dialect(line: str) -> None:
    message = parse_line(line)
    assert isinstance(message, TextMessage)
    assert isinstance(decode(message), UnreadableText)


@pytest.mark.parametrize("filename", ["my picture.jpg", "", "pictures/t1.jpg", "..", "a\\b.jpg"])
def test_a_picture_that_the_old_client_could_not_show_is_refused(filename: str) -> None:
    with pytest.raises(ValueError, match="picture's file name"):
        TreasureImage(0, filename)


@given(st.sampled_from(["%%goto", "%%error", "%%found", "%%image", "%%score"]), st.text(max_size=40))
def test_no_content_makes_decoding_fail(command: str, text: str) -> None:
    message = TextMessage(command, "A", "B", tuple(tokens(text)))
    assert decode(message) is not None
