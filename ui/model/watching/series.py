"""Numbers over time, for each robot: how far its belief is from the truth, what it admits, its energy, its speed."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from sim.common.geometry import Pose2, wrap_angle
from thbridge.analysis.report.tracks import deviations
from thbridge.ros.messages import types, unpack
from thbridge.ros.robots import is_map_frame
from ui.model.watching.curves import Curve
from ui.model.watching.frames import Frames, children_of, namespace_of_tf
from ui.model.watching.messages import TF_TYPES, WatchedMessage
from ui.model.watching.robots import WatchedRobot

PERIOD = 0.1
"""Seconds from one sample to the next, at least."""
ODOMETRY_TIMEOUT = 1.0
"""Seconds in which a robot that tf speaks of may begin to tell its odometry."""
_SLACK = 1e-6
_WAITING = 64
"""Samples that wait for the truth at their time, before the oldest is given up."""
_STALE = 1.0
"""Seconds between two words of the truth, beyond which nobody knows what was between."""


@dataclass(slots=True)
class RobotSeries:
    """One robot; times are seconds since the beginning.

    Attributes:
        truth: time, x, y, theta.
        estimate: likewise.
        odometry: likewise, in the frame of its odometry.
        errors: time, metres, radians (not negative) between estimate and truth.
        deviations: time, standard deviations of position (m) and heading (rad) that its localiser admits.
        energy: time, what is left.
        speeds: time, m/s, rad/s by its odometry.
    """

    truth: Curve = field(default_factory=lambda: Curve(3))
    estimate: Curve = field(default_factory=lambda: Curve(3))
    odometry: Curve = field(default_factory=lambda: Curve(3))
    errors: Curve = field(default_factory=lambda: Curve(2, peaks=True))
    deviations: Curve = field(default_factory=lambda: Curve(2, peaks=True))
    energy: Curve = field(default_factory=Curve)
    speeds: Curve = field(default_factory=lambda: Curve(2))


class Series:
    """Grows with the messages that are taken, in order of time.

    Args:
        start_ns: when time begins.
    """

    def __init__(self, start_ns: int) -> None:
        self._start_ns = start_ns
        self._builders: dict[int, _SeriesBuilder] = {}
        self._handlers: dict[str, list[Callable[[WatchedMessage, float], None]]] = {}
        self._tf = _Tf()

    @property
    def topics(self) -> frozenset[str]:
        """What has to be taken, beside the messages of tf; all else changes nothing."""
        return frozenset(self._handlers)

    def follow(self, cast: Sequence[WatchedRobot], mapped: bool) -> None:
        """Go by these robots from now on; those that were there before keep what is known of them.

        Args:
            cast: the robots.
            mapped: whether there is a map.
        """
        self._handlers = {}
        self._tf.mapped = mapped
        for member in cast:
            teller = self._builders.setdefault(member.robot, _SeriesBuilder(self._tf))
            teller.member = member
            for topic, taker in (
                (member.truth, teller.truth),
                (member.odom, teller.odometry),
                (member.estimate, teller.belief),
                (member.battery, teller.energy),
            ):
                if topic is not None:
                    self._handlers.setdefault(topic, []).append(taker)

    def take(self, said: WatchedMessage) -> None:
        """Take a message; one that cannot be read changes nothing."""
        if said.msgtype in TF_TYPES:
            self._tf.take(said)
            for teller in self._builders.values():
                teller.frames((said.stamp_ns - self._start_ns) / 1e9)
            return
        for taker in self._handlers.get(said.topic, ()):
            try:
                taker(said, (said.stamp_ns - self._start_ns) / 1e9)
            except ValueError:
                continue

    def of(self, robot: int) -> RobotSeries:
        """What is known of a robot; nothing of one that there is not."""
        teller = self._builders.get(robot)
        return RobotSeries() if teller is None else teller.series


class _Tf:
    """The frames that hold now, unpacked when somebody asks."""

    def __init__(self) -> None:
        self._said: dict[tuple[str, bytes], WatchedMessage] = {}
        self._frames: Frames | None = None
        self.mapped = False

    def take(self, said: WatchedMessage) -> None:
        try:
            key = (namespace_of_tf(said.topic), children_of(said.data))
        except ValueError:
            return
        self._said.pop(key, None)  # so that what is said last comes last
        self._said[key] = said
        self._frames = None

    def frames(self) -> Frames:
        if self._frames is None:
            self._frames = Frames(self._said.values(), self.mapped)
        return self._frames


class _SeriesBuilder:
    """Makes one robot's series."""

    def __init__(self, tf: _Tf) -> None:
        self.series = RobotSeries()
        self.member: WatchedRobot | None = None
        self._tf = tf
        self._told: tuple[float, WatchedMessage] | None = None
        self._known: tuple[float, Pose2] | None = None
        self._waiting: list[tuple[float, Pose2]] = []
        self._alone_since = math.inf

    def truth(self, said: WatchedMessage, time: float) -> None:
        """Between two words of the truth lies what it was meanwhile."""
        due = _due(self.series.truth, time)
        if not due and not self._waiting:
            self._told, self._known = (time, said), None  # unpacked when it is needed
            return
        before, pose = self._last_truth(), _pose_of(said)
        if due:
            self.series.truth.append(time, pose.x, pose.y, pose.theta)
        while self._waiting and self._waiting[0][0] <= time:
            then, estimate = self._waiting.pop(0)
            self._compare(then, estimate, before, (time, pose))
        self._told, self._known = None, (time, pose)

    def _last_truth(self) -> tuple[float, Pose2] | None:
        if self._known is None and self._told is not None:
            self._known = (self._told[0], _pose_of(self._told[1]))
        return self._known

    def _compare(
        self, time: float, estimate: Pose2, before: tuple[float, Pose2] | None, after: tuple[float, Pose2]
    ) -> None:
        if time == after[0]:
            truth = after[1]
        elif before is None or not before[0] <= time or after[0] - before[0] > _STALE:
            return
        else:
            share = (time - before[0]) / (after[0] - before[0])
            one, other = before[1], after[1]
            turned = wrap_angle(other.theta - one.theta)
            x, y = one.x + share * (other.x - one.x), one.y + share * (other.y - one.y)
            truth = Pose2(x, y, wrap_angle(one.theta + share * turned))
        heading = abs(wrap_angle(estimate.theta - truth.theta))
        self.series.errors.append(time, estimate.distance(truth), heading)

    def odometry(self, said: WatchedMessage, time: float) -> None:
        """What its wheels count, and with it where it believes to be."""
        if self.member is None or not _due(self.series.odometry, time):
            return
        driven = unpack.odometry(said.data)
        pose = driven.pose
        self.series.odometry.append(time, pose.x, pose.y, pose.theta)
        self.series.speeds.append(time, driven.twist.linear, driven.twist.angular)
        if is_map_frame(driven.frame):
            self._believe(time, pose)
            return
        odom_in_map = self._tf.frames().planar(driven.frame, self.member.key)
        if odom_in_map is not None:
            self._believe(time, odom_in_map.compose(pose))

    def frames(self, time: float) -> None:
        """What tf alone says of where it believes to be, where neither odometry nor a localiser has a topic."""
        member = self.member
        if member is None or member.odom is not None or member.estimate is not None or not member.base:
            return
        self._alone_since = min(self._alone_since, time)
        if time - self._alone_since >= ODOMETRY_TIMEOUT and _due(self.series.estimate, time):
            base_in_map = self._tf.frames().planar(member.base, member.key)
            if base_in_map is not None:
                self._believe(time, base_in_map)

    def belief(self, said: WatchedMessage, time: float) -> None:
        """What its localiser says of where it is, and how sure it is."""
        told = unpack.pose_with_covariance(said.data)
        admitted = deviations(time, told.covariance)
        if admitted is not None:
            self.series.deviations.append(*admitted)
        # Where odometry tells every step, this would only tell some of them again.
        if self.member is not None and self.member.odom is None and is_map_frame(told.frame):
            self._believe(time, told.pose)

    def energy(self, said: WatchedMessage, time: float) -> None:
        """What it has left."""
        told = unpack.battery_state(said.data)
        left = told.charge if math.isfinite(told.charge) else 100.0 * told.percentage
        if math.isfinite(left):
            self.series.energy.append(time, left)

    def _believe(self, time: float, pose: Pose2) -> None:
        self.series.estimate.append(time, pose.x, pose.y, pose.theta)
        known = self._last_truth()
        if known is not None and known[0] == time:
            self._compare(time, pose, None, known)
            return
        self._waiting.append((time, pose))
        if len(self._waiting) > _WAITING:
            self._waiting.pop(0)


def _due(curve: Curve, time: float) -> bool:
    return time - curve.time >= PERIOD - _SLACK


def _pose_of(said: WatchedMessage) -> Pose2:
    match said.msgtype:
        case types.ODOMETRY:
            return unpack.odometry(said.data).pose
        case types.POSE_STAMPED:
            return unpack.pose_stamped(said.data).pose
        case _:
            return unpack.pose_with_covariance(said.data).pose
