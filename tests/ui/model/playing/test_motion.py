"""Robots on the map move smoothly, a little behind, and never back, whatever the network does."""

import itertools
import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.numerics.elementary import wrap_angle
from thbridge.roles.shared.notices import Ellipse, PlannedPaths, PoseTelemetry
from ui.model.playing.motion import KEPT_SAMPLES, MotionPlayback
from ui.model.playing.trails import TRAIL_POINTS

FRAME = 1.0 / 60.0
PERIOD = 0.04
"""Seconds between two messages: 25 Hz."""


def where(tick: int, *poses: tuple[float, float, float], **more: object) -> PoseTelemetry:
    return PoseTelemetry(tick=tick, poses=poses, **more)  # type: ignore[arg-type]


@dataclass
class ShownPose:
    now: float
    x: float
    y: float
    theta: float


def play(
    motions: MotionPlayback, arrivals: list[tuple[float, PoseTelemetry]], until: float, begin: float = 0.0
) -> list[ShownPose]:
    """Poses of the first robot as shown at 60 Hz while messages arrive."""
    shown = []
    waiting = sorted(arrivals, key=lambda arrival: arrival[0])
    for frame in range(round((until - begin) / FRAME)):
        now = begin + frame * FRAME
        while waiting and waiting[0][0] <= now:
            moment, message = waiting.pop(0)
            motions.receive(message, moment)
        robots = motions.at(now)
        if robots:
            pose = robots[0].pose
            shown.append(ShownPose(now, pose.x, pose.y, pose.theta))
    return shown


def straight(
    seconds: float, speed: float = 0.5, rate: float = 1.0, start_tick: int = 0
) -> list[tuple[float, PoseTelemetry]]:
    """A straight drive along x, received at once."""
    count = round(seconds / PERIOD)
    ticks = [start_tick + round(k * PERIOD * rate / 0.02) for k in range(count)]
    return [(k * PERIOD, where(tick, (speed * (tick - start_tick) * 0.02, 0.0, 0.0))) for k, tick in enumerate(ticks)]


def in_order(arrivals: list[tuple[float, PoseTelemetry]]) -> list[tuple[float, PoseTelemetry]]:
    """A stream keeps its order: nothing overtakes what was sent before."""
    moments = np.maximum.accumulate([moment for moment, _ in arrivals]).tolist()
    return [(moment, message) for moment, (_, message) in zip(moments, arrivals, strict=True)]


@settings(max_examples=25)
@given(
    jitter=st.lists(st.floats(0.0, 0.03), min_size=75, max_size=75),
    dropped=st.sets(st.integers(5, 74), max_size=20),
    speed=st.floats(0.05, 1.0),
    stall=st.tuples(st.integers(10, 60), st.floats(0.0, 0.4)),
)
def test_a_straight_drive_never_goes_back(
    jitter: list[float], dropped: set[int], speed: float, stall: tuple[int, float]
) -> None:
    at, long = stall
    drive = straight(3.0, speed)
    late = [
        (moment + delay + (long if at <= k < at + 10 else 0.0), message)
        for k, ((moment, message), delay) in enumerate(zip(drive, jitter, strict=True))
        if k not in dropped
    ]
    shown = play(MotionPlayback(), in_order(late), 3.5)
    highest = np.maximum.accumulate([one.x for one in shown])
    assert np.max(highest - [one.x for one in shown]) < 0.01
    assert all(one.x <= speed * 3.0 + 0.06 for one in shown)


@settings(max_examples=25)
@given(jitter=st.lists(st.floats(0.0, 0.015), min_size=75, max_size=75), speed=st.floats(0.2, 1.0))
def test_what_is_shown_is_at_most_a_tenth_of_a_second_behind(jitter: list[float], speed: float) -> None:
    drive = straight(3.0, speed)
    shown = play(
        MotionPlayback(),
        in_order([(now + delay, message) for (now, message), delay in zip(drive, jitter, strict=True)]),
        2.9,
    )
    settled = [one for one in shown if one.now > 0.5]
    behind = [one.now - one.x / speed for one in settled]
    assert max(behind) < 0.1


def test_steps_between_frames_are_even_in_spite_of_jitter() -> None:
    delays = [0.012 * (k * 7 % 5) / 4 for k in range(75)]
    drive = straight(3.0, 1.0)
    late = [(now + delay, message) for (now, message), delay in zip(drive, delays, strict=True)]
    xs = np.array([one.x for one in play(MotionPlayback(), in_order(late), 2.9) if one.now > 0.5])
    steps = np.diff(xs)
    assert steps.min() > 0.5 * FRAME
    assert steps.max() < 1.5 * FRAME


