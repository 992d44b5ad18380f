"""Columns out of messages: every value that rosbags' own reader finds, under its tidy name."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from thbridge.analysis.export.columns import fields_of
from thbridge.analysis.fields.layout import MessageLayout, layout_of
from thbridge.analysis.fields.rows import ALIKE, GatheredRows
from thbridge.files.tables.table_files import Column, ListColumn, Values
from thbridge.ros.messages.types import OWN_TYPES, plain_definition

FOREIGN = """\
std_msgs/Header header
string name
bool on
byte signed_one
char unsigned_one
int64 far
float32[3] triple
float64[] reals
uint8[] blob
string[] words
string[2] pair
time[] moments
duration wait
Empty nothing
Wheel[] wheels
Wheel[2] axle
int32 LIMIT=7
================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
================================================================================
MSG: far_away/Empty
# nothing at all
================================================================================
MSG: far_away/Wheel
string label
float32 radius
int16[] ticks
"""
STORE = get_typestore(Stores.ROS1_NOETIC)
STORE.register({"far_away/msg/Empty": ([], [])})
_NOT_PARSED = "=" * 80 + "\nMSG: far_away/Empty\n# nothing at all\n"
STORE.register(get_types_from_msg(FOREIGN.replace(_NOT_PARSED, ""), "far_away/msg/Rover"))
Rover, Wheel, Empty = (STORE.types[f"far_away/msg/{name}"] for name in ("Rover", "Wheel", "Empty"))
Header = STORE.types["std_msgs/msg/Header"]
Time, Duration = (STORE.types[f"builtin_interfaces/msg/{name}"] for name in ("Time", "Duration"))

uint32 = st.integers(0, 2**32 - 1)
texts = st.text(st.characters(codec="utf-8"), max_size=8)
reals = st.floats(width=32, allow_nan=False)


def arrays(elements: st.SearchStrategy, dtype: type, low: int = 0, high: int = 4) -> st.SearchStrategy:
    return st.lists(elements, min_size=low, max_size=high).map(lambda values: np.array(values, dtype=dtype))


# rosbags takes no seconds beyond 2038.
times = st.builds(Time, st.integers(0, 2**31 - 1), st.integers(0, 999_999_999))
wheels = st.builds(Wheel, texts, reals, arrays(st.integers(-(2**15), 2**15 - 1), np.int16))
rovers = st.builds(
    Rover,
    header=st.builds(Header, uint32, times, texts),
    name=texts,
    on=st.booleans(),
    signed_one=st.integers(-128, 127),
    unsigned_one=st.integers(0, 255),
    far=st.integers(-(2**63), 2**63 - 1),
    triple=arrays(reals, np.float32, 3, 3),
    reals=arrays(st.floats(allow_nan=False), np.float64),
    blob=arrays(st.integers(0, 255), np.uint8),
    words=st.lists(texts, max_size=3),
    pair=st.lists(texts, min_size=2, max_size=2),
    moments=st.lists(times, max_size=3),
    wait=st.builds(Duration, st.integers(-(2**31), 2**31 - 1), st.integers(0, 999_999_999)),
    nothing=st.just(Empty()),
    wheels=st.lists(wheels, max_size=3),
    axle=st.lists(wheels, min_size=2, max_size=2),
)


def serialized(message: object) -> bytes:
    return bytes(STORE.serialize_ros1(message, "far_away/msg/Rover"))


def taken(record: MessageLayout, rows: GatheredRows) -> dict[str, Values]:
    return {field.column.name: field.values(rows) for field in fields_of(record, ())}


def ns(moment: object) -> int:
    return moment.sec * 1_000_000_000 + moment.nanosec


def lists(values: Values) -> list[list]:
    assert isinstance(values, ListColumn)
    ends = np.cumsum(values.lengths)
    elements = list(values.elements)
    return [elements[end - length : end] for end, length in zip(ends, values.lengths, strict=True)]


@settings(max_examples=40)
@given(st.lists(rovers, min_size=1, max_size=3))
def test_a_type_that_nobody_knows_is_read_value_for_value(said: list) -> None:
    record = layout_of("far_away/Rover", FOREIGN)
    rows = GatheredRows(record)
    for rover in said:
        rows.add(serialized(rover))
    values = taken(record, rows)
    assert values["seq"].tolist() == [rover.header.seq for rover in said]
    assert values["stamp_ns"].tolist() == [ns(rover.header.stamp) for rover in said]
    assert values["frame_id"] == [rover.header.frame_id for rover in said]
    for name in ("on", "signed_one", "unsigned_one", "far"):
        assert values[name].tolist() == [getattr(rover, name) for rover in said]
    for index in range(3):
        assert values[f"triple_{index}"].tolist() == [rover.triple[index] for rover in said]
    assert values["wait_ns"].tolist() == [ns(rover.wait) for rover in said]
    assert lists(values["reals"]) == [rover.reals.tolist() for rover in said]
    assert values["blob"] == [rover.blob.tobytes() for rover in said]
    assert lists(values["words"]) == [rover.words for rover in said]
    assert lists(values["pair"]) == [rover.pair for rover in said]
    moments, each, axle = rows.inner
    assert taken(moments.record, moments)["moments_ns"].tolist() == [ns(m) for rover in said for m in rover.moments]
    for wheels_rows, chosen in ((each, "wheels"), (axle, "axle")):
        inner = taken(wheels_rows.record, wheels_rows)
        flat = [wheel for rover in said for wheel in getattr(rover, chosen)]
        assert inner["label"] == [wheel.label for wheel in flat]
        assert inner["radius"].tolist() == [wheel.radius for wheel in flat]
        assert lists(inner["ticks"]) == [wheel.ticks.tolist() for wheel in flat]


@settings(max_examples=40)
@given(rovers, rovers, st.data())
def test_a_broken_message_leaves_nothing_behind(good: object, other: object, data: st.DataObject) -> None:
    record = layout_of("far_away/Rover", FOREIGN)
    whole = serialized(other)
    broken = data.draw(
        st.integers(0, len(whole) - 1).map(lambda end: whole[:end]) | st.just(whole + b"x") | st.just(b"\xff" * 200)
    )
    rows, alone = GatheredRows(record), GatheredRows(record)
    for gathered in (rows, alone):
        gathered.add(serialized(good))
    with pytest.raises(ValueError, match="message"):
        rows.add(broken)
    for gathered in (rows, alone):
        gathered.add(whole)
    assert str(taken(record, rows)) == str(taken(record, alone))
    assert [inner.count for inner in rows.inner] == [inner.count for inner in alone.inner]


@settings(max_examples=80)
@given(said=st.lists(rovers, min_size=1, max_size=3), broken=st.binary(max_size=40))
def test_messages_of_one_length_are_read_together_as_one_by_one(said: list, broken: bytes) -> None:
    record = layout_of("far_away/Rover", FOREIGN)
    together, alone = GatheredRows(record), GatheredRows(record)
    messages = [serialized(rover) for rover in said for _ in range(ALIKE)]
    messages[len(messages) // 2 : len(messages) // 2] = [broken] * (ALIKE + 1)
    refused = together.add_all(bytearray().join(messages), np.array([*map(len, messages)]))
    for index, data in enumerate(messages):
        if index not in refused:
            alone.add(data)
    assert str(taken(record, together)) == str(taken(record, alone))
    assert len(refused) in {0, ALIKE + 1}
    assert together.count == alone.count


def columns(msgtype: str) -> dict[str, Column]:
    record = layout_of(msgtype, plain_definition(msgtype).text)
    return {field.column.name: field.column for field in fields_of(record, ())}


def test_names_are_short_and_say_their_unit() -> None:
    odometry = columns("nav_msgs/Odometry")
    assert list(odometry)[:12] == [
        *("seq", "stamp_ns", "frame_id", "child_frame_id"),
        *("x_m", "y_m", "z_m", "qx", "qy", "qz", "qw", "yaw_rad"),
    ]
    assert {"pose_std_yaw_rad", "twist_cov_x_x", "linear_x_m_s", "angular_z_rad_s"} < set(odometry)
    assert sum("_cov_" in name for name in odometry) == 72
    assert "ranges_m" in columns("sensor_msgs/LaserScan")


def test_where_short_names_would_be_the_same_all_words_stay() -> None:
    text = "A one\nA two\n" + "=" * 80 + "\nMSG: p/A\nfloat64 x\nWrap pose\n" + "=" * 80 + "\nMSG: p/Wrap\nfloat64 x\n"
    names = [field.column.name for field in fields_of(layout_of("p/Both", text), ("two_x",))]
    assert names == ["one_x", "one_pose_x", "two_x_", "two_pose_x"]
    assert len(set(names)) == 4


def test_values_know_their_frame_and_unit() -> None:
    odometry = columns("nav_msgs/Odometry")
    assert (odometry["x_m"].frame_column, odometry["x_m"].unit) == ("frame_id", "m")
    assert (odometry["linear_x_m_s"].frame_column, odometry["linear_x_m_s"].unit) == ("child_frame_id", "m/s")
    assert (odometry["seq"].frame_column, odometry["seq"].unit) == ("", "")
    goal = columns("move_base_msgs/MoveBaseActionGoal")["goal_target_pose_yaw_rad"]
    assert (goal.frame_column, goal.unit) == ("goal_target_pose_frame_id", "rad")
    assert "pose to reach" in goal.meaning


def test_yaw_and_standard_deviations_are_worked_out() -> None:
    msgtype = "geometry_msgs/PoseWithCovarianceStamped"
    record = layout_of(msgtype, plain_definition(msgtype).text)
    variances = np.zeros((6, 6))
    variances[[0, 1, 5], [0, 1, 5]] = 0.25, -1.0, 4.0
    half = 0.5 * 2.5
    rows = GatheredRows(record)
    rows.add(bytes(16) + np.array([1.0, 2.0, 0.0, 0.0, 0.0, math.sin(half), math.cos(half), *variances.flat]).tobytes())
    values = taken(record, rows)
    assert values["yaw_rad"] == pytest.approx([2.5])
    assert (values["pose_std_x_m"][0], values["pose_std_yaw_rad"][0]) == (0.5, 2.0)
    assert np.isnan(values["pose_std_y_m"][0])


@pytest.mark.parametrize("msgtype", OWN_TYPES)
def test_every_column_of_our_own_types_has_a_meaning(msgtype: str) -> None:
    assert all(column.meaning for column in columns(msgtype).values())


def test_definitions_that_cannot_be_laid_out_are_refused() -> None:
    with pytest.raises(ValueError, match="contains itself"):
        layout_of("p/A", "A inner\n" + "=" * 80 + "\nMSG: p/A\nA inner\n")
    with pytest.raises(ValueError, match="missing"):
        layout_of("p/A", "B inner\n")
