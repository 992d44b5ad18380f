"""Values over time for each robot: error of the estimate, standard deviations, energy, speed."""

import math
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from sim.common.geometry import Pose2
from thbridge.analysis.report.paths import RELOCATED
from thbridge.analysis.report.tracks import deviations
from thbridge.ros.messages import unpack
from thbridge.ros.messages.unpack import BatteryCharge
from thbridge.ros.robots import is_map_frame
from ui.model.watching.curves import Curve
from ui.model.watching.frames import Frames, children_of, namespace_of_tf
from ui.model.watching.messages import TF_TYPES, WatchedMessage
from ui.model.watching.pose_errors import PoseErrors, pose_of
from ui.model.watching.robots import WatchedRobot

PERIOD = 0.1
"""Shortest time between two samples, seconds."""
ODOMETRY_TIMEOUT = 1.0
"""Seconds that the program waits for odometry of a robot known from tf, before it uses tf alone."""
JUMPS_KEPT = 1000
"""Maximum number of stored jumps of an estimate, and of stored gaps. A lost robot can jump often."""
_SLACK = 1e-6


@dataclass(slots=True)
class RobotSeries:
    """Curves of one robot; times are seconds since the beginning of the session or recording.

    Attributes:
        truth: time, x, y, theta.
        estimate: time, x, y, theta.
        odometry: time, x, y, theta, in the robot's odometry frame.
        errors: time, distance (m) and angle (rad) between estimate and truth, not negative.
        deviations: time, standard deviations of position (m) and heading (rad), from the localizer.
        energy: time, remaining energy.
        speeds: time, linear speed (m/s) and angular speed (rad/s), from the odometry.
        relocations: times at which the localizer corrected the pose by a jump, in order.
    """

    truth: Curve = field(default_factory=lambda: Curve(3))
    estimate: Curve = field(default_factory=lambda: Curve(3))
    odometry: Curve = field(default_factory=lambda: Curve(3))
    errors: Curve = field(default_factory=lambda: Curve(2, peaks=True))
    deviations: Curve = field(default_factory=lambda: Curve(2, peaks=True))
    energy: Curve = field(default_factory=Curve)
    speeds: Curve = field(default_factory=lambda: Curve(2))
    relocations: deque[float] = field(default_factory=lambda: deque(maxlen=JUMPS_KEPT))


class Series:
    """Curves of all robots. Messages must be added in order of time.

    Args:
        start_ns: ROS time of the beginning, nanoseconds.

    Attributes:
        gaps: times of the last messages before interruptions, in order.
    """

    def __init__(self, start_ns: int) -> None:
        self.gaps: deque[float] = deque(maxlen=JUMPS_KEPT)
        self._start_ns = start_ns
        self._builders: dict[int, _SeriesBuilder] = {}
        self._handlers: dict[str, list[Callable[[WatchedMessage, float], None]]] = {}
        self._tf = _Tf()

    @property
    def topics(self) -> frozenset[str]:
        """Topics, in addition to tf topics, whose messages change the curves."""
        return frozenset(self._handlers)

    def follow(self, robots: Sequence[WatchedRobot], mapped: bool) -> None:
        """Follow these robots from now on; robots that were followed before keep their curves.

        Args:
            robots: the robots, and their topics.
            mapped: True if there is a map.
        """
        self._handlers = {}
        self._tf.mapped = mapped
        for robot in robots:
            builder = self._builders.setdefault(robot.robot, _SeriesBuilder(self._tf))
            builder.robot = robot
            for topic, handler in (
                (robot.truth, builder.truth),
                (robot.odom, builder.odometry),
                (robot.estimate, builder.belief),
                (robot.battery, builder.energy),
            ):
                if topic is not None:
                    self._handlers.setdefault(topic, []).append(handler)

    def take(self, message: WatchedMessage) -> None:
        """Process a message; unreadable messages have no effect."""
        if message.msgtype in TF_TYPES:
            self._tf.take(message)
            for builder in self._builders.values():
                builder.frames((message.stamp_ns - self._start_ns) / 1e9)
            return
        for handler in self._handlers.get(message.topic, ()):
            try:
                handler(message, (message.stamp_ns - self._start_ns) / 1e9)
            except ValueError:
                continue

    def interrupt(self, last_ns: int) -> None:
        """Record that messages after this time were missed; lines are interrupted there."""
        # The added time is much shorter than a tick.
        self.gaps.append((last_ns - self._start_ns) / 1e9 + _SLACK)

    def of(self, robot: int) -> RobotSeries:
        """Return the curves of a robot; empty if the robot is unknown."""
        builder = self._builders.get(robot)
        return RobotSeries() if builder is None else builder.series