@pytest.mark.parametrize("rate", [0.25, 0.5, 2.0, 4.0])
def test_a_simulation_at_another_rate_is_followed(rate: float) -> None:
    shown = play(MotionPlayback(), straight(3.0, 0.5, rate), 2.9)
    settled = [one for one in shown if one.now > 1.5]
    behind = [(one.now - one.x / (0.5 * rate)) for one in settled]
    assert max(behind) < 0.1 + 0.02 / rate
    assert min(behind) > -0.05


def test_a_late_message_is_bridged_and_what_was_bridged_is_bounded() -> None:
    shown = play(MotionPlayback(), straight(1.0, 1.0), 3.0)
    newest = 0.96
    assert shown[-1].x > newest
    assert shown[-1].x < newest + 0.06


def test_messages_held_up_and_delivered_in_one_go_are_caught_up_with() -> None:
    held_up = [(2.0 if 1.5 <= now < 2.0 else now, message) for now, message in straight(4.0)]
    shown = play(MotionPlayback(), held_up, 3.9)
    settled = [one.now - one.x / 0.5 for one in shown if one.now > 2.4]
    assert max(settled) < 0.1
    assert min(settled) > -0.02


def test_a_pause_is_waited_out() -> None:
    before, after = straight(1.0, 0.5), straight(1.0, 0.5)
    pose = before[-1][1].poses[0]
    tick = before[-1][1].tick
    resumed = [
        (now + 11.0, where(tick + message.tick, (pose[0] + message.poses[0][0], 0.0, 0.0))) for now, message in after
    ]
    shown = play(MotionPlayback(), before + resumed, 11.9)
    xs = [one.x for one in shown]
    assert np.max(np.maximum.accumulate(xs) - xs) < 0.01
    assert xs[-1] > 0.85


def test_a_corrected_estimate_is_blended() -> None:
    drive = straight(2.0, 0.5)
    corrected = [(now, where(t.tick, (t.poses[0][0], 0.2 if now >= 1.0 else 0.0, 0.0))) for now, t in drive]
    shown = play(MotionPlayback(), corrected, 1.9)
    ys = np.array([one.y for one in shown])
    assert np.diff(ys).max() < 0.06
    assert np.diff(ys).min() > -1e-9
    settled = [one.y for one in shown if one.now > 1.3]
    assert min(settled) > 0.19


def test_small_corrections_do_not_pull_a_robot_back() -> None:
    drive = [(now, where(t.tick, (t.poses[0][0] - 0.03 * int(now), 0.0, 0.0))) for now, t in straight(4.0, 0.5)]
    xs = np.array([one.x for one in play(MotionPlayback(), drive, 3.9)])
    assert np.diff(xs).min() > -0.001


def test_a_robot_that_was_carried_moves_at_once_and_leaves_no_trail() -> None:
    motions = MotionPlayback()
    carried = [
        (now, where(t.tick, (t.poses[0][0] + (3.0 if now >= 1.0 else 0.0), 0.0, 0.0))) for now, t in straight(2.0, 0.5)
    ]
    shown = play(motions, carried, 1.1)
    assert not [one for one in shown if 0.6 < one.x < 3.4]
    assert motions.at(1.1)[0].trail[:, 0].min() > 3.4


def test_angles_turn_the_short_way() -> None:
    turning = [(k * PERIOD, where(2 * k, (0.0, 0.0, wrap_angle(3.0 + 0.02 * k)))) for k in range(50)]
    headings = [one.theta for one in play(MotionPlayback(), turning, 1.9)]
    steps = [abs(wrap_angle(other - one)) for one, other in itertools.pairwise(headings)]
    assert max(steps) < 0.03
    assert min(headings) < -3.0 < 3.0 < max(headings)


def test_a_simulation_that_begins_anew_is_shown_from_its_start() -> None:
    motions = MotionPlayback()
    play(motions, straight(2.0, 0.5), 2.0)
    motions.receive(where(0, (7.0, 7.0, 0.0)), 2.0)
    (robot,) = motions.at(2.01)
    assert (robot.pose.x, robot.pose.y) == (7.0, 7.0)
    assert len(robot.trail) == 1


def test_another_number_of_robots_begins_anew() -> None:
    motions = MotionPlayback()
    motions.receive(where(0, (0.0, 0.0, 0.0)), 0.0)
    motions.receive(where(2, (0.0, 0.0, 0.0), (1.0, 1.0, 0.0)), 0.04)
    assert [robot.pose.x for robot in motions.at(0.05)] == [0.0, 1.0]


def test_robots_carried_while_the_simulation_stands_still_are_shown_there() -> None:
    motions = MotionPlayback()
    play(motions, straight(1.0, 0.5), 2.0)
    motions.receive(where(48, (5.0, 0.0, 0.0)), 2.0)
    assert motions.at(2.1)[0].pose.x == pytest.approx(5.0)


