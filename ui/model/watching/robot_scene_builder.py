"""Builder of the scene of one robot at one moment."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.numerics.float_array import FloatArray
from thbridge.analysis.report.tracks import deviations
from thbridge.roles.shared.notices import Ellipse
from thbridge.ros.messages import types, unpack
from thbridge.ros.messages.goal_status import ENDED, GoalStatus
from thbridge.ros.messages.pack import DiagnosticLevel, DiagnosticStatus
from thbridge.ros.messages.unpack import (
    BatteryCharge,
    LaserScan,
    MoveBaseGoal,
    MoveBaseResult,
    OdometryMessage,
    PoseInFrame,
)
from thbridge.ros.robots import is_map_frame
from ui.model.watching.decode_cache import DecodeCache
from ui.model.watching.frames import Frames
from ui.model.watching.messages import TopicSnapshot, WatchedMessage
from ui.model.watching.robots import WatchedRobot
from ui.model.watching.scene import NO_POINTS, NO_POSES, RobotScene, ShownLayers
from ui.model.watching.series import Series, energy_of

THINNED = 60
"""Number of particles shown for a robot that is not selected."""
STALE_NS = 500_000_000
"""If the true pose is newer than odometry by more than these nanoseconds, the robot's software counts as stopped."""
CHI_SQUARE_95 = 5.991
"""95 % quantile of the chi-square distribution with two degrees of freedom.

An ellipse whose squared radius is this number times the variance contains 95 of 100 places.
"""


T = TypeVar("T")


def framed(decoded: Callable[[bytes], T]) -> Callable[[bytes], tuple[str, T]]:
    """Return a decoder for messages with a header, which returns the frame and the value of a message."""
    return lambda data: (unpack.frame_of(data), decoded(data))


class DecodedTopics:
    """Decoded values of the robots' last messages, with one cache per type of message."""

    def __init__(self) -> None:
        self.odometry = DecodeCache[OdometryMessage](unpack.odometry)
        self.poses = DecodeCache[PoseInFrame](unpack.pose_stamped)
        self.beliefs = DecodeCache[PoseInFrame](unpack.pose_with_covariance)
        self.clouds = DecodeCache(framed(unpack.pose_array))
        self.grids = DecodeCache(framed(unpack.occupancy_grid))
        self.batteries = DecodeCache[BatteryCharge](unpack.battery_state)
        self.paths = DecodeCache(framed(unpack.path))
        self.footprints = DecodeCache(framed(unpack.polygon))
        self.goals = DecodeCache[MoveBaseGoal](unpack.move_base_goal)
        self.statuses = DecodeCache[list[GoalStatus]](unpack.goal_status_array)
        self.results = DecodeCache[MoveBaseResult](unpack.move_base_result)
        self.scans: dict[str, tuple[bytes, FloatArray]] = {}


@dataclass(frozen=True, slots=True, eq=False)
class SceneContext:
    """Inputs that all robots of a scene share.

    Attributes:
        snapshot: the present messages.
        frames_at: function that returns the frames at a time up to this moment.
        frames: the present frames.
        diagnoses: diagnoses by name of the robot's part.
        series: values over time.
        time: seconds since the beginning of the session or recording.
        begun: time at which the game began and robots returned to their start poses, in the same seconds as `time`.
        shown: the layers to show.
        decoded: decoded values of messages.
    """

    snapshot: TopicSnapshot
    frames_at: Callable[[int], Frames]
    frames: Frames
    diagnoses: dict[str, DiagnosticStatus]
    series: Series
    time: float
    begun: float
    shown: ShownLayers
    decoded: DecodedTopics


