"""A robot followed through bags that are not ours."""

import itertools
import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rosbags.rosbag1 import Writer

from sim.common.geometry import IDENTITY, Pose2
from sim.parameters import AmclParameters, RobotParameters
from sim.robot.localization.amcl import Amcl
from tests.support.bags.foreign_bags import FIRST, PERIOD_NS, START_NS, Robot, room, write
from thbridge.files.errors import BadFile
from thbridge.hunt.refusals import RequestRefused
from thbridge.offline.localize import LocalizationResult, SkipReason, localize
from thbridge.offline.localizers import recorded_localizer, warm_up
from thbridge.offline.recording import LocalizationBag, open_recording
from thbridge.ros.odometry_faults import FaultKind

PARAMETERS = AmclParameters(min_particles=200, max_particles=500)
CERTAIN = np.diag((0.01, 0.01, 0.01))


def follow(
    recording: LocalizationBag, origin: Pose2 = IDENTITY, parameters: AmclParameters = PARAMETERS, start: Pose2 = FIRST
) -> LocalizationResult:
    localizer = Amcl(parameters, room(origin), recording.laser.mount, 1, "robot1")
    localizer.start(origin.compose(start), CERTAIN)
    clock = itertools.count()
    done = localize(
        localizer, recording.laser, recording.odometry, recording.scans(), lambda: float(next(clock)), lambda: None
    )
    assert isinstance(done, LocalizationResult)
    return done


def errors(done: LocalizationResult, truth: list[Pose2], origin: Pose2 = IDENTITY) -> Iterator[float]:
    for fix in done.updates:
        index = round((fix.stamp_ns - START_NS) / PERIOD_NS)
        yield origin.compose(truth[index]).distance(fix.base_in_map)


BAGS = {
    "odometry and tf": Robot(),
    "tf only": Robot(odom_topic=None),
    "frames with slashes": Robot(odom_frame="/odom", base_frame="/base_footprint", laser_frame="/hokuyo"),
    "frames with a prefix": Robot(
        odom_topic=None, odom_frame="a1/odom", base_frame="a1/base", body_frame="a1/body", laser_frame="a1/scan"
    ),
    "laser turned": Robot(laser=Pose2(-0.2, 0.1, 2.0)),
    "laser upside down": Robot(laser=Pose2(0.1, 0.0, 0.7), roll=math.pi, angle_min=-1.0),
    "odometry spikes": Robot(spikes={20: 1000.0, 21: 1000.0, 60: -4.0}),
    "odometry spikes in tf": Robot(odom_topic=None, spikes={20: 1000.0, 60: -4.0}),
    "odometry reset": Robot(reset_at=50),
    "slow odometry": Robot(odom_per_scan=1),
    "fast odometry": Robot(odom_per_scan=5),
    "bz2": Robot(compression=Writer.CompressionFormat.BZ2),
    "lz4": Robot(compression=Writer.CompressionFormat.LZ4),
}


@pytest.mark.parametrize("robot", BAGS.values(), ids=BAGS.keys())
def test_a_robot_is_followed(tmp_path: Path, robot: Robot) -> None:
    truth = write(tmp_path / "a.bag", robot)
    done = follow(open_recording(tmp_path / "a.bag", "/scan", "/odom", None))
    assert len(done.updates) > 10
    assert np.mean(list(errors(done, truth))) < 0.08
    assert done.last.base_in_map.distance(truth[-1]) < 0.15
    assert not done.skipped


@pytest.mark.parametrize("kind", ["ekf", "ukf"])
def test_a_kalman_filter_follows_a_robot_too(tmp_path: Path, kind: str) -> None:
    truth = write(tmp_path / "a.bag", BAGS["odometry spikes"])
    recording = open_recording(tmp_path / "a.bag", "/scan", "/odom", None)
    for start in (FIRST, None):
        localizer = recorded_localizer(RobotParameters(localization=kind), room(), recording.laser.mount, start, 1)
        done = localize(localizer, recording.laser, recording.odometry, recording.scans(), float, lambda: None)
        assert isinstance(done, LocalizationResult)
        assert len(done.updates) > 10
        assert (
            max(error for error, update in zip(errors(done, truth), done.updates, strict=True) if not update.lost) < 0.1
        )
        assert [stretch.start_ns for stretch in done.lost_stretches] == ([] if start else [done.updates[0].stamp_ns])
        assert {update.agreement for update in done.updates} == {None}
        assert all(update.p_wrong is not None for update in done.updates)


def test_a_kalman_filter_that_is_lost_reports_the_scans_it_refuses(tmp_path: Path) -> None:
    write(tmp_path / "a.bag", Robot(laser=Pose2(0.0, 0.0, 0.0)))
    elsewhere = open_recording(tmp_path / "a.bag", "/scan", "/odom", Pose2(0.0, 0.0, 2.0))
    software = RobotParameters(localization="ekf")
    localizer = recorded_localizer(software, room(), elsewhere.laser.mount, FIRST, 1)
    done = localize(localizer, elsewhere.laser, elsewhere.odometry, elsewhere.scans(), float, lambda: None)
    assert isinstance(done, LocalizationResult)
    assert done.lost_stretches


