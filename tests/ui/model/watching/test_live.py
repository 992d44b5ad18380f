import math
from dataclasses import replace

import numpy as np
import pytest

from sim.common.geometry import Pose2
from tests.support.bags.drawn_team import MOUNT, SCAN_PERIOD, SESSION, arena, records, snapshots
from tests.support.ros.watched_messages import SECOND, StampedMessage, odometry, tf
from thbridge.ros.publisher import RosMessage, TeamPublisher
from ui.model.watching.live import LiveSource
from ui.model.watching.scene import ShownLayers
from ui.model.watching.session_log import is_logged


def stamped(messages: list[RosMessage]) -> list[StampedMessage]:
    return [
        StampedMessage(message.topic.name, message.topic.msgtype, message.stamp_ns, message.data)
        for message in messages
    ]


def opening() -> list[StampedMessage]:
    return stamped(TeamPublisher(2, MOUNT, SCAN_PERIOD).opening(0, SESSION, arena()))


def ticks(first: int, count: int) -> list[StampedMessage]:
    publisher = TeamPublisher(2, MOUNT, SCAN_PERIOD)
    return [
        message for each in snapshots(2, count, first) for message in stamped(publisher.tick(each, records(each.tick)))
    ]


@pytest.fixture
def source() -> LiveSource:
    live = LiveSource()
    live.take([*opening(), *ticks(0, 100)], 10.0)
    return live


def test_nothing_is_there_before_anything_is_received() -> None:
    live = LiveSource()
    assert (live.scene(ShownLayers()).robots, live.session, live.messages) == ((), None, 0)
    assert live.stale_for(5.0) == math.inf


def test_it_shows_the_last_messages(source: LiveSource) -> None:
    scene = source.scene(ShownLayers())
    assert (scene.stamp_ns - source.start_ns) / SECOND == pytest.approx(99 / 50)
    assert source.session == SESSION
    assert scene.grid == arena()
    assert [robot.name for robot in scene.robots] == ["robot 1", "robot 2"]
    assert all(robot.error is not None and robot.error < 0.2 for robot in scene.robots)
    assert source.stale_for(12.5) == 2.5


def test_messages_from_before_robots_are_told_apart_are_taken_for_their_own_robots() -> None:
    messages = ticks(0, 100)
    poses = [[each for each in messages if each.topic == f"/robot{number}/amcl_pose"] for number in (1, 2)]
    latched = [poses[1][0], poses[0][-1]]
    live = LiveSource()
    live.take([*opening(), *latched, *ticks(100, 20)], 10.0)
    for robot, pose in enumerate((poses[0][-1], poses[1][0])):
        series = live.series.of(robot)
        times = series.deviations.rows(until=99 / 50)[:, 0]
        assert times == pytest.approx([(pose.stamp_ns - live.start_ns) / SECOND])
        assert series.estimate.rows()[0, 0] >= 100 / 50


def test_another_session_begins_anew(source: LiveSource) -> None:
    events = len(source.log.entries("event"))
    source.take([*opening(), *ticks(0, 1)], 20.0)
    assert source.sessions == 1
    assert len(source.log.entries("event")) < events
    scene = source.scene(ShownLayers())
    assert scene.stamp_ns == source.start_ns
    assert scene.grid == arena()  # published before its robots tell that it is another session
    assert len(source.series.of(0).truth) == 1


def test_a_session_that_introduces_itself_otherwise_is_another_though_its_time_goes_on(source: LiveSource) -> None:
    other = replace(SESSION, seed=SESSION.seed + 1)
    introduced = stamped(TeamPublisher(2, MOUNT, SCAN_PERIOD).opening(0, other, arena()))
    source.take([*introduced, *ticks(120, 1)], 20.0)
    assert (source.sessions, source.session) == (1, other)
    assert len(source.series.of(0).truth) == 1


def test_who_comes_late_knows_since_when_it_knows() -> None:
    live = LiveSource()
    live.take(opening(), 10.0)
    assert live.joined_ns is None
    live.take(ticks(100, 20), 10.0)
    assert live.joined_ns is not None
    assert live.joined_ns - live.start_ns == pytest.approx(2 * SECOND, abs=0.02 * SECOND)


def test_the_same_session_met_again_goes_on(source: LiveSource) -> None:
    """A door tells newcomers what is latched first, as old as it is."""
    samples = len(source.series.of(0).truth)
    source.take([*opening(), *ticks(120, 50)], 20.0)
    assert source.sessions == 0
    assert len(source.series.of(0).truth) > samples
    assert len(source.series.gaps) == 1
    robot = source.scene(ShownLayers()).robots[0]
    for path in (robot.truth_path, robot.estimate_path, robot.odometry_path):
        (gap,) = np.flatnonzero(np.isnan(path[:, 0]))
        assert 0 < gap == samples, "no line leads over what was missed"


def test_of_what_the_same_session_repeats_only_what_was_missed_is_listed(source: LiveSource) -> None:
    seen = len(source.log.entries("event")), len(source.log.entries("line"))
    missed = [each for each in ticks(100, 100) if is_logged(each.topic, each.msgtype)]
    repeated = [each for each in ticks(0, 100) if is_logged(each.topic, each.msgtype)]
    source.take([*opening(), *repeated, *missed, *ticks(200, 1)], 20.0)
    fresh = LiveSource()
    fresh.take([*opening(), *repeated, *missed, *ticks(200, 1)], 20.0)
    for kind, before in zip(("event", "line"), seen, strict=True):
        assert len(source.log.entries(kind)) > before > 0
        assert source.log.entries(kind) == fresh.log.entries(kind)


def test_frames_of_a_while_ago_are_those_that_held_then() -> None:
    live = LiveSource()
    live.take([tf(second, ("map", "odom", Pose2(second, 0, 0))) for second in (1.0, 1.5, 2.0)], 0.0)
    scene = live.scene(ShownLayers())
    assert scene.robots == ()
    live.take([odometry(2.0, Pose2(1, 0, 0))], 0.0)
    (robot,) = live.scene(ShownLayers()).robots
    assert robot.estimate == Pose2(3, 0, 0)


def test_frames_that_are_not_sent_any_more_are_forgotten() -> None:
    live = LiveSource()
    live.take([tf(1, ("map", "odom", Pose2(1, 0, 0))), odometry(1, Pose2(0, 0, 0))], 0.0)
    assert live.scene(ShownLayers()).robots[0].estimate is not None
    live.take([odometry(12, Pose2(0, 0, 0), speed=1.0)], 0.0)
    (robot,) = live.scene(ShownLayers()).robots
    assert (robot.speed, robot.estimate) == (1.0, None)


def test_messages_that_cannot_be_read_are_left_out(source: LiveSource) -> None:
    broken = [StampedMessage(each.topic, each.msgtype, each.stamp_ns, each.data[:9]) for each in ticks(100, 20)]
    source.take(broken, 11.0)
    scene = source.scene(ShownLayers())
    assert [robot.truth for robot in scene.robots] == [None, None]
