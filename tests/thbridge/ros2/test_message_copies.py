"""Copies are those of rosbags' converter, which decodes each message, for random messages of all our types."""

import io
import struct
from contextlib import redirect_stdout, suppress
from functools import cache

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rosbags.convert.converter import generate_message_converter
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore

from thbridge.ros.messages import types
from thbridge.ros.messages.foreign_types import register
from thbridge.ros2.copied_fields import LOG_OF_ROS1, LOG_OF_ROS2
from thbridge.ros2.message_copies import MessageCopy

FORMS = {"bool": "?", "uint8": "B", "int8": "b", "uint16": "H", "int16": "h", "uint32": "I", "int32": "i",
         "uint64": "Q", "int64": "q", "float32": "f", "float64": "d"}  # fmt: skip
EMPTY = "structure_needs_at_least_one_member"
"""Field of empty messages. It is sent in ROS 2 only."""
OURS = types.typestore()
NAMES = [
    *types.OWN_TYPES, *types.MAVROS_TYPES, types.TFMESSAGE, types.ODOMETRY, types.PATH, types.OCCUPANCY_GRID,
    types.LASER_SCAN, types.BATTERY_STATE, types.POSE_ARRAY, types.MARKER_ARRAY, types.POLYGON_STAMPED,
    types.MOVE_BASE_FEEDBACK, types.GOAL_STATUS_ARRAY, types.DIAGNOSTIC_ARRAY, types.STRING, types.BOOL,
    "sensor_msgs/CameraInfo", "stereo_msgs/DisparityImage", "sensor_msgs/PointCloud2", "sensor_msgs/Imu",
    types.MOVE_BASE_RESULT, "std_msgs/Empty",
]  # fmt: skip


@cache
def theirs() -> Typestore:
    store = get_typestore(Stores.ROS2_JAZZY)
    register(store, {name: own for name, own in OURS.fielddefs.items() if name not in store.fielddefs})
    return store


def random_message(draw: st.DrawFn, name: str, lengths: dict[str, int]) -> bytes:
    """Return a message of ROS 1; `lengths` are those of its strings and arrays, by their place."""

    def field(described: tuple, path: str) -> bytes:
        match described:
            case (1, ("string", _)):
                text = draw(st.text(max_size=7)).encode()
                return len(text).to_bytes(4, "little") + text
            case (1, (base, _)):
                form = struct.Struct("<" + FORMS[{"byte": "uint8", "char": "uint8", "octet": "uint8"}.get(base, base)])
                if base == "bool":
                    return bytes((draw(st.booleans()),))
                if base.startswith("float"):
                    return form.pack(draw(st.floats(width=8 * form.size, allow_nan=False)))
                return draw(st.binary(min_size=form.size, max_size=form.size))
            case (2, inner):
                fields = OURS.fielddefs[inner][1]
                return b"".join(field(each, path + name) for name, each in fields if name != EMPTY)
            case (3, (element, count)):
                return b"".join(field(element, path) for _ in range(count))
            case (4, (element, _)):
                count = lengths.setdefault(path, draw(st.integers(0, 3)))
                return count.to_bytes(4, "little") + b"".join(field(element, path) for _ in range(count))
        raise AssertionError(described)

    return field((2, name), "")


@cache
def converters(name: str) -> tuple:
    with redirect_stdout(io.StringIO()):
        return (
            generate_message_converter(OURS, theirs(), name, name, {}, src_is2=False, dst_is2=True),
            generate_message_converter(theirs(), OURS, name, name, {}, src_is2=True, dst_is2=False),
            MessageCopy(OURS.fielddefs, name, theirs().fielddefs, name, to_cdr=True),
            MessageCopy(theirs().fielddefs, name, OURS.fielddefs, name, to_cdr=False),
        )


@pytest.mark.parametrize("msgtype", NAMES)
@given(data=st.data())
def test_copies_are_those_of_a_decoder(msgtype: str, data: st.DataObject) -> None:
    name = msgtype.replace("/", "/msg/")
    to_cdr, to_ros1, copy, back = converters(name)
    for lengths in ({}, {}):
        message = data.draw(st.composite(random_message)(name, lengths))
        cdr = copy(message)
        assert cdr == bytes(to_cdr(message))
        assert back(cdr) == bytes(to_ros1(cdr))
        assert copy(back(cdr)) == cdr


@pytest.mark.parametrize("msgtype", [types.ODOMETRY, types.PATH, types.DIAGNOSTIC_ARRAY, types.MARKER_ARRAY])
@given(data=st.data())
def test_bytes_that_are_no_message_are_refused(msgtype: str, data: st.DataObject) -> None:
    name = msgtype.replace("/", "/msg/")
    _, _, copy, back = converters(name)
    message = data.draw(st.composite(random_message)(name, {}))
    cut = data.draw(st.integers(0, len(message) - 1))
    for bad in (message[:cut], message + b"x", data.draw(st.binary(max_size=60))):
        try:
            cdr = copy(bad)
        except ValueError:
            assert bad != message
        else:
            assert bad != message[:cut]
            assert len(back(cdr)) == len(bad)
    for bad in (copy(message)[: 4 + cut], data.draw(st.binary(max_size=60))):
        with suppress(ValueError):
            back(bad)


def test_plans_of_many_shapes_are_forgotten() -> None:
    copy = converters("std_msgs/msg/String")[2]
    for size in range(1000):
        assert copy(size.to_bytes(4, "little") + b"a" * size)[8:] == b"a" * size + b"\x00"
    assert len(copy._plans) <= 64


def test_text_that_is_not_utf_8_and_zeros_in_it_are_kept() -> None:
    _, _, copy, back = converters("std_msgs/msg/String")
    message = b"\x04\x00\x00\x00\xff\x00\xfe\x00"
    assert back(copy(message)) == message


def test_a_log_message_has_ros_2s_levels() -> None:
    args = (OURS.fielddefs, LOG_OF_ROS1, theirs().fielddefs, LOG_OF_ROS2)
    copy, back = MessageCopy(*args, to_cdr=True), MessageCopy(*args[2:], *args[:2], to_cdr=False)
    stamp = OURS.types["builtin_interfaces/msg/Time"](3, 4)
    header = OURS.types["std_msgs/msg/Header"](0, stamp, "")
    for level, theirs_level in ((1, 10), (2, 20), (4, 30), (8, 40), (16, 50)):
        log = OURS.types[LOG_OF_ROS1](header, level, "/node", "text", "file.py", "main", 7, [])
        message = bytes(OURS.serialize_ros1(log, LOG_OF_ROS1))
        seen = theirs().deserialize_cdr(copy(message), LOG_OF_ROS2)
        assert (seen.stamp.sec, seen.level, seen.name, seen.msg, seen.line) == (3, theirs_level, "/node", "text", 7)
        assert back(copy(message)) == message


def test_fields_of_other_types_are_refused() -> None:
    store = get_typestore(Stores.EMPTY)
    register(store, {"a/msg/A": ([], [("x", (1, ("int32", 0)))]), "a/msg/B": ([], [("x", (1, ("float64", 0)))])})
    with pytest.raises(ValueError, match="int32 in one type and float64"):
        MessageCopy(store.fielddefs, "a/msg/A", store.fielddefs, "a/msg/B", to_cdr=True)
