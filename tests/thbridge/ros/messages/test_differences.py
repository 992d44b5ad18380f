import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.common.observations import Twist
from thbridge.ros.messages import pack, types
from thbridge.ros.messages.differences import MOST, FieldDifference, differences
from thbridge.ros.messages.session_records import GameEvent, ScoreRecord


def odometry(x: float) -> bytes:
    return pack.odometry(7, "map", "base", Pose2(x, 2.0, 0.0), Twist(0.1, 0.2))


def test_equal_messages_differ_in_nothing() -> None:
    assert differences(types.ODOMETRY, odometry(1.0), odometry(1.0)) == ()


def test_a_field_is_named_by_its_path_with_all_its_digits() -> None:
    (found,) = differences(types.ODOMETRY, odometry(0.3), odometry(0.1 + 0.2))
    assert found == FieldDifference("pose.pose.position.x", "0.3", "0.30000000000000004")


def test_the_sign_of_zero_counts() -> None:
    (found,) = differences(types.ODOMETRY, odometry(0.0), odometry(-0.0))
    assert (found.was, found.now) == ("0.0", "-0.0")


def test_lists_may_have_other_lengths() -> None:
    was, now = (pack.score(1, ScoreRecord(3, 2, 8, energy)) for energy in ((1.0, 2.0), (1.5,)))
    assert differences(types.SCORE, was, now) == (
        FieldDifference("energy[0]", "1.0", "1.5"),
        FieldDifference("energy[1]", "2.0", "nothing"),
    )


def test_of_many_fields_the_first_are_told() -> None:
    was, now = (pack.pose_array(1, "map", np.full((100, 3), value)) for value in (0.1, 0.2))
    found = differences(types.POSE_ARRAY, was, now)
    assert len(found) == MOST
    assert found[0].field == "poses[0].position.x"


def test_of_long_texts_the_place_is_told() -> None:
    was, now = (pack.game_event(1, GameEvent("started", None, None, "x" * 500 + end)) for end in ("a", "bc"))
    (found,) = differences(types.GAME_EVENT, was, now)
    assert (found.field, found.was, found.now) == ("json", repr("x" * 12 + "a"), repr("x" * 12 + "bc"))


@given(st.floats(), st.floats())
def test_any_two_numbers_that_differ_read_differently(one: float, other: float) -> None:
    found = differences(types.ODOMETRY, odometry(one), odometry(other))
    same = one == other and math.copysign(1, one) == math.copysign(1, other)
    assert bool(found) != (same or (math.isnan(one) and math.isnan(other)))
    assert all(difference.was != difference.now for difference in found)


@given(
    st.sampled_from(
        [types.ODOMETRY, types.LASER_SCAN, types.MARKER_ARRAY, types.STRING, types.GOAL_STATUS_ARRAY, types.UTTERANCE]
    ),
    st.binary(max_size=200),
)
def test_bytes_that_are_no_such_message_are_refused(msgtype: str, data: bytes) -> None:
    try:
        differences(msgtype, data, data)
    except ValueError as error:
        assert f"it cannot be read as a {msgtype}" in str(error)
