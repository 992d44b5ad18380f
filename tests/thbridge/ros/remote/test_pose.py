"""Pose of a real robot from its own messages: late, duplicate, or missing."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.common.observations import Twist
from thbridge.ros.clients import InvalidMessage
from thbridge.ros.messages.pack import Transform
from thbridge.ros.messages.unpack import OdometryMessage, PoseInFrame
from thbridge.ros.remote.names import RemoteNames
from thbridge.ros.remote.pose import STALE_NS, UNLOCALIZED_DISTANCE, RemotePose

SECOND = 1_000_000_000
NAMES = RemoteNames("map", "odom", "base", *(f"/{name}" for name in "abcdefgh"))
COVARIANCE = np.diag([0.1, 0.2, 0.3])


def odometry(seconds: float, x: float, y: float = 0.0, theta: float = 0.0, frame: str = "odom") -> OdometryMessage:
    return OdometryMessage(round(seconds * SECOND), frame, "base", Pose2(x, y, theta), Twist(0.5, 0.1))


def located(seconds: float, x: float, y: float = 0.0, theta: float = 0.0, frame: str = "map") -> PoseInFrame:
    return PoseInFrame(round(seconds * SECOND), frame, Pose2(x, y, theta), COVARIANCE)


def heard(robot: RemotePose, seconds: float, x: float) -> None:
    assert robot.receive_odometry(odometry(seconds, x), round(seconds * SECOND)) is None


@pytest.fixture
def robot() -> RemotePose:
    return RemotePose(NAMES)


def where(robot: RemotePose, seconds: float) -> tuple[float, float]:
    estimate = robot.estimate(0, round(seconds * SECOND))
    assert estimate is not None
    return round(estimate.base_in_map.x, 6), round(estimate.base_in_map.y, 6)


def test_nothing_is_known_before_both_odometry_and_localiser_have_spoken(robot):
    assert robot.receive_pose(located(1, 5)) is None
    assert robot.estimate(0, SECOND) is None
    heard(robot, 1, 0.0)
    assert where(robot, 2) == (5, 0)


poses = st.builds(Pose2, st.floats(-50, 50), st.floats(-50, 50), st.floats(-3.1, 3.1))


steps = st.builds(Pose2, st.floats(-0.6, 0.6), st.floats(-0.6, 0.6), st.floats(-3.1, 3.1))


@given(poses, poses, steps)
def test_a_pose_belongs_to_the_odometry_of_its_stamp_and_is_carried_on_by_what_came_after(drift, then, step):
    robot = RemotePose(NAMES)
    later = then.compose(step)
    for seconds, base_in_odom in ((10.0, then), (10.1, later)):
        robot.receive_odometry(OdometryMessage(round(seconds * SECOND), "odom", "", base_in_odom, Twist(0, 0)), 0)
    base_in_map = drift.compose(then)
    robot.receive_pose(PoseInFrame(10 * SECOND, "map", base_in_map, COVARIANCE))
    estimate = robot.estimate(0, 0)
    expected = drift.compose(later)
    assert math.hypot(estimate.base_in_map.x - expected.x, estimate.base_in_map.y - expected.y) < 1e-6
    assert math.cos(estimate.base_in_map.theta - expected.theta) > 1 - 1e-9
    assert (estimate.covariance == COVARIANCE).all()
    assert estimate.updated
    assert not robot.estimate(0, 0).updated


@pytest.mark.parametrize("changed_at", [0, 5, 10])
@pytest.mark.parametrize(("seconds", "x"), [(0.0, 10.2), (0.2, 10.6), (-0.2, 10.0)])
def test_odometry_that_leads_the_scans_is_stamped_later_also_what_came_before(seconds, x, changed_at):
    robot = RemotePose(NAMES)
    for step in range(11):
        if step == changed_at:
            robot.stamp_odometry_later(round(seconds * SECOND))
        heard(robot, 1.0 + step / 10, step / 5)
    robot.receive_pose(located(1.9, 10.0))
    assert where(robot, 2) == (x, 0)


def test_late_words_change_nothing(robot):
    heard(robot, 1, 1.0)
    heard(robot, 2, 1.5)
    robot.receive_pose(located(2, 11.5))
    heard(robot, 1.5, 9.0)
    robot.receive_pose(located(1, 99.0))
    assert where(robot, 2) == (11.5, 0)


def test_tf_wins_over_single_poses_and_brings_its_own_odometry(robot):
    robot.receive_transforms([(SECOND, Transform("map", "odom", Pose2(10, 0, 0)))], SECOND)
    for step in range(3):
        stamp = SECOND + step * SECOND // 10
        robot.receive_transforms([(stamp, Transform("/odom", "/base", Pose2(0.1 * step, 0, 0)))], stamp)
    robot.receive_pose(located(1.2, 77))
    assert where(robot, 1.2) == (10.2, 0)
    assert robot.twist.linear == pytest.approx(1.0)
    robot.receive_transforms([(SECOND, Transform("map", "other/odom", Pose2(99, 0, 0)))], SECOND)
    assert where(robot, 1.2) == (10.2, 0)


def test_other_frames_are_refused_and_say_which_key_to_change(robot):
    refused = robot.receive_odometry(odometry(1, 0, frame="robot7/odom"), 0)
    assert isinstance(refused, InvalidMessage)
    assert "'robot7/odom'" in refused.sentence
    assert "odom_frame" in refused.sentence
    assert isinstance(robot.receive_pose(located(1, 0, frame="world")), InvalidMessage)
    assert isinstance(robot.receive_pose(located(1, math.nan)), InvalidMessage)
    assert isinstance(robot.receive_odometry(odometry(1, math.inf), 0), InvalidMessage)
    assert robot.estimate(0, 0) is None


def test_a_localiser_that_falls_silent_makes_the_robot_lost(robot):
    heard(robot, 1, 0.0)
    robot.receive_transforms([(SECOND, Transform("map", "odom", Pose2(0, 0, 0)))], SECOND)
    assert not robot.estimate(0, SECOND + STALE_NS).lost
    assert robot.estimate(0, SECOND + STALE_NS + 1).lost
    robot.receive_transforms([(SECOND, Transform("map", "odom", Pose2(0, 0, 0)))], 9 * SECOND)
    assert not robot.estimate(0, 9 * SECOND).lost


def test_without_tf_a_way_driven_blindly_makes_it_lost_and_standing_does_not(robot):
    heard(robot, 1, 0.0)
    robot.receive_pose(located(1, 0))
    assert not robot.estimate(0, 1000 * SECOND).lost
    for step in range(1, 12):
        heard(robot, 1 + step, step * UNLOCALIZED_DISTANCE / 10)
    assert robot.estimate(0, 13 * SECOND).lost
    robot.receive_pose(located(12, 3))
    assert not robot.estimate(0, 13 * SECOND).lost


@pytest.mark.parametrize(("seconds", "x"), [(2.02, 0.0), (-100.0, 4.9)])
def test_a_driver_that_counts_anew_makes_the_robot_lost_until_the_next_correction(robot, seconds, x):
    heard(robot, 2, 5.0)
    robot.receive_pose(located(2, 5))
    for later in (0.0, 0.02):
        assert not robot.estimate(0, 2 * SECOND).lost
        robot.receive_odometry(odometry(seconds + later, x), round((2.02 + later) * SECOND))
    assert robot.estimate(0, 3 * SECOND).lost
    (notice,) = robot.notices
    assert ("its clock was set back by 102.0 s" if seconds < 0 else "its odometry was reset") in notice
    robot.receive_pose(located(seconds, 5.1))
    assert not robot.estimate(0, 3 * SECOND).lost
    assert where(robot, 3) == (5.1, 0)


def test_an_outlier_of_odometry_moves_nothing_and_is_reported(robot):
    heard(robot, 1, 5.0)
    robot.receive_transforms([(SECOND, Transform("map", "odom", Pose2(10, 0, 0)))], SECOND)
    for number in range(1, 11):
        heard(robot, 1 + 0.02 * number, 1005.0 if number % 2 else 5.0)
        assert where(robot, 1.2) == (15, 0)
        assert not robot.estimate(0, 2 * SECOND).lost
    notice = "an odometry message is left out: its pose is 1000.0 m away"
    assert robot.notices == [f"{notice} ({count} so far)" for count in (1, 2, 4)]
