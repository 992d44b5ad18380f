"""Truth and estimate are compared at the same stamps; what no robot drove is not driven."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from sim.common.geometry import Pose2
from tests.support.bags.bags_with_faults import ODOM_LINE, Entry, Planted, tf, write
from tests.support.bags.bags_with_faults import TF_LINE as TF
from tests.support.bags.foreign_bags import odometry, transform
from tests.support.bags.late_stamps import BEGIN, HOUR, LATE, TENTH, pose
from thbridge.analysis.export.folder import export_bag
from thbridge.analysis.report.builder import read_report
from thbridge.analysis.report.paths import pieces
from thbridge.analysis.report.report import Track
from thbridge.files.tables.table_files import TableFormat
from thbridge.recording.bag.reading.reader import messages


def entry(topic: str, recorded_ns: int, stamp_ns: int, x: float) -> Entry:
    line = type(ODOM_LINE)(topic, "geometry_msgs/PoseStamped")
    return Entry(line, recorded_ns, pose(stamp_ns, x))


def two(stamp_of_truth: Callable[[int], int], late: int = LATE) -> Planted:
    """A robot that drives half a meter a second and knows it; its truth is recorded late."""
    entries = []
    for number in range(60):
        ns, x = BEGIN + number * TENTH, 0.05 * number
        entries += [
            entry("/robot_pose", ns, ns, x),
            entry("/vicon/pose", ns + late, stamp_of_truth(ns), x),
        ]
    return Planted(sorted(entries, key=lambda each: each.ns))


def track_of(tmp_path: Path, planted: Planted) -> Track:
    (track,) = read_report(messages(write(tmp_path / "a.bag", planted))).tracks
    return track


def driven(samples: list[tuple[int, int, float]], tmp_path: Path) -> Track:
    """A report of odometry in tf: numbers of tenths when it was recorded and which it is of, meters."""
    entries = [
        Entry(TF, BEGIN + at * TENTH, tf(transform(BEGIN + of * TENTH, "odom", "base_link", Pose2(x, 0.0, 0.0))))
        for at, of, x in samples
    ]
    return track_of(tmp_path, Planted(entries))


def test_a_truth_that_is_recorded_late_is_compared_by_its_stamps(tmp_path: Path) -> None:
    late = track_of(tmp_path, two(lambda ns: ns))
    at_once = track_of(tmp_path, two(lambda ns: ns, late=0))
    for track in (late, at_once):
        assert track.errors[:, 0].tolist() == pytest.approx([0.1 * number for number in range(60)])
        assert track.errors[:, 1].max() == pytest.approx(0.0, abs=1e-6)
        assert not any("time of recording" in sentence for sentence in track.sources)


@pytest.mark.parametrize(
    ("truth_late", "estimate_late"),
    [(lambda _: 0, lambda _: LATE), (lambda n: (3 + 5 * (n % 2)) * TENTH, lambda _: 0)],
    ids=["the estimate is late", "the truth comes out of order"],
)
def test_whatever_is_recorded_late_is_compared_by_its_stamps(
    truth_late: Callable[[int], int], estimate_late: Callable[[int], int], tmp_path: Path
) -> None:
    entries = []
    for number in range(60):
        ns, x = BEGIN + number * TENTH, 0.05 * number
        entries += [
            entry("/amcl_pose", ns + estimate_late(number), ns, x),
            entry("/vicon/pose", ns + truth_late(number), ns, x),
        ]
    track = track_of(tmp_path, Planted(sorted(entries, key=lambda each: each.ns)))
    assert len(track.errors) == 60
    assert track.errors[:, 1].max() == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize(
    ("stamp_of_truth", "reason"),
    [
        (lambda ns: 0, "are stamped 0"),
        (lambda ns: ns - HOUR, "are 3600.5 s before the time of recording"),
        (lambda ns: ns + HOUR, "are 3599.5 s after the time of recording"),
        (lambda ns: ns + 2 * LATE, "are 0.5 s after the time of recording"),
        (lambda ns: BEGIN, "have one stamp for many poses"),
        (lambda ns: ns - 8 * TENTH * (ns > BEGIN + 30 * TENTH) * 10, "are from a clock that was changed"),
    ],
)
def test_stamps_of_another_clock_are_not_used_and_it_says_so(
    stamp_of_truth: Callable[[int], int], reason: str, tmp_path: Path
) -> None:
    track = track_of(tmp_path, two(stamp_of_truth))
    # Half a second at half a meter a second.
    assert track.errors[:, 1] == pytest.approx(0.25, abs=1e-6)
    told = f"compared by the time of recording, because the headers of /vicon/pose {reason}"
    assert any(told in sentence for sentence in track.sources)


def test_the_table_of_poses_has_them_at_the_same_stamps_too(tmp_path: Path) -> None:
    for name, stamp_of_truth, error in (("good", lambda ns: ns, 0.0), ("zero", lambda ns: 0, 0.25)):
        bag = write(tmp_path / f"{name}.bag", two(stamp_of_truth))
        done = export_bag(bag, tmp_path / name, (TableFormat.CSV,))
        table = np.genfromtxt(tmp_path / name / "poses.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
        known = table["error_m"][~np.isnan(table["error_m"])]
        assert len(known) >= 55
        assert known == pytest.approx(error, abs=1e-6)
        assert any("by the time of recording" in sentence for sentence in done.notices) == (name == "zero")


def straight(count: int = 60) -> list[tuple[int, int, float]]:
    return [(number, number, 0.05 * number) for number in range(count)]


def test_an_outlier_is_not_driven_and_named(tmp_path: Path) -> None:
    samples = straight()
    samples[30] = (30, 30, 1000.0)
    track = driven(samples, tmp_path)
    assert track.distance == pytest.approx(59 * 0.05)
    assert len(track.odometry) == 59
    (told,) = track.faults
    assert told.startswith("tf odom -> base_link: messages left out as outliers")


def test_poses_stamped_years_ahead_are_not_driven_and_named(tmp_path: Path) -> None:
    samples = straight()
    for after in (45, 30, 15):
        samples.insert(after + 1, (after, 3_000_000_000, 0.0))
    track = driven(samples, tmp_path)
    assert track.distance == pytest.approx(59 * 0.05)
    (told,) = track.faults
    assert "with a time stamp that does not fit the others: 3" in told


def test_odometry_that_is_set_to_0_goes_on_from_there(tmp_path: Path) -> None:
    samples = [(at, of, x - 1.5 * (at >= 30) + 9.0 * (at < 30)) for at, of, x in straight()]
    track = driven(samples, tmp_path)
    assert track.distance == pytest.approx(58 * 0.05)
    assert [len(piece) for piece in pieces(track.odometry, track.reset)] == [30, 30]
    (told,) = track.faults
    assert "resets to 0" in told


WRONG = {"first": {0: 1000.0}, "last": {59: 1000.0}, "two at once": {30: 1000.0, 31: -700.0}}


@pytest.mark.parametrize("wrong", WRONG.values(), ids=WRONG)
def test_outliers_anywhere_are_not_driven_and_named(wrong: dict[int, float], tmp_path: Path) -> None:
    track = driven([(at, of, wrong.get(at, x)) for at, of, x in straight()], tmp_path)
    assert track.distance == pytest.approx((59 - ({0, 59} & wrong.keys() != set())) * 0.05)
    (told,) = track.faults
    assert f"cannot have driven there: {len(wrong)} (" in told


@pytest.mark.parametrize(
    ("moved", "reason"),
    [(lambda at: -1.0 * (at >= 20) - 1.0 * (at >= 40), "resets to 0"), (lambda at: 30.0 * (at >= 30), "jumps of the")],
    ids=["twice", "elsewhere"],
)
def test_odometry_that_is_set_again_or_elsewhere_goes_on(
    moved: Callable[[int], float], reason: str, tmp_path: Path
) -> None:
    track = driven([(at, of, x + moved(at)) for at, of, x in straight()], tmp_path)
    assert track.distance == pytest.approx((59 - len(track.reset)) * 0.05)
    (told,) = track.faults
    assert reason in told
    assert f": {len(track.reset)} (" in told


@pytest.mark.parametrize("rounds", [3, 4])
def test_a_drive_that_is_played_in_a_loop_is_driven_as_often(rounds: int, tmp_path: Path) -> None:
    samples = [(at + 60 * number, of, x) for number in range(rounds) for at, of, x in straight()]
    assert driven(samples, tmp_path).distance == pytest.approx(rounds * 59 * 0.05)


def test_an_estimate_that_jumps_is_not_driven_and_named(tmp_path: Path) -> None:
    entries = []
    for number in range(60):
        ns = BEGIN + number * TENTH
        entries.append(entry("/amcl_pose", ns, ns, 0.05 * number + 8.0 * (number >= 30)))
    track = track_of(tmp_path, Planted(entries))
    assert track.distance == pytest.approx(58 * 0.05)
    assert "the estimate jumps 1 times without a drive" in track.sources


def test_a_drive_that_is_played_again_is_driven_twice_without_the_way_back(tmp_path: Path) -> None:
    """Stamps begin again, too."""
    again = [(at + 60, of, x) for at, of, x in straight()]
    track = driven(straight() + again, tmp_path)
    assert track.distance == pytest.approx(2 * 59 * 0.05)
    assert track.odometry[:, 0] == pytest.approx([0.1 * number for number in range(120)])


def test_a_truth_that_jumps_was_carried(tmp_path: Path) -> None:
    planted = two(lambda ns: ns, late=0)
    for number, each in enumerate(planted.of("/vicon/pose")[30:], 30):
        ns = BEGIN + number * TENTH
        planted.entries[planted.entries.index(each)] = entry("/vicon/pose", ns, ns, 0.05 * number + 20.0)
    track = track_of(tmp_path, planted)
    assert track.distance == pytest.approx(58 * 0.05)
    assert track.carried.tolist() == pytest.approx([3.0])
    assert any("jumps 1 times" in sentence for sentence in track.sources)


def test_a_wrong_estimate_is_an_error_and_not_driven(tmp_path: Path) -> None:
    entries = []
    for number in range(60):
        ns = BEGIN + number * TENTH
        entries.append(entry("/robot_pose", ns, ns, 0.05 * number + 100.0 * (number in {20, 21})))
        entries.append(Entry(ODOM_LINE, ns, odometry(ns, "odom", "base_link", Pose2(0.05 * number, 0.0, 0.0))))
    track = track_of(tmp_path, Planted(entries))
    assert track.estimate[:, 1].max() == pytest.approx(101.05)
    assert track.distance == pytest.approx(56 * 0.05)  # without the three steps to, between and from the wrong ones
    assert math.isclose(track.estimate[20, 1], 101.0)
