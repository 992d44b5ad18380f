import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from tests.support.ros.straight_odometry import SECOND, straight, x_at
from thbridge.offline.odometry import LONGEST_GAP_NS, REACH_NS, OdometryTrack
from thbridge.ros.odometry_faults import FaultKind, OdometrySample


@given(st.integers(0, 19 * SECOND // 10))
def test_between_two_messages_the_way_is_straight(stamp: int) -> None:
    assert x_at(OdometryTrack(straight(0, 20)), stamp) == pytest.approx(stamp / SECOND, abs=1e-6)


@given(st.permutations(range(12)))
def test_the_order_of_messages_does_not_matter(order: list[int]) -> None:
    steps = straight(0, 12, period=SECOND // 20)
    track = OdometryTrack([steps[index]._replace(received_ns=0) for index in order])
    assert x_at(track, SECOND // 4) == 0.25
    assert not track.faults


def test_headings_are_taken_the_short_way() -> None:
    track = OdometryTrack([OdometrySample(0, 0, Pose2(0, 0, 3.0)), OdometrySample(SECOND, SECOND, Pose2(0, 0, -3.0))])
    pose = track.at(SECOND // 2, 0)
    assert pose is not None
    assert abs(pose.theta) == pytest.approx(math.pi)


def test_a_motion_is_carried_on_a_little_way_only() -> None:
    track = OdometryTrack(straight(SECOND, 11))
    assert x_at(track, SECOND - REACH_NS) == -0.1
    assert x_at(track, 2 * SECOND + REACH_NS) == 1.1
    assert x_at(track, SECOND - REACH_NS - 1) is None
    assert x_at(track, 2 * SECOND + REACH_NS + 1) is None


def test_a_long_gap_has_no_odometry() -> None:
    track = OdometryTrack([*straight(0, 3), *straight(5 * SECOND, 3, offset=5.0)])
    assert x_at(track, 2 * SECOND) is None
    assert x_at(track, 2 * SECOND // 10 + REACH_NS) == 0.2
    assert x_at(track, 5 * SECOND - REACH_NS) == 5.0
    assert x_at(OdometryTrack(straight(0, 2, period=LONGEST_GAP_NS)), SECOND // 2) == 0.5


def test_of_two_with_the_same_stamp_the_last_holds() -> None:
    track = OdometryTrack(
        [
            OdometrySample(SECOND, SECOND, Pose2(0, 0, 0)),
            OdometrySample(SECOND + 1, SECOND, Pose2(1, 0, 0)),
            OdometrySample(SECOND + 2, 2 * SECOND, Pose2(2, 0, 0)),
        ]
    )
    assert x_at(track, SECOND) == 1.0


def test_a_clock_that_was_set_back_begins_a_new_run() -> None:
    """The same stamps twice: when a scan was recorded tells which are meant."""
    before = [step._replace(received_ns=step.stamp_ns) for step in straight(100 * SECOND, 20)]
    after = [step._replace(received_ns=step.stamp_ns + 10 * SECOND) for step in straight(100 * SECOND, 20, 7.0)]
    track = OdometryTrack(before + after)
    assert [(fault.kind, fault.seconds) for fault in track.faults] == [(FaultKind.CLOCK_BACK, -10.0)]
    assert x_at(track, 101 * SECOND, 101 * SECOND) == 1.0
    assert x_at(track, 101 * SECOND, 111 * SECOND) == 8.0


def test_one_odd_stamp_does_not_hide_what_follows() -> None:
    steps = straight(100 * SECOND, 20)
    steps.insert(10, OdometrySample(steps[10].received_ns, 5, Pose2(0, 0, 0)))
    track = OdometryTrack(steps)
    assert [x_at(track, 100 * SECOND + i * SECOND // 10) for i in (5, 9, 10, 15)] == [0.5, 0.9, 1.0, 1.5]
    assert [fault.kind for fault in track.faults] == [FaultKind.WRONG_STAMP]


def test_what_is_not_finite_is_left_out() -> None:
    steps = straight(0, 3)
    steps.insert(1, OdometrySample(1, 1, Pose2(math.nan, 0, 0)))
    steps.insert(2, OdometrySample(2, 2, Pose2(1e300, 0, 0)))
    track = OdometryTrack(steps)
    assert len(track) == 3
    assert [fault.kind for fault in track.faults] == [FaultKind.NOT_FINITE] * 2


def test_no_odometry_at_all() -> None:
    assert OdometryTrack([]).at(0, 0) is None


@pytest.mark.parametrize("every", [1, 5])
def test_messages_that_are_not_stamped_are_of_the_time_of_recording(every: int) -> None:
    steps = straight(SECOND, 20)
    track = OdometryTrack(step._replace(stamp_ns=0) if not n % every else step for n, step in enumerate(steps))
    assert (track.unstamped, track.faults) == (20 // every, ())
    assert x_at(track, 2 * SECOND) == 1.0
