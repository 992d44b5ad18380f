"""Each fault is planted into a bag that is clean without it: rules of `contents`."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.support.bags.bags_with_faults import (
    START,
    STEP,
    Entry,
    Line,
    clean,
    found,
    grid,
    judged,
    odom_message,
    rules,
    scan_message,
)
from thbridge.analysis.check import BagTool, FindingSeverity


@pytest.mark.parametrize(
    ("quaternion", "fault"),
    [((0, 0, 0, 0), "all zero"), ((0, 0, 0, 2), "not of length one"), ((0, 0, 0, float("nan")), "not finite")],
)
@pytest.mark.parametrize("topic", ["/odom", "/tf"])
def test_quaternions(tmp_path: Path, topic: str, quaternion: tuple[float, ...], fault: str) -> None:
    planted = clean()
    message = planted.of(topic)[-1].message
    rotation = message.pose.pose.orientation if topic == "/odom" else message.transforms[0].transform.rotation  # type: ignore[attr-defined]
    rotation.x, rotation.y, rotation.z, rotation.w = map(float, quaternion)
    finding = found(judged(tmp_path, planted), "quaternion")
    forgiven = topic == "/odom" and fault == "all zero"
    severity = FindingSeverity.WARNING if forgiven else FindingSeverity.ERROR
    assert (finding.topic, finding.count, finding.severity) == (topic, 1, severity)
    assert (BagTool.RVIZ in finding.tools) is not forgiven
    assert fault in finding.what


def test_a_bad_quaternion_in_an_array(tmp_path: Path) -> None:
    planted = clean()
    count = 50
    poses = np.zeros((count, 7))
    poses[:, 6] = 1.0
    poses[33, 6] = 0.5
    head = b"\0" * 4 + (START // 10**9).to_bytes(4, "little") + b"\0" * 4 + b"\x03\0\0\0map"
    line = Line("/particlecloud", "geometry_msgs/PoseArray")
    planted.entries.append(
        Entry(line, START + 30 * STEP, data=head + count.to_bytes(4, "little") + poses.astype("<f8").tobytes())
    )
    assert found(judged(tmp_path, planted), "quaternion").topic == "/particlecloud"


def test_place_that_is_not_a_number(tmp_path: Path) -> None:
    planted = clean()
    planted.of("/odom")[-1].message.pose.pose.position.x = float("inf")  # type: ignore[attr-defined]
    assert found(judged(tmp_path, planted), "not-finite").topic == "/odom"


def test_odometry_without_covariance(tmp_path: Path) -> None:
    planted = clean()
    planted.entries = [
        replace(entry, message=odom_message(entry.ns, sure=True)) if entry.line.topic == "/odom" else entry
        for entry in planted.entries
    ]
    finding = found(judged(tmp_path, planted), "covariance-zero")
    assert (finding.topic, finding.count) == ("/odom", 30)


def test_one_message_with_covariance_is_enough(tmp_path: Path) -> None:
    planted = clean()
    first = planted.of("/odom")[0]
    planted.entries[planted.entries.index(first)] = replace(first, message=odom_message(first.ns, sure=True))
    assert "covariance-zero" not in rules(judged(tmp_path, planted))


@pytest.mark.parametrize(("ranges", "intensities"), [(80, 0), (100, 0), (91, 90)])
def test_scan_whose_arrays_do_not_match(tmp_path: Path, ranges: int, intensities: int) -> None:
    planted = clean()
    message = scan_message(START + 29 * STEP, ranges=ranges, intensities=intensities)
    planted.entries[-1] = replace(planted.entries[-1], message=message)
    assert found(judged(tmp_path, planted), "length-wrong").topic == "/scan"


def test_map_with_too_few_cells(tmp_path: Path) -> None:
    planted = clean()
    planted.entries[0] = replace(planted.entries[0], message=grid(START, cells=11))
    assert found(judged(tmp_path, planted), "length-wrong").topic == "/map"


def test_arrays_too_long_to_plot(tmp_path: Path) -> None:
    planted = clean()
    planted.entries[0] = replace(planted.entries[0], message=grid(START, 40, 30, 1200))
    finding = found(judged(tmp_path, planted), "long-array")
    assert (finding.severity, finding.tools) == (FindingSeverity.NOTE, (BagTool.PLOTJUGGLER,))


@pytest.mark.parametrize("change", [lambda data: data[:-3], lambda data: data + b"\0\0", lambda data: b""])
def test_data_that_do_not_fit_the_definition(tmp_path: Path, change: object) -> None:
    planted = clean()
    last = planted.entries[-1]
    planted.entries[-1] = Entry(last.line, last.ns, data=change(last.bytes()))  # type: ignore[operator]
    finding = found(judged(tmp_path, planted), "data-wrong")
    assert (finding.topic, finding.count, finding.first_ns) == ("/scan", 1, last.ns)
    assert set(finding.tools) == set(BagTool) - {BagTool.EVO}, "evo does not read scans"


@pytest.mark.parametrize(
    ("changes", "severity", "told"),
    [
        ({"range_max": math.nan}, FindingSeverity.ERROR, "range_max is not a number"),
        ({"range_min": math.nan}, FindingSeverity.ERROR, "range_min is not a number"),
        ({"range_min": 20.0}, FindingSeverity.ERROR, "range_min is not below range_max"),
        ({"range_min": -1.0}, FindingSeverity.WARNING, "range_min is negative"),
        ({"range_max": -1.0}, FindingSeverity.ERROR, "range_min is not below range_max"),
        ({"time_increment": math.nan}, FindingSeverity.ERROR, "time_increment is not finite"),
        ({"scan_time": math.inf}, FindingSeverity.ERROR, "scan_time is not finite"),
        ({"scan_time": -0.1}, FindingSeverity.WARNING, "scan_time is negative"),
        ({"ranges": np.array([1.0, -1.0] * 45 + [math.nan], dtype=np.float32)}, FindingSeverity.WARNING, "ranges are"),
    ],
)
def test_scans_whose_header_contradicts_itself(
    changes: dict[str, object], severity: FindingSeverity, told: str, tmp_path: Path
) -> None:
    planted = clean()
    for entry in planted.of("/scan")[3:5]:
        for name, value in changes.items():
            setattr(entry.message, name, value)
    finding = found(judged(tmp_path, planted), "scan-header")
    assert (finding.severity, finding.topic, finding.count) == (severity, "/scan", 2)
    assert told in finding.what


def test_what_is_not_seen_is_in_order(tmp_path: Path) -> None:
    planted = clean()
    nothing = np.array([math.inf, -math.inf, math.nan] * 30 + [0.0], dtype=np.float32)
    for entry in planted.of("/scan"):
        entry.message.ranges = nothing  # type: ignore[attr-defined]
        entry.message.range_max = math.inf  # type: ignore[attr-defined]
    assert "scan-header" not in rules(judged(tmp_path, planted))