class _Tf:
    """Present frames, decoded on demand."""

    def __init__(self) -> None:
        self._messages: dict[tuple[str, bytes], WatchedMessage] = {}
        self._frames: Frames | None = None
        self.mapped = False

    def take(self, message: WatchedMessage) -> None:
        try:
            key = (namespace_of_tf(message.topic), children_of(message.data))
        except ValueError:
            return
        self._messages.pop(key, None)  # The newest message must be the last in the dict.
        self._messages[key] = message
        self._frames = None

    def frames(self) -> Frames:
        if self._frames is None:
            self._frames = Frames(self._messages.values(), self.mapped)
        return self._frames


class _SeriesBuilder:
    """Builder of one robot's curves."""

    def __init__(self, tf: _Tf) -> None:
        self.series = RobotSeries()
        self.robot: WatchedRobot | None = None
        self._tf = tf
        self._errors = PoseErrors(self.series.errors)
        self._alone_since = math.inf
        self._correction: Pose2 | None = None

    def truth(self, message: WatchedMessage, time: float) -> None:
        """Add a true pose."""
        if _due(self.series.truth, time):
            pose = pose_of(message)
            self.series.truth.append(time, pose.x, pose.y, pose.theta)
        self._errors.truth(message, time)

    def odometry(self, message: WatchedMessage, time: float) -> None:
        """Add odometry, and the estimated pose that follows from the odometry."""
        if self.robot is None or not _due(self.series.odometry, time):
            return
        driven = unpack.odometry(message.data)
        pose = driven.pose
        self.series.odometry.append(time, pose.x, pose.y, pose.theta)
        self.series.speeds.append(time, driven.twist.linear, driven.twist.angular)
        if is_map_frame(driven.frame):
            self._believe(message, time, pose)
            return
        odom_in_map = self._tf.frames().planar(driven.frame, self.robot.key)
        if odom_in_map is not None:
            before, self._correction = self._correction, odom_in_map
            estimate = odom_in_map.compose(pose)
            if before is not None and before.compose(pose).distance(estimate) > RELOCATED:
                self.series.relocations.append(time)
            self._believe(message, time, estimate)

    def frames(self, time: float) -> None:
        """Add the estimated pose from tf alone, if the robot has no topic for odometry or localization."""
        robot = self.robot
        if robot is None or robot.odom is not None or robot.estimate is not None or not robot.base:
            return
        self._alone_since = min(self._alone_since, time)
        if time - self._alone_since >= ODOMETRY_TIMEOUT and _due(self.series.estimate, time):
            base_in_map = self._tf.frames().planar(robot.base, robot.key)
            if base_in_map is not None:
                self._believe(None, time, base_in_map)

    def belief(self, message: WatchedMessage, time: float) -> None:
        """Add the pose of the localizer, and its covariance."""
        localised = unpack.pose_with_covariance(message.data)
        admitted = deviations(time, localised.covariance)
        if admitted is not None:
            self.series.deviations.append(*admitted)
        # If there is odometry, every estimated pose is already in the curve.
        if self.robot is not None and self.robot.odom is None and is_map_frame(localised.frame):
            self._believe(message, time, localised.pose)

    def energy(self, message: WatchedMessage, time: float) -> None:
        """Add the remaining energy."""
        left = energy_of(unpack.battery_state(message.data))
        if left is not None:
            self.series.energy.append(time, left)

    def _believe(self, message: WatchedMessage | None, time: float, pose: Pose2) -> None:
        self.series.estimate.append(time, pose.x, pose.y, pose.theta)
        self._errors.estimate(message, time, pose)


def energy_of(charge: BatteryCharge) -> float | None:
    """Return the charge; if unknown, return the percentage; if both are unknown, return None."""
    left = charge.charge if math.isfinite(charge.charge) else 100.0 * charge.percentage
    return left if math.isfinite(left) else None


def _due(curve: Curve, time: float) -> bool:
    return time - curve.time >= PERIOD - _SLACK
