"""Real robot of a team. Its messages become the output of a robot in the team. Inputs become messages to the robot.

Time stamps in messages are times of the robot's own clock, and are only compared with each other. Times of arrival are
times of our clock. The charge is from the real battery, not from the game. The turn rate is from odometry.
"""

import math
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import assert_never

import numpy as np

from sim.common.geometry import Pose2
from sim.common.observations import Battery, Imu, Neighbour, Observations, Odometry
from sim.common.robot_numbers import namespace_of, robot_name
from sim.inputs import CancelGoal, DriveManually, SendGoal, SetPoseEstimate
from sim.numerics import elementary_arrays
from sim.numerics.float_array import FloatArray
from sim.robot.navigator.navigation import Navigation
from sim.robot.software import RobotOutput
from thbridge.ros import names
from thbridge.ros.clients import InvalidMessage
from thbridge.ros.messages import pack, types, unpack
from thbridge.ros.messages.goal_status import GoalId
from thbridge.ros.messages.stamps import TICK_NS, tick_of
from thbridge.ros.remote.changes import RobotPart
from thbridge.ros.remote.goals import MoveBaseClient, OutgoingCancel, OutgoingGoal
from thbridge.ros.remote.names import RemoteNames
from thbridge.ros.remote.pose import STALE_NS, RemotePose
from thbridge.ros.remote.topic_states import NO_POSES, RemotePlan, RemoteScans, VelocityCommands
from thbridge.ros.topics import RosMessage, Topic

RemoteInput = SendGoal | CancelGoal | DriveManually | SetPoseEstimate
"""Inputs that real robots accept."""

_NO_TIMES: FloatArray = np.empty(0)

_transforms = lru_cache(maxsize=4)(unpack.transforms)
"""Decoder of messages of /tf. It has a cache, because all robots read the same messages."""