class RobotSceneBuilder:
    """Builder of the scene of one robot at one moment."""

    def __init__(self, robot: WatchedRobot, context: SceneContext) -> None:
        self._robot, self._context = robot, context
        self._odometry_message, self._truth_message = self._newest(robot.odom), self._newest(robot.truth)
        self._odometry = context.decoded.odometry.of(self._odometry_message)
        self._belief = context.decoded.beliefs.of(self._newest(robot.estimate))

    def build(self, commander: str, carried: Sequence[float]) -> RobotScene:
        """Return the scene of the robot.

        Args:
            commander: commander of the robot in words; empty if the participant commands the robot.
            `carried`: times at which a person moved the robot by hand, in order.
        """
        robot, shown, dead = self._robot, self._context.shown, self._dead()
        truth, estimate = self._truth(), self._estimate()
        belief, odometry = self._belief, None if dead else self._odometry
        admitted = None if belief is None else deviations(0.0, belief.covariance)
        charge = self._context.decoded.batteries.of(self._newest(robot.battery))
        selected = shown.selected == robot.robot
        cloud = self._cloud() if shown.clouds else NO_POSES
        state, trouble = self._state(dead)
        truth_path, estimate_path, odometry_path = self._tracks(carried) if shown.paths else (NO_POINTS,) * 3
        return RobotScene(
            robot=robot.robot,
            name=robot.name,
            truth=truth,
            estimate=estimate,
            error=None if truth is None or estimate is None else truth.distance(estimate),
            ellipse=None if belief is None else ellipse_of(belief.covariance),
            deviation=None if admitted is None else admitted[1],
            odometry_path=odometry_path,
            truth_path=truth_path,
            estimate_path=estimate_path,
            cloud=cloud if selected else thinned(cloud),
            scan=self._scan() if shown.scans and not dead else NO_POINTS,
            global_costmap=self._costmap(robot.global_costmap) if selected and shown.global_costmap else None,
            local_costmap=self._costmap(robot.local_costmap) if selected and shown.local_costmap else None,
            plan=self._points(self._context.decoded.paths, robot.plan) if shown.plans else NO_POINTS,
            local_plan=self._points(self._context.decoded.paths, robot.local_plan) if shown.plans else NO_POINTS,
            footprint=self._points(self._context.decoded.footprints, robot.footprint),
            goal=self._goal(),
            energy=None if charge is None else energy_of(charge),
            speed=None if odometry is None else odometry.twist.linear,
            state=state,
            trouble=trouble,
            dead=dead,
            commander=commander,
        )

    def _newest(self, topic: str | None) -> WatchedMessage | None:
        return None if topic is None else self._context.snapshot.newest(topic)

    def _dead(self) -> bool:
        odometry, truth = self._odometry_message, self._truth_message
        return odometry is not None and truth is not None and truth.stamp_ns - odometry.stamp_ns > STALE_NS

    def _truth(self) -> Pose2 | None:
        message, decoded = self._truth_message, self._context.decoded
        if message is not None and message.msgtype == types.ODOMETRY:
            odometry = decoded.odometry.of(message)
            return None if odometry is None else odometry.pose
        stamped = message is not None and message.msgtype == types.POSE_STAMPED
        framed_pose = (decoded.poses if stamped else decoded.beliefs).of(message)
        return None if framed_pose is None else framed_pose.pose

    def _estimate(self) -> Pose2 | None:
        """Return the robot's odometry, corrected by its localizer.

        Without a correction, return the pose from tf frames or, if there is none, the localizer's pose.
        """
        robot, odometry, belief = self._robot, self._odometry, self._belief
        if odometry is not None:
            corrected = self._on_map(odometry.frame, odometry.pose)
            if corrected is not None:
                return corrected
        direct = self._context.frames.planar(robot.base, robot.key) if robot.base else None
        if direct is not None or belief is None:
            return direct
        return self._on_map(belief.frame, belief.pose)

    def _on_map(self, frame: str, pose: Pose2) -> Pose2 | None:
        """Transform a pose from a frame to the map."""
        if is_map_frame(frame):
            return pose
        frame_in_map = self._context.frames.planar(frame, self._robot.key)
        return None if frame_in_map is None else frame_in_map.compose(pose)

    def _tracks(self, carried: Sequence[float]) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the robot's paths in this game: true, estimated, and according to odometry."""
        series, time, begun = self._context.series.of(self._robot.robot), self._context.time, self._context.begun
        gaps = self._context.series.gaps
        driven = series.odometry.path(time, begun, gaps)
        if len(driven) and self._odometry is not None:
            odom_in_map = self._on_map(self._odometry.frame, Pose2(0.0, 0.0, 0.0))
            driven = NO_POINTS if odom_in_map is None else odom_in_map.transform(driven)
        estimate = series.estimate.path(time, begun, sorted((*series.relocations, *gaps)))
        return series.truth.path(time, begun, sorted((*carried, *gaps))), estimate, driven

    def _cloud(self) -> FloatArray:
        frame, cloud = self._context.decoded.clouds.of(self._newest(self._robot.cloud)) or ("", NO_POSES)
        if not len(cloud) or is_map_frame(frame):
            return cloud
        frame_in_map = self._context.frames.planar(frame, self._robot.key)
        if frame_in_map is None:
            return NO_POSES
        turned = (cloud[:, 2] + frame_in_map.theta + np.pi) % (2.0 * np.pi) - np.pi
        return np.column_stack((frame_in_map.transform(cloud[:, :2]), turned))

    def _scan(self) -> FloatArray:
        """Return the end points of beams as seen from the estimated pose at the time of the scan.

        They do not move until the next scan.
        """
        message, known = self._newest(self._robot.scan), self._context.decoded.scans
        if message is None:
            return NO_POINTS
        before = known.get(message.topic)
        if before is not None and before[0] is message.data:
            return before[1]
        points = self._end_points(message)
        known[message.topic] = (message.data, points)
        return points

    def _end_points(self, message: WatchedMessage) -> FloatArray:
        try:
            scan = unpack.laser_scan(message.data)
        except ValueError:
            return NO_POINTS
        laser_in_map = self._context.frames_at(message.stamp_ns).pose(scan.frame, self._robot.key)
        return NO_POINTS if laser_in_map is None else end_points(scan, laser_in_map)

    def _costmap(self, topic: str | None) -> OccupancyGrid | None:
        framed_grid = self._context.decoded.grids.of(self._newest(topic))
        if framed_grid is None or is_map_frame(framed_grid[0]):
            return None if framed_grid is None else framed_grid[1]
        frame, grid = framed_grid
        origin = self._on_map(frame, grid.origin)
        return None if origin is None else OccupancyGrid(grid.cells, grid.resolution, origin)

    def _points(self, decoded: DecodeCache[tuple[str, FloatArray]], topic: str | None) -> FloatArray:
        frame, points = decoded.of(self._newest(topic)) or ("", NO_POINTS)
        if not len(points) or is_map_frame(frame):
            return points[:, :2]
        frame_in_map = self._context.frames.planar(frame, self._robot.key)
        return NO_POINTS if frame_in_map is None else frame_in_map.transform(points[:, :2])

    def _goal(self) -> Pose2 | None:
        robot, decoded = self._robot, self._context.decoded
        goal = decoded.goals.of(self._newest(robot.goal))
        if goal is None:
            return None
        result = decoded.results.of(self._newest(robot.result))
        statuses = decoded.statuses.of(self._newest(robot.status)) or ()
        ended = any(each.goal.id == goal.goal_id and each.status in ENDED for each in statuses)
        if ended or (result is not None and result.goal_id == goal.goal_id):
            return None
        return self._on_map(goal.frame, goal.pose)

    def _state(self, dead: bool) -> tuple[str, bool]:
        """Return the robot's activity in words, and True if the activity needs attention."""
        if dead:
            return "software stopped", True
        parts = {part: self._context.diagnoses.get(f"{self._robot.key}: {part}") for part in _PARTS}
        known = [each for each in parts.values() if each is not None]
        worrying = [each for each in known if each.level is not DiagnosticLevel.OK]
        drives = parts["navigation"]
        words = [each.message for each in worrying if each is not drives]
        if drives is not None:
            words.append(drives.message)
        return ", ".join(words), bool(worrying)