def test_the_filter_doubts_its_pose_more_after_a_reset(tmp_path: Path) -> None:
    """Odometry does not say how far the robot drove meanwhile."""
    write(tmp_path / "a.bag", Robot(reset_at=50))
    recording = open_recording(tmp_path / "a.bag", "/scan", "/odom", None)
    assert len(recording.odometry.faults) == 1
    doubted: list[tuple[float, float]] = []

    class Watched(Amcl):
        def widen(self, distance: float, turn: float) -> None:
            doubted.append((distance, turn))
            super().widen(distance, turn)

    localizer = Watched(PARAMETERS, room(), recording.laser.mount, 1, "robot1")
    localizer.start(FIRST, CERTAIN)
    localize(localizer, recording.laser, recording.odometry, recording.scans(), lambda: 0.0, lambda: None)
    ((distance, turn),) = doubted
    assert distance == pytest.approx(0.051, abs=0.002), "half a metre a second, for a tenth of a second"
    assert turn == 0.03


def test_a_clock_that_is_set_back_and_scans_with_odd_stamps_are_named(tmp_path: Path) -> None:
    hour = 3_600_000_000_000
    write(tmp_path / "a.bag", Robot(stamp_offsets={4: -hour, **dict.fromkeys(range(12, 21), hour)}), seconds=2.0)
    done = follow(open_recording(tmp_path / "a.bag", "/scan", "/odom", None))
    assert [(fault.kind, fault.seconds) for fault in done.scan_faults] == [
        (FaultKind.WRONG_STAMP, 0.0),
        (FaultKind.CLOCK_AHEAD, 3600.0),
    ]


@pytest.mark.parametrize("every", [1, 4])
def test_scans_that_are_not_stamped_are_used_and_counted(every: int, tmp_path: Path) -> None:
    unstamped = range(0, 61, every)
    zero = {number: -(START_NS + number * PERIOD_NS) for number in unstamped}
    truth = write(tmp_path / "a.bag", Robot(stamp_offsets=zero))
    done = follow(open_recording(tmp_path / "a.bag", "/scan", "/odom", None))
    assert (done.unstamped, done.skipped, done.scan_faults) == (len(unstamped), {}, ())
    assert done.last.base_in_map.distance(truth[-1]) < 0.15


def test_a_laser_pose_that_is_given_wins(tmp_path: Path) -> None:
    robot = Robot(tf=False)
    truth = write(tmp_path / "a.bag", robot)
    done = follow(open_recording(tmp_path / "a.bag", "/scan", "/odom", robot.laser))
    assert np.mean(list(errors(done, truth))) < 0.08


@settings(max_examples=8)
@given(st.builds(Pose2, st.floats(-1000, 1000), st.floats(-1000, 1000), st.floats(-math.pi, math.pi, exclude_max=True)))
def test_where_the_world_lies_does_not_matter(tmp_path_factory: pytest.TempPathFactory, origin: Pose2) -> None:
    """The whole world moved and turned, map with it: the errors stay, but for chance, which knows the map's axes."""
    path = tmp_path_factory.mktemp("bag") / "a.bag"
    truth = write(path, Robot(), seconds=3.0)
    recording = open_recording(path, "/scan", "/odom", None)
    here, there = follow(recording), follow(recording, origin)
    assert [fix.stamp_ns for fix in here.updates] == [fix.stamp_ns for fix in there.updates]
    mean_here, mean_there = np.mean(list(errors(here, truth))), np.mean(list(errors(there, truth, origin)))
    assert mean_here == pytest.approx(mean_there, abs=0.03)


def test_the_same_seed_gives_the_same_poses(tmp_path: Path) -> None:
    write(tmp_path / "a.bag", Robot(), seconds=2.0)
    first, second = (follow(open_recording(tmp_path / "a.bag", "/scan", "/odom", None)) for _ in range(2))
    assert [fix.base_in_map for fix in first.updates] == [fix.base_in_map for fix in second.updates]


def test_only_the_filter_is_timed(tmp_path: Path) -> None:
    write(tmp_path / "a.bag", Robot(), seconds=1.0)
    done = follow(open_recording(tmp_path / "a.bag", "/scan", "/odom", None))
    assert done.cpu_seconds == done.scans == 11


def test_scans_that_cannot_be_used_are_counted(tmp_path: Path) -> None:
    """One is stamped long before, one a little before its forerunner, one as its forerunner."""
    offsets = {4: -3_600_000_000_000, 6: -PERIOD_NS - 1, 8: -PERIOD_NS}
    write(tmp_path / "a.bag", Robot(stamp_offsets=offsets), seconds=2.0)
    done = follow(open_recording(tmp_path / "a.bag", "/scan", "/odom", None))
    assert done.skipped == {SkipReason.NO_ODOMETRY: 1, SkipReason.NOT_NEWER: 2}
    assert done.scans == 18