def test_memory_is_bounded() -> None:
    motions = MotionPlayback()
    circle = [
        (k * PERIOD, where(2 * k, (3 * math.cos(0.02 * k), 3 * math.sin(0.02 * k), wrap_angle(0.02 * k + 1.57))))
        for k in range(2000)
    ]
    play(motions, circle, 80.0)
    assert len(motions.at(80.0)[0].trail) == TRAIL_POINTS
    assert len(motions._samples) <= KEPT_SAMPLES


def test_trails_are_thinned_and_lie_where_the_robot_was() -> None:
    motions = MotionPlayback()
    play(motions, straight(3.0, 0.5), 3.0)
    trail = motions.at(3.0)[0].trail
    assert np.diff(trail[:, 0]).min() > 0.05
    assert np.all(trail[:, 1] == 0.0)


def test_a_way_begins_at_the_robot_and_what_is_driven_does_not_come_back() -> None:
    motions = MotionPlayback()
    motions.receive(PlannedPaths(0, (tuple((0.1 * k, 0.0) for k in range(31)),)), 0.0)
    play(motions, straight(2.0, 0.5), 2.0)
    (robot,) = motions.at(2.0)
    assert robot.path[0] == pytest.approx([robot.pose.x, robot.pose.y])
    assert robot.path[1, 0] > robot.pose.x
    assert robot.path[-1] == pytest.approx([3.0, 0.0])


def test_a_path_sent_again_with_another_s_stays_as_far_driven() -> None:
    motions = MotionPlayback()
    out = tuple((0.1 * k, 0.0) for k in range(61))
    motions.receive(PlannedPaths(0, (out,)), 0.0)
    play(motions, straight(5.0, 1.0), 5.0)
    before = len(motions.at(5.0)[0].path)
    motions.receive(PlannedPaths(250, (out, ((0.0, 0.0), (1.0, 0.0)))), 5.0)
    assert len(motions.at(5.0)[0].path) == before < 15


def test_who_comes_late_sees_what_still_lies_ahead() -> None:
    motions = MotionPlayback()
    motions.receive(PlannedPaths(0, (tuple((0.1 * k, 0.0) for k in range(61)),)), 0.0)
    motions.receive(where(0, (5.0, 0.0, 0.0)), 0.0)
    assert len(motions.at(0.0)[0].path) < 15


def test_the_same_moment_sent_again_changes_nothing() -> None:
    once, twice = MotionPlayback(), MotionPlayback()
    drive = straight(1.0, 0.5)
    again = [arrival for now, message in drive for arrival in ((now, message), (now + 0.001, message))]
    expected = [one.x for one in play(once, drive, 1.0)]
    assert [one.x for one in play(twice, again, 1.0)] == pytest.approx(expected, abs=1e-4)


def test_a_way_that_comes_back_near_itself_is_driven_in_its_order() -> None:
    motions = MotionPlayback()
    out = [(0.1 * k, 0.0) for k in range(41)]
    back = [(4.0 - 0.1 * k, 0.2) for k in range(41)]
    motions.receive(PlannedPaths(0, ((*out, *back),)), 0.0)
    play(motions, straight(1.0, 0.5), 1.0)
    assert len(motions.at(1.0)[0].path) > 60


def test_no_way_is_empty() -> None:
    motions = MotionPlayback()
    motions.receive(PlannedPaths(0, ((),)), 0.0)
    motions.receive(where(0, (0.0, 0.0, 0.0)), 0.0)
    assert motions.at(0.0)[0].path.shape == (0, 2)


def test_truth_and_ellipse_come_along() -> None:
    motions = MotionPlayback()
    for k in range(50):
        motions.receive(
            where(2 * k, (0.02 * k, 0.0, 0.0), truth=((0.02 * k, 0.3, 0.0),), ellipses=(Ellipse(0.5, 0.2, 0.1),)),
            k * PERIOD,
        )
        motions.at(k * PERIOD)
    (robot,) = motions.at(2.0)
    assert robot.truth is not None
    assert (robot.truth.x, robot.truth.y) == pytest.approx((robot.pose.x, 0.3), abs=2e-3)
    assert robot.ellipse == Ellipse(0.5, 0.2, 0.1)


def test_nothing_is_shown_before_anything_was_received() -> None:
    assert MotionPlayback().at(1.0) == ()


def test_numbers_that_are_none_are_not_taken() -> None:
    motions = MotionPlayback()
    motions.receive(where(0, (math.nan, 0.0, 0.0)), 0.0)
    assert motions.at(0.0) == ()
