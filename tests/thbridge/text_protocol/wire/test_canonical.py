"""The canonical forms of 2015, and which reading of a ``%%goto`` wins."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.text_protocol.values.dialect import Dialect
from thbridge.text_protocol.wire.canonical import (
    CanonicalValue,
    GotoPoint,
    MoveByHand,
    MoveDirection,
    PoseQuery,
    PoseReport,
    decode,
    decode_goto,
    encode,
)
from thbridge.text_protocol.wire.legacy import GotoRoom
from thbridge.text_protocol.wire.lines import TextMessage, UnreadableText, parse_line

LINES: list[tuple[CanonicalValue, str]] = [
    (PoseReport(0, 1.5, -2.25, math.pi / 2), "%%pose A B 0 1.500 -2.250 90.000 "),
    (PoseQuery(2), "%%where A B 2 "),
    (GotoPoint(1, 3.0, 4.0), "%%goto A B 1 3.000 4.000 "),
    (GotoPoint(1, 3.0, 4.0, -math.pi / 4), "%%goto A B 1 3.000 4.000 -45.000 "),
    (MoveByHand(0, MoveDirection.TURN_CLOCKWISE, 5), "%%move A B 0 c 5 "),
    (MoveByHand(0, MoveDirection.WIDE_CLOCKWISE, 1), "%%move A B 0 C 1 "),
]


@pytest.mark.parametrize(("value", "line"), LINES)
def test_a_value_and_its_line(value: CanonicalValue, line: str) -> None:
    assert encode(value, "A", "B").line() == line
    assert decode(encode(value, "A", "B")) == value


@given(st.floats(-100, 100), st.floats(-100, 100), st.floats(-math.pi, math.pi, exclude_max=True))
def test_a_pose_keeps_a_millimetre_and_a_thousandth_of_a_degree(x: float, y: float, heading: float) -> None:
    pose = decode(encode(PoseReport(0, x, y, heading), "A", "B"))
    assert isinstance(pose, PoseReport)
    assert math.hypot(pose.x - x, pose.y - y) < 1e-3
    assert abs(math.remainder(pose.heading - heading, 2 * math.pi)) < math.radians(1e-3)
    assert -math.pi <= pose.heading < math.pi


def test_a_negative_zero_is_not_sent() -> None:
    assert encode(PoseReport(0, -0.0001, 0.0, 0.0), "A", "B").line() == "%%pose A B 0 0.000 0.000 0.000 "


def test_headings_come_back_wrapped() -> None:
    pose = decode(TextMessage.of("%%pose", "A", "B", "0 0 0 270"))
    assert isinstance(pose, PoseReport)
    assert pose.heading == pytest.approx(-math.pi / 2)


@pytest.mark.parametrize(
    "line",
    [
        "%%pose A B 0 1 2",
        "%%pose A B 0 1 nan 0",
        "%%pose A B 0 1 1e999 0",
        "%%goto A B 0 one 2",
        "%%goto A B -1 1 2",
        "%%goto A B 0 1",
        "%%move A B 0 X 3",
        "%%move A B 0 F 0",
        "%%move A B 0 F 6",
        "%%where A B",
        "%%snap A B 1",
    ],
)
def test_bad_content_is_unreadable(line: str) -> None:
    message = parse_line(line)
    assert isinstance(message, TextMessage)
    assert isinstance(decode(message), UnreadableText)


def test_a_number_that_cannot_be_sent_is_an_error_of_ours() -> None:
    with pytest.raises(ValueError, match="not a number"):
        encode(PoseReport(0, math.nan, 0.0, 0.0), "A", "B")


@pytest.mark.parametrize(
    ("content", "dialect", "expected"),
    [
        ("0 3 3 45", Dialect.LEGACY_2016, GotoRoom(0, 3)),
        ("0 3 3 45", Dialect.CANONICAL, GotoPoint(0, 3.0, 3.0, math.radians(45))),
        ("0 8 8 45", Dialect.LEGACY_2016, GotoPoint(0, 8.0, 8.0, math.radians(45))),
        ("0 3 3 90", Dialect.LEGACY_2016, GotoPoint(0, 3.0, 3.0, math.radians(90))),
        ("0 3 4 45", Dialect.LEGACY_2016, GotoPoint(0, 3.0, 4.0, math.radians(45))),
        ("0 3.0 3.0 45", Dialect.LEGACY_2016, GotoPoint(0, 3.0, 3.0, math.radians(45))),
        ("0 3 3", Dialect.LEGACY_2016, GotoPoint(0, 3.0, 3.0)),
    ],
)
def test_a_goto_is_a_room_or_a_point(content: str, dialect: Dialect, expected: GotoRoom | GotoPoint) -> None:
    assert decode_goto(TextMessage.of("%%goto", "TabUI", "SimR", content), dialect, rooms=8) == expected


def test_a_goto_that_is_neither_is_unreadable() -> None:
    assert isinstance(
        decode_goto(TextMessage.of("%%goto", "A", "B", "x"), Dialect.LEGACY_2016, rooms=8), UnreadableText
    )
    assert isinstance(
        decode_goto(TextMessage.of("%%where", "A", "B", "0"), Dialect.LEGACY_2016, rooms=8), UnreadableText
    )
