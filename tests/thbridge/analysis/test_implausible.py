"""Bags with numbers that are none: NaN, inf, and such as no robot drives."""

import math
import struct
from pathlib import Path

import pytest

from tests.support.bags.bags_with_faults import START, STEP, Entry, Line, Planted, clean, write
from tests.support.slow import slow
from thbridge.analysis.export.folder import export_bag
from thbridge.analysis.plot.figures import draw
from thbridge.analysis.plot.kinds import FigureKind
from thbridge.analysis.plot.style import ONE_COLUMN, FigureFormat
from thbridge.analysis.report.builder import read_report
from thbridge.analysis.report_page.page import build_report
from thbridge.files.tables.table_files import TableFormat
from thbridge.hunt.refusals import RequestRefused
from thbridge.offline.recording import open_recording
from thbridge.recording.bag.reading.reader import messages
from thbridge.ros.messages import unpack
from thbridge.ros.messages.types import ODOMETRY

BAD = [math.nan, math.inf, -math.inf, 1e308, -1e308]


def wild(value: float) -> Planted:
    """Every third odometry message and every transform on the map is wild."""
    planted = clean()
    for entry in planted.of("/odom")[::3]:
        entry.message.pose.pose.position.x = value  # type: ignore[attr-defined]
        entry.message.pose.covariance[0] = value  # type: ignore[attr-defined]
        entry.message.twist.twist.linear.x = value  # type: ignore[attr-defined]
    for entry in planted.of("/tf")[1::3]:
        for transform in entry.message.transforms:  # type: ignore[attr-defined]
            transform.transform.translation.x = value
    return planted


@pytest.mark.parametrize("value", [BAD[0], *slow(*BAD[1:-1]), BAD[-1]])
def test_figures_leave_them_out_and_say_so(value: float, tmp_path: Path) -> None:
    bag = write(tmp_path / "wild.bag", wild(value))
    report = read_report(messages(bag))
    assert report.left_out == (
        "20 values of /tf are omitted: they are not finite, or beyond 1e+09.",
        "20 values of /odom are omitted: they are not finite, or beyond 1e+09.",
    )
    assert set(report.left_out) <= set(report.missing)
    for kind in (FigureKind.PATHS, FigureKind.VELOCITY):
        drawn = draw(kind, report, ONE_COLUMN)
        assert not isinstance(drawn, RequestRefused)
        assert ONE_COLUMN.rendered(drawn, FigureFormat.SVG)
    assert "20 values of /odom are omitted" in build_report(bag, None)


@pytest.mark.parametrize("value", BAD)
def test_the_table_of_poses_leaves_them_out_and_others_keep_them(value: float, tmp_path: Path) -> None:
    bag = write(tmp_path / "wild.bag", wild(value))
    exported = export_bag(bag, tmp_path / "out", [TableFormat.CSV])
    assert any(notice.startswith("poses: 10 values of /odom are omitted") for notice in exported.notices)
    assert exported.tables["poses"][1] == 20
    assert exported.tables["odom"][1] == 30


def test_localisation_leaves_them_out_and_says_so(tmp_path: Path) -> None:
    recording = open_recording(write(tmp_path / "wild.bag", wild(math.nan)), None, None, None)
    assert len(recording.odometry) == 20
    assert any(
        notice.startswith("/odom: messages left out because their values are not finite or too large: 10 ")
        for notice in recording.notices
    )


def test_a_map_that_lies_nowhere_is_no_map() -> None:
    planted = clean()
    message = planted.of("/map")[0]
    message.message.info.origin.position.x = math.nan  # type: ignore[attr-defined]
    with pytest.raises(ValueError, match="has its origin at nan"):
        unpack.occupancy_grid(message.bytes())


def test_a_path_does_not_claim_billions_of_poses() -> None:
    header = bytes(12) + bytes(4)
    with pytest.raises(ValueError, match="ends too early"):
        unpack.path(header + (2**32 - 1).to_bytes(4, "little") + bytes(100))


def test_no_odometry_is_left_out_of_a_clean_bag(tmp_path: Path) -> None:
    bag = write(tmp_path / "clean.bag", clean())
    assert read_report(message for message in messages(bag) if message.msgtype == ODOMETRY).left_out == ()


@pytest.mark.parametrize("msgtype", [ODOMETRY, "geometry_msgs/PoseStamped", "geometry_msgs/TransformStamped"])
def test_a_type_of_a_known_name_with_other_fields_is_a_table_without_poses(msgtype: str, tmp_path: Path) -> None:
    line = Line("/p", msgtype, md5="1" * 32, definition="float64 x\n")
    entries = [Entry(line, START + number * STEP, data=struct.pack("<d", number)) for number in range(5)]
    done = export_bag(write(tmp_path / "a.bag", Planted(entries)), tmp_path / "tables", (TableFormat.CSV,))
    assert list(done.tables) == ["p"]