_PARTS = ("localisation", "navigation")
"""Parts of a robot whose diagnoses describe the robot's activity."""


def thinned(cloud: FloatArray, most: int = THINNED) -> FloatArray:
    """Return at most `most` evenly spaced rows; the result for a cloud is always the same."""
    return cloud if len(cloud) <= most else cloud[np.linspace(0, len(cloud) - 1, most).astype(np.int64)]


def ellipse_of(covariance: FloatArray) -> Ellipse | None:
    """Return the ellipse that contains 95 of 100 places, from a (3, 3) covariance of x, y, theta.

    Return None if the matrix is not a covariance.
    """
    planar = covariance[:2, :2]
    if not np.isfinite(planar).all():
        return None
    (xx, xy), (yx, yy) = planar.tolist()
    middle, half, mixed = 0.5 * (xx + yy), 0.5 * (xx - yy), 0.5 * (xy + yx)
    reach = math.hypot(half, mixed)
    if middle - reach < -1e-9:
        return None
    major, minor = (math.sqrt(CHI_SQUARE_95 * max(variance, 0.0)) for variance in (middle + reach, middle - reach))
    return Ellipse(major, minor, 0.5 * math.atan2(mixed, half))


def end_points(scan: LaserScan, laser_in_map: FloatArray) -> FloatArray:
    """Return (m, 2) points on the map where beams hit something; beams without a hit are omitted.

    Args:
        scan: scan of a laser.
        laser_in_map: (4, 4) pose of the laser; the laser may be upside down.
    """
    ranges = scan.ranges.astype(np.float64)
    met = np.isfinite(ranges) & (ranges >= scan.range_min) & (ranges <= scan.range_max)
    angles = scan.angle_min + np.flatnonzero(met) * scan.angle_increment
    beams = np.column_stack((np.cos(angles), np.sin(angles))) * ranges[met, np.newaxis]
    points: FloatArray = beams @ laser_in_map[:2, :2].T + laser_in_map[:2, 3]
    return points
