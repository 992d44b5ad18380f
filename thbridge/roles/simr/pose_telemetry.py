"""Pose telemetry: SimR sends poses, activities and planned paths of the robots to subscribers many times per second.

SimR never sends values that the study does not show, so receivers do not need to hide values.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.common.observations import TICKS_PER_SECOND
from sim.numerics import elementary
from sim.numerics.float_array import FloatArray
from sim.robot.software import RobotOutput
from sim.snapshot import TeamSnapshot
from thbridge.hunt.events import Condition
from thbridge.roles.shared.notices import Activity, Ellipse, PlannedPaths, PoseTelemetry, RobotMotion
from thbridge.roles.simr.polyline import needed_points
from thbridge.text_protocol.wire.lines import TextMessage
from thbridge.text_protocol.wire.notice_format import NoticeValue, encode_notice

POSE_PERIOD = TICKS_PER_SECOND // 25
"""Number of ticks between two messages with poses."""
CLOCK_PERIOD = TICKS_PER_SECOND // 2
"""Number of ticks between two messages with the simulated time, for participants who do not see the map."""
PATH_PERIOD = TICKS_PER_SECOND // 10
"""Number of ticks between two messages with planned paths, if the paths change."""
SUBSCRIPTION_TICKS = 60 * TICKS_PER_SECOND
"""Number of ticks after which a subscription ends without renewal. It is large, because windows renew subscriptions in
real time and the simulation may be much faster."""

PATH_TOLERANCE = 0.01
"""Largest distance of removed points from the path, in meters. At the robot, the error may be twice as large, because
the robot itself may be this far from its path. With the rounding to centimeters, the error of a sent path is less than
0.03 m."""
MOST_PATH_POINTS = 2000
"""Maximum number of points of all paths in one message."""
CHI_SQUARE_95 = 5.991
"""Squared Mahalanobis distance that contains 95 % of a normal distribution in the plane (chi-square, 2 degrees of
freedom)."""

Triple = tuple[float, float, float]
Line = tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class TelemetryOptions:
    """Data about robots that a study shows in addition to estimated poses and activities.

    Attributes:
        path: True to show planned paths.
        uncertainty: True to show ellipses of the estimated positions.
        truth: True to show true poses.
    """

    path: bool = True
    uncertainty: bool = False
    truth: bool = False


class TelemetryPublisher:
    """Sender of pose telemetry to its subscribers.

    Args:
        sender: name of the sending role.
        options: data that the study shows.
    """

    def __init__(self, sender: str, options: TelemetryOptions) -> None:
        self._sender = sender
        self._options = options
        self._until: dict[str, int] = {}
        self._clocks_until: dict[str, int] = {}
        self._newcomers: dict[str, None] = {}
        self._plans: tuple[_Plan, ...] = ()
        self._paths: tuple[Line, ...] = ()

    def subscribe(self, name: str, tick: int, *, with_poses: bool = True) -> None:
        """Start or renew a subscription. Without poses, the subscriber receives only the simulated time."""
        if not with_poses:
            self._clocks_until[name] = tick + SUBSCRIPTION_TICKS
            return
        self._until[name] = tick + SUBSCRIPTION_TICKS
        if self._options.path:
            self._newcomers[name] = None

    def messages(
        self,
        tick: int,
        snapshot: TeamSnapshot,
        conditions: Sequence[Condition],
        progress: Mapping[int, float],
    ) -> list[TextMessage]:
        """Return the messages of this tick.

        Args:
            tick: tick of the role.
            snapshot: snapshot of the robots.
            conditions: condition of each robot.
            progress: driven share of the path of each robot with a move of the game, by robot.
        """
        if not self._until and not self._clocks_until:
            return []
        self._until = {name: until for name, until in self._until.items() if until > tick}
        self._clocks_until = {name: until for name, until in self._clocks_until.items() if until > tick}
        messages: list[TextMessage] = []
        if tick % CLOCK_PERIOD == 0:
            messages += self._addressed(PoseTelemetry(snapshot.tick, ()), self._clocks_until)
        if not self._until:
            return messages
        if tick % POSE_PERIOD == 0:
            messages += self._addressed(self._pose_notice(snapshot, conditions, progress), self._until)
        if tick % PATH_PERIOD == 0 and self._options.path:
            before, self._paths = self._paths, self._paths_ahead(snapshot, conditions)
            receivers = self._newcomers if self._paths == before else self._until
            messages += self._addressed(PlannedPaths(snapshot.tick, self._paths), receivers)
            self._newcomers.clear()
        return messages

    def _addressed(self, value: NoticeValue, names: Mapping[str, object]) -> list[TextMessage]:
        return [encode_notice(self._sender, name, value) for name in names]

    def _paths_ahead(self, snapshot: TeamSnapshot, conditions: Sequence[Condition]) -> tuple[Line, ...]:
        """Return the remaining path of each robot that responds."""
        count = len(snapshot.robots)
        if len(self._plans) != count:
            self._plans = tuple(_Plan(max(2, MOST_PATH_POINTS // count)) for _ in range(count))
        return tuple(
            () if condition is Condition.SILENT else plan.ahead(output)
            for plan, output, condition in zip(self._plans, snapshot.robots, conditions, strict=True)
        )

    def _pose_notice(
        self, snapshot: TeamSnapshot, conditions: Sequence[Condition], progress: Mapping[int, float]
    ) -> PoseTelemetry:
        robots = snapshot.robots
        motions = (
            _motion(output, condition, progress.get(robot, 0.0))
            for robot, (output, condition) in enumerate(zip(robots, conditions, strict=True))
        )
        ellipses = (ellipse_of(output.estimate.covariance) for output in robots)
        knows_truth = self._options.truth and snapshot.world is not None
        return PoseTelemetry(
            tick=snapshot.tick,
            poses=tuple(_triple(output.estimate.base_in_map.array()) for output in robots),
            motions=tuple(motions),
            ellipses=tuple(ellipses) if self._options.uncertainty else None,
            truth=tuple(_triple(pose) for pose in snapshot.truth.poses) if knows_truth else None,
        )


def ellipse_of(covariance: FloatArray) -> Ellipse:
    """Return the ellipse with 95 % of the probability of a robot's position.

    The half axes are the square roots of the eigenvalues of the 2 x 2 covariance, scaled by the chi-square quantile.

    Args:
        covariance: at least 2 x 2, with x and y first, m^2.
    """
    (xx, xy), (_, yy) = covariance[:2, :2].tolist()
    mean, spread = 0.5 * (xx + yy), elementary.hypot(0.5 * (xx - yy), xy)
    major, minor = (math.sqrt(CHI_SQUARE_95 * max(0.0, variance)) for variance in (mean + spread, mean - spread))
    return Ellipse(_milli(major), _milli(minor), _milli(0.5 * elementary.atan2(2.0 * xy, xx - yy)))


def _motion(output: RobotOutput, condition: Condition, progress: float) -> RobotMotion:
    navigation = output.navigation
    silent = condition is Condition.SILENT
    waits_for = None if silent else navigation.waits_for
    doing: Activity
    match navigation.state:
        case _ if silent:
            doing = "silent"
        case "clearing":
            doing = "clearing"
        case _ if waits_for is not None:
            doing = "waiting"
        case "planning":
            doing = "planning"
        case "controlling":
            doing = "driving"
        case "idle":
            doing = "resting"
    makes_way_for = None if silent else navigation.makes_way_for
    return RobotMotion(doing, waits_for, _milli(progress), _milli(navigation.remaining), makes_way_for)


class _Plan:
    """A robot's plan, reduced to a few points.

    Only a new plan is reduced. During the drive, the reduced plan is shortened. If it were reduced again at each step,
    the drawn path would jump on the map.

    Args:
        most: maximum number of points.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._points: FloatArray = np.empty((0, 2))
        self._kept: NDArray[np.bool_] = np.empty(0, dtype=np.bool_)

    def ahead(self, output: RobotOutput) -> Line:
        """Return the path from the robot's position to the goal. Empty if the robot is not following a plan."""
        navigation, here = output.navigation, output.estimate.base_in_map
        points = navigation.plan[1:, :2]
        if navigation.state != "controlling" or not len(points):
            return ()
        driven = len(self._points) - len(points)
        if driven >= 0 and np.allclose(self._points[driven:], points, rtol=0.0, atol=1e-6):
            self._points, self._kept = self._points[driven:], self._kept[driven:]
        else:
            self._points, self._kept = points, self._few(points)
        few = [[here.x, here.y], *points[self._kept].tolist()]
        return tuple((round(x, 2), round(y, 2)) for x, y in few)

    def _few(self, points: FloatArray) -> NDArray[np.bool_]:
        tolerance = PATH_TOLERANCE
        while (kept := needed_points(points, tolerance)).sum() > self._most:
            tolerance *= 2.0
        return kept


def _triple(pose: FloatArray) -> Triple:
    x, y, theta = pose.tolist()
    return _milli(x), _milli(y), _milli(theta)


def _milli(number: float) -> float:
    """Return a number rounded to 0.001 m or 0.001 rad. Windows need no more digits, and lines stay short."""
    return round(number, 3)
