"""Each fault is planted into a bag that is clean without it: rules of `connections`."""

from dataclasses import replace
from pathlib import Path

import pytest

from sim.common.geometry import IDENTITY
from tests.support.bags.bags_with_faults import (
    MAP_LINE,
    START,
    STATIC_LINE,
    STEP,
    Entry,
    Line,
    clean,
    content,
    found,
    grid,
    judged,
    rules,
    tf,
    write,
)
from tests.support.bags.foreign_bags import transform
from thbridge.analysis.check import BagTool, FindingSeverity, judge
from thbridge.recording.bag.reading.scan import scan
from thbridge.ros.messages.types import plain_definition


@pytest.mark.parametrize("topic", ["/map", "/tf_static"])
@pytest.mark.parametrize("latching", ["0", None])
def test_unlatched(tmp_path: Path, topic: str, latching: str | None) -> None:
    planted = clean()
    planted.change(topic, latching=latching)
    finding = found(judged(tmp_path, planted), "unlatched")
    assert (finding.topic, finding.severity) == (topic, FindingSeverity.ERROR)
    assert BagTool.RVIZ in finding.tools


def test_a_map_that_is_said_again_and_again_needs_no_latching(tmp_path: Path) -> None:
    planted = clean()
    line = replace(MAP_LINE, topic="/costmap", latching="0")
    planted.entries += [Entry(line, START + second * 1_000_000_000, grid(START)) for second in range(3, 20)]
    assert "unlatched" not in rules(judged(tmp_path, planted))


@pytest.mark.parametrize("latching", ["2", "true", "yes"])
def test_latching_that_is_neither_0_nor_1(tmp_path: Path, latching: str) -> None:
    planted = clean()
    planted.change("/odom", latching=latching)
    finding = found(judged(tmp_path, planted), "latching-word")
    assert finding.topic == "/odom"
    assert {BagTool.ROSBAG, BagTool.EVO} <= set(finding.tools)


@pytest.mark.parametrize("field", [b"message_definition=", b"md5sum="])
def test_connections_that_lack_a_field(tmp_path: Path, field: bytes) -> None:
    bag = write(tmp_path / "a.bag", clean())
    bag.write_bytes(bag.read_bytes().replace(field, b"x" + field[1:]))
    judgement = judge(scan(bag))
    incomplete = [finding for finding in judgement.findings if finding.rule == "connection-incomplete"]
    assert sorted({str(finding.topic) for finding in incomplete}) == ["/map", "/odom", "/scan", "/tf", "/tf_static"]
    assert all(field[:-1].decode() in finding.what for finding in incomplete)
    assert "data-wrong" not in rules(judgement)


def test_two_publishers_of_static_transforms(tmp_path: Path) -> None:
    planted = clean()
    other = replace(STATIC_LINE, caller="/camera")
    planted.entries.insert(2, Entry(other, START, tf(transform(START, "base_link", "camera", IDENTITY))))
    finding = found(judged(tmp_path, planted), "two-latched")
    assert (finding.topic, finding.severity) == ("/tf_static", FindingSeverity.ERROR)
    assert "/camera" in finding.what


def test_publishers_that_disagree_on_the_type(tmp_path: Path) -> None:
    planted = clean()
    planted.entries.append(Entry(Line("/odom", "std_msgs/String"), START + 30 * STEP, data=b"\0\0\0\0"))
    assert found(judged(tmp_path, planted), "two-types").topic == "/odom"


def test_wrong_md5(tmp_path: Path) -> None:
    planted = clean()
    planted.change("/odom", md5="0" * 32)
    finding = found(judged(tmp_path, planted), "md5-wrong")
    assert (finding.topic, finding.severity) == ("/odom", FindingSeverity.ERROR)
    assert plain_definition("nav_msgs/Odometry").md5 in finding.what


