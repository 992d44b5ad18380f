"""Odometry that cannot be true: left out or joined, and named."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from sim.common.geometry import Pose2
from tests.support.ros.straight_odometry import SECOND, straight, x_at
from thbridge.offline.odometry import OdometryTrack
from thbridge.ros.odometry_faults import FaultKind, OdometrySample, fault_sentences, sound_odometry


def drive(count: int = 60, offset: float = 0.0) -> list[OdometrySample]:
    """One meter a second, 50 messages a second, from 1 s."""
    return straight(SECOND, count, offset, SECOND // 50)


def moved_from(index: int, steps: list[OdometrySample], by: Pose2) -> list[OdometrySample]:
    """The same odometry seen from another origin, from one message on."""
    moved = [step._replace(base_in_odom=by.compose(step.base_in_odom)) for step in steps[index:]]
    return [*steps[:index], *moved]


@pytest.mark.parametrize("bad", [[20], [20, 21, 22], [20, 25, 26, 40], [0], [0, 1], [59], range(18, 30)])
@pytest.mark.parametrize("off", [Pose2(1000.0, 0.0, 0.0), Pose2(0.0, -3.0, 0.0), Pose2(0.0, 0.0, 3.0)])
def test_where_the_robot_cannot_have_driven_is_left_out_and_named(bad: Sequence[int], off: Pose2) -> None:
    steps = drive()
    for index in bad:
        there = steps[index].base_in_odom
        steps[index] = steps[index]._replace(base_in_odom=Pose2(there.x + off.x, off.y, off.theta))
    track = OdometryTrack(steps)
    assert [x_at(track, steps[index].stamp_ns) for index in (10, 23, 50)] == [0.2, 0.46, 1.0]
    assert [(fault.kind, fault.stamp_ns) for fault in track.faults] == [
        (FaultKind.OUTLIER, steps[index].stamp_ns) for index in bad
    ]
    assert all(fault.distance == pytest.approx(math.hypot(off.x, off.y), abs=0.3) for fault in track.faults)
    assert all(fault.turn == pytest.approx(abs(off.theta), abs=0.01) for fault in track.faults)
    assert not track.missed(0, 100 * SECOND)


def test_an_outlier_is_one_also_where_only_the_way_to_it_is_too_long() -> None:
    steps = drive()
    steps[20] = steps[20]._replace(base_in_odom=Pose2(steps[20].base_in_odom.x + 0.11, 0.0, 0.0))
    track = OdometryTrack(steps)
    assert [(fault.kind, fault.stamp_ns) for fault in track.faults] == [(FaultKind.OUTLIER, steps[20].stamp_ns)]
    assert x_at(track, steps[-1].stamp_ns) == pytest.approx(59 * 0.02)


def test_the_increments_go_on_after_a_reset() -> None:
    """Another heading, too: the robot is turned by a quarter in the new frame."""
    reset = Pose2(0.0, 0.0, 0.4).compose(Pose2(-7.6, 0.0, 0.0))
    steps = moved_from(30, drive(offset=7.0), reset)
    track = OdometryTrack(steps)
    (fault,) = track.faults
    assert fault.kind is FaultKind.RESET
    assert fault.distance == pytest.approx(7.58)
    poses = [track.at(step.stamp_ns, step.received_ns) for step in steps]
    assert [pose.x for pose in poses if pose] == pytest.approx([7.0 + 0.02 * (i - (i >= 30)) for i in range(60)])
    assert all(abs(pose.theta) < 1e-9 for pose in poses if pose)
    (missed,) = track.missed(0, 100 * SECOND)
    assert (missed.received_ns, missed.distance, missed.turn) == (steps[30].received_ns, 0.05, 0.03)


def test_a_jump_to_elsewhere_and_back_is_no_motion() -> None:
    steps = moved_from(100, moved_from(30, drive(160), Pose2(40.0, 0.0, 0.0)), Pose2(-40.0, 0.0, 0.0))
    track = OdometryTrack(steps)
    assert [fault.kind for fault in track.faults] == [FaultKind.JUMP, FaultKind.JUMP]
    assert x_at(track, steps[-1].stamp_ns) == pytest.approx(0.02 * 157)


def test_what_a_robot_can_drive_is_no_fault() -> None:
    """It stands, drives off, gets as fast as a car; its messages come in bursts, and once after a gap."""
    x, ns, steps = 0.0, SECOND, []
    for number in range(2000):
        speed = 0.0 if number < 500 else min(0.1 * (number - 500), 20.0)
        gap = 3 * (number == 1500)
        ns += (10**6 if number % 5 else 96 * 10**6) + gap * SECOND
        x += speed * (0.02 + gap)
        steps.append(OdometrySample(ns, ns, Pose2(x, 0.0, 0.0)))
    assert not OdometryTrack(steps).faults


def test_the_fastest_speed_can_be_given() -> None:
    steps = moved_from(30, drive(), Pose2(0.05, 0.0, 0.0))
    assert not OdometryTrack(steps).faults
    assert [fault.kind for fault in OdometryTrack(steps, 1.5).faults] == [FaultKind.JUMP]


def test_a_clock_that_was_set_ahead_is_named_and_nothing_is_lost() -> None:
    steps = straight(100 * SECOND, 40)
    steps[20:] = [step._replace(stamp_ns=step.stamp_ns + 3600 * SECOND) for step in steps[20:]]
    track = OdometryTrack(steps)
    assert [(fault.kind, fault.seconds) for fault in track.faults] == [(FaultKind.CLOCK_AHEAD, 3600.0)]
    assert x_at(track, 3703 * SECOND, 103 * SECOND) == 3.0
    assert len(track) == 40


def test_a_simulation_that_restarts_goes_on_from_the_last_pose() -> None:
    """Clock and odometry begin again; the robot need not have moved."""
    first = straight(100 * SECOND, 40, offset=30.0)
    again = [step._replace(received_ns=step.received_ns + 4 * SECOND) for step in straight(100 * SECOND, 40)]
    track = OdometryTrack(first + again)
    assert [fault.kind for fault in track.faults] == [FaultKind.CLOCK_BACK, FaultKind.RESET]
    assert x_at(track, 101 * SECOND, 105 * SECOND) == pytest.approx(34.9)


def test_faults_are_told_with_topic_time_and_size() -> None:
    steps = drive()
    steps[20] = steps[20]._replace(base_in_odom=Pose2(1000.0, 0.0, 0.0))
    track = OdometryTrack(moved_from(40, steps, Pose2(-0.8, 0.0, 0.0)))
    assert list(fault_sentences("/odom", track.faults, track.begin_ns)) == [
        "/odom: messages left out as outliers, because the robot cannot have driven there: 1 (after 0.40 s, by 999.6 m "
        "and 0.00 rad).",
        "/odom: resets to 0; from then on, only increments are used: 1 (after 0.80 s, by 0.8 m and 0.00 rad).",
    ]


def test_it_says_which_samples_are_sound_and_where_they_go_on_elsewhere() -> None:
    """An outlier, a reset, and a clock that is set back by an hour."""
    steps = drive(80)
    steps[10] = steps[10]._replace(base_in_odom=Pose2(1000.0, 0.0, 0.0))
    steps = moved_from(30, steps, Pose2(-40.0, 0.0, 0.0))
    steps[60:] = [step._replace(stamp_ns=step.stamp_ns - 3600 * SECOND) for step in steps[60:]]
    sound = sound_odometry(steps, None)
    assert sound.kept.tolist() == [index for index in range(80) if index != 10]
    assert sound.kept[sound.cuts].tolist() == [30, 60]


def test_nothing_to_judge() -> None:
    sound = sound_odometry([], None)
    assert (sound.runs, sound.faults, sound.kept.tolist(), sound.cuts.tolist()) == ((), (), [], [])
    alone = sound_odometry([OdometrySample(1, 1, Pose2(np.nan, 0.0, 0.0))], None)
    assert (alone.kept.tolist(), [fault.kind for fault in alone.faults]) == ([], [FaultKind.NOT_FINITE])
