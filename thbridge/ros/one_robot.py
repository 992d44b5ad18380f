"""Messages of one robot's ROS nodes (driver, localizer, navigator), tick by tick."""

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple, assert_never

import numpy as np

from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND, Neighbour, Twist
from sim.numerics import elementary
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray
from sim.robot.navigator.navigation import Navigation
from sim.robot.software import PropagatedOutput, RobotOutput
from thbridge.ros.actionlib import (
    FEEDBACK_PERIOD,
    STATUS_PERIOD,
    ActionRequest,
    ActionServerMessage,
    Feedback,
    GoalEnded,
    GoalSet,
    MoveBaseServer,
    StatusList,
)
from thbridge.ros.messages import pack
from thbridge.ros.messages.goal_status import GoalId
from thbridge.ros.messages.records import CancelRequest, GoalRequest, SimpleGoal
from thbridge.ros.names import MAP_FRAME, RobotNames
from thbridge.ros.topics import Planners, RobotTopics, RosMessage, Topic

COMMAND_PERIOD = 5
"""Ticks after which an unchanged command is repeated while there is a goal. This is 10 Hz, because base drivers stop
without commands."""
GLOBAL_FOOTPRINT_PERIOD = TICKS_PER_SECOND
LOCAL_FOOTPRINT_PERIOD = TICKS_PER_SECOND // 5
"""Ticks between two footprints. move_base publishes a footprint at every update of a costmap."""

SHARED_PERIODS = (FEEDBACK_PERIOD, STATUS_PERIOD, TICKS_PER_SECOND)
"""Periods, in ticks, of messages that all robots send in the same ticks: feedback, status lists, batteries."""

UNMEASURED = 1e6
"""Variance of z, roll and pitch, as in ROS drivers. A planar robot does not measure these."""

ODOMETRY_COVARIANCE = pack.covariance(np.diag([1e-3, 1e-3, 1e-3]), UNMEASURED)
"""Constant covariance, as in drivers of real bases. Filters that fuse odometry (robot_pose_ekf, robot_localization) use
its increments. If the covariance grew with the distance, they would distrust each increment."""


class Motion(NamedTuple):
    """Motions of all robots in one tick. Each attribute is a list in the team's order.

    Attributes:
        truth: true poses and twists, as nav_msgs/Odometry.
        odometry: poses and twists measured by the wheels, as nav_msgs/Odometry.
        poses: x, y, theta of the true poses.
        commands: commands to the motors, m/s and rad/s.
        charges: remaining energy.
    """

    truth: Sequence[bytes]
    odometry: Sequence[bytes]
    poses: Sequence[Sequence[float]]
    commands: Sequence[Sequence[float]]
    charges: Sequence[float]


