import math

import pytest

from sim.common.geometry import Pose2
from tests.support.ros.watched_messages import tf
from ui.model.watching.frames import Frames, children_of


def test_messages_about_the_same_frames_have_one_key() -> None:
    one = tf(0, ("map", "odom", Pose2(0, 0, 0)), ("odom", "base", Pose2(1, 2, 3)))
    same = tf(1, ("map", "odom", Pose2(5, 0, 1)), ("odom", "base", Pose2(0, 0, 0)))
    fewer = tf(1, ("map", "odom", Pose2(5, 0, 1)))
    assert children_of(one.data) == children_of(same.data) != children_of(fewer.data)


def test_what_is_no_message_is_refused() -> None:
    data = tf(0, ("map", "odom", Pose2(0, 0, 0))).data
    for length in (0, 3, 10, 20):
        with pytest.raises(ValueError, match="incomplete"):
            children_of(data[:length])


def test_frames_hang_on_the_map() -> None:
    frames = Frames([tf(0, ("map", "odom", Pose2(1, 0, math.pi / 2))), tf(1, ("/odom", "/base", Pose2(2, 0, 0)))])
    pose = frames.planar("base")
    assert pose is not None
    assert (pose.x, pose.y, pose.theta) == pytest.approx((1, 2, math.pi / 2))
    assert frames.planar("elsewhere") is None


def test_the_last_word_on_a_frame_holds() -> None:
    frames = Frames([tf(0, ("map", "base", Pose2(1, 0, 0))), tf(1, ("map", "base", Pose2(2, 0, 0)))])
    assert frames.planar("base") == Pose2(2, 0, 0)


def test_robots_whose_frames_have_the_same_names_are_told_apart_by_their_topics() -> None:
    frames = Frames(
        [
            tf(0, ("map", "odom", Pose2(1, 0, 0)), topic="/r1/tf"),
            tf(0, ("map", "odom", Pose2(2, 0, 0)), topic="/r2/tf"),
        ]
    )
    assert [frames.planar("odom", owner) for owner in ("r1", "r2")] == [Pose2(1, 0, 0), Pose2(2, 0, 0)]


def test_where_there_is_no_map_frames_are_seen_from_odometry() -> None:
    frames = Frames([tf(0, ("odom", "base", Pose2(1, 2, 0)))], mapped=False)
    assert frames.planar("base") == Pose2(1, 2, 0)
    assert frames.planar("laser") is None


def test_frames_that_hang_on_each_other_hang_nowhere() -> None:
    frames = Frames([tf(0, ("a", "b", Pose2(1, 0, 0)), ("b", "a", Pose2(1, 0, 0)), ("map", "c", Pose2(0, 0, 0)))])
    assert frames.planar("a") is None
