"""Each fault is planted into a bag that is clean without it: rules of `times`."""

from dataclasses import replace
from pathlib import Path

import pytest

from sim.common.geometry import IDENTITY
from tests.support.bags.bags_with_faults import (
    SCAN_LINE,
    START,
    STEP,
    Entry,
    clean,
    found,
    grid,
    judged,
    odom_message,
    rules,
    scan_message,
    tf,
)
from tests.support.bags.foreign_bags import stamp, transform
from thbridge.analysis.check import BagTool, FindingSeverity


def test_messages_out_of_order_within_a_chunk(tmp_path: Path) -> None:
    planted = clean()
    planted.entries[40] = replace(planted.entries[40], ns=planted.entries[40].ns - 2 * STEP)
    finding = found(judged(tmp_path, planted), "back-in-time")
    assert (finding.count, finding.first_ns) == (1, planted.entries[40].ns)
    assert "0.200 s" in finding.what


def test_stamp_of_zero(tmp_path: Path) -> None:
    planted = clean()
    planted.entries.insert(0, Entry(SCAN_LINE, 0, scan_message(START)))
    finding = found(judged(tmp_path, planted), "stamp-zero")
    assert (finding.topic, finding.count, finding.first_ns) == ("/scan", 1, 0)
    assert BagTool.ROSBAG in finding.tools


def test_headers_far_from_the_recording(tmp_path: Path) -> None:
    planted = clean()
    planted.entries[-1] = replace(planted.entries[-1], message=scan_message(START + 30 * 1_000_000_000))
    finding = found(judged(tmp_path, planted), "header-far")
    assert (finding.topic, finding.count) == ("/scan", 1)
    assert "27.1 s after" in finding.what


def test_a_topic_that_is_recorded_late(tmp_path: Path) -> None:
    planted = clean()
    planted.entries = [
        replace(entry, message=scan_message(entry.ns - 5 * STEP)) if entry.line.topic == "/scan" else entry
        for entry in planted.entries
    ]
    finding = found(judged(tmp_path, planted), "recorded-late")
    assert (finding.topic, finding.count, finding.first_ns) == ("/scan", 30, START)
    assert finding.tools == (BagTool.FOXGLOVE, BagTool.PLOTJUGGLER)
    assert "0.50 s after their stamps" in finding.what


@pytest.mark.parametrize("ahead", [5, 20])
def test_a_topic_that_is_stamped_ahead(ahead: int, tmp_path: Path) -> None:
    planted = clean()
    planted.entries = [
        replace(entry, message=scan_message(entry.ns + ahead * STEP)) if entry.line.topic == "/scan" else entry
        for entry in planted.entries
    ]
    finding = found(judged(tmp_path, planted), "stamped-ahead")
    assert (finding.topic, finding.count, finding.first_ns) == ("/scan", 30, START)
    assert f"{ahead / 10:.2f} s after the time of recording" in finding.what


def test_transforms_that_amcl_stamps_ahead_are_in_order(tmp_path: Path) -> None:
    planted = clean()
    planted.entries = [
        replace(entry, message=tf(transform(entry.ns + 5 * STEP, "map", "odom", IDENTITY)))
        if entry.line.topic == "/tf"
        else entry
        for entry in planted.entries
    ]
    assert "stamped-ahead" not in rules(judged(tmp_path, planted))


def test_a_few_late_messages_are_no_late_topic(tmp_path: Path) -> None:
    planted = clean()
    for entry in planted.of("/scan")[:15]:
        at = planted.entries.index(entry)
        planted.entries[at] = replace(entry, message=scan_message(entry.ns - 5 * STEP))
    assert "recorded-late" not in rules(judged(tmp_path, planted))


def test_old_headers_of_what_is_latched_are_in_order(tmp_path: Path) -> None:
    planted = clean()
    planted.entries[0] = replace(planted.entries[0], message=grid(START - 60 * 1_000_000_000))
    assert "header-far" not in rules(judged(tmp_path, planted))


def test_static_transforms_hold_at_all_times_whatever_their_stamps(tmp_path: Path) -> None:
    planted = clean()
    planted.change("/tf_static", latching="0")
    old = transform(START - 60 * 1_000_000_000, "base_link", "hokuyo", IDENTITY)
    at = planted.entries.index(planted.of("/tf_static")[0])
    planted.entries[at] = replace(planted.entries[at], message=tf(old))
    assert "header-far" not in rules(judged(tmp_path, planted))


def test_odometry_that_is_not_stamped(tmp_path: Path) -> None:
    planted = clean()
    planted.entries = [
        replace(entry, message=odom_message(0)) if entry.line.topic == "/odom" else entry for entry in planted.entries
    ]
    finding = found(judged(tmp_path, planted), "header-zero")
    assert (finding.tools, finding.count) == ((BagTool.EVO,), 30)


@pytest.mark.parametrize("every", [1, 10])
def test_transforms_that_are_not_stamped(every: int, tmp_path: Path) -> None:
    planted = clean()
    for entry in planted.of("/tf")[::every]:
        entry.message.transforms[0].header.stamp = stamp(0)  # type: ignore[attr-defined]
    finding = found(judged(tmp_path, planted), "header-zero")
    assert (finding.topic, finding.count) == ("/tf", 30 // every)
    assert BagTool.RVIZ in finding.tools


def test_headers_that_go_back(tmp_path: Path) -> None:
    planted = clean()
    last = planted.of("/odom")[-1]
    planted.entries[planted.entries.index(last)] = replace(last, message=odom_message(START))
    assert found(judged(tmp_path, planted), "header-back").tools == (BagTool.EVO,)


def test_headers_that_repeat(tmp_path: Path) -> None:
    planted = clean()
    last = planted.of("/odom")[-1]
    planted.entries[planted.entries.index(last)] = replace(last, message=odom_message(last.ns - STEP))
    finding = found(judged(tmp_path, planted), "header-repeated")
    assert (finding.severity, finding.count, finding.tools) == (FindingSeverity.WARNING, 1, (BagTool.EVO,))