def test_a_bag_without_a_usable_scan_is_refused(tmp_path: Path) -> None:
    write(tmp_path / "a.bag", Robot(stamp_offsets=dict.fromkeys(range(11), 3_600_000_000_000)), seconds=1.0)
    recording = open_recording(tmp_path / "a.bag", "/scan", "/odom", None)
    localizer = Amcl(PARAMETERS, room(), recording.laser.mount, 1, "robot1")
    done = localize(localizer, recording.laser, recording.odometry, recording.scans(), lambda: 0.0, lambda: None)
    assert done == RequestRefused("no-usable-scan", "No scan could be used: 11 no odometry near its time.")


@pytest.mark.parametrize(
    ("robot", "scan_topic", "told"),
    [
        (Robot(), "/base_scan", "sensor_msgs/LaserScan is on /scan"),
        (Robot(tf=False, odom_topic="/wheels"), "/scan", "nav_msgs/Odometry is on /wheels"),
        (Robot(tf=False, odom_topic=None), "/scan", "the bag has no nav_msgs/Odometry"),
        (Robot(tf=False), "/scan", "--laser-pose"),
    ],
)
def test_what_is_missing_is_told_with_what_there_is(tmp_path: Path, robot: Robot, scan_topic: str, told: str) -> None:
    write(tmp_path / "a.bag", robot, seconds=0.5)
    with pytest.raises(BadFile, match=told):
        open_recording(tmp_path / "a.bag", scan_topic, "/odom", None)


def test_a_cut_off_bag_is_refused_with_the_remedy(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    write(path, Robot(), seconds=1.0)
    path.write_bytes(path.read_bytes()[:-300])
    with pytest.raises(BadFile, match="thbridge bag reindex"):
        open_recording(path, "/scan", "/odom", None)


def test_the_filter_that_warms_up_is_another_one(tmp_path: Path) -> None:
    write(tmp_path / "a.bag", Robot(), seconds=1.0)
    recording = open_recording(tmp_path / "a.bag", "/scan", "/odom", None)
    alone = follow(recording)
    scan = recording.laser.scan(0, recording.laser.first)
    software = RobotParameters(amcl=PARAMETERS)
    warm_up(recorded_localizer(software, room(), recording.laser.mount, FIRST, 1), software, scan)
    assert follow(recording).last.base_in_map == alone.last.base_in_map


OLD_TF = "tf/msg/tfMessage"
LAYOUTS = {
    "TurtleBot": (Robot(), "/scan", "/odom"),
    "Stage": (
        Robot(scan_topic="/base_scan", tf_type=OLD_TF, odom_frame="/odom", base_frame="/base_link"),
        "/base_scan",
        "/odom",
    ),
    "PR2": (
        Robot(
            scan_topic="/base_scan",
            more_scans=("/tilt_scan",),
            odom_topic="/base_odometry/odom",
            odom_frame="odom_combined",
            tf_type=OLD_TF,
        ),
        "/base_scan",
        "/base_odometry/odom",
    ),
    "gmapping's tutorial": (
        Robot(scan_topic="/base_scan", odom_topic=None, tf_type=OLD_TF),
        "/base_scan",
        "tf odom -> base_footprint",
    ),
    "one of several with a tf of their own": (
        Robot(scan_topic="/tb3_1/scan", odom_topic=None, tf_namespace="/tb3_1", stray_tf="/tb3_0/tf"),
        "/tb3_1/scan",
        "tf odom -> base_footprint",
    ),
    "one of a fleet": (
        Robot(
            scan_topic="/tb3_1/scan",
            odom_topic="/tb3_1/odom",
            odom_frame="tb3_1/odom",
            base_frame="tb3_1/base_footprint",
            body_frame="tb3_1/base_link",
            laser_frame="tb3_1/base_scan",
        ),
        "/tb3_1/scan",
        "/tb3_1/odom",
    ),
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_scans_and_odometry_are_found_under_the_names_of_other_robots(tmp_path: Path, layout: str) -> None:
    robot, scans, odometry = LAYOUTS[layout]
    truth = write(tmp_path / "a.bag", robot)
    recording = open_recording(tmp_path / "a.bag", None, None, None)
    assert (recording.scan_topic, recording.odometry_source) == (scans, odometry)
    assert max(errors(follow(recording), truth)) < 0.3
    assert any("/tilt_scan" in notice for notice in recording.notices) == bool(robot.more_scans)


def test_of_several_robots_one_must_be_named(tmp_path: Path) -> None:
    robot = Robot(scan_topic="/robot_0/base_scan", more_scans=("/robot_1/base_scan",), odom_topic="/robot_1/odom")
    write(tmp_path / "a.bag", robot, seconds=1.0)
    with pytest.raises(BadFile, match=r"several robots.*/robot_0/base_scan, /robot_1/base_scan.*--scan-topic"):
        open_recording(tmp_path / "a.bag", None, None, None)
    assert open_recording(tmp_path / "a.bag", "/robot_1/base_scan", None, None).odometry_source == "/robot_1/odom"