class RemoteRobot:
    """Real robot of a team.

    Args:
        robot: its index in the team.
        named: names of its topics and frames.
        caller: name of our node, with which the ids of our goals start.
        footprint: (n, 2) corners of its body in the base frame, meters.
        stale_ns: time without messages after which a part of the robot counts as dead.

    Attributes:
        names: names of its topics and frames.
        outgoing: messages that must be published. The publisher empties the list.
        subscriptions: topics that `receive` accepts, with their message types.
        publications: topics of the messages in `outgoing`.
    """

    def __init__(
        self, robot: int, named: RemoteNames, caller: str, footprint: FloatArray, stale_ns: int = STALE_NS
    ) -> None:
        self.outgoing: list[RosMessage] = []
        self._robot = robot
        self.names = named
        self._footprint = footprint
        self._pose = RemotePose(named, stale_ns)
        self._goals = MoveBaseClient(f"{caller}-{namespace_of(robot)}-", stale_ns)
        self._scans = RemoteScans(named.base_frame)
        self._plan = RemotePlan()
        self._set_goal = Topic(named.action("goal"), types.MOVE_BASE_GOAL)
        self._cancel = Topic(named.action("cancel"), types.GOAL_ID)
        cmd_vel = Topic(named.cmd_vel, types.TWIST)
        self._commands = VelocityCommands(lambda data, now_ns: self._publish(cmd_vel, data, now_ns))
        self._initialpose = Topic(named.initialpose, types.POSE_WITH_COVARIANCE)
        self.publications = (self._set_goal, self._cancel, cmd_vel, self._initialpose)
        pose, goals = self._pose, self._goals
        self._handlers: dict[str, tuple[str, Callable[[bytes, int], InvalidMessage | None]]] = {
            names.TF: (types.TFMESSAGE, lambda data, now: pose.receive_transforms(_transforms(data), now)),
            names.TF_STATIC: (types.TFMESSAGE, self._scans.receive_static),
            named.odom: (types.ODOMETRY, lambda data, now: pose.receive_odometry(unpack.odometry(data), now)),
            named.amcl_pose: (
                types.POSE_WITH_COVARIANCE,
                lambda data, _: pose.receive_pose(unpack.pose_with_covariance(data)),
            ),
            named.scan: (types.LASER_SCAN, self._scans.receive),
            named.battery: (types.BATTERY_STATE, self._receive_battery),
            named.cmd_vel: (types.TWIST, self._commands.receive),
            named.plan: (types.PATH, self._plan.receive),
            named.action("goal"): (types.MOVE_BASE_GOAL, self._receive_goal),
            named.action("status"): (
                types.GOAL_STATUS_ARRAY,
                lambda data, now: goals.receive_status(unpack.goal_status_array(data), now),
            ),
            named.action("result"): (
                types.MOVE_BASE_RESULT,
                lambda data, now: goals.receive_result(unpack.goal_result(data), now),
            ),
        }
        self.subscriptions = {topic: kind for topic, (kind, _) in self._handlers.items()}
        self._battery = (math.nan, math.nan, 0)

    def missing(self) -> list[str]:
        """Return the messages that are missing before the robot can be used, each with its topic."""
        named = self.names
        parts = []
        if self._pose.received_ns is None:
            parts.append(f"no odometry on {named.odom}, or {named.odom_frame} -> {named.base_frame} on {named.tf}")
        if not self._pose.localized:
            parts.append(f"no pose on {named.amcl_pose}, or {named.map_frame} -> {named.odom_frame} on {named.tf}")
        if not self._goals.server_seen:
            parts.append(f"no action server {named.move_base}")
        return parts

    def silent_parts(self, now_ns: int) -> frozenset[RobotPart]:
        """Return the parts of the robot that were active before, but are silent now."""
        silent = {
            RobotPart.ODOMETRY: self._pose.is_silent(now_ns),
            RobotPart.NAVIGATION: self._goals.is_silent(now_ns),
            RobotPart.LOCALIZATION: self._pose.is_lost(now_ns),
        }
        return frozenset(part for part, is_silent in silent.items() if is_silent)

    @property
    def resent_goals(self) -> int:
        """Number of goals that were sent a second time, because the robot's navigation did not report them."""
        return self._goals.resent

    def take_notices(self) -> list[str]:
        """Return the sentences for people about the robot's odometry since the last call."""
        notices, self._pose.notices = self._pose.notices, []
        return notices

    def stamp_odometry_later(self, later_ns: int) -> None:
        """Add a time to the time stamps of the robot's odometry. See `RemotePose`."""
        self._pose.stamp_odometry_later(later_ns)

    def receive(self, topic: str, data: bytes, now_ns: int) -> InvalidMessage | None:
        """Process a message of a topic and type in `subscriptions`. Return the reason if it cannot be used."""
        try:
            return self._handlers[topic][1](data, now_ns)
        except ValueError as error:
            return InvalidMessage(str(error))

    def take(self, item: RemoteInput, now_ns: int) -> None:
        """Send an input to the robot."""
        match item:
            case SendGoal(_, goal):
                self._commands.stop(now_ns)
                self._goals.go(goal, now_ns)
            case CancelGoal():
                self._commands.stop(now_ns)
                self._goals.cancel(now_ns)
            case DriveManually(_, command, ticks):
                self._goals.cancel(now_ns)
                self._commands.drive(command, now_ns, ticks * TICK_NS)
            case SetPoseEstimate(_, base_in_map, covariance):
                data = pack.pose_with_covariance(tick_of(now_ns), self.names.map_frame, base_in_map, covariance)
                self._publish(self._initialpose, data, now_ns)
            case _:
                assert_never(item)

    def stop(self, now_ns: int) -> None:
        """Stop the robot, because no more messages will be sent to it."""
        self._commands.stop(now_ns)
        self._goals.cancel(now_ns)
        self._publish_goals(now_ns)

    def step(self, now_ns: int) -> RobotOutput | None:
        """Return the robot's current output, or None while messages are missing (see `missing`)."""
        tick = tick_of(now_ns)
        estimate, received_ns = self._pose.estimate(tick, now_ns), self._pose.received_ns
        if estimate is None or received_ns is None:
            return None
        self._goals.step(now_ns, lost=estimate.lost, stale=self._pose.is_silent(now_ns))
        self._commands.step(now_ns)
        navigation = self._navigation(estimate.base_in_map, now_ns)
        self._publish_goals(now_ns)
        observations = Observations(
            tick_of(received_ns),
            Odometry(tick_of(received_ns), self._pose.base_in_odom, self._pose.twist),
            Imu(tick_of(received_ns), self._pose.twist.angular),
            self._scans.take(),
            Battery(tick_of(self._battery[2]), self._battery[0], self._battery[1]),
        )
        neighbour = Neighbour(
            self._robot, estimate.base_in_map, self._pose.twist, self._footprint, navigation.plan[:, :2], _NO_TIMES
        )
        return RobotOutput(observations, estimate, navigation, neighbour)

    # Received messages

    def _receive_battery(self, data: bytes, now_ns: int) -> None:
        message = unpack.battery_state(data)
        self._battery = message.charge, message.charge / message.percentage if message.percentage else math.nan, now_ns

    def _receive_goal(self, data: bytes, now_ns: int) -> None:
        message = unpack.move_base_goal(data)
        self._goals.receive_goal(message.goal_id, message.pose, now_ns)

    # Output

    def _navigation(self, here: Pose2, now_ns: int) -> Navigation:
        goal = self._goals.goal(now_ns, here)
        plan = NO_POSES if goal is None else self._plan.ahead(here, goal.base_in_map, self._goals.sent_ns)
        remaining = 0.0
        if len(plan):
            remaining = float(elementary_arrays.hypot(*np.diff(plan[:, :2], axis=0).T).sum())
        elif goal is not None:
            remaining = here.distance(goal.base_in_map)
        return Navigation(
            command=self._commands.current(now_ns),
            goal=goal,
            state="idle" if goal is None else "controlling" if self._goals.active else "planning",
            plan=plan,
            times=_NO_TIMES,
            local_plan=NO_POSES,
            result=self._goals.results.pop(0) if self._goals.results else None,
            remaining=remaining,
        )

    # Sent messages

    def _publish_goals(self, now_ns: int) -> None:
        message, self._goals.outgoing = self._goals.outgoing, []
        for item in message:
            match item:
                case OutgoingGoal(goal_id, base_in_map):
                    data = pack.move_base_goal(tick_of(now_ns), goal_id, self.names.map_frame, base_in_map)
                    self._publish(self._set_goal, data, now_ns)
                case OutgoingCancel(name):
                    # In actionlib, an id with the time 0 cancels only the goal with this id.
                    self._publish(self._cancel, pack.goal_id(GoalId(name, 0)), now_ns)
                case _:
                    assert_never(item)

    def _publish(self, topic: Topic, data: bytes, now_ns: int) -> None:
        self.outgoing.append(RosMessage(topic, now_ns, data))


def missing_of(robots: Sequence[RemoteRobot]) -> list[str]:
    """Return a sentence for each robot that cannot be used yet. It lists the missing messages."""
    return [
        f"{robot_name(robot)} is not ready yet: {'; '.join(parts)}"
        for robot, remote in enumerate(robots)
        if (parts := remote.missing())
    ]