class RobotPublisher:
    """Source of one robot's messages. For messages that are published only after a change, it stores the last content.

    Args:
        robot: its index in the team.
        scan_period: seconds between two scans.
        planners: names of its planners.

    Attributes:
        names: its namespace and frames.
        topics: all topics that it publishes.
        odom_in_map: pose of its frame odom, according to its last estimate. None before the first estimate.
        map_to_odom: packed transform of `odom_in_map` without its head.
        map_to_base: packed frames of its true pose.
        odom_to_base: packed frames of its odometry.
        transform_bytes: length of head, frames and pose in an odometry message. These parts are its transform.
    """

    def __init__(self, robot: int, scan_period: float, planners: Planners) -> None:
        self.names = RobotNames.of(robot)
        self.topics = RobotTopics(self.names, planners)
        self.odom_in_map: Pose2 | None = None
        self.map_to_odom = b""
        self.odom_to_base = pack.frame_names(self.names.odom, self.names.base_footprint)
        self.map_to_base = pack.frame_names(MAP_FRAME, self.names.base_footprint)
        self.transform_bytes = len(pack.head(0)) + len(self.odom_to_base) + pack.POSE_BYTES
        self._robot = robot
        self._base_laser = self.names.base_laser
        self._scan_period = scan_period
        self._server = MoveBaseServer(robot)
        self._navigation: Navigation | None = None
        self._charge = math.nan
        self._lost: bool | None = None
        self._command: Sequence[float] = [0.0, 0.0]
        self._command_tick = 0
        self._plan: FloatArray = np.empty((0, 3))
        self._local_plan: FloatArray = self._plan

    def correct(self, odom_in_map: Pose2) -> None:
        """Set `odom_in_map` and `map_to_odom`."""
        self.odom_in_map = odom_in_map
        self.map_to_odom = pack.frame_names(MAP_FRAME, self.names.odom) + pack.compiled_pose(odom_in_map)

    def received(self, stamp_ns: int, tick: int, request: ActionRequest) -> Iterator[RosMessage]:
        """Yield the message of a client's request. Yield nothing if no message can contain the request."""
        match request:
            case GoalRequest(_, goal_id, goal_stamp_ns, Pose2() as base):
                data = pack.move_base_goal(tick, GoalId(goal_id, goal_stamp_ns), MAP_FRAME, base)
                yield RosMessage(self.topics.goal, stamp_ns, data, foreign=True)
            case SimpleGoal(_, Pose2() as base):
                yield RosMessage(
                    self.topics.simple_goal, stamp_ns, pack.pose_stamped(tick, MAP_FRAME, base), foreign=True
                )
            case CancelRequest(_, goal_id, goal_stamp_ns):
                yield RosMessage(
                    self.topics.cancel, stamp_ns, pack.goal_id(GoalId(goal_id, goal_stamp_ns)), foreign=True
                )

    def goals(
        self, tick: int, requests: Sequence[ActionRequest], output: RobotOutput, dead: bool
    ) -> Sequence[ActionServerMessage]:
        """Return the action server's messages of a tick. `requests` are the clients' requests in this tick."""
        self._server.take(tick, requests)
        return self._server.follow(tick, None if dead else output.navigation)

    def is_quiet(self, tick: int, motion: Motion, output: PropagatedOutput) -> bool:
        """Return True if this output only causes messages of truth and odometry.

        This is the case between two periodic messages while the navigator continues as before. The caller checks the
        conditions that are common to robots: `SHARED_PERIODS`, requests, and true states.
        """
        navigation = output.navigation
        return (
            navigation is self._navigation
            and (navigation.goal is None or tick - self._command_tick < COMMAND_PERIOD)
            and (tick - self._robot) % LOCAL_FOOTPRINT_PERIOD != 0
            and motion.commands[self._robot] == self._command
        )

    def tick(
        self, tick: int, motion: Motion, base: bytes, output: RobotOutput, goals: Sequence[ActionServerMessage]
    ) -> Iterator[tuple[Topic, bytes]]:
        """Yield the messages of a robot in one tick. The robot must not be dead.

        Parts of an extrapolated output are computed on access. So they are only accessed if a message needs them.

        Args:
            tick: number of the tick.
            motion: motions of all robots.
            base: the believed pose, as geometry_msgs/Pose. Empty if no message contains it.
            output: output of its software.
            goals: messages of its action server.
        """
        topics, robot, navigation = self.topics, self._robot, output.navigation
        believed = pack.header(tick, MAP_FRAME) + base if base else b""
        stepped = not isinstance(output, PropagatedOutput)
        if stepped:
            yield from self._errors(motion.poses[robot], output, believed)
        yield topics.odom, motion.odometry[robot]
        if stepped:
            yield from self._sensed(tick, output, believed)
        charge, command = motion.charges[robot], motion.commands[robot]
        if tick % TICKS_PER_SECOND == 0 or charge != self._charge:
            self._charge = charge
            yield topics.battery, pack.battery_state(output.observations.battery, self.names.namespace[1:])
        for message in goals:
            yield self._packed(tick, message, believed)
        repeated = navigation.goal is not None and tick - self._command_tick >= COMMAND_PERIOD
        if repeated or command != self._command:
            self._command, self._command_tick = command, tick
            yield topics.cmd_vel, pack.command(Twist(*command))
        if stepped:
            yield from self._plans(tick, navigation)
        self._navigation = navigation
        if (tick - robot) % LOCAL_FOOTPRINT_PERIOD == 0:
            yield from self._footprints(tick, output.neighbour)

    def _errors(self, true: Sequence[float], output: RobotOutput, believed: bytes) -> Iterator[tuple[Topic, bytes]]:
        """Yield the believed pose and its errors at every scan, and the lost state when it changes."""
        topics, estimate = self.topics, output.estimate
        if estimate.lost is not self._lost:
            self._lost = estimate.lost
            yield topics.lost, pack.boolean(estimate.lost)
        if output.observations.scan is not None:
            base, (x, y, theta) = estimate.base_in_map, true
            yield topics.believed_pose, believed
            yield topics.position_error, pack.float64(elementary.hypot(base.x - x, base.y - y))
            yield topics.heading_error, pack.float64(wrap_angle(base.theta - theta))

    def _sensed(self, tick: int, output: RobotOutput, believed: bytes) -> Iterator[tuple[Topic, bytes]]:
        topics, scan, estimate = self.topics, output.observations.scan, output.estimate
        if scan is not None:
            yield topics.scan, pack.laser_scan(scan, self._base_laser, self._scan_period)
        if estimate.updated:
            yield topics.amcl_pose, believed + pack.covariance(estimate.covariance)
            if estimate.p_wrong is not None:
                yield topics.p_wrong, pack.float64(estimate.p_wrong)
            if len(estimate.particles):
                yield topics.particlecloud, pack.pose_array(tick, MAP_FRAME, estimate.particles)

    def _packed(self, tick: int, message: ActionServerMessage, believed: bytes) -> tuple[Topic, bytes]:
        match message:
            case GoalSet(goal, base):
                return self.topics.goal, pack.move_base_goal(tick, goal, MAP_FRAME, base)
            case StatusList(entries):
                return self.topics.status, pack.goal_status_array(tick, entries)
            case Feedback(entry):
                return self.topics.feedback, pack.move_base_feedback(tick, entry, believed)
            case GoalEnded(entry):
                return self.topics.result, pack.move_base_result(tick, entry)
            case _:
                assert_never(message)

    def _plans(self, tick: int, navigation: Navigation) -> Iterator[tuple[Topic, bytes]]:
        topics = self.topics
        if not _is_rest(navigation.plan, self._plan):
            yield topics.plan, pack.path(tick, MAP_FRAME, navigation.plan)
        self._plan = navigation.plan
        local_plan = navigation.local_plan
        if local_plan is not self._local_plan and not _equal(local_plan, self._local_plan):
            yield topics.local_plan, pack.path(tick, MAP_FRAME, local_plan)
        self._local_plan = local_plan
        if navigation.global_costmap is not None:
            yield topics.global_costmap, pack.costmap(MAP_FRAME, navigation.global_costmap.read())
        if navigation.local_costmap is not None:
            yield topics.local_costmap, pack.costmap(MAP_FRAME, navigation.local_costmap.read())

    def _footprints(self, tick: int, robot: Neighbour) -> Iterator[tuple[Topic, bytes]]:
        if not len(robot.footprint):
            return
        corners = pack.polygon(tick, MAP_FRAME, _moved(robot.base_in_map, robot.footprint))
        yield self.topics.local_footprint, corners
        if (tick - self._robot) % GLOBAL_FOOTPRINT_PERIOD == 0:
            yield self.topics.global_footprint, corners


def _moved(pose: Pose2, corners: FloatArray) -> list[tuple[float, float]]:
    """Return the result of `Pose2.transform` for (v, 2) points, bit for bit. For few points, this loop is faster."""
    c, s = elementary.cos_sin(pose.theta)
    return [(pose.x + c * x - s * y, pose.y + s * x + c * y) for x, y in corners.tolist()]


def _is_rest(plan: FloatArray, last: FloatArray) -> bool:
    """Return True if a plan is equal to the last plan, or to the rest of the last plan from the current pose.

    Then it is not published again.
    """
    if plan is last:
        return True
    if not len(plan):
        return not len(last)
    ahead = plan[1:]
    return len(plan) <= len(last) and _equal(last[len(last) - len(ahead) :], ahead)


def _equal(poses: FloatArray, others: FloatArray) -> bool:
    """Return True if (n, 3) and (m, 3) poses are equal. The last pose is compared first, because it usually differs."""
    if len(poses) != len(others):
        return False
    return not len(poses) or (poses[-1, 0] == others[-1, 0] and bool((poses == others).all()))
