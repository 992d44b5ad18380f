"""Each fault is planted into a bag that is clean without it: rules of `frames`."""

from dataclasses import replace
from pathlib import Path

import pytest

from sim.common.geometry import IDENTITY, Pose2
from tests.support.bags.bags_with_faults import (
    START,
    STATIC_LINE,
    STEP,
    TF_LINE,
    Entry,
    Line,
    Planted,
    clean,
    found,
    judged,
    rules,
    scan_message,
    tf,
    write,
)
from tests.support.bags.foreign_bags import transform
from thbridge.analysis.check import BagTool, FindingSeverity, judge
from thbridge.recording.bag.reading.scan import scan


def test_static_transforms_that_replace_each_other(tmp_path: Path) -> None:
    planted = clean()
    planted.entries.insert(2, Entry(STATIC_LINE, START, tf(transform(START, "base_link", "camera", IDENTITY))))
    assert "laser" in found(judged(tmp_path, planted), "static-partial").what


def test_frame_that_nothing_joins(tmp_path: Path) -> None:
    planted = clean()
    planted.drop("/tf_static")
    finding = found(judged(tmp_path, planted), "tf-missing")
    assert (finding.topic, finding.count, finding.first_ns) == ("/scan", 30, START)
    assert "'laser'" in finding.what
    assert "'map'" in finding.what
    assert set(finding.tools) == {BagTool.RVIZ, BagTool.FOXGLOVE}


def test_no_transforms_at_all_are_one_finding(tmp_path: Path) -> None:
    planted = clean()
    planted.drop("/tf_static")
    planted.drop("/tf")
    (finding,) = judged(tmp_path, planted).findings
    assert (finding.rule, finding.topic, finding.severity) == ("tf-missing", None, FindingSeverity.ERROR)
    assert "laser, map, odom" in finding.what


def test_one_frame_needs_no_transforms(tmp_path: Path) -> None:
    planted = clean()
    planted.entries = planted.of("/odom")
    assert judged(tmp_path, planted).findings == ()


def test_what_is_not_shown_hangs_loose_with_a_warning(tmp_path: Path) -> None:
    planted = clean()
    line = Line("/battery", "sensor_msgs/BatteryState")
    data = b"\0" * 4 + (START // 10**9).to_bytes(4, "little") + b"\0" * 4 + b"\x03\0\0\0gps" + b"\0" * 48
    planted.entries.append(Entry(line, START + 30 * STEP, data=data))
    assert found(judged(tmp_path, planted), "tf-missing").severity is FindingSeverity.WARNING


def test_tree_in_two_pieces(tmp_path: Path) -> None:
    planted = clean()
    planted.entries = [
        replace(entry, message=tf(transform(entry.ns, "odom", "base_link", IDENTITY)))
        if entry.line.topic == "/tf"
        else entry
        for entry in planted.entries
    ]
    missing = [finding for finding in judged(tmp_path, planted).findings if finding.rule == "tf-missing"]
    assert {finding.topic for finding in missing} == {"/odom", "/scan"}


def test_transforms_that_come_late(tmp_path: Path) -> None:
    planted = clean()
    planted.entries = [e for e in planted.entries if e.line.topic != "/tf" or e.ns >= START + 15 * STEP]
    finding = found(judged(tmp_path, planted), "tf-late")
    assert finding.severity is FindingSeverity.WARNING
    assert "1.500 s" in finding.what


def test_slashed_frames(tmp_path: Path) -> None:
    planted = clean()
    planted.entries[-1] = replace(planted.entries[-1], message=scan_message(START + 29 * STEP, "/laser"))
    judgement = judged(tmp_path, planted)
    finding = found(judgement, "frame-slash")
    assert (finding.topic, finding.severity, finding.tools) == ("/scan", FindingSeverity.ERROR, (BagTool.RVIZ,))
    assert "tf-missing" not in rules(judgement)


def test_slashes_in_transforms_hurt_less(tmp_path: Path) -> None:
    judgement = judged(tmp_path, extra_tf(clean(), transform(START, "/map", "/box", IDENTITY)))
    assert {finding.severity for finding in judgement.findings} == {FindingSeverity.WARNING}
    assert {finding.rule for finding in judgement.findings} == {"frame-slash"}


def test_frame_that_is_not_named(tmp_path: Path) -> None:
    planted = clean()
    planted.entries[-1] = replace(planted.entries[-1], message=scan_message(START + 29 * STEP, ""))
    assert found(judged(tmp_path, planted), "frame-empty").topic == "/scan"


def extra_tf(planted: Planted, *transforms: object) -> Planted:
    for index in range(30):
        planted.entries.append(Entry(TF_LINE, START + 30 * STEP + index, tf(*transforms)))
    return planted


def test_frame_with_two_parents(tmp_path: Path) -> None:
    both = (transform(START, "map", "box", IDENTITY), transform(START, "odom", "box", IDENTITY))
    finding = found(judged(tmp_path, extra_tf(clean(), *both)), "tf-two-parents")
    assert finding.severity is FindingSeverity.ERROR
    assert "'box'" in finding.what


def test_loop_of_transforms(tmp_path: Path) -> None:
    judgement = judged(tmp_path, extra_tf(clean(), transform(START, "base_link", "map", IDENTITY)))
    assert "base_link -> odom -> map -> base_link" in found(judgement, "tf-loop").what


@pytest.mark.parametrize(("parent", "child"), [("", "box"), ("map", ""), ("box", "box")])
def test_transform_without_two_names(tmp_path: Path, parent: str, child: str) -> None:
    assert found(judged(tmp_path, extra_tf(clean(), transform(START, parent, child, IDENTITY))), "tf-names")


def test_another_branch_of_the_tree_is_fine(tmp_path: Path) -> None:
    path = write(tmp_path / "a.bag", extra_tf(clean(), transform(START, "map", "box", Pose2(1.0, 2.0, 0.5))))
    assert judge(scan(path)).ok