def test_fields_of_another_release(tmp_path: Path) -> None:
    planted = clean()
    line = Line(
        "/battery", "std_msgs/String", md5="01c7df3b0e90f2ac49bbd1ecef2a6b6b", definition="string d\nstring e\n"
    )
    planted.entries.append(Entry(line, START + 30 * STEP, data=b"\0" * 8))
    judgement = judged(tmp_path, planted)
    wrong = [finding for finding in judgement.findings if finding.topic == "/battery"]
    assert {finding.rule for finding in wrong} <= {"md5-wrong", "other-release"}
    assert wrong


def test_definition_without_a_nested_type(tmp_path: Path) -> None:
    planted = clean()
    text = plain_definition("nav_msgs/Odometry").text
    planted.change("/odom", definition=text.partition("=" * 80)[0])
    finding = found(judged(tmp_path, planted), "definition-missing")
    assert finding.topic == "/odom"
    assert "geometry_msgs/PoseWithCovariance" in finding.what


def test_no_definition_at_all(tmp_path: Path) -> None:
    planted = clean()
    planted.change("/odom", definition="")
    assert found(judged(tmp_path, planted), "definition-missing").topic == "/odom"


def test_definition_that_says_two_things_of_a_type(tmp_path: Path) -> None:
    text = plain_definition("nav_msgs/Odometry").text
    separator = "=" * 80
    planted = clean()
    planted.change(
        "/odom", definition=f"{text}{separator}\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring name\n"
    )
    finding = found(judged(tmp_path, planted), "definition-twice")
    assert (finding.severity, finding.tools) == (FindingSeverity.ERROR, (BagTool.FOXGLOVE,))
    assert "std_msgs/Header" in finding.what


def test_definition_that_says_a_thing_twice(tmp_path: Path) -> None:
    text = plain_definition("nav_msgs/Odometry").text
    separator = "=" * 80
    planted = clean()
    planted.change("/odom", definition=text + separator + text.partition(separator)[2])
    assert judged(tmp_path, planted).findings == ()


def test_connection_without_messages(tmp_path: Path) -> None:
    line = Line("/silent", "std_msgs/String")
    assert found(judged(tmp_path, clean(), extra_lines=(line,)), "unused").topic == "/silent"


def test_everybody_latches_the_log(tmp_path: Path) -> None:
    planted = clean()
    text = "string msg\n"
    for caller in ("/amcl", "/move_base"):
        line = Line("/rosout", "rosgraph_msgs/Log", "1", caller, definition=text)
        planted.entries.append(Entry(line, START + 30 * STEP, data=b"\0\0\0\0"))
    assert "two-latched" not in rules(judged(tmp_path, planted))


def test_a_clock_in_the_bag(tmp_path: Path) -> None:
    planted = clean()
    planted.entries.append(Entry(Line("/clock", "rosgraph_msgs/Clock"), START + 30 * STEP, data=b"\0" * 8))
    assert found(judged(tmp_path, planted), "clock-recorded").tools == (BagTool.ROSBAG, BagTool.RVIZ)


def test_nothing_for_evo(tmp_path: Path) -> None:
    planted = clean()
    planted.entries = [*planted.of("/scan"), *planted.of("/tf_static")]
    finding = found(judged(tmp_path, planted), "no-trajectory")
    assert (finding.severity, finding.tools) == (FindingSeverity.NOTE, (BagTool.EVO,))


def test_messages_of_no_connection(tmp_path: Path) -> None:
    data = content(clean())
    # The number of the connection of the first message of /scan, of which there are more in this chunk.
    at = data.rindex(b"conn=", 0, data.index(b"laser", data.index(b"/scan"))) + len(b"conn=")
    path = tmp_path / "a.bag"
    path.write_bytes(data[:at] + b"\x63" + data[at + 1 :])
    finding = found(judge(scan(path)), "unknown-source")
    assert (finding.severity, finding.count) == (FindingSeverity.ERROR, 1)
