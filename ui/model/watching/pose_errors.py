"""Errors of a robot's estimated poses, computed while messages with estimates and true poses arrive."""

from bisect import bisect_left
from collections import deque

from sim.common.geometry import Pose2
from sim.numerics.elementary import wrap_angle
from thbridge.analysis.report.sound_paths import EARLIEST, LATEST
from thbridge.ros.messages import types, unpack
from thbridge.ros.messages.cursor import Cursor
from ui.model.watching.curves import Curve
from ui.model.watching.messages import WatchedMessage

_TRUTHS = 1024
"""Number of true poses kept for estimates that arrive later: ten seconds at 100 poses per second."""
_WAITING = 64
"""Maximum number of estimates that wait for a true pose; when there are more, the oldest is dropped."""
_STALE = 1.0
"""Poses are interpolated between two true poses if the time between them is at most this, seconds."""
_REPEATS = 3
"""If this number of successive true poses have the same stamp, stamps are ignored."""


class PoseErrors:
    """Comparison of each estimate with the true pose that has the same stamp.

    If stamps are useless, the times of recording replace them.

    Args:
        errors: curve that receives the time and the errors in meters and radians (not negative).
    """

    def __init__(self, errors: Curve) -> None:
        self._errors = errors
        self._by_stamp = True
        self._repeats = 0
        self._times: deque[float] = deque(maxlen=_TRUTHS)
        self._truths: deque[WatchedMessage | Pose2] = deque(maxlen=_TRUTHS)
        self._waiting: list[tuple[float, Pose2]] = []

    def truth(self, message: WatchedMessage, time: float) -> None:
        """Add a true pose with its time of recording, and compare it with the estimates that waited for it."""
        stamp = self._time_of(message, time)
        if self._times and stamp <= self._times[-1]:
            self._repeats += 1
            if self._by_stamp and self._repeats >= _REPEATS:
                self._forget_stamps()
            return
        self._repeats = 0
        self._times.append(stamp)
        self._truths.append(message)  # The message is decoded when its pose is needed.
        while self._waiting and self._waiting[0][0] <= stamp:
            self._compare(*self._waiting.pop(0))

    def estimate(self, message: WatchedMessage | None, time: float, pose: Pose2) -> None:
        """Add an estimate with its message.

        If `message` is None, the estimate comes from tf frames, so it has no stamp.
        """
        if message is None and self._by_stamp:
            self._forget_stamps()
        stamp = time if message is None else self._time_of(message, time)
        if self._times and stamp <= self._times[-1]:
            self._compare(stamp, pose)
            return
        self._waiting.append((stamp, pose))
        if len(self._waiting) > _WAITING:
            self._waiting.pop(0)

    def _time_of(self, message: WatchedMessage, time: float) -> float:
        """Return the time in the message's header; if stamps are useless, return the time of recording."""
        if self._by_stamp:
            stamp_ns, _ = Cursor(message.data).header()
            late_ns = message.stamp_ns - stamp_ns
            if stamp_ns and EARLIEST <= late_ns / 1e9 <= LATEST:
                return time - late_ns / 1e9
            self._forget_stamps()
        return time

    def _forget_stamps(self) -> None:
        self._by_stamp = False
        self._times.clear()
        self._truths.clear()
        self._waiting.clear()

    def _compare(self, time: float, estimate: Pose2) -> None:
        after = bisect_left(self._times, time)
        if after == len(self._times) or (self._times[after] != time and after == 0):
            return
        truth = self._pose(after)
        if self._times[after] != time:
            span = self._times[after] - self._times[after - 1]
            if span > _STALE:
                return
            share, one, other = (time - self._times[after - 1]) / span, self._pose(after - 1), truth
            turned = wrap_angle(other.theta - one.theta)
            x, y = one.x + share * (other.x - one.x), one.y + share * (other.y - one.y)
            truth = Pose2(x, y, wrap_angle(one.theta + share * turned))
        self._errors.append(time, estimate.distance(truth), abs(wrap_angle(estimate.theta - truth.theta)))

    def _pose(self, index: int) -> Pose2:
        known = self._truths[index]
        if not isinstance(known, Pose2):
            known = self._truths[index] = pose_of(known)
        return known


def pose_of(message: WatchedMessage) -> Pose2:
    """Return the pose in an odometry message, or in a pose message with or without covariance."""
    match message.msgtype:
        case types.ODOMETRY:
            return unpack.odometry(message.data).pose
        case types.POSE_STAMPED:
            return unpack.pose_stamped(message.data).pose
        case _:
            return unpack.pose_with_covariance(message.data).pose
