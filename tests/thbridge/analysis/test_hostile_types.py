"""Bags whose connections have names and definitions that no ROS has."""

from pathlib import Path

import pytest

from tests.support.bags.bags_with_faults import START, STEP, Entry, Line, Planted, found, judged, write
from tests.support.ros.nested_types import nested
from thbridge.analysis.export.exporting import table_name
from thbridge.analysis.export.folder import export_bag
from thbridge.analysis.to_ros2 import to_ros2
from thbridge.files.tables.table_files import TableFormat

TYPES = [
    ("", "int32 x\n"),
    ("///", "int32 x\n"),
    ("9a/1b", "int32 x\n"),
    ("a/T0", nested(24)),
    ("a/T", "".join(f"int8 f{index}\n" for index in range(60_000))),
    ("a/T", "uint8[4000000000] x\n"),
]


def of(msgtype: str, definition: str, topic: str = "/x") -> Planted:
    line = Line(topic, msgtype, md5="0" * 32, definition=definition)
    return Planted([Entry(line, START + index * STEP, data=bytes(4)) for index in range(3)])


@pytest.fixture(autouse=True)
def _no_plain_definitions(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let bags be planted with types that nobody knows."""
    known = type("Known", (), {"md5": "", "text": ""})
    monkeypatch.setattr("tests.support.bags.bags_with_faults.plain_definition", lambda name: known)


@pytest.mark.parametrize(("msgtype", "definition"), TYPES)
def test_the_check_finds_them_and_other_commands_leave_them_out(msgtype: str, definition: str, tmp_path: Path) -> None:
    planted = of(msgtype, definition)
    assert found(judged(tmp_path, planted), "definition-missing").topic == "/x"
    bag = write(tmp_path / "hostile.bag", planted)
    exported = export_bag(bag, tmp_path / "out", [TableFormat.CSV])
    assert len(exported.notices) == 1
    assert exported.notices[0].startswith("/x is omitted: ")
    assert to_ros2(bag, tmp_path / "ros2").left_out == ("/x",)


def test_messages_that_do_not_fit_their_definition_are_left_out_of_a_folder_for_ros_2(tmp_path: Path) -> None:
    bag = write(tmp_path / "short.bag", of("a/T", "float64 x\n"))
    done = to_ros2(bag, tmp_path / "ros2")
    assert (done.messages, done.broken) == (0, 3)


def test_a_topic_of_thousands_of_letters_becomes_a_table(tmp_path: Path) -> None:
    bag = write(tmp_path / "long.bag", of("a/T", "int32 x\n", "/" + "x" * 5000))
    exported = export_bag(bag, tmp_path / "out", [TableFormat.CSV])
    assert [count for _, count in exported.tables.values()] == [3]


def test_long_topics_that_begin_alike_have_different_tables() -> None:
    assert table_name("/" + "x" * 500 + "/a") != table_name("/" + "x" * 500 + "/b")
