"""Bags whose connections have no definition, a placeholder, or only a part of one."""

from pathlib import Path

import pytest
from mcap.reader import make_reader

from tests.support.bags.bags_with_faults import Planted, clean, found, judged, rules, write
from tests.support.programs.commands import invoke
from thbridge.analysis.cut import CutRange, cut
from thbridge.analysis.export.folder import export_bag
from thbridge.analysis.report.builder import read_report
from thbridge.analysis.to_mcap import to_mcap
from thbridge.analysis.to_ros2 import to_ros2
from thbridge.files.tables.table_files import TableFormat
from thbridge.recording.bag.reading.reader import messages, recorded
from thbridge.ros.messages.identification import DefinitionSource, fits, identified
from thbridge.ros.messages.types import plain_definition

SCAN = "sensor_msgs/LaserScan"
ANY = [("", None), ("Definition of {msgtype}", None), ("# see the package\n", None), ("", "*"), ("", "0" * 32)]
"""Definitions, and md5 sums; None: the right one."""


def without(definition: str, md5: str | None = None) -> Planted:
    """A clean bag with other definitions of odometry and scans."""
    planted = clean()
    for topic in ("/odom", "/scan"):
        msgtype = planted.of(topic)[0].line.msgtype
        planted.change(topic, definition=definition.format(msgtype=msgtype), md5=md5 or plain_definition(msgtype).md5)
    return planted


@pytest.mark.parametrize(("definition", "md5"), ANY)
def test_types_are_known_by_md5_or_else_by_name(definition: str, md5: str | None, tmp_path: Path) -> None:
    whole, bag = write(tmp_path / "whole.bag", clean()), write(tmp_path / "a.bag", without(definition, md5))
    export_bag(whole, tmp_path / "from-whole", (TableFormat.PARQUET,))
    done = export_bag(bag, tmp_path / "tables", (TableFormat.PARQUET,))
    for name in ("odom", "scan", "tf", "poses"):
        one, other = ((tmp_path / folder / f"{name}.parquet").read_bytes() for folder in ("from-whole", "tables"))
        assert one == other
    why = "because its md5 sum matches" if md5 is None else "because its messages match"
    assert sorted(done.notices) == [
        f"{topic}: the bag has no complete definition of its type; "
        f"the definition of {msgtype} in ROS Noetic is used, {why}."
        for topic, msgtype in (("/odom", "nav_msgs/Odometry"), ("/scan", SCAN))
    ]
    (tmp_path / "ros2").mkdir()
    assert to_ros2(bag, tmp_path / "ros2" / "a").left_out == ()
    converted = to_mcap(bag, tmp_path / "a.mcap")
    assert converted.undefined == ()
    with converted.path.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    texts = {schema.name: schema.data.decode() for schema in summary.schemas.values()}
    assert texts[SCAN] == plain_definition(SCAN).text


def test_a_cut_bag_has_its_definitions_again(tmp_path: Path) -> None:
    bag = write(tmp_path / "a.bag", without("Definition of {msgtype}"))
    cut(bag, CutRange(), tmp_path / "b.bag")
    assert all(
        publisher.definition == plain_definition(publisher.msgtype).text and publisher.source is DefinitionSource.BAG
        for publisher, _, _ in recorded(tmp_path / "b.bag", ("/odom", "/scan"))
    )


@pytest.mark.parametrize(("definition", "md5"), ANY)
def test_messages_without_definition_are_no_wrong_messages(definition: str, md5: str | None, tmp_path: Path) -> None:
    judgement = judged(tmp_path, without(definition, md5))
    assert "data-wrong" not in rules(judgement)
    missing = [finding for finding in judgement.findings if finding.rule == "definition-missing"]
    assert [finding.topic for finding in missing] == ["/odom", "/scan"]
    assert all(("bag cut" in finding.remedy) == (md5 is None) for finding in missing)


def test_contents_are_checked_by_the_definition_that_is_found(tmp_path: Path) -> None:
    planted = without("")
    planted.of("/odom")[3].message.pose.pose.orientation.w = 0.5  # type: ignore[attr-defined]
    finding = found(judged(tmp_path, planted), "quaternion")
    assert (finding.topic, finding.count) == ("/odom", 1)


def test_a_report_takes_messages_without_md5_that_fit(tmp_path: Path) -> None:
    (track,) = read_report(messages(write(tmp_path / "a.bag", without("", "*")))).tracks
    assert len(track.odometry) == 30


def test_what_nobody_knows_is_no_table_and_no_success(tmp_path: Path) -> None:
    planted = without("")
    planted.entries = planted.of("/scan")
    planted.change("/scan", msgtype="lab_msgs/Secret", md5="1" * 32)
    for entry in planted.entries:
        object.__setattr__(entry, "data", b"1234")
    bag = write(tmp_path / "a.bag", planted)
    done = invoke("bag", "export", bag, "--to", tmp_path / "tables")
    assert done.exit_code == 1
    assert "/scan is omitted: the bag has no definition of lab_msgs/Secret." in done.output
    converted = invoke("bag", "to-mcap", bag)
    assert converted.exit_code == 0
    assert "/scan: the bag has no definition of its type" in converted.output


def test_a_text_gets_the_types_that_it_lacks_if_the_md5_sum_says_so() -> None:
    whole = plain_definition("nav_msgs/Odometry")
    own = whole.text.partition("=" * 80)[0]
    mine = "lab_msgs/Wheels"
    assert identified(mine, whole.md5, whole.text) == (whole.text, DefinitionSource.BAG)
    filled = identified(mine, whole.md5, own)
    assert filled is not None
    assert filled.source is DefinitionSource.MD5
    assert identified(mine, "1" * 32, own) is None


def test_a_message_fits_a_type_with_all_its_bytes(tmp_path: Path) -> None:
    bag = write(tmp_path / "a.bag", clean())
    data = next(message.data for message in messages(bag, ("/scan",)))
    assert fits(SCAN, data)
    assert not fits(SCAN, data + b"\0")
    assert not fits(SCAN, data[:-1])
    assert not fits("nav_msgs/Odometry", data)
