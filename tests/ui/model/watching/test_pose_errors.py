"""Errors in the researcher's window: estimates and the truth of the same stamps, however late either is recorded."""

from collections.abc import Callable
from dataclasses import dataclass

import pytest

from sim.common.geometry import Pose2
from sim.numerics.float_array import FloatArray
from tests.support.bags.foreign_bags import STORE
from tests.support.bags.late_stamps import BEGIN, HOUR, LATE, TENTH, pose
from thbridge.ros.messages import types
from ui.model.watching.curves import Curve
from ui.model.watching.pose_errors import PoseErrors


@dataclass(frozen=True)
class Heard:
    """A true pose, or an estimate, and when it was recorded."""

    topic: str
    stamp_ns: int
    data: bytes
    x: float
    msgtype: str = types.POSE_STAMPED


def heard(topic: str, recorded_ns: int, stamp_ns: int, x: float) -> Heard:
    data = STORE.serialize_ros1(pose(stamp_ns, x), "geometry_msgs/msg/PoseStamped")
    return Heard(topic, recorded_ns, bytes(data), x)


def drive(stamp_of_truth: Callable[[int], int], truth_late: int, estimate_late: int) -> list[Heard]:
    """A robot that drives half a meter a second and knows it."""
    messages = []
    for number in range(60):
        ns, x = BEGIN + number * TENTH, 0.05 * number
        messages.append(heard("truth", ns + truth_late, stamp_of_truth(ns), x))
        messages.append(heard("estimate", ns + estimate_late, ns, x))
    return sorted(messages, key=lambda message: message.stamp_ns)


def errors_of(messages: list[Heard], stamped: bool = True) -> FloatArray:
    curve = Curve(2, peaks=True)
    errors = PoseErrors(curve)
    for message in messages:
        time = (message.stamp_ns - BEGIN) / 1e9
        if message.topic == "truth":
            errors.truth(message, time)
        else:
            errors.estimate(message if stamped else None, time, Pose2(message.x, 0.0, 0.0))
    return curve.rows()


@pytest.mark.parametrize(("truth_late", "estimate_late"), [(0, 0), (LATE, 0), (0, LATE), (LATE, 30 * TENTH)])
def test_they_are_of_the_same_stamps(truth_late: int, estimate_late: int) -> None:
    rows = errors_of(drive(lambda ns: ns, truth_late, estimate_late))
    assert rows[:, 0] == pytest.approx([0.1 * number for number in range(60)])
    assert rows[:, 1] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("stamp_of_truth", [lambda ns: 0, lambda ns: ns - HOUR, lambda ns: ns + HOUR, lambda ns: BEGIN])
def test_stamps_of_no_use_are_left_for_the_time_of_recording(stamp_of_truth: Callable[[int], int]) -> None:
    rows = errors_of(drive(stamp_of_truth, LATE, 0))
    assert len(rows) >= 50
    assert rows[-50:, 1] == pytest.approx(0.25, abs=1e-6)


def test_estimates_of_frames_have_no_stamp_of_their_own() -> None:
    rows = errors_of(drive(lambda ns: ns, LATE, 0), stamped=False)
    assert rows[-50:, 1] == pytest.approx(0.25, abs=1e-6)


def test_nothing_is_known_where_the_truth_is_away() -> None:
    messages = [
        message for message in drive(lambda ns: ns, LATE, 0) if message.topic == "estimate" or not 1.0 < message.x < 2.0
    ]
    times = errors_of(messages)[:, 0]
    assert not ((times > 2.0 + 1e-6) & (times < 4.0 - 1e-6)).any()
    assert len(times) == 60 - 19
